//! Fixed-step simulation of dynamic friction and of the effects that a recorded signal adds to it.
//!
//! The base model is the dynamic friction of a hydrodynamic journal bearing (Harnoy & Friedland
//! 1994, as reduced by Cohn, NJIT 1998).
//!
//! The crate is `no_std` and does not allocate, a step does not panic, and results are identical
//! bit for bit on every target. Configuration ([`Chain`], [`law::journal::Journal`]) is separate
//! from state, so one set of coefficients serves many runs.
//!
//! ```
//! use jbf_core::{Bearing, Clock, law::{Law, journal::{Journal, Parameters}}};
//! let law = Journal::new(&Bearing::THESIS, 104.0, &Parameters::TABLE_4_2, Clock::Journal)?;
//! let steady = law.steady(0.02)?;
//! assert!((steady.coefficient - 0.05782937675212433).abs() < 1e-9);
//! # Ok::<(), jbf_core::Error>(())
//! ```
#![no_std]
// The only `unsafe` call is in `root.rs`, on Cortex-M with a floating-point unit. Unsafe code is
// forbidden on all other targets.
#![cfg_attr(
    not(all(target_arch = "arm", target_abi = "eabihf", target_os = "none")),
    forbid(unsafe_code)
)]
#![deny(unsafe_code)]
#![deny(missing_docs)]

#[cfg(any(test, feature = "std"))]
extern crate std;

/// Runs the example of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

// Foundations: numbers, names and errors.
pub mod bearing;
mod builder;
pub mod clock;
mod delay_line;
pub mod dual;
pub mod error;
pub mod film;
pub mod film_path;
pub mod friction;
pub mod motion;
pub mod page;
mod path;
pub mod real;
pub mod relaxation;
mod root;
pub mod transition;

// Friction laws, effects, and the chain that runs them.
pub mod chain;
pub mod effect;
pub mod law;
pub mod record;
pub mod run;
pub mod spec;

// Fixed-step integrators, and trajectories computed to a tolerance.
pub mod driver;
pub mod stepper;

// Control loop: counter in, voltage out, and a simulated shaft for tests.
pub mod compensator;
pub mod control_law;
pub mod controller;
pub mod encoder;
pub mod observer;
pub mod plant;
pub mod reference;

pub use bearing::Bearing;
pub use chain::Chain;
pub use clock::Clock;
pub use dual::Dual;
pub use error::{Error, ParameterError};
pub use friction::Friction;
pub use motion::Motion;
pub use real::Real;
