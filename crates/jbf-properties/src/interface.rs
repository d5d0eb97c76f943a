//! Property: the C interface, called as from C, has the results of `jbf_core` bit for bit.
//!
//! It returns an error code for invalid input, including null pointers.

use crate::bytes::{between, number, parameters, step_s};
use crate::steps::seen;
use arbitrary::{Result, Unstructured};
use core::ffi::{c_char, CStr};
use core::mem::MaybeUninit;
use core::ptr::{null, null_mut};
use jbf_c::{CBearing, CError, CMotion, CRecord, NAME, NULL, OK, PARAMETER};
use jbf_core::effect::{self, Effects};
use jbf_core::law::{self, Named};
use jbf_core::{Bearing, Chain, Clock, Motion, Real};

const LARGEST: f64 = 1e4;
const NAMES: [&CStr; 3] = [c"", c"no_such_effect", c"\xff\xfe"];

const BEARING: CBearing = CBearing {
    radius_m: Bearing::THESIS.radius_m,
    length_m: Bearing::THESIS.length_m,
    clearance_m: Bearing::THESIS.clearance_m,
    mass_kg: Bearing::THESIS.mass_kg,
    viscosity_pa_s: Bearing::THESIS.viscosity_pa_s,
    count: Bearing::THESIS.count,
};

/// Draws any number; one in sixteen is not finite.
fn any<T: Real>(bytes: &mut Unstructured<'_>) -> Result<T> {
    Ok(match bytes.int_in_range(0..=31_u8)? {
        0 => T::of(f64::NAN),
        1 => T::of(f64::INFINITY),
        _ => T::of(number(bytes, LARGEST)?),
    })
}

fn motion<T: Real>(bytes: &mut Unstructured<'_>, time_s: T) -> Result<CMotion<T>> {
    let [velocity_m_s, acceleration_m_s2, angle_rad] = [any(bytes)?, any(bytes)?, any(bytes)?];
    Ok(CMotion {
        time_s,
        velocity_m_s,
        acceleration_m_s2,
        angle_rad,
        load_n: any(bytes)?,
        temperature_c: any(bytes)?,
        // Not from the bytes: the inputs of the corpus keep their meaning.
        weight_offset_rad: T::of(0.5) * angle_rad,
    })
}

/// Returns true if all values of a motion are finite.
fn sound<T: Real>(m: &CMotion<T>) -> bool {
    Motion::from(m).is_finite()
}

/// Asserts that both texts of an error are zero-terminated and not empty.
fn told(error: &CError) {
    assert!(error.name.contains(&0) && error.rule.contains(&0));
    assert!(error.name[0] != 0 && error.rule[0] != 0);
}

