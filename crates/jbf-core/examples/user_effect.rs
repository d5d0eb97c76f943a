//! A user-defined effect combined with effects of the catalogue: a wiper whose friction varies over
//! a turn.
//!
//! No change of the crate is necessary.
//!
//! ```text
//! cargo run --example user_effect
//! ```

use jbf_core::effect::sensor_lag::{self, SensorLag};
use jbf_core::effect::{Effect, Rig};
use jbf_core::law::stribeck::{self, Stribeck};
use jbf_core::JournalMotion;
use jbf_core::{Chain, Error, Friction, Motion, Real};

/// Wiper with the friction `F_w (1 + sin th)/2`, where `th` is the shaft angle.
#[derive(Clone, Copy, Debug)]
struct Wiper<T> {
    force_n: T,
}

impl<T: Real> Effect<T> for Wiper<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    fn add_friction(
        &self,
        _state: &(),
        journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        _transmitted_n: &mut T,
    ) {
        let share = (T::ONE + journal.angle_rad.sin()) * T::of(0.5);
        sum_n.jump += self.force_n * share;
    }
}

fn main() -> Result<(), Error> {
    let law = Stribeck::new(stribeck::Parameters::default())?;
    let lag = SensorLag::new(sensor_lag::Parameters { tau_s: 0.05 })?;
    let bare = Chain::new(law).with(lag);
    let wiped = bare.with(Wiper { force_n: 2.0 });
    let motion = |t: f64| Motion {
        time_s: t,
        velocity_m_s: 0.127 * t.sin(),
        acceleration_m_s2: 0.127 * t.cos(),
        angle_rad: 10.0 * (1.0 - t.cos()),
        ..Motion::default()
    };
    let (mut a, mut b) = (bare.start(&motion(0.0)), wiped.start(&motion(0.0)));
    println!("time_s,bare_n,wiped_n");
    for i in 1..=3000 {
        let (t, dt) = (0.002 * f64::from(i), 0.002);
        let (bare_n, wiped_n) = (
            bare.step(&mut a, &motion(t), dt),
            wiped.step(&mut b, &motion(t), dt),
        );
        if i % 250 == 0 {
            println!("{t:.1},{bare_n:.3},{wiped_n:.3}");
        }
    }
    Ok(())
}
