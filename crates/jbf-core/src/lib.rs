#![doc = include_str!("../README.md")]
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

// Foundations: numbers, names and errors.
mod bearing;
mod builder;
mod clock;
mod delay_line;
mod described;
mod dual;
mod error;
mod film;
mod friction;
mod motion;
mod parameter;
mod path;
mod real;
mod relaxation;
mod root;
mod transition;

// Friction laws, effects, and the chain that runs them.
pub mod chain;
pub mod effect;
pub mod law;
mod prediction;
mod record;
pub mod run;

// Fixed-step integrators, and trajectories computed to a tolerance.
pub mod driver;
pub mod stepper;

// Control loop: counter in, voltage out, and a simulated shaft for tests.
pub mod compensator;
mod control_law;
pub mod controller;
pub mod encoder;
pub mod observer;
pub mod plant;
pub mod reference;

#[doc(hidden)]
pub mod internals;

pub use bearing::Bearing;
pub use chain::Chain;
pub use clock::Clock;
pub use dual::Dual;
pub use error::Error;
pub use friction::Friction;
pub use motion::{JournalMotion, Motion};
pub use nalgebra;
pub use real::Real;
