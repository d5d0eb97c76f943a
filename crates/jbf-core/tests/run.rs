//! Tests of predictions along whole records: inner steps between samples, reversals between
//! samples.

mod common;

use common::motion::Sines;
use common::{chain, chain_round, readings};
use jbf_core::internals::{film_rate_1_s, inner_step_s, inner_steps};
use jbf_core::law::{with_law, Named, Visitor, CATALOGUE};
use jbf_core::run::{predict, Record};
use jbf_core::{Clock, Motion};

/// Columns of a sampled motion, and the temperature if there is one.
struct Columns([Vec<f64>; 5], Option<Vec<f64>>);

impl Columns {
    fn of(sines: &Sines, dt_s: f64, count: u32) -> Self {
        let motions: Vec<Motion<f64>> = (0..count).map(|i| sines.at(dt_s * f64::from(i))).collect();
        let column = |f: fn(&Motion<f64>) -> f64| motions.iter().map(f).collect();
        Self(
            [
                column(|m| m.time_s),
                column(|m| m.velocity_m_s),
                column(|m| m.acceleration_m_s2),
                column(|m| m.angle_rad),
                column(|m| m.load_n),
            ],
            None,
        )
    }

    fn record(&self) -> Record<'_> {
        let [time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n] = &self.0;
        Record {
            time_s,
            velocity_m_s,
            acceleration_m_s2,
            angle_rad,
            weight_offset_rad: None,
            load_n,
            temperature_c: self.1.as_deref(),
        }
    }
}

fn run(effects: &[(&str, &[f64])], columns: &Columns, max_step_s: f64) -> Vec<f64> {
    let mut out = Vec::new();
    predict(
        &chain::<f64>(effects),
        &columns.record(),
        max_step_s,
        |i, reading| {
            assert_eq!(i, out.len(), "samples come in order");
            out.push(reading);
        },
    );
    out
}

