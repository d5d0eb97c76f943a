//! Property: the estimates of observers with any valid gain stay within the bounds of their inputs.

use crate::bytes::{between, number, rounding};
use crate::steps::seen;
use arbitrary::{Result, Unstructured};
use jbf_core::observer::coulomb::State;
use jbf_core::observer::{CoulombObserver, VelocityObserver};
use jbf_core::Real;

/// Checks that the speed estimate converges to at most the speed that its inputs sustain.
fn velocity<T: Real>(bytes: &mut Unstructured<'_>) -> Result<()> {
    let (gain, damping) = (between(bytes, 1e-3, 1e5)?, between(bytes, 0.0, 1e4)?);
    let (input, dt_s) = (between(bytes, 0.0, 1e5)?, between(bytes, 1e-6, 1.0)?);
    let Ok(observer) = VelocityObserver::<T>::with_feedforward(gain, damping, input, dt_s) else {
        return Ok(());
    };
    let (most_rad, most_v) = (between(bytes, 1e-9, 10.0)?, between(bytes, 1e-3, 1e3)?);
    let mut carried = T::ZERO;
    let mut bound = 0.0_f64;
    let keep = 1.0 - (gain + damping) * dt_s;
    while !bytes.is_empty() {
        let moved = T::of(number(bytes, most_rad)?);
        let input_v = T::of(number(bytes, most_v)?);
        seen();
        let measured = observer.correct(carried, moved);
        carried = observer.predict(measured, input_v);
        bound += gain * most_rad;
        let told = || format!("{observer:?} {moved:?} {input_v:?}: {measured:?} {carried:?}");
        let within = |seen: T, bound: f64| seen.value().abs() <= bound * 1.001 + 1e-30;
        assert!(within(measured, bound), "{bound} {}", told());
        // A rounded product below one may be slightly larger.
        bound = (keep + 1e-6) * bound + input * dt_s * most_v;
        assert!(within(carried, bound), "{bound} {}", told());
    }
    Ok(())
}

/// Checks that the estimated friction level stays within its limit for any input.
fn coulomb<T: Real + Default>(bytes: &mut Unstructured<'_>) -> Result<()> {
    let exponent = if bytes.arbitrary()? {
        1.0
    } else {
        between(bytes, 0.05, 4.0)?
    };
    let (gain, input) = (between(bytes, 1e-6, 1e3)?, between(bytes, 1e-3, 1e5)?);
    let (limit_v, dt_s) = (between(bytes, 1e-3, 1e3)?, between(bytes, 1e-6, 1e-1)?);
    let Ok(observer) = CoulombObserver::<T>::new(gain, exponent, input, limit_v, dt_s) else {
        return Ok(());
    };
    let begin: f64 = number(bytes, 1e6)?;
    let mut state = observer.learned(T::of(begin));
    let rest = observer.power(T::ZERO);
    let first = observer.level_v(&state, &rest).value();
    let power_size = |power_v: f64| rounding::<T>() * 8.0 * power_v.abs();
    assert!(first.is_finite(), "{observer:?} {begin}");
    while !bytes.is_empty() {
        let v = T::of(number(bytes, 1e3)?);
        let free = T::of(number(bytes, 1e6)?);
        let power = observer.power(v);
        seen();
        observer.learn(&mut state, &power, v, free);
        let level = observer.level_v(&state, &power).value();
        // z holds the level and k phi: it is as exact as their sum.
        let share = observer.level_v(&State::default(), &power).value();
        let bound =
            limit_v * (1.0 + 1e-5) + power_size(share) + power_size(limit_v) + power_size(first);
        let told = || format!("{observer:?} {state:?} {v:?} {free:?}");
        assert!(level.abs() <= bound, "{level} beyond {bound}: {}", told());
    }
    Ok(())
}

/// Checks that the estimates of both observers, in either precision, stay within the bounds of
/// their inputs.
pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    match bytes.int_in_range(0..=3)? {
        0 => velocity::<f32>(bytes),
        1 => velocity::<f64>(bytes),
        2 => coulomb::<f32>(bytes),
        _ => coulomb::<f64>(bytes),
    }
}
