//! The square root of single precision.
//!
//! `libm` has it in hardware on x86-64 and 64-bit Arm, but in some sixty integer operations on a
//! Cortex-M with a floating-point unit, and stable Rust without `std` names no other way to the
//! instruction. A call of C's `sqrtf` is one that the compiler knows: it emits the instruction, and
//! calls only for a negative number. IEEE 754 rounds a root correctly, so the bits are the same.

#[cfg(not(all(target_arch = "arm", target_abi = "eabihf", target_os = "none")))]
pub(crate) use libm::sqrtf;

/// Square root.
#[cfg(all(target_arch = "arm", target_abi = "eabihf", target_os = "none"))]
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
