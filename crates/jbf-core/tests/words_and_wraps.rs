//! Tests of a law whose bristle does not deflect, an instrument alone, a periodic table, and learned
//! viscous friction.

mod common;

use common::{bench, chain, chain_round, readings};
use jbf_core::compensator::learning::Learned;
use jbf_core::compensator::{Axis, Table};
use jbf_core::compensator::{Compensator, Input};
use jbf_core::internals::read_force;
use jbf_core::law::Law;
use jbf_core::{Friction, Motion};

/// Law that declares a bristle but does not implement its deflection.
#[derive(Clone, Copy, Debug)]
struct Rigid(f64);

impl Law<f64> for Rigid {
    type State = ();

    const HAS_BRISTLE: bool = true;

    fn start(&self, _load_n: f64) {}

    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        f64::INFINITY
    }

    fn set_load(&self, _state: &mut (), _load_n: f64) {}

    fn friction(&self, _state: &(), _velocity_m_s: f64) -> Friction<f64> {
        Friction {
            jump: self.0,
            smooth: 0.0,
        }
    }

    fn advance(&self, _state: &mut (), _speed_m_s: [f64; 3], _rate: f64, _dt_s: f64) {}
}

/// The friction of a bristle that does not deflect is its level with the sign of the motion, and
/// zero at rest.
#[test]
fn rigid_bristle_gives_its_level_along_the_motion() {
    let speeds = [0.1, 0.2, 0.1, 0.0, 0.0, -0.1, -0.3, 0.0];
    let got = readings(&chain_round(Rigid(0.2), &[]), 0.01, 7, |t| {
        let mut motion = Motion::at_rest(100.0);
        motion.time_s = t;
        motion.velocity_m_s = speeds[(t / 0.01).round() as usize];
        motion
    });
    for (speed, n) in speeds.iter().zip(&got) {
        let direction = if *speed == 0.0 { 0.0 } else { speed.signum() };
        assert!((n - 20.0 * direction).abs() < 1e-12, "{speed} m/s: {n} N");
    }
}

/// Readings of the instrument effects for a force, one per sample.
fn read(effects: &[(&str, &[f64])], time_s: &[f64], force_n: &[f64]) -> Vec<f64> {
    let mut out = Vec::new();
    read_force(&chain::<f64>(effects).effects, time_s, force_n, |i, n| {
        assert_eq!(i, out.len(), "samples come in order");
        out.push(n);
    });
    out
}

/// A lag follows its differential equation along linear segments of the force with any sampling
/// interval.
///
/// At a slope `s` the reading lags by `s tau (1 - exp(-t / tau))`.
#[test]
fn lag_of_linear_segments_follows_its_differential_equation() {
    let tau_s = 0.1;
    for step_s in [0.005, 0.05, 0.25] {
        let time_s: Vec<f64> = (0..40).map(|i| 3.0 + step_s * f64::from(i)).collect();
        let force_n: Vec<f64> = time_s.iter().map(|t| 2.0 + 5.0 * (t - 3.0)).collect();
        let got = read(&[("sensor_lag", &[tau_s])], &time_s, &force_n);
        for ((t, n), got) in time_s.iter().zip(&force_n).zip(&got) {
            let late = 5.0 * tau_s * (1.0 - (-(t - 3.0) / tau_s).exp());
            assert!(
                (got - (n - late)).abs() < 2e-3,
                "{step_s} {t}: {got} {}",
                n - late
            );
        }
    }
}

/// The drift of a sensor is zero at the first sample of a run, regardless of the origin of time.
#[test]
fn drift_is_zero_at_the_first_sample() {
    let time_s: Vec<f64> = (0..12).map(|i| 50.0 + 0.5 * f64::from(i)).collect();
    let got = read(&[("sensor_drift", &[0.2])], &time_s, &[1.0; 12]);
    for (t, got) in time_s.iter().zip(&got) {
        assert!((got - (1.0 + 0.2 * (t - 50.0))).abs() < 1e-12, "{t}: {got}");
    }
}

/// A table of friction against the angle covers one period and is linear between its entries.
///
/// The last entry is followed by the first, in both directions.
#[test]
fn table_over_the_angle_is_periodic() {
    let table = Table::new([1.0, 3.0, 2.0, 6.0], Axis::Angle, 0.5, 0.0).expect("a table");
    let levels = [
        (0.0, 1.0),
        (0.25, 2.0),
        (0.5, 3.0),
        (1.0, 2.0),
        (1.25, 4.0),
        (1.5, 6.0),
        (1.75, 3.5),
    ];
    for (angle, level) in levels {
        for periods in [-3.0, -1.0, 0.0, 1.0, 7.0] {
            let got: f64 = table.at(angle + 2.0 * periods);
            assert!((got - level).abs() < 1e-12, "{angle} {periods}: {got}");
        }
    }
}

/// A table of friction against the speed ignores its sign; the last entry applies to higher speeds.
#[test]
fn table_over_the_speed_holds_its_last_entry() {
    let table = Table::new([1.0, 3.0, 2.0], Axis::Speed, 0.5, 0.0).expect("a table");
    let levels = [
        (0.0, 1.0),
        (0.25, 2.0),
        (0.5, 3.0),
        (0.75, 2.5),
        (1.0, 2.0),
        (9.0, 2.0),
    ];
    for (speed, level) in levels {
        for sign in [1.0, -1.0] {
            let got: f64 = table.at(sign * speed);
            assert!((got - level).abs() < 1e-12, "{speed}: {got}");
        }
    }
}

/// The learned gamma scales viscous friction only, in proportion.
///
/// For a gamma of zero, only dry friction remains.
#[test]
fn viscous_friction_is_proportional_to_the_learned_gamma() {
    let sent = |gamma: f64, velocity_rad_s: f64| {
        let learned = Learned {
            gamma,
            ..Learned::THESIS
        };
        let loop_ = bench::learning::<f64>(bench::Control::Velocity).resumed(learned);
        let input = Input {
            velocity_rad_s,
            ..Input::default()
        };
        loop_.step(&mut loop_.start(), &input).sum_v
    };
    for velocity in [0.5, 4.0, -4.0] {
        let [one, two, three] = [33.0, 66.0, 99.0].map(|gamma| sent(gamma, velocity));
        let viscous = two - one;
        assert!(viscous * velocity > 0.0, "{velocity}: {viscous} V");
        assert!((three - two - viscous).abs() < 1e-12 * three.abs());
        // Asperities just touch at the start: there is no dry friction yet.
        assert!(
            (one - viscous).abs() < 1e-9 * one.abs(),
            "{velocity}: {one} V, {viscous} V"
        );
    }
    let ratio = sent(33.0, 4.0) / sent(33.0, 0.5);
    assert!((ratio - 8.0).abs() < 1e-9, "{ratio}");
}
