//! Tests of the simulated shaft against closed forms: free motion, stopping, sticking, symmetry.

mod common;

use common::bench::{plant, DRIVE, DT_S, LOAD_N};
use common::constant_law::ConstantLaw;
use common::{chain_round, law, newtons};
use jbf_core::effect::{Effects, Info, Need, Rig};
use jbf_core::law::{with_law, Law, Named, Visitor};
use jbf_core::plant::{Drive, Plant};
use jbf_core::{Bearing, Chain, Clock};

const H: f64 = 0.001;

fn chain<L>(law: L) -> Chain<f64, L> {
    Chain {
        law,
        effects: Effects::NONE,
        rig: Rig {
            radius_m: 0.0127,
            count: 4.0,
            force_at_drive: false,
        },
    }
}

/// Shaft with the drive of Cohn (1998) and a constant friction of `volts`.
fn dry(volts: f64) -> Plant<f64, ConstantLaw> {
    let coefficient = volts / (LOAD_N * DRIVE.volts_per_n);
    Plant::new(chain(ConstantLaw(coefficient)), DRIVE, H).unwrap()
}

/// A step without friction is the exact solution for a constant input.
#[test]
fn plant_without_friction_follows_the_exact_solution() {
    let plant = dry(0.0);
    let mut state = plant.start(LOAD_N, 0.0);
    for i in 1..=500 {
        plant.step(&mut state, 2.0, LOAD_N);
        let t = f64::from(i) * H;
        let exact = 457.0 / 135.0 * 2.0 * -(-135.0 * t).exp_m1();
        assert!((state.speed_rad_s / exact - 1.0).abs() < 1e-6, "{t} s");
    }
}

/// A drive without damping, such as one with a torque controller, accelerates uniformly.
#[test]
fn plant_without_damping_and_friction_accelerates_uniformly() {
    let drive = Drive::new(0.0, 200.0);
    let plant = Plant::new(chain(ConstantLaw(0.0)), drive, H).unwrap();
    let mut state = plant.start(LOAD_N, 0.0);
    for i in 1..=500 {
        plant.step(&mut state, 0.5, LOAD_N);
        let t = f64::from(i) * H;
        assert!((state.speed_rad_s - 100.0 * t).abs() < 1e-9);
        assert!((state.angle_rad - 50.0 * t * t).abs() < 1e-9);
    }
}

/// With a constant friction level L, the speed V falls to zero at t = ln(1 + aV/(bL))/a and stays
/// zero.
#[test]
fn dry_friction_stops_the_plant_at_the_exact_time() {
    let (a, b, level) = (135.0, 457.0, 0.8);
    let plant = dry(level);
    let mut state = plant.start(LOAD_N, 0.0);
    for _ in 0..2000 {
        plant.step(&mut state, 10.0, LOAD_N);
    }
    let top = state.speed_rad_s;
    assert!((top / (b / a * (10.0 - level)) - 1.0).abs() < 1e-6);
    let expected = (1.0 + a * top / (b * level)).ln() / a;
    let mut steps = 0;
    while state.speed_rad_s > 0.0 {
        plant.step(&mut state, 0.0, LOAD_N);
        steps += 1;
        assert!(steps < 1000);
    }
    assert!(
        (f64::from(steps) * H - expected).abs() <= H,
        "{steps} steps, {expected} s"
    );
    for _ in 0..1000 {
        plant.step(&mut state, 0.0, LOAD_N);
        assert_eq!(state.speed_rad_s, 0.0);
        assert_eq!(state.friction_v, 0.0);
    }
}

/// With an input of nine tenths of the friction level, the shaft does not move for an hour, and
/// friction equals the input.
#[test]
fn plant_below_the_breakaway_level_stays_at_rest_for_an_hour() {
    let plant = plant(&[]);
    let mut state = plant.start(LOAD_N, 600.0);
    // The journal at rest holds f_m times its load.
    let push = 0.9 * 0.26 * LOAD_N * DRIVE.volts_per_n;
    let steps = (3600.0 / (DT_S / 2.0)) as u32;
    for _ in 0..steps {
        plant.step(&mut state, push, LOAD_N);
    }
    assert_eq!(state.angle_rad, 0.0);
    assert_eq!(state.speed_rad_s, 0.0);
    assert!((state.friction_v / push - 1.0).abs() < 1e-12);
    // An input above the level moves the shaft at once.
    for _ in 0..10 {
        plant.step(&mut state, push / 0.9 * 1.02, LOAD_N);
    }
    assert!(state.speed_rad_s > 0.0);
}

