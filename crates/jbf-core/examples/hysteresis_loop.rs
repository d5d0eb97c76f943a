//! Prints one period of friction against speed, U = 0.127 sin(t).
//!
//! The friction at rising speed differs from that at falling speed, and the peak follows the
//! reversal.
//!
//! `cargo run -p jbf-core --example hysteresis_loop`

use jbf_core::effect::{Effects, Rig};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Chain, Clock, Error, Motion};
use std::f64::consts::TAU;

const LOAD_N: f64 = 104.0;
const AMPLITUDE_M_S: f64 = 0.127;

/// Imposed motion at a time; angle and acceleration follow from the speed.
fn motion(time_s: f64) -> Motion<f64> {
    Motion {
        time_s,
        velocity_m_s: AMPLITUDE_M_S * time_s.sin(),
        acceleration_m_s2: AMPLITUDE_M_S * time_s.cos(),
        angle_rad: AMPLITUDE_M_S * (1.0 - time_s.cos()) / Bearing::THESIS.radius_m,
        ..Motion::at_rest(LOAD_N)
    }
}

fn main() -> Result<(), Error> {
    let law = Journal::new(
        &Bearing::THESIS,
        LOAD_N,
        &Parameters::TABLE_4_2,
        Clock::Journal,
    )?;
    let rig = Rig {
        radius_m: Bearing::THESIS.radius_m,
        count: 4.0,
        force_at_drive: false,
    };
    let chain = Chain {
        law,
        effects: Effects::NONE,
        rig,
    };

    // 40 rows per period, 80 steps per row, none at rest; the first period only settles the film.
    let dt_s = TAU / 3200.0;
    let mut state = chain.start(&motion(0.0));
    println!("{:>7}  {:>8}  {:>9}", "t, s", "U, m/s", "f");
    for i in 1..=6400 {
        let to = motion(dt_s * f64::from(i));
        let force_n = chain.step(&mut state, &to, dt_s);
        if i > 3200 && i % 80 == 40 {
            let f = force_n / LOAD_N;
            let column = (30.0 + f * 400.0).round() as usize;
            println!(
                "{:7.3}  {:8.4}  {f:9.5}  {:>column$}",
                to.time_s, to.velocity_m_s, "*"
            );
        }
    }
    Ok(())
}
