//! Fingerprints (hashes of results) of all computations of `jbf-core` with time steps.
//!
//! They include laws, integration methods, effects, chains, trajectories and control loops, in
//! single and double precision.
//!
//! A target computes correctly if its fingerprints equal those of [`TABLE`], to the last bit of
//! every step.
//!
//! The crate is `no_std`, does not allocate and does not depend on the platform. A microcontroller
//! runs the same code and compares its results with the same table. Call [`check`]:
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

/// Fingerprint of one computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trace {
    /// Group of the computation: `law`, `stepper`, `effect`, `chain`, `driver` or `loop`.
    pub group: &'static str,
    /// Name of the computation in its group.
    pub name: &'static str,
    /// Number type, `f32` or `f64`.
    pub kind: &'static str,
    /// Hash of the results of every step.
    pub hash: u64,
}

/// Result of the comparison of all fingerprints with [`TABLE`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Number of fingerprints equal to those of the table.
    pub same: u32,
    /// Number of fingerprints different from those of the table.
    pub different: u32,
    /// Number of fingerprints that the table does not contain because they are newer.
    pub unknown: u32,
}

/// Computes all fingerprints with the number type `T`, whose name is `kind`, and passes each to
/// `visit`.
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

/// Computes the fingerprints of all computations that a control loop may need, with the number type
/// `T`, and passes each to `visit`.
///
/// Trajectories, which are for analysis, are not included.
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

/// Computes all fingerprints in single and double precision, and compares them with [`TABLE`].
///
/// `visit` is called with each fingerprint and its hash in the table, if there is one.
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