macro_rules! laws {
    ($($module:ident::$Type:ident $kind:ident
       $init:ident $effect:ident $start:ident $step:ident $predict:ident;)*) => {
        $(mod $init {
            use super::*;
            type Law = law::$module::$Type<$kind>;

            pub fn run(bytes: &mut Unstructured<'_>) -> Result<()> {
                let page = <Law as Named<$kind>>::INFO;
                let mut place = MaybeUninit::<Chain<$kind, Law>>::uninit();
                let model = place.as_mut_ptr();
                let mut error = CError { name: [0; 32], rule: [0; 96], value: 0.0 };
                let values = parameters::<f64>(bytes, page.parameters)?;
                let bearing: *const CBearing = if bytes.ratio(1, 16)? { null() } else { &BEARING };
                let load_n = if bytes.ratio(1, 16)? { any(bytes)? } else { between(bytes, 1.0, 1e3)? };
                let clock = if bytes.ratio(1, 16)? { bytes.arbitrary()? } else { 0 };
                let count = if bytes.ratio(1, 16)? { bytes.int_in_range(0..=values.len())? } else { values.len() };
                let given = if bytes.ratio(1, 32)? { null() } else { values.as_ptr() };
                // SAFETY: `model` and `error` are writable, `values` holds at least `count`.
                let done = unsafe {
                    assert_eq!(jbf_c::$init(null_mut(), bearing, load_n, given, count, clock, &mut error), NULL);
                    // Without a location for the error the result is the same.
                    let silent = jbf_c::$init(model, bearing, load_n, given, count, clock, null_mut());
                    let done = jbf_c::$init(model, bearing, load_n, given, count, clock, &mut error);
                    assert_eq!(silent, done);
                    done
                };
                let lifted: Vec<$kind> = values.iter().map(|&v| v as $kind).collect();
                let shaft = (!bearing.is_null()).then_some(&Bearing::THESIS);
                let own = match clock {
                    0 => Some(Clock::Journal),
                    1 => Some(Clock::Thesis),
                    _ => None,
                };
                let values = if given.is_null() { &[][..] } else { &lifted[..count] };
                let built = own.map(|clock| {
                    page.check(values).and_then(|()| <Law as Named<$kind>>::build(shaft, Some(load_n), values, clock))
                });
                let law = match (done, built) {
                    (OK, Some(Ok(law))) => law,
                    (PARAMETER, Some(Err(_))) => {
                        told(&error);
                        return Ok(());
                    }
                    (NAME, None) => return Ok(()),
                    (code, built) => panic!("{}: {code} where the core says {built:?}", page.name),
                };
                let chain = Chain::new(law).with_effects(Effects::NONE);
                let mut chain = match shaft {
                    Some(bearing) => chain.on(bearing),
                    None => chain,
                };
                for _ in 0..bytes.int_in_range(0..=3)? {
                    effect(bytes, model, &mut chain, &page)?;
                }
                // SAFETY: init reported that the model is built.
                unsafe { along(bytes, model, &chain, &page)? };
                Ok(())
            }

            fn effect(
                bytes: &mut Unstructured<'_>,
                model: *mut Chain<$kind, Law>,
                chain: &mut Chain<$kind, Law>,
                page: &law::Info,
            ) -> Result<()> {
                let info = bytes.choose(effect::CATALOGUE)?;
                let values = parameters::<f64>(bytes, info.parameters)?;
                let mut text: Vec<u8> = info.name.into();
                text.push(0);
                let wrong = bytes.ratio(1, 8)?;
                let name = if wrong { bytes.choose(&NAMES)?.as_ptr() } else { text.as_ptr().cast::<c_char>() };
                let mut error = CError { name: [0; 32], rule: [0; 96], value: 0.0 };
                // SAFETY: a built model, a text with its zero, and the stated number of values.
                let done = unsafe {
                    assert_eq!(jbf_c::$effect(null_mut(), name, values.as_ptr(), values.len(), null_mut()), NULL);
                    assert_eq!(jbf_c::$effect(model, null(), values.as_ptr(), values.len(), null_mut()), NULL);
                    jbf_c::$effect(model, name, values.as_ptr(), values.len(), &mut error)
                };
                let lifted: Vec<$kind> = values.iter().map(|&v| v as $kind).collect();
                if wrong || info.lacking(page).is_some() {
                    assert_eq!(done, NAME);
                } else if chain.effects.set(info.name, &lifted).is_ok() {
                    assert_eq!(done, OK);
                } else {
                    assert_eq!(done, PARAMETER);
                    told(&error);
                }
                Ok(())
            }

            unsafe fn along(
                bytes: &mut Unstructured<'_>,
                model: *const Chain<$kind, Law>,
                chain: &Chain<$kind, Law>,
                page: &law::Info,
            ) -> Result<()> {
                let begin = motion::<$kind>(bytes, 0.0)?;
                if !sound(&begin) {
                    return Ok(());
                }
                let mut place = MaybeUninit::uninit();
                let state = place.as_mut_ptr();
                assert_eq!(jbf_c::$start(null(), state, &begin), 0.0);
                assert_eq!(jbf_c::$start(model, null_mut(), &begin), 0.0);
                assert_eq!(jbf_c::$start(model, state, null()), 0.0);
                let mut own = chain.start(&Motion::from(&begin));
                let first = jbf_c::$start(model, state, &begin);
                assert_eq!(first.to_bits(), own.reading_n.to_bits(), "{}", page.name);
                let mut time_s = 0.0;
                let mut rows = vec![begin];
                while !bytes.is_empty() {
                    let dt_s = step_s(bytes)?.min(1e3) as $kind;
                    time_s += dt_s;
                    let to = motion::<$kind>(bytes, time_s)?;
                    assert_eq!(jbf_c::$step(null(), state, &to, dt_s), 0.0);
                    assert_eq!(jbf_c::$step(model, null_mut(), &to, dt_s), 0.0);
                    assert_eq!(jbf_c::$step(model, state, null(), dt_s), 0.0);
                    seen();
                    let theirs = jbf_c::$step(model, state, &to, dt_s);
                    let ours = chain.step(&mut own, &Motion::from(&to), dt_s);
                    assert!(theirs.is_finite(), "{} {:?} after {:?} {dt_s}: {:?} {:?}", page.name, own.law, begin.load_n, Motion::from(&to), chain.law);
                    assert_eq!(theirs.to_bits(), ours.to_bits(), "{}", page.name);
                    if sound(&to) && to.time_s > rows[rows.len() - 1].time_s && time_s < 100.0 {
                        rows.push(to);
                    }
                }
                record(model, &rows, bytes.arbitrary().unwrap_or(false));
                Ok(())
            }

            unsafe fn record(model: *const Chain<$kind, Law>, rows: &[CMotion<$kind>], optional: bool) {
                let column = |of: fn(&CMotion<$kind>) -> $kind| -> Vec<f64> {
                    rows.iter().map(|m| f64::from(of(m))).collect()
                };
                let time_s = column(|m| m.time_s);
                // A realistic speed: fine steps of the film at 1e4 m/s take too long.
                let velocity_m_s: Vec<f64> = column(|m| m.velocity_m_s).iter().map(|v| v.clamp(-1.0, 1.0)).collect();
                let acceleration_m_s2 = column(|m| m.acceleration_m_s2);
                let angle_rad = column(|m| m.angle_rad);
                let load_n: Vec<f64> = column(|m| m.load_n).iter().map(|n| n.abs().max(1.0)).collect();
                let temperature_c = vec![40.0; rows.len()];
                let weight_offset_rad = column(|m| m.weight_offset_rad);
                let record = CRecord {
                    samples: rows.len().min(6),
                    time_s: time_s.as_ptr(),
                    velocity_m_s: velocity_m_s.as_ptr(),
                    acceleration_m_s2: acceleration_m_s2.as_ptr(),
                    angle_rad: angle_rad.as_ptr(),
                    load_n: load_n.as_ptr(),
                    temperature_c: if optional { temperature_c.as_ptr() } else { null() },
                    weight_offset_rad: if optional { weight_offset_rad.as_ptr() } else { null() },
                };
                let mut out: Vec<$kind> = vec![0.0; rows.len()];
                assert_eq!(jbf_c::$predict(null(), &record, 0.02, out.as_mut_ptr()), NULL);
                assert_eq!(jbf_c::$predict(model, null(), 0.02, out.as_mut_ptr()), NULL);
                assert_eq!(jbf_c::$predict(model, &record, 0.02, null_mut()), NULL);
                let lost = CRecord { load_n: null(), ..record };
                assert_eq!(jbf_c::$predict(model, &lost, 0.02, out.as_mut_ptr()), NULL);
                let empty = CRecord { samples: 0, ..record };
                assert_eq!(jbf_c::$predict(model, &empty, 0.02, out.as_mut_ptr()), OK);
            }
        })*

        const RUNS: &[fn(&mut Unstructured<'_>) -> Result<()>] = &[$($init::run,)*];
    };
}

laws! {
    journal::Journal f32
        jbf_journal_f32_init jbf_journal_f32_effect jbf_journal_f32_start jbf_journal_f32_step jbf_journal_f32_predict;
    journal::Journal f64
        jbf_journal_f64_init jbf_journal_f64_effect jbf_journal_f64_start jbf_journal_f64_step jbf_journal_f64_predict;
    journal_full::JournalFull f32
        jbf_journal_full_f32_init jbf_journal_full_f32_effect jbf_journal_full_f32_start jbf_journal_full_f32_step jbf_journal_full_f32_predict;
    journal_full::JournalFull f64
        jbf_journal_full_f64_init jbf_journal_full_f64_effect jbf_journal_full_f64_start jbf_journal_full_f64_step jbf_journal_full_f64_predict;
    coulomb::Coulomb f32
        jbf_coulomb_f32_init jbf_coulomb_f32_effect jbf_coulomb_f32_start jbf_coulomb_f32_step jbf_coulomb_f32_predict;
    coulomb::Coulomb f64
        jbf_coulomb_f64_init jbf_coulomb_f64_effect jbf_coulomb_f64_start jbf_coulomb_f64_step jbf_coulomb_f64_predict;
    stribeck::Stribeck f32
        jbf_stribeck_f32_init jbf_stribeck_f32_effect jbf_stribeck_f32_start jbf_stribeck_f32_step jbf_stribeck_f32_predict;
    stribeck::Stribeck f64
        jbf_stribeck_f64_init jbf_stribeck_f64_effect jbf_stribeck_f64_start jbf_stribeck_f64_step jbf_stribeck_f64_predict;
    seven_parameter::SevenParameter f32
        jbf_seven_parameter_f32_init jbf_seven_parameter_f32_effect jbf_seven_parameter_f32_start jbf_seven_parameter_f32_step jbf_seven_parameter_f32_predict;
    seven_parameter::SevenParameter f64
        jbf_seven_parameter_f64_init jbf_seven_parameter_f64_effect jbf_seven_parameter_f64_start jbf_seven_parameter_f64_step jbf_seven_parameter_f64_predict;
    dahl::Dahl f32
        jbf_dahl_f32_init jbf_dahl_f32_effect jbf_dahl_f32_start jbf_dahl_f32_step jbf_dahl_f32_predict;
    dahl::Dahl f64
        jbf_dahl_f64_init jbf_dahl_f64_effect jbf_dahl_f64_start jbf_dahl_f64_step jbf_dahl_f64_predict;
    lugre::LuGre f32
        jbf_lugre_f32_init jbf_lugre_f32_effect jbf_lugre_f32_start jbf_lugre_f32_step jbf_lugre_f32_predict;
    lugre::LuGre f64
        jbf_lugre_f64_init jbf_lugre_f64_effect jbf_lugre_f64_start jbf_lugre_f64_step jbf_lugre_f64_predict;
    maxwell_slip::MaxwellSlip f32
        jbf_maxwell_slip_f32_init jbf_maxwell_slip_f32_effect jbf_maxwell_slip_f32_start jbf_maxwell_slip_f32_step jbf_maxwell_slip_f32_predict;
    maxwell_slip::MaxwellSlip f64
        jbf_maxwell_slip_f64_init jbf_maxwell_slip_f64_effect jbf_maxwell_slip_f64_start jbf_maxwell_slip_f64_step jbf_maxwell_slip_f64_predict;
    elasto_plastic::ElastoPlastic f32
        jbf_elasto_plastic_f32_init jbf_elasto_plastic_f32_effect jbf_elasto_plastic_f32_start jbf_elasto_plastic_f32_step jbf_elasto_plastic_f32_predict;
    elasto_plastic::ElastoPlastic f64
        jbf_elasto_plastic_f64_init jbf_elasto_plastic_f64_effect jbf_elasto_plastic_f64_start jbf_elasto_plastic_f64_step jbf_elasto_plastic_f64_predict;
    rate_and_state::RateAndState f32
        jbf_rate_and_state_f32_init jbf_rate_and_state_f32_effect jbf_rate_and_state_f32_start jbf_rate_and_state_f32_step jbf_rate_and_state_f32_predict;
    rate_and_state::RateAndState f64
        jbf_rate_and_state_f64_init jbf_rate_and_state_f64_effect jbf_rate_and_state_f64_start jbf_rate_and_state_f64_step jbf_rate_and_state_f64_predict;
}

/// Checks that the C interface of any law, in either precision, has the results of `jbf_core`, and
/// refuses invalid input.
pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    assert_eq!(RUNS.len(), jbf_c::SIZES.len());
    let run = bytes.choose(RUNS)?;
    run(bytes)
}
