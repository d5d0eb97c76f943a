//! Fingerprints of everything that `jbf-core` steps: laws, steppers, effects, whole chains, the
//! driver, control loops, in single and double precision. A target computes right if its fingerprints are those
//! of [`TABLE`], to the last bit of every step.
//!
//! `no_std`, no allocation, nothing of the platform's: a microcontroller runs the same code and
//! compares with the same table. [`check`] is all that it has to call:
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
//! After a change that is meant to change numbers, `make bits-table` writes the table anew.
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

/// The fingerprint of one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trace {
    /// What kind of thing ran: `law`, `stepper`, `effect`, `chain`, `driver` or `loop`.
    pub group: &'static str,
    /// Its name.
    pub name: &'static str,
    /// `f32` or `f64`.
    pub kind: &'static str,
    /// Hash of the bits of every step.
    pub hash: u64,
}

/// How many fingerprints agree with [`TABLE`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Those of the table.
    pub same: u32,
    /// Not those of the table.
    pub different: u32,
    /// Not in the table: newer than it.
    pub unknown: u32,
}

/// All fingerprints in one kind of number, handed to `visit` as they are computed.
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

/// Those of everything that a control loop may step: all but the driver, which is for analysis.
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

/// All fingerprints, each beside what the table has for it.
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
