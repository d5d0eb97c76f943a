//! Functions of the C interface, generic over the law and the number type.
//!
//! Null pointers are handled here. The caller must ensure that the other pointers satisfy the
//! requirements of the header.

use crate::types::{clock, CBearing, CError, CMotion, CRecord, NAME, NULL, OK, PARAMETER};
use core::ffi::{c_char, CStr};
use core::{ptr, slice};
use jbf_core::chain::State;
use jbf_core::effect::{Effects, CATALOGUE};
use jbf_core::law::{Law, Named};
use jbf_core::run::{predict, Record};
use jbf_core::{Bearing, Chain, Error, Motion, Real};

/// Largest number of parameters of a law or an effect; further ones are ignored.
const MOST: usize = 16;

/// Writes the parameter that violates its rule to `error`, and returns [`PARAMETER`].
///
/// # Safety
/// `error` must be null or valid for writes.
unsafe fn refuse(error: *mut CError, why: Error) -> i32 {
    if !error.is_null() {
        error.write(why.into());
    }
    PARAMETER
}

/// Converts `n` numbers at `values` to the number type of the model; returns them with their count,
/// at most [`MOST`].
///
/// # Safety
/// `values` must be null or point to `n` numbers.
unsafe fn lifted<T: Real>(values: *const f64, n: usize) -> ([T; MOST], usize) {
    let mut out = [T::ZERO; MOST];
    let given = if values.is_null() || n == 0 {
        &[][..]
    } else {
        slice::from_raw_parts(values, n)
    };
    for (slot, &value) in out.iter_mut().zip(given) {
        *slot = T::of(value);
    }
    (out, given.len().min(MOST))
}

/// Builds a law without effects at `model`, and returns [`OK`] or the number of an error.
///
/// `bearing` may be null for a law in newtons.
///
/// # Safety
/// `model` must be null or valid for writes, and `error` likewise. `bearing` must be null or point
/// to a bearing, and `values` to `n` numbers.
pub unsafe fn init<T: Real, L: Named<T>>(
    model: *mut Chain<T, L>,
    bearing: *const CBearing,
    load_n: f64,
    (values, n): (*const f64, usize),
    clock_number: i32,
    error: *mut CError,
) -> i32 {
    if model.is_null() {
        return NULL;
    }
    let Some(clock) = clock(clock_number) else {
        return NAME;
    };
    let bearing: Option<Bearing> = bearing.as_ref().map(Bearing::from);
    let (values, n) = lifted::<T>(values, n);
    let values = values.get(..n).unwrap_or_default();
    let page = L::INFO;
    match page
        .check(values)
        .and_then(|()| L::build(bearing.as_ref(), Some(load_n), values, clock))
    {
        Ok(law) => {
            let chain = Chain::new(law).with_effects(Effects::NONE);
            let chain = match &bearing {
                Some(bearing) => chain.on(bearing),
                None => chain,
            };
            ptr::write(model, chain);
            OK
        }
        Err(why) => refuse(error, why),
    }
}

/// Adds the effect `name` to a model, and returns [`OK`] or the number of an error.
///
/// # Safety
/// `model` must be null or point to a model that `init` built. `name` must be null or point to a
/// zero-terminated text, and `values` to `n` numbers. `error` must be null or valid for writes.
pub unsafe fn effect<T: Real, L: Named<T>>(
    model: *mut Chain<T, L>,
    name: *const c_char,
    (values, n): (*const f64, usize),
    error: *mut CError,
) -> i32 {
    let (Some(model), false) = (model.as_mut(), name.is_null()) else {
        return NULL;
    };
    let Ok(name) = CStr::from_ptr(name).to_str() else {
        return NAME;
    };
    let mut known = CATALOGUE.iter();
    if !known.any(|page| page.name == name && page.lacking(&L::INFO).is_none()) {
        return NAME;
    }
    let (values, n) = lifted::<T>(values, n);
    match model.effects.set(name, values.get(..n).unwrap_or_default()) {
        Ok(()) => OK,
        Err(why) => refuse(error, why),
    }
}

/// Writes the state at the first sample to `state`, and returns the reading of the instrument
/// there, N.
///
/// Returns zero if a pointer is null.
///
/// # Safety
/// `model` must be null or point to a model that `init` built, and `motion` to a motion. `state`
/// must be null or valid for writes.
pub unsafe fn start<T: Real, L: Law<T>>(
    model: *const Chain<T, L>,
    state: *mut State<T, L::State>,
    motion: *const CMotion<T>,
) -> T {
    let (Some(model), Some(motion), false) = (model.as_ref(), motion.as_ref(), state.is_null())
    else {
        return T::ZERO;
    };
    let begin = model.start(&Motion::from(motion));
    let reading_n = begin.reading_n;
    ptr::write(state, begin);
    reading_n
}

/// Advances `state` to the motion `dt_s` later, and returns the reading of the instrument there, N.
///
/// Returns zero if a pointer is null.
///
/// # Safety
/// `model` must be null or point to a model that `init` built, `state` to a state that `start`
/// wrote, and `motion` to a motion.
pub unsafe fn step<T: Real, L: Law<T>>(
    model: *const Chain<T, L>,
    state: *mut State<T, L::State>,
    motion: *const CMotion<T>,
    dt_s: T,
) -> T {
    let (Some(model), Some(motion), Some(state)) =
        (model.as_ref(), motion.as_ref(), state.as_mut())
    else {
        return T::ZERO;
    };
    model.step(state, &Motion::from(motion), dt_s)
}

/// Computes the readings of the instrument (N) at all samples of a record into `out_n`, as `jbf
/// predict` does.
///
/// Returns [`OK`] or the number of an error.
///
/// # Safety
/// `model` must be null or point to a model that `init` built. The columns of `record` must have as
/// many values as the record has samples, and `out_n` must be valid for as many writes.
pub unsafe fn whole<T: Real, L: Law<T>>(
    model: *const Chain<T, L>,
    record: *const CRecord,
    max_step_s: f64,
    out_n: *mut T,
) -> i32 {
    let (Some(model), Some(r), false) = (model.as_ref(), record.as_ref(), out_n.is_null()) else {
        return NULL;
    };
    let columns = [
        r.time_s,
        r.velocity_m_s,
        r.acceleration_m_s2,
        r.angle_rad,
        r.load_n,
    ];
    if columns.iter().any(|c| c.is_null()) {
        return NULL;
    }
    let [time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n] =
        columns.map(|c| slice::from_raw_parts(c, r.samples));
    let optional = |c: *const f64| (!c.is_null()).then(|| slice::from_raw_parts(c, r.samples));
    let record = Record {
        time_s,
        velocity_m_s,
        acceleration_m_s2,
        angle_rad,
        weight_offset_rad: optional(r.weight_offset_rad),
        load_n,
        temperature_c: optional(r.temperature_c),
    };
    let out = slice::from_raw_parts_mut(out_n, r.samples);
    predict(model, &record, max_step_s, |i, reading| {
        if let Some(slot) = out.get_mut(i) {
            *slot = reading;
        }
    });
    OK
}
