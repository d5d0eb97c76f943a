//! Tests of control loops with friction models that have steep viscous friction.
//!
//! Such a loop is as accurate if friction stops the shaft in a fraction of a time step as if this
//! takes many steps.

mod common;

use common::bench::{self, Control, COUNTS_PER_RAD, DRIVE, DT_S, LOAD_N};
use common::chain_round;
use jbf_core::compensator::LawModel;
use jbf_core::compensator::Observed;
use jbf_core::law::coulomb::Coulomb;
use jbf_core::law::{Law, Named};
use jbf_core::plant::Plant;
use jbf_core::reference::Target;
use jbf_core::{Chain, Clock, Real};

const SETTLED: u32 = 4000;
const SEEN: u32 = 1000;

fn law<T: Real>(viscous: f64) -> Coulomb<T> {
    let values = [8.0, 10.0, viscous].map(T::of);
    Coulomb::build(None, None, &values, Clock::Journal).expect("in the bounds")
}

/// RMS of the tracking error over a period, relative to the amplitude of the target.
fn error<T: Real>(control: Control, viscous: f64, times: f64) -> f64 {
    let chain: Chain<f64, Coulomb<f64>> = chain_round(law(viscous), &[]);
    let model = LawModel::new(law::<T>(viscous), 0.0127, DRIVE.volts_per_n, LOAD_N);
    let compensator = Observed::new(model, &bench::settings(control)).expect("settings");
    let controller = bench::controller::<T, _>(control, compensator);
    // An amplitude within the ability of the drive.
    let viscous_v = chain.law.friction(&chain.law.start(LOAD_N), 0.0127).smooth * DRIVE.volts_per_n;
    let size = times * 1.5 / (1.0 + 1.5 * viscous_v);
    let plant = Plant::new(chain, DRIVE, DT_S / 2.0).expect("the thesis's drive");
    let (mut shaft, mut state) = (plant.start(LOAD_N, 0.1), controller.start());
    let mut square = 0.0;
    for i in 0..SETTLED + SEEN {
        let counter = ((shaft.angle_rad * COUNTS_PER_RAD).floor() as i64) as u32 & 0xffff;
        let rate = core::f64::consts::TAU / (f64::from(SEEN) * DT_S);
        let phase = rate * f64::from(i) * DT_S;
        let (value, slope) = (size * phase.sin(), rate * size * phase.cos());
        if i >= SETTLED {
            let there = match control {
                Control::Position => shaft.angle_rad,
                Control::Velocity => shaft.speed_rad_s,
            };
            square += (there - value).powi(2) / f64::from(SEEN);
        }
        let target = Target {
            value: T::of(value),
            rate: T::of(slope),
        };
        let parts = controller.step(&mut state, counter, &target);
        for _ in 0..2 {
            plant.step(&mut shaft, parts.output_v.value(), LOAD_N);
        }
    }
    square.sqrt() / size
}

/// Viscous friction, N s/m.
///
/// The time constant of the shaft is 7 ms without viscous friction, and a seventh of a step with
/// the largest value.
const VISCOUS: [f64; 10] = [0.0, 1e3, 2e3, 2.4e3, 3e3, 4e3, 5e3, 7e3, 1e4, 2e4];

#[test]
fn steep_viscous_friction_raises_the_position_error_by_at_most_20_percent() {
    let without = error::<f64>(Control::Position, 0.0, 1.0);
    for viscous in VISCOUS {
        let (double, single) = (
            error::<f64>(Control::Position, viscous, 1.0),
            error::<f32>(Control::Position, viscous, 1.0),
        );
        println!("{viscous} N s/m: {double:.4}, {single:.4} in single precision");
        for error in [double, single] {
            assert!(
                error < 1.2 * without,
                "{viscous}: {error}, {without} without"
            );
        }
    }
}

/// The observer stays stable with a target of ten times the ability of the drive.
///
/// The saturated voltage differs from the commanded one, and so does the friction that is
/// cancelled.
#[test]
fn observer_stays_stable_if_the_drive_saturates() {
    for viscous in VISCOUS {
        for error in [
            error::<f64>(Control::Position, viscous, 10.0),
            error::<f32>(Control::Position, viscous, 10.0),
        ] {
            // Less than the error without any motion.
            assert!(error < 0.7, "{viscous}: {error}");
        }
    }
}
