//! A user-defined effect combined with effects of the catalogue: a wiper whose friction varies over
//! a turn.
//!
//! No change of the crate is necessary.
//!
//! ```text
//! cargo run --example user_effect
//! ```

use jbf_core::effect::{Beside, Effect, Effects, Info, OtherFriction, Parameter, Rig, Stage};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::motion::JournalMotion;
use jbf_core::{Bearing, Chain, Clock, Friction, Motion, ParameterError, Real};

/// Wiper with the friction `F_w (1 + sin th)/2`, where `th` is the shaft angle.
#[derive(Clone, Copy, Debug)]
struct Wiper<T> {
    force_n: T,
}

impl<T: Real> Effect<T> for Wiper<T> {
    const INFO: Info = Info::new("wiper", Stage::Other)
        .summary("a wiper that drags harder in one half of each turn")
        .equation("+ F_w (1 + sin th)/2 sgn v")
        .source("this example")
        .limits("a stiff wiper: it does not bend before it slides")
        .parameters(&[Parameter::new("F_w_n", "N", "largest drag", [0.0, 1e3], &[1.0]).null(0.0)]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            force_n: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> OtherFriction<T> for Wiper<T> {
    fn friction_n(&self, _state: &(), journal: &JournalMotion<T>) -> Friction<T> {
        let share = (T::ONE + journal.angle_rad.sin()) * T::of(0.5);
        Friction {
            jump: self.force_n * share,
            smooth: T::ZERO,
        }
    }
}

fn main() -> Result<(), ParameterError> {
    let law = Journal::new(
        &Bearing::THESIS,
        104.0,
        &Parameters::TABLE_4_2,
        Clock::Journal,
    )?;
    let mut effects = Effects::NONE;
    effects.set("sensor_lag", &[0.05])?;
    let bearing = Some(&Bearing::THESIS);
    let bare = Chain::round(law, effects, bearing);
    let wiper = Beside(Wiper::new(&[2.0])?);
    let wiped = Chain::round(law, effects.with(wiper), bearing);
    let motion = |t: f64| {
        Motion::at_rest(104.0)
            .with_time_s(t)
            .with_velocity_m_s(0.127 * t.sin())
            .with_acceleration_m_s2(0.127 * t.cos())
            .with_angle_rad(10.0 * (1.0 - t.cos()))
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
