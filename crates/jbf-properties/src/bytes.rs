//! Conversion of random bytes to numbers, step lengths, time scales and effects.

use arbitrary::{Result, Unstructured};
use jbf_core::effect::{self, Effects, Parameter};
use jbf_core::law::Info;
use jbf_core::{Clock, Real};

/// Draws any number with an absolute value of at most `largest`, including zero and denormal
/// numbers.
///
/// Half of the numbers have a magnitude typical of machines, which is rare in random bits.
pub fn number(bytes: &mut Unstructured<'_>, largest: f64) -> Result<f64> {
    let plain: u8 = bytes.arbitrary()?;
    if plain < 128 {
        let size = between(bytes, 1e-4, 1e2)?.min(largest);
        return Ok(if plain & 1 == 0 { size } else { -size });
    }
    let any = f64::from_bits(bytes.arbitrary()?);
    Ok(match any {
        x if x.is_nan() => 0.0,
        x => x.clamp(-largest, largest),
    })
}

/// Draws any number from `low` to `high`, from all decades if both are positive.
pub fn between(bytes: &mut Unstructured<'_>, low: f64, high: f64) -> Result<f64> {
    let share = f64::from(bytes.arbitrary::<u16>()?) / f64::from(u16::MAX);
    let value = if low > 0.0 {
        low * (high / low).powf(share)
    } else {
        low + (high - low) * share
    };
    Ok(value.clamp(low, high))
}

/// Draws a value within the bounds of a parameter, in some cases a bound or the null value.
pub fn parameter(bytes: &mut Unstructured<'_>, page: &Parameter) -> Result<f64> {
    match bytes.arbitrary::<u8>()? {
        0 => Ok(page.lower),
        1 => Ok(page.upper),
        2 => Ok(page.null.unwrap_or(page.starts[0])),
        3..=60 if page.lower >= 0.0 => {
            between(bytes, page.lower.max(1e-12 * page.upper), page.upper)
        }
        _ => between(bytes, page.lower, page.upper),
    }
}

/// Draws a value for each parameter of a list.
pub fn parameters<T: Real>(bytes: &mut Unstructured<'_>, pages: &[Parameter]) -> Result<Vec<T>> {
    let values = pages.iter().map(|p| parameter(bytes, p).map(T::of));
    values.collect()
}

/// Draws the length of a step, s.
pub fn step_s(bytes: &mut Unstructured<'_>) -> Result<f64> {
    if bytes.ratio(1, 8)? {
        return Ok(number(bytes, 1e9)?.abs());
    }
    between(bytes, 1e-7, 10.0)
}

/// Draws one of the two time scales of the film.
pub fn clock(bytes: &mut Unstructured<'_>) -> Result<Clock> {
    Ok(if bytes.arbitrary()? {
        Clock::Journal
    } else {
        Clock::Thesis
    })
}

/// Draws some of the effects that are compatible with a law: none, a few, or any subset.
pub fn effects<T: Real>(bytes: &mut Unstructured<'_>, law: &Info) -> Result<Effects<T>> {
    let mut effects = Effects::NONE;
    let fitting = |i: usize| effect::CATALOGUE[i].lacking(law).is_none();
    let few: u8 = bytes.arbitrary()?;
    let wanted: u64 = if few < 192 {
        let mut some = 0;
        for _ in 0..few / 64 {
            some |= 1 << bytes.int_in_range(0..=effect::CATALOGUE.len() - 1)?;
        }
        some
    } else {
        bytes.arbitrary()?
    };
    for (i, info) in effect::CATALOGUE.iter().enumerate() {
        if wanted & (1 << (i % 64)) == 0 || !fitting(i) {
            continue;
        }
        let values: Vec<T> = parameters(bytes, info.parameters)?;
        // In single precision a bound may round outwards, which is correctly rejected.
        let _ = effects.set(info.name, &values);
    }
    Ok(effects)
}

/// Machine epsilon of a number type, the relative distance between adjacent numbers.
pub fn rounding<T: Real>() -> f64 {
    if size_of::<T>() == size_of::<f32>() {
        f32::EPSILON.into()
    } else {
        f64::EPSILON
    }
}
