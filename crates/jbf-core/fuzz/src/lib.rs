//! Numbers out of the fuzzer's bytes.

use arbitrary::{Result, Unstructured};
use jbf_core::effect::Parameter;

/// Any number of at most `largest`: zero, denormal, whatever the bits say.
pub fn number(bytes: &mut Unstructured<'_>, largest: f64) -> Result<f64> {
    let any = f64::from_bits(bytes.arbitrary()?);
    Ok(match any {
        x if x.is_nan() => 0.0,
        x => x.clamp(-largest, largest),
    })
}

/// Anything from `low` to `high`: over all decades where both are positive.
pub fn between(bytes: &mut Unstructured<'_>, low: f64, high: f64) -> Result<f64> {
    let share = f64::from(bytes.arbitrary::<u16>()?) / f64::from(u16::MAX);
    let value = if low > 0.0 {
        low * (high / low).powf(share)
    } else {
        low + (high - low) * share
    };
    Ok(value.clamp(low, high))
}

/// A value within the bounds of a page, its ends and its null now and then.
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

/// Length of a step, s.
pub fn step_s(bytes: &mut Unstructured<'_>) -> Result<f64> {
    if bytes.ratio(1, 8)? {
        return Ok(number(bytes, 1e9)?.abs());
    }
    between(bytes, 1e-7, 10.0)
}
