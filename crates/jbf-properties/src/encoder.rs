//! Property: the encoder agrees with integer arithmetic for every motion, and reports and ignores
//! every jump.

use crate::bytes::{between, rounding};
use crate::steps::seen;
use arbitrary::{Result, Unstructured};
use jbf_core::encoder::{Encoder, State};
use jbf_core::Real;

/// Numbers of bits of the counter, common and rare ones.
const BITS: [u32; 6] = [8, 10, 16, 24, 31, 32];

fn run<T: Real>(bytes: &mut Unstructured<'_>) -> Result<()> {
    let counts_per_rad = between(bytes, 1e-2, 1e6)?;
    let top_rad_s = between(bytes, 1e-2, 1e5)?;
    let dt_s = between(bytes, 1e-6, 1.0)?;
    let bits = *bytes.choose(&BITS)?;
    let Ok(encoder) = Encoder::<T>::new(counts_per_rad, bits, top_rad_s, dt_s) else {
        return Ok(());
    };
    let most = (counts_per_rad * top_rad_s * dt_s + 2.0) as i64;
    let range = 1_i64 << bits;
    let mut state = State::default();
    let mut counter: u32 = bytes.arbitrary()?;
    encoder.step(&mut state, counter);
    let (mut total, mut still) = (0_i64, 0_u32);
    while !bytes.is_empty() {
        // A possible motion of the shaft, or an arbitrary counter.
        let possible = bytes.ratio(7, 8)?;
        let moved = if possible {
            bytes.int_in_range(-most..=most)?
        } else {
            bytes.int_in_range(-range / 2..=range / 2 - 1)?
        };
        let believed = if moved.abs() <= most { moved } else { 0 };
        total += believed;
        still = if moved == 0 { still + 1 } else { 0 };
        // Bits above the width of the counter are ignored.
        let above = if bits < 32 {
            bytes.arbitrary::<u32>()? << bits
        } else {
            0
        };
        let mask = ((1_u64 << bits) - 1) as u32;
        counter = (counter.wrapping_add(moved as u32) & mask) | above;
        seen();
        let sample = encoder.step(&mut state, counter);
        let told = || format!("{encoder:?} {moved} of at most {most}: {sample:?} {state:?}");
        assert_eq!(sample.jumped, moved.abs() > most, "{}", told());
        assert_eq!(sample.still, still, "{}", told());
        let near = |seen: T, counts: i64| {
            let exact = counts as f64 / counts_per_rad;
            (seen.value() - exact).abs() <= 4.0 * rounding::<T>() * exact.abs()
        };
        assert!(near(sample.moved_rad, believed), "{}", told());
        assert!(near(encoder.angle_rad(&state), total), "{total} {}", told());
    }
    Ok(())
}

/// Checks that an encoder with any number of bits follows every possible motion, and reports every
/// jump.
pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    if bytes.arbitrary()? {
        run::<f32>(bytes)
    } else {
        run::<f64>(bytes)
    }
}
