//! Square root on every target.
//!
//! For single precision `libm` uses the hardware on x86-64 and 64-bit Arm. On a Cortex-M with a
//! floating-point unit, `libm` needs about sixty integer operations, and stable Rust without `std`
//! offers no other access to the hardware instruction. For a call of the C function `sqrtf`, the
//! compiler emits the instruction, and calls the function only for a negative number.
//!
//! With the feature `std` the standard library's function is used. IEEE 754 rounds a root
//! correctly, so the bits are identical on every target.

#[cfg(not(any(
    feature = "std",
    all(target_arch = "arm", target_abi = "eabihf", target_os = "none")
)))]
pub(crate) use libm::sqrtf;

/// Square root in single precision.
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

/// Square root in single precision.
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
        // Provided by Rust's compiler_builtins, or by the C library that a firmware links.
        #[link_name = "sqrtf"]
        fn root(x: f32) -> f32;
    }
    // Sound: it takes and returns a number in a register, for any value of the number.
    unsafe { root(x) }
}
