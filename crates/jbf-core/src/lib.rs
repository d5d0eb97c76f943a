//! Friction that moves: the dynamic friction of a hydrodynamic journal bearing
//! (Harnoy & Friedland 1994, as reduced by Cohn, NJIT 1998) and the effects that a
//! measured signal adds to it, one fixed step at a time.
//!
//! `no_std`, no allocation, no panic in a step, the same bits on every target.
//! Configuration ([`Chain`], [`law::journal::Journal`]) is apart from state, so one set of
//! coefficients serves many runs.
//!
//! ```
//! use jbf_core::{Bearing, Clock, law::{Law, journal::{Journal, Parameters}}};
//! let law = Journal::new(&Bearing::THESIS, 104.0, &Parameters::TABLE_4_2, Clock::Journal)?;
//! let steady = law.steady(0.02)?;
//! assert!((steady.coefficient - 0.05782937675212433).abs() < 1e-9);
//! # Ok::<(), jbf_core::Error>(())
//! ```
#![no_std]
// One call, in `root.rs`, on Cortex-M with a floating-point unit; forbidden everywhere else.
#![cfg_attr(
    not(all(target_arch = "arm", target_abi = "eabihf", target_os = "none")),
    forbid(unsafe_code)
)]
#![deny(unsafe_code)]
#![deny(missing_docs)]

#[cfg(any(test, feature = "std"))]
extern crate std;

/// The README's example is a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

// What the physics stands on: numbers, names, errors.
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

// Laws, the effects round them, and how a chain of both runs.
pub mod chain;
pub mod effect;
pub mod law;
pub mod record;
pub mod run;
pub mod spec;

// Integrators of fixed step, and trajectories to a tolerance.
pub mod driver;
pub mod stepper;

// The loop: counter in, voltage out, and the bench's shaft to try it on.
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
