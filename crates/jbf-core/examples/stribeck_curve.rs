//! Prints the Stribeck curve for the parameters of Table 4.2 (Cohn 1998): speed, eccentricity ratio
//! and steady friction coefficient.
//!
//! `cargo run -p jbf-core --example stribeck_curve`

use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Clock, Error};

fn main() -> Result<(), Error> {
    let law = Journal::new(
        &Bearing::THESIS,
        104.0,
        &Parameters::TABLE_4_2,
        Clock::Journal,
    )?;
    println!(
        "{:>8}  {:>8}  {:>8}  {:>8}",
        "U, m/s", "eps", "phi, rad", "f"
    );
    for i in 0..=24 {
        // From creep to full film, six points per decade.
        let speed_m_s = 1e-4 * 10.0_f64.powf(f64::from(i) / 6.0);
        let film = law.steady(speed_m_s)?;
        let bar = "*".repeat((film.coefficient * 200.0).round() as usize);
        println!(
            "{:8.5}  {:8.5}  {:8.4}  {:8.5}  {bar}",
            speed_m_s, film.eps, film.phi_rad, film.coefficient
        );
    }
    Ok(())
}