/// The reported friction F satisfies `v' = -a v + b (u - F)` in every step.
#[test]
fn reported_friction_satisfies_the_equation_of_motion() {
    let plant = plant(&[("stribeck_excess", &[0.1, 0.005, 1.0])]);
    let mut state = plant.start(LOAD_N, 10.0);
    let fall = -(-135.0 * DT_S / 2.0).exp_m1();
    for i in 0..20_000_u32 {
        let u = 1.5 * (f64::from(i) * 1e-3).sin();
        let before = state.speed_rad_s;
        plant.step(&mut state, u, LOAD_N);
        let expected = before * (1.0 - fall) + 457.0 / 135.0 * fall * (u - state.friction_v);
        assert!((state.speed_rad_s - expected).abs() < 1e-9, "step {i}");
    }
}

struct Symmetric;

impl Visitor<f64> for Symmetric {
    type Output = f64;

    fn visit<L: Named<f64>>(self, law: L) -> f64 {
        let plant = Plant::new(chain(law), DRIVE, H).unwrap();
        let mut there = plant.start(LOAD_N, 1.0);
        let mut back = there;
        let mut worst = 0.0_f64;
        let mut travelled = 0.0_f64;
        for i in 0..10_000_u32 {
            let u = 3.0 * (f64::from(i) * 2e-3).sin();
            plant.step(&mut there, u, LOAD_N);
            plant.step(&mut back, -u, LOAD_N);
            worst = worst.max((there.angle_rad + back.angle_rad).abs());
            travelled = travelled.max(there.angle_rad.abs());
            assert!(there.speed_rad_s.is_finite());
        }
        assert!(travelled > 0.1, "{} never moved", L::INFO.name);
        worst
    }
}

/// For every law of the catalogue, the opposite input results in the opposite motion.
#[test]
fn plant_with_any_law_is_symmetric_in_the_input() {
    for info in jbf_core::law::CATALOGUE {
        let values: Vec<f64> = info.parameters.iter().map(|p| p.starts[0]).collect();
        let worst = with_law(
            info.name,
            Some(&Bearing::THESIS),
            Some(LOAD_N),
            &values,
            Clock::Journal,
            Symmetric,
        )
        .unwrap();
        assert!(worst < 1e-9, "{}: {worst}", info.name);
    }
}

/// Asserts that the motion with each effect is finite and ends at rest.
fn runs_and_rests<L: Law<f64> + Copy>(law: L, effects: &[Info]) {
    for info in effects {
        let values: Vec<f64> = info.parameters.iter().map(|p| p.starts[0]).collect();
        let round = chain_round(law, &[(info.name, &values)]);
        let plant = Plant::new(round, DRIVE, H).unwrap();
        let mut state = plant.start(LOAD_N, 5.0);
        for i in 0..10_000_u32 {
            plant.step(&mut state, 2.0 * (f64::from(i) * 2e-3).sin(), LOAD_N);
            assert!(state.speed_rad_s.is_finite() && state.friction_v.is_finite());
            assert!(state.speed_rad_s.abs() < 7.0, "{}", info.name);
        }
        for _ in 0..5_000 {
            plant.step(&mut state, 0.0, LOAD_N);
        }
        assert!(
            state.speed_rad_s.abs() < 1e-3,
            "{}: {}",
            info.name,
            state.speed_rad_s
        );
    }
}

/// The shaft moves and comes to rest with every effect of the catalogue, combined with a compatible
/// law.
#[test]
fn plant_with_any_effect_moves_and_comes_to_rest() {
    let (of_drives, others): (Vec<Info>, Vec<Info>) = jbf_core::effect::CATALOGUE
        .iter()
        .partition(|info| info.needs.contains(&Need::NoFilm));
    assert!(!of_drives.is_empty() && !others.is_empty());
    runs_and_rests(law(Clock::Journal), &others);
    runs_and_rests(newtons(15.0, 5.0), &of_drives);
}

/// With a compliant drive, the shaft turns before the journal, by the deflection of the spring
/// under the input.
#[test]
fn shaft_of_a_compliant_drive_twists_before_the_journal_moves() {
    let plant = plant(&[("drive_compliance", &[60.0, 0.5, 1e-3])]);
    let mut state = plant.start(LOAD_N, 60.0);
    let push_v = 0.3;
    for _ in 0..5_000 {
        plant.step(&mut state, push_v, LOAD_N);
    }
    // Twist = torque / stiffness; a volt is 1/volts_per_n newtons on each of four bearings.
    let torque_n_m = push_v / DRIVE.volts_per_n * 4.0 * 0.0127;
    let twist = torque_n_m / 60.0;
    assert!(
        (state.angle_rad / twist - 1.0).abs() < 0.01,
        "{} {twist}",
        state.angle_rad
    );
}
