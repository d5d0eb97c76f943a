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

pub mod bearing;
mod builder;
pub mod chain;
pub mod clock;
pub mod compensator;
pub mod control_law;
pub mod controller;
mod delay_line;
pub mod driver;
pub mod dual;
pub mod effect;
pub mod encoder;
pub mod error;
pub mod film;
pub mod friction;
pub mod law;
pub mod motion;
pub mod observer;
pub mod page;
mod path;
pub mod plant;
pub mod real;
pub mod record;
pub mod reference;
pub mod relaxation;
mod root;
pub mod run;
pub mod spec;
pub mod stepper;
pub mod transition;

pub use bearing::Bearing;
pub use chain::Chain;
pub use clock::Clock;
pub use dual::Dual;
pub use error::{Error, ParameterError};
pub use friction::Friction;
pub use motion::Motion;
pub use real::Real;
