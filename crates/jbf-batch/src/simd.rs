//! Instruction sets of a computation in lanes, selected at run time.
//!
//! Lanes are independent and nothing is contracted (no fused multiply-add), so every instruction
//! set gives the same bits.

use core::fmt::Debug;

/// An instruction set as a type, for code that is compiled once per set.
pub trait InstructionSet: Copy + Debug + Send + Sync {
    /// Calls `work` as a separate function; all code inlined into it is compiled for this set.
    fn call<R>(self, work: impl FnOnce() -> R) -> R;
}

/// Baseline instruction set of the target (SSE2 on x86-64).
#[derive(Clone, Copy, Debug)]
pub struct Baseline;

impl InstructionSet for Baseline {
    #[inline(never)]
    fn call<R>(self, work: impl FnOnce() -> R) -> R {
        work()
    }
}

#[cfg(all(feature = "wide", target_arch = "x86_64"))]
impl InstructionSet for pulp::x86::V3 {
    #[inline(always)]
    fn call<R>(self, work: impl FnOnce() -> R) -> R {
        pulp::Simd::vectorize(self, work)
    }
}

#[cfg(all(feature = "wide", target_arch = "x86_64"))]
impl InstructionSet for pulp::x86::V4 {
    #[inline(always)]
    fn call<R>(self, work: impl FnOnce() -> R) -> R {
        pulp::Simd::vectorize(self, work)
    }
}

/// Instruction set of a computation in lanes.
#[derive(Clone, Copy, Debug)]
pub enum Simd {
    /// Baseline instruction set of the target (SSE2 on x86-64).
    Baseline,
    /// AVX2: four numbers of double precision.
    #[cfg(all(feature = "wide", target_arch = "x86_64"))]
    Avx2(pulp::x86::V3),
    /// AVX-512: eight numbers of double precision.
    #[cfg(all(feature = "wide", target_arch = "x86_64"))]
    Avx512(pulp::x86::V4),
}

impl Simd {
    /// Instruction sets that this machine supports, best first.
    pub fn available() -> Vec<Self> {
        #[cfg(all(feature = "wide", target_arch = "x86_64"))]
        let wide = [
            pulp::x86::V4::try_new().map(Self::Avx512),
            pulp::x86::V3::try_new().map(Self::Avx2),
        ];
        #[cfg(not(all(feature = "wide", target_arch = "x86_64")))]
        let wide: [Option<Self>; 0] = [];
        wide.into_iter().flatten().chain([Self::Baseline]).collect()
    }

    /// Best instruction set that this machine supports.
    pub fn best() -> Self {
        Self::available()[0]
    }

    /// Name of the instruction set.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            #[cfg(all(feature = "wide", target_arch = "x86_64"))]
            Self::Avx2(_) => "avx2",
            #[cfg(all(feature = "wide", target_arch = "x86_64"))]
            Self::Avx512(_) => "avx512",
        }
    }

    /// Runs `work`; all code inlined into it is compiled for this instruction set.
    #[inline(always)]
    pub fn dispatch<R>(self, work: impl FnOnce() -> R) -> R {
        match self {
            Self::Baseline => work(),
            #[cfg(all(feature = "wide", target_arch = "x86_64"))]
            Self::Avx2(v3) => pulp::Simd::vectorize(v3, work),
            #[cfg(all(feature = "wide", target_arch = "x86_64"))]
            Self::Avx512(v4) => pulp::Simd::vectorize(v4, work),
        }
    }
}
