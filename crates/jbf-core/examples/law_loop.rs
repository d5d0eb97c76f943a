//! Prints the hysteresis loop of any law in newtons, and the steady friction of the law against
//! speed.
//!
//! The loop is friction against position over one stroke forward and back.
//!
//! `cargo run -p jbf-core --example law_loop -- lugre`

use jbf_core::effect::{Effects, Rig};
use jbf_core::law::{steady_n, with_law, Named, Visitor, CATALOGUE};
use jbf_core::{Chain, Clock, Error, Motion};
use std::f64::consts::TAU;

/// Imposed motion at a time: a stroke of 2 mm every two seconds.
fn motion(time_s: f64) -> Motion<f64> {
    let (sin, cos) = (0.5 * TAU * time_s).sin_cos();
    Motion {
        time_s,
        velocity_m_s: 1e-3 * 0.5 * TAU * sin,
        angle_rad: -1e-3 * cos, // on a linear axis the place, m
        ..Motion::at_rest(1.0)
    }
}

/// Prints a table of the second period: forty rows, one every fifty steps.
struct Table;

impl Visitor<f64> for Table {
    type Output = Vec<(Motion<f64>, f64)>;

    fn visit<L: Named<f64>>(self, law: L) -> Self::Output {
        let chain = Chain {
            law,
            effects: Effects::NONE,
            rig: Rig::default(),
        };
        let mut state = chain.start(&motion(0.0));
        let step = |i: u32| {
            let to = motion(1e-3 * f64::from(i));
            (to, chain.step(&mut state, &to, 1e-3))
        };
        let rows: Vec<_> = (1..=4000).map(step).collect();
        rows[1999..].iter().step_by(50).copied().collect()
    }
}

fn main() -> Result<(), Error> {
    let name = std::env::args().nth(1).unwrap_or("lugre".into());
    let Some(law) = CATALOGUE
        .iter()
        .find(|l| l.name == name && !l.needs_bearing)
    else {
        let known = CATALOGUE.iter().filter(|l| !l.needs_bearing);
        let known: Vec<_> = known.map(|l| l.name).collect();
        println!("Laws in newtons: {}", known.join(", "));
        return Ok(());
    };
    println!("{}: {}\n{}\n", law.name, law.summary, law.equation);
    let values: Vec<f64> = law.parameters.iter().map(|p| p.starts[0]).collect();
    for (p, v) in law.parameters.iter().zip(&values) {
        println!("{:>14} = {v:<10} {}", p.name, p.meaning);
    }
    println!("\n{:>8}  {:>9}  {:>8}", "x, mm", "v, mm/s", "F, N");
    for (m, force_n) in with_law(&name, None, None, &values, Clock::Journal, Table)? {
        let bar = (30.0 + force_n * 1.5).round().max(0.0) as usize;
        println!(
            "{:8.3}  {:9.3}  {force_n:8.3}  {:>bar$}",
            m.angle_rad * 1e3,
            m.velocity_m_s * 1e3,
            "*"
        );
    }
    println!("\n{:>9}  {:>8}", "v, mm/s", "steady F");
    for k in -8..=2 {
        let v = 10.0_f64.powf(0.5 * f64::from(k));
        let mut force_n = [0.0];
        steady_n(
            &name,
            None,
            None,
            &values,
            Clock::Journal,
            &[v],
            &mut force_n,
        )?;
        println!("{:9.3}  {:8.3}", v * 1e3, force_n[0]);
    }
    Ok(())
}