/// A prediction without inner steps and reversals equals the steps of the chain from sample to
/// sample.
#[test]
fn run_without_inner_steps_equals_the_chain() {
    let sines = Sines::one_way(1.0);
    let columns = Columns::of(&sines, 0.005, 500);
    let stepped = readings(&chain::<f64>(&[]), 0.005, 499, |t| sines.at(t));
    // Times as differences of columns round differently from the exact 0.005.
    for (a, b) in run(&[], &columns, 0.01).iter().zip(&stepped) {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
}

/// The error of a prediction along a record with long sampling intervals decreases with the inner
/// step.
///
/// Reversals are between samples. With a jump at a wrong instant, the error with a lag would be far
/// above the tolerance: 0.02 s times 2 F_d, divided by tau.
#[test]
fn error_decreases_with_the_inner_step_across_reversals() {
    let sines = Sines {
        offset_m_s: 0.013,
        ..Sines::two_way(1.3)
    };
    let columns = Columns::of(&sines, 0.02, 600);
    let effects: [(&str, &[f64]); 2] = [("coulomb_drag", &[2.0]), ("sensor_lag", &[0.1])];
    let apart = |a: f64, b: f64| {
        let (a, b) = (run(&effects, &columns, a), run(&effects, &columns, b));
        a.iter()
            .zip(&b)
            .map(|(x, y)| (x - y).abs())
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (apart(0.01, 1e-3), apart(2e-3, 1e-4));
    assert!(coarse < 0.02, "{coarse} N");
    assert!(fine < coarse / 10.0, "{coarse} N, {fine} N");
}

/// The shortest column determines the length of a run; an empty column has no readings.
#[test]
fn run_ends_with_its_shortest_column() {
    let mut columns = Columns::of(&Sines::one_way(1.0), 0.01, 50);
    columns.0[3].truncate(20);
    assert_eq!(run(&[], &columns, 0.01).len(), 20);
    columns.0[1].clear();
    assert!(run(&[], &columns, 0.01).is_empty());
}

/// The temperature is interpolated linearly between its samples, so that records with long and
/// short sampling intervals have the same readings.
#[test]
fn temperature_is_interpolated_between_its_samples() {
    let sines = Sines::one_way(1.0);
    let effect: [(&str, &[f64]); 1] = [("dry_temperature_dependence", &[-0.03, 20.0])];
    let warming = |dt_s: f64, count: u32| {
        let mut columns = Columns::of(&sines, dt_s, count);
        columns.1 = Some(columns.0[0].iter().map(|t| 20.0 + 3.0 * t).collect());
        columns
    };
    let (coarse, fine) = (warming(0.02, 201), warming(0.001, 4001));
    let [coarse, fine] = [coarse, fine].map(|columns| run(&effect, &columns, 1e-3));
    let bare = run(&[], &Columns::of(&sines, 0.02, 201), 1e-3);
    for (i, a) in coarse.iter().enumerate() {
        assert!((a - fine[20 * i]).abs() < 2e-3, "{i}: {a} {}", fine[20 * i]);
    }
    assert!((coarse[200] - bare[200]).abs() > 0.5);
}

/// Warm oil requires shorter inner steps: those of a run are determined by its warmest sample.
///
/// They equal the inner steps for a film of that oil. Without a temperature, and at the reference
/// temperature, the inner steps are those of the law.
#[test]
fn warm_oil_requires_shorter_inner_steps() {
    let effects: [(&str, &[f64]); 1] = [("vogel_viscosity", &[800.0, -95.0, 40.0])];
    let chain = chain::<f64>(&effects);
    let mut columns = Columns::of(&Sines::two_way(1.0), 0.01, 400);
    let rate = |columns: &Columns| film_rate_1_s(&chain, &columns.record());
    let without = rate(&columns);
    columns.1 = Some(vec![40.0; 400]);
    assert_eq!(rate(&columns), without);
    if let Some(all) = columns.1.as_mut() {
        all[17] = 90.0;
    }
    let warm = rate(&columns);
    let thin = (800.0_f64 / 185.0 - 800.0 / 135.0).exp();
    let mut slower = Sines::two_way(1.0);
    slower.waves[0][0] *= thin;
    let wanted = rate(&Columns::of(&slower, 0.01, 400)) / thin;
    assert!((warm / wanted - 1.0).abs() < 1e-3 && warm > 1.5 * without);
}

/// A speed at a reversal that is zero except for rounding is a reversal at that sample.
///
/// The following readings equal those after a small speed at this sample.
#[test]
fn speed_of_rounding_size_is_a_reversal_at_its_sample() {
    let turning = |speed_m_s: f64| {
        let mut columns = Columns::of(&Sines::two_way(1.0), 0.02, 400);
        let velocity = &mut columns.0[1];
        let at = (1..399)
            .find(|&i| velocity[i] * velocity[i + 1] < 0.0)
            .expect("it turns round");
        velocity[at] = speed_m_s;
        (run(&[], &columns, 1e-2), at)
    };
    let (small, at) = turning(-1e-9);
    for speed_m_s in [-8.7e-18, -1e-13, -1e-300] {
        let (found, _) = turning(speed_m_s);
        for (i, (a, b)) in found.iter().zip(&small).enumerate() {
            // A speed below the rounding of its neighbour is lost: the shaft rests there.
            let rests = i == at && *a == 0.0;
            assert!(rests || (a - b).abs() < 1e-3, "{speed_m_s} {i}: {a} {b}");
        }
    }
}

/// The predicted number of inner steps is the number of steps that a prediction makes.
#[test]
fn predicted_cost_of_a_run_is_its_number_of_inner_steps() {
    let chain = chain::<f64>(&[]);
    let columns = Columns::of(&Sines::two_way(1.0), 0.01, 401);
    let film_s = inner_step_s(&chain, &columns.record(), 1.0);
    for max_step_s in [1e-3, 0.5 * film_s] {
        let counted = inner_steps(&chain, &columns.record(), max_step_s);
        let every = 401.0 + 401.0 * 0.01 / max_step_s.min(film_s);
        assert!((counted / every - 1.0).abs() < 1e-6, "{counted} {every}");
    }
}

/// Computes the number of steps of a law with effects along a record, and the readings (N).
struct Counted<'a>(Record<'a>, &'a [(&'a str, &'a [f64])]);

impl Visitor<f64> for Counted<'_> {
    type Output = (f64, Vec<f64>);

    fn visit<L: Named<f64>>(self, law: L) -> Self::Output {
        let chain = chain_round(law, self.1);
        let mut out = Vec::new();
        predict(&chain, &self.0, 0.02, |_, reading| out.push(reading));
        (inner_steps(&chain, &self.0, 0.02), out)
    }
}

/// A chain without memory makes one step per sample, with the same readings as with many steps.
fn assert_one_step_per_sample(law: &str, effects: &[(&str, &[f64])]) {
    let motion = Sines::two_way(std::f64::consts::TAU / 40.0);
    let info = CATALOGUE.iter().find(|info| info.name == law);
    let parameters = info.expect("known").parameters;
    let values: Vec<f64> = parameters.iter().map(|p| p.starts[0]).collect();
    let along = |columns: &Columns| {
        let visitor = Counted(columns.record(), effects);
        with_law(law, None, None, &values, Clock::Journal, visitor).expect("sound")
    };
    let (steps, slow) = along(&Columns::of(&motion, 2.0, 101));
    let (_, dense) = along(&Columns::of(&motion, 0.02, 10_001));
    assert_eq!(steps, 101.0, "{law} {effects:?}");
    for (k, reading) in slow.iter().enumerate().skip(1) {
        let other = dense[100 * k];
        assert!(
            (reading - other).abs() < 1e-9 * other.abs().max(1.0),
            "{law} {effects:?} {k}"
        );
    }
}

#[test]
fn laws_without_memory_take_one_step_per_sample() {
    for name in ["coulomb", "stribeck"] {
        assert_one_step_per_sample(name, &[]);
    }
}

#[test]
fn effects_of_the_position_take_one_step_per_sample() {
    let effects: [(&str, &[f64]); 6] = [
        ("spring", &[30.0]),
        ("cogging", &[0.5, 0.01, 0.3]),
        ("cogging_2", &[0.5, 0.02, 0.3]),
        ("pitch_ripple", &[0.2, 0.01, 0.3]),
        ("pitch_ripple_2", &[0.2, 0.02, 0.3]),
        (
            "stroke_dependence",
            &[0.1, 0.05, 0.02, 0.03, 0.01, 0.02, 0.0, 0.05],
        ),
    ];
    for effect in effects {
        assert_one_step_per_sample("coulomb", &[effect]);
    }
}

/// Computes the inner step (s) of a law of the catalogue with its starting values along a record,
/// and the readings (N).
struct Along<'a>(Record<'a>, f64);

