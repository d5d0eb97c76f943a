//! Tests that the longest step of the journal law is accurate for any parameters.

mod common;

use common::random::Random;
use jbf_core::law::journal::{Journal, Parameters, State};
use jbf_core::law::Law;
use jbf_core::{Bearing, Clock};

/// The return of a film to its steady state in steps of this length equals that in steps a quarter
/// as long, within a thousandth of the gap.
///
/// The film is displaced from its steady state by a tenth of its gap and more.
#[test]
fn longest_step_agrees_with_shorter_steps_within_a_thousandth_of_the_gap() {
    let mut random = Random::new(11);
    for _ in 0..5000 {
        let p = Parameters {
            f_m: 0.26,
            u_tr_m_s: random.log_uniform(0.005, 0.5),
            k0: random.log_uniform(1e4, 1e9),
            gamma: 33.0,
        };
        let clock = if random.chance(0.5) {
            Clock::Journal
        } else {
            Clock::Thesis
        };
        let load_n = random.log_uniform(10.0, 1000.0);
        let law = Journal::new(&Bearing::THESIS, load_n, &p, clock).expect("valid");
        let speed = p.u_tr_m_s * random.log_uniform(0.01, 10.0);
        let steady = law.steady(speed).expect("a speed");
        let dt = law.longest_step_s(speed);
        let eps = 1.0 - (1.0 - steady.eps) * random.uniform(1.0, 1.2);
        let start = State::at(eps, steady.phi_rad + 0.02, law.nominal());
        let after = |parts: u32| {
            let mut state = start;
            for _ in 0..200 * parts {
                law.advance(&mut state, [speed; 3], 1.0, dt / f64::from(parts));
            }
            assert_eq!(
                state.clamped, 0,
                "{p:?} {clock:?} {load_n} N, {speed} m/s, {dt} s"
            );
            state.eps()
        };
        let apart = (after(1) - after(4)).abs() / (1.0 - steady.eps);
        assert!(
            apart < 1e-3,
            "{apart:e}: {p:?} {clock:?} {load_n} N, {speed} m/s, {dt} s"
        );
    }
}

/// The longest step is not too short: it is several time steps of the 2 ms loop of Cohn (1998) for
/// his bearing.
#[test]
fn longest_step_is_several_times_the_loop_step() {
    for clock in [Clock::Journal, Clock::Thesis] {
        let dt = common::law::<f64>(clock).longest_step_s(0.127);
        assert!((6e-3..0.1).contains(&dt), "{clock:?} {dt}");
    }
}
