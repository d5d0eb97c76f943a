//! The square root.
//!
//! `libm` has that of single precision in hardware on x86-64 and 64-bit Arm, but in some sixty integer operations on a
//! Cortex-M with a floating-point unit, and stable Rust without `std` names no other way to the
//! instruction. A call of C's `sqrtf` is one that the compiler knows: it emits the instruction, and
//! calls only for a negative number. With the feature `std` it is the standard library's. IEEE 754
//! rounds a root correctly, so the bits are the same everywhere.

#[cfg(not(any(
    feature = "std",
    all(target_arch = "arm", target_abi = "eabihf", target_os = "none")
)))]
pub(crate) use libm::sqrtf;

/// Square root.
#[cfg(feature = "std")]
#[inline(always)]
pub(crate) fn sqrtf(x: f32) -> f32 {
    std::primitive::f32::sqrt(x)
}

#[cfg(not(feature = "std"))]
pub(crate) use libm::sqrt;

/// Square root in double precision.
#[cfg(feature = "std")]
#[inline(always)]
pub(crate) fn sqrt(x: f64) -> f64 {
    std::primitive::f64::sqrt(x)
}

/// Square root.
#[cfg(all(
    not(feature = "std"),
    target_arch = "arm",
    target_abi = "eabihf",
    target_os = "none"
))]
#[allow(unsafe_code)]
#[inline(always)]
pub(crate) fn sqrtf(x: f32) -> f32 {
    extern "C" {
        // Of Rust's own compiler_builtins, or of the C library that a firmware links.
        #[link_name = "sqrtf"]
        fn root(x: f32) -> f32;
    }
    // Sound: it takes and gives a number in a register, whatever the number is.
    unsafe { root(x) }
}
