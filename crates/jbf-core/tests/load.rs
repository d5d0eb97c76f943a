//! Tests that a law after a change of the load equals one created with the new load.

mod common;

use common::table_4_2;
use jbf_core::law::journal::{Journal, State};
use jbf_core::law::Law;
use jbf_core::stepper::Rk4;
use jbf_core::{Bearing, Clock};

#[test]
fn friction_after_a_change_of_load_is_that_of_the_new_load() {
    let heavy = common::law::<f64>(Clock::Journal);
    let light = Journal::new(&Bearing::THESIS, 83.5, &table_4_2(), Clock::Journal).expect("valid");
    let mut state = heavy.start(104.0);
    let speed = |i: u32| 0.05 + 0.04 * (0.01 * f64::from(i)).sin();
    for i in 0..500 {
        heavy.advance_with(&Rk4, &mut state, [speed(i); 3], 1.0, 0.002);
    }
    heavy.set_load(&mut state, 83.5);
    assert_eq!(state.loaded.eps_tr, light.nominal().eps_tr);
    let xy = state.xy();
    let mut own = State::at(xy.norm(), xy.y.atan2(xy.x), light.nominal());
    for i in 500..1500 {
        heavy.advance_with(&Rk4, &mut state, [speed(i); 3], 1.0, 0.002);
        light.advance_with(&Rk4, &mut own, [speed(i); 3], 1.0, 0.002);
        let f = [
            heavy.friction(&state, speed(i)),
            light.friction(&own, speed(i)),
        ];
        assert!(
            (f[0].along(1.0) - f[1].along(1.0)).abs() < 1e-12,
            "step {i}"
        );
    }
}

/// A bearing without load has the friction of one with a hundredth of its load.
///
/// The film reaches the steady state of that load from any load, and all numbers are finite.
#[test]
fn lifted_bearing_has_the_friction_of_a_hundredth_of_its_load() {
    let law = common::law::<f64>(Clock::Journal);
    let light = Journal::new(&Bearing::THESIS, 1.04, &table_4_2(), Clock::Journal).expect("valid");
    let chain = common::chain_round(law, &[]);
    let mut motion = common::motion::constant::<f64>(0.05, 0.0);
    let mut state = chain.start(&motion);
    for load_n in [104.0, 0.0, 104.0, -50.0, 104.0] {
        motion.load_n = load_n;
        for _ in 0..10_000 {
            let reading = chain.step(&mut state, &motion, 0.002);
            assert!(reading.is_finite() && reading > 0.0);
        }
        let steady = if load_n > 0.0 { law } else { light }
            .steady(0.05)
            .expect("a speed");
        let expected = steady.coefficient * load_n.max(1.04);
        assert!(
            (state.reading_n - expected).abs() < 1e-6,
            "{load_n}: {}",
            state.reading_n
        );
    }
}