impl Visitor<f64> for Along<'_> {
    type Output = (f64, Vec<f64>);

    fn visit<L: Named<f64>>(self, law: L) -> Self::Output {
        let chain = chain_round(law, &[]);
        let mut out = Vec::new();
        predict(&chain, &self.0, self.1, |_, reading| out.push(reading));
        (inner_step_s(&chain, &self.0, self.1), out)
    }
}

/// Along a record with long sampling intervals, a law without a film makes at most 16 steps per
/// sample.
///
/// That is 16 steps per 0.4 s instead of 200, and the friction hardly differs. Along other records,
/// all steps are made.
#[test]
fn widely_spaced_samples_are_stepped_only_as_finely_as_the_record_resolves() {
    let slow = Sines::two_way(std::f64::consts::TAU / 40.0);
    for name in ["lugre", "seven_parameter"] {
        let info = CATALOGUE
            .iter()
            .find(|law| law.name == name)
            .expect("known");
        let values: Vec<f64> = info.parameters.iter().map(|p| p.starts[0]).collect();
        for (apart_s, inner_s) in [(0.4, 0.02), (0.2, 0.0125), (0.03, 0.002), (0.002, 0.002)] {
            let columns = Columns::of(&slow, apart_s, 300);
            let along = |most_s: f64| {
                let visitor = Along(columns.record(), most_s);
                with_law(name, None, None, &values, Clock::Journal, visitor).expect("sound")
            };
            let ((inner, usual), (_, fine)) = (along(0.02), along(2e-4));
            assert!((inner - inner_s).abs() < 1e-12, "{name} {apart_s} {inner}");
            let squares = usual.iter().zip(&fine).map(|(a, b)| (a - b).powi(2));
            let apart_n = (squares.sum::<f64>() / 300.0).sqrt();
            assert!(apart_n < 2e-3, "{name} {apart_s} s: {apart_n} N");
        }
    }
}
