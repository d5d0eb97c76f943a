//! A user-defined law combined with effects of the catalogue: dry friction that falls with a power
//! of the speed, `F = F_1 (|v|/v_1)^-p`.
//!
//! No change of the crate is necessary.
//!
//! ```text
//! cargo run --example user_law
//! ```

use jbf_core::effect::inertia::{self, Inertia};
use jbf_core::effect::presliding::{self, Presliding};
use jbf_core::effect::sensor_lag::{self, SensorLag};
use jbf_core::law::Law;
use jbf_core::{Chain, Error, Friction, Motion, Real};

/// Friction of a slide, `F_1 (|v|/v_1)^-p`, N.
///
/// The friction does not depend on the load. Its coefficient is the friction relative to a load of
/// one newton.
#[derive(Clone, Copy, Debug)]
struct FallingPower<T> {
    at_unit_speed_n: T,
    unit_speed_m_s: T,
    power: T,
}

impl<T: Real> Law<T> for FallingPower<T> {
    type State = ();

    fn start(&self, _load_n: T) {}

    // A law in newtons: every load is one newton.
    fn pressed_n(&self, _load_n: T) -> T {
        T::ONE
    }

    fn set_load(&self, _state: &mut (), _load_n: T) {}

    fn friction(&self, _state: &(), velocity_m_s: T) -> Friction<T> {
        // Bounded at zero speed: a step never returns a value that is not finite.
        let speed = velocity_m_s.abs().max(T::of(1e-6)) / self.unit_speed_m_s;
        Friction {
            jump: self.at_unit_speed_n * (-self.power * speed.ln()).exp(),
            smooth: T::ZERO,
        }
    }

    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        f64::INFINITY
    }

    fn advance(&self, _state: &mut (), _speed_m_s: [T; 3], _rate: T, _dt_s: T) {}
}

fn main() -> Result<(), Error> {
    let law = FallingPower {
        at_unit_speed_n: 4.0,
        unit_speed_m_s: 0.01,
        power: 0.1,
    };
    let chain = Chain::new(law)
        .with(Inertia::new(inertia::Parameters { m_e: 2.0 })?)
        .with(Presliding::new(presliding::Parameters { sigma: 1e5 })?)
        .with(SensorLag::new(sensor_lag::Parameters { tau_s: 0.01 })?);
    let mut state = chain.start(&Motion::default());
    println!("time_s,friction_n");
    for i in 1..=3000 {
        let (t, dt) = (0.002 * f64::from(i), 0.002);
        let friction_n = chain.step_velocity(&mut state, 0.05 * t.sin(), dt);
        if i % 250 == 0 {
            println!("{t:.1},{friction_n:.3}");
        }
    }
    Ok(())
}
