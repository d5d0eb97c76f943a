//! Fingerprints of all computations of `jbf-core` that take steps: laws, steppers, effects, whole
//! chains, the driver, control loops, in single and double precision.
//!
//! A target computes correctly if its fingerprints equal those of [`TABLE`], to the last bit of
//! every step.
//!
//! The crate is `no_std`, does not allocate and uses nothing of the platform. A microcontroller
//! runs the same code and compares with the same table. [`check`] is the only function to call:
//!
//! ```
//! let found = jbf_trace::check(|trace, expected| {
//!     if expected.is_some_and(|hash| hash != trace.hash) {
//!         println!("{}/{} {}: {:#018x}", trace.group, trace.name, trace.kind, trace.hash);
//!     }
//! });
//! assert_eq!(found.different, 0);
//! ```
//!
//! After an intended change of results, `make bits-table` rewrites the table.
#![no_std]
#![forbid(unsafe_code)]

mod chains;
mod drivers;
mod hash;
pub mod loops;
mod motion;
mod shaft;
mod steppers;
mod table;

pub use hash::Hash;
pub use motion::{motions, STEP_S};
pub use shaft::{asked, Shaft, LOOP_STEPS, LOOP_STEP_S};
pub use table::TABLE;

use jbf_core::Real;

/// Fingerprint of one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trace {
    /// Group of the run: `law`, `stepper`, `effect`, `chain`, `driver` or `loop`.
    pub group: &'static str,
    /// Name of the run.
    pub name: &'static str,
    /// Number type, `f32` or `f64`.
    pub kind: &'static str,
    /// Hash of the bits of every step.
    pub hash: u64,
}

/// Result of the comparison with [`TABLE`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Number of fingerprints equal to those of the table.
    pub same: u32,
    /// Number of fingerprints different from those of the table.
    pub different: u32,
    /// Number of fingerprints that the table does not contain because they are newer.
    pub unknown: u32,
}

/// Computes all fingerprints in one number type and passes each to `visit`.
pub fn traces<T: Real>(kind: &'static str, visit: &mut dyn FnMut(&Trace)) {
    steps::<T>(kind, visit);
    drivers::drivers::<T>(&mut |group, name, hash: Hash| {
        visit(&Trace {
            group,
            name,
            kind,
            hash: hash.0,
        });
    });
}

/// Computes the fingerprints of everything that a control loop may step: all except the driver,
/// which is for analysis.
pub fn steps<T: Real>(kind: &'static str, visit: &mut dyn FnMut(&Trace)) {
    let mut named = |group, name, hash: Hash| {
        visit(&Trace {
            group,
            name,
            kind,
            hash: hash.0,
        });
    };
    chains::laws::<T>(&mut named);
    steppers::steppers::<T>(&mut named);
    chains::effects::<T>(&mut named);
    chains::together::<T>(&mut named);
    loops::loops::<T>(&mut named);
}

/// Computes all fingerprints and passes each to `visit` with the value of the table.
pub fn check(mut visit: impl FnMut(&Trace, Option<u64>)) -> Found {
    let mut found = Found::default();
    let mut one = |trace: &Trace| {
        let expected = TABLE
            .iter()
            .find(|t| (t.group, t.name, t.kind) == (trace.group, trace.name, trace.kind))
            .map(|t| t.hash);
        match expected {
            Some(hash) if hash == trace.hash => found.same += 1,
            Some(_) => found.different += 1,
            None => found.unknown += 1,
        }
        visit(trace, expected);
    };
    traces::<f64>("f64", &mut one);
    traces::<f32>("f32", &mut one);
    found
}
