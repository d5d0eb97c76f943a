//! Tests of backlash: after each reversal the journal rests while the drive crosses the gap, and
//! then follows.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::Sines;
use crate::common::{chain_round, on_drive, readings, LOAD_N};
use jbf_core::run::{predict, Record};
use jbf_core::{Bearing, Dual, Motion, Real};
use std::f64::consts::PI;

const F: f64 = 0.1;
const DT_S: f64 = 0.002;

fn signal(gap_rad: f64, sines: &Sines, steps: u32) -> Vec<f64> {
    let chain = chain_round(ConstantLaw(F), &[("backlash", &[gap_rad])]);
    readings(&chain, DT_S, steps, |t| sines.at(t))
}

/// For `U = A sin t`, the drive reverses at pi and crosses the gap until `A (1 + cos t) = gap R`,
/// and so on after each reversal.
#[test]
fn friction_is_zero_after_a_reversal_until_the_gap_is_crossed() {
    let gap = 0.4;
    let sines = Sines::two_way(1.0);
    let since = PI - (gap * Bearing::THESIS.radius_m / 0.127 - 1.0).acos();
    for (i, f) in signal(gap, &sines, 3000).iter().enumerate().skip(1) {
        let t = DT_S * i as f64;
        let way = t % PI;
        let sign = if (t / PI) as i32 % 2 == 0 { 1.0 } else { -1.0 };
        let expected = if t < PI || way > since + DT_S {
            sign * F * LOAD_N
        } else if way < since - DT_S {
            0.0
        } else {
            continue;
        };
        assert!((f - expected).abs() < 1e-12, "{t}: {f} {expected}");
    }
}

/// At a drive, the force that accelerates its inertia is also measured inside the gap.
#[test]
fn inertia_of_a_drive_acts_inside_the_gap() {
    let (gap, mass_kg) = (0.005, 2.0);
    let chain = on_drive(
        ConstantLaw(F),
        &[("inertia", &[mass_kg]), ("backlash", &[gap])],
    );
    let reversed = PI + 0.5 * (1.0 - gap / 0.127_f64).acos();
    let motion = |t: f64| Motion {
        time_s: t,
        angle_rad: -0.127 * t.cos(),
        velocity_m_s: 0.127 * t.sin(),
        acceleration_m_s2: 0.127 * t.cos(),
        ..Motion::at_rest(LOAD_N)
    };
    let steps = (reversed / DT_S) as u32;
    let force = readings(&chain, DT_S, steps, motion)[steps as usize];
    let expected = mass_kg * 0.127 * (DT_S * f64::from(steps)).cos();
    assert!((force - expected).abs() < 1e-12, "{force} {expected}");
}

/// The effect is zero without a reversal, because the flank is in contact at the first motion.
#[test]
fn motion_in_one_direction_is_unaffected() {
    for sines in [
        Sines::one_way(1.0),
        Sines::one_way(1.0).mirrored(),
        Sines::one_way(1.0).resting(2.0, 1.0),
    ] {
        assert_eq!(signal(0.3, &sines, 2000), signal(0.0, &sines, 2000));
    }
}

/// An oscillation smaller than the gap does not move the journal after its first stroke.
#[test]
fn oscillation_smaller_than_the_gap_does_not_move_the_journal() {
    let omega = 25.0;
    let sines = Sines {
        offset_m_s: 0.0,
        waves: vec![[0.127, omega, 0.0]],
        sign: 1.0,
        rest_s: None,
    };
    // The swing is 2 x 0.127/25 m, and the first stroke has this full length.
    let gap = 2.01 * 0.127 / omega / Bearing::THESIS.radius_m;
    let got = signal(gap, &sines, 400);
    assert!(got[10] > 1.0);
    for (i, f) in got.iter().enumerate() {
        if DT_S * i as f64 > PI / omega + DT_S {
            // It returns to the flank that it left, and touches it at the reversal.
            let touches = (DT_S * i as f64 * omega / PI).rem_euclid(2.0) - 1.0;
            if touches.abs() > 0.05 {
                assert_eq!(*f, 0.0, "sample {i}");
            }
        }
    }
}

/// The predicted reading is a continuous function of the size of the gap.
///
/// Its derivative with respect to the gap is that of the ramp that replaces the jump.
#[test]
fn reading_of_a_record_is_continuous_in_the_gap() {
    let sines = Sines::two_way(1.0);
    let samples: Vec<Motion<f64>> = (0..400).map(|i| sines.at(0.02 * f64::from(i))).collect();
    let column = |pick: fn(&Motion<f64>) -> f64| samples.iter().map(pick).collect::<Vec<_>>();
    let columns = [
        column(|m| m.time_s),
        column(|m| m.velocity_m_s),
        column(|m| m.acceleration_m_s2),
        column(|m| m.angle_rad),
        column(|m| m.load_n),
    ];
    let record = Record {
        time_s: &columns[0],
        velocity_m_s: &columns[1],
        acceleration_m_s2: &columns[2],
        angle_rad: &columns[3],
        weight_offset_rad: None,
        load_n: &columns[4],
        temperature_c: None,
    };
    let run = |gap: f64| {
        let mut out = vec![0.0; 400];
        let chain = chain_round(ConstantLaw(F), &[("backlash", &[gap])]);
        predict(&chain, &record, 0.02, |i, f: f64| out[i] = f);
        out
    };
    let mut before = run(0.01);
    let mut moved = 0.0_f64;
    for k in 1..2000 {
        let now = run(0.01 + 2e-5 * f64::from(k));
        for (a, b) in before.iter().zip(&now) {
            assert!((a - b).abs() < 0.1 * F * LOAD_N, "{k}: {a} {b}");
            moved += (a - b).abs();
        }
        before = now;
    }
    assert!(moved > F * LOAD_N);
    let mut slope = 0.0_f64;
    let mut effects = jbf_core::effect::Effects::NONE;
    effects
        .set("backlash", &[Dual::<1>::parameter(0.1003, 0)])
        .expect("valid");
    let chain = jbf_core::Chain {
        law: ConstantLaw(F),
        effects,
        rig: jbf_core::effect::Rig {
            radius_m: Dual::of(0.0127),
            count: Dual::of(4.0),
            force_at_drive: false,
        },
    };
    predict(&chain, &record, 0.02, |_, f| {
        slope = slope.max(f.slope[0].abs())
    });
    assert!(slope > 1.0, "{slope}");
}
