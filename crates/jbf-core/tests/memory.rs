//! Tests that the state of a chain takes only the memory that its law, the motion and its effects
//! need.

use jbf_core::chain::State;
use jbf_core::effect::coulomb_drag::CoulombDrag;
use jbf_core::effect::sensor_lag::SensorLag;
use jbf_core::effect::{Effect, Effects};
use jbf_core::law::coulomb::Coulomb;
use jbf_core::law::Law;
use jbf_core::JournalMotion;
use jbf_core::{Chain, Motion, Real};
use std::mem::size_of;

type Changes<T, L, E> = State<T, <L as Law<T>>::State, E>;

/// Size of the state of a chain with Coulomb's law, bytes.
fn state<T: Real, E: Effect<T>>() -> usize {
    size_of::<Changes<T, Coulomb<T>, E>>()
}

fn lean<T: Real>() {
    // Both motions, the effective film speed and its factor, the level of a bristle, the jump, the
    // force, the reading, and the law's own state.
    let number = size_of::<T>();
    let needed = size_of::<Motion<T>>() + size_of::<JournalMotion<T>>() + 6 * number;
    assert!(
        state::<T, ()>() <= needed + number,
        "{} bytes, {needed} and the law's one needed",
        state::<T, ()>()
    );
    let drag = state::<T, CoulombDrag<T>>();
    assert_eq!(drag, state::<T, ()>(), "a drag remembers nothing");
    let lag = state::<T, (CoulombDrag<T>, SensorLag<T>)>();
    assert_eq!(lag, state::<T, ()>() + number, "a lag remembers a number");
    assert!(
        state::<T, Effects<T>>() > 4 * lag,
        "the catalogue keeps room for all"
    );
    // Three numbers of the law, three words of the rig, one of the drag and one of the lag.
    type Pair<T> = (CoulombDrag<T>, SensorLag<T>);
    assert_eq!(size_of::<Chain<T, Coulomb<T>, ()>>(), 6 * number);
    assert_eq!(size_of::<Chain<T, Coulomb<T>, Pair<T>>>(), 8 * number);
}

#[test]
fn absent_effect_takes_no_memory() {
    lean::<f32>();
    lean::<f64>();
    println!(
        "state of a bare chain round coulomb, bytes: {} in f32, {} in f64; with the catalogue {}, {}",
        state::<f32, ()>(),
        state::<f64, ()>(),
        state::<f32, Effects<f32>>(),
        state::<f64, Effects<f64>>()
    );
}
