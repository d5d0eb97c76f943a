//! Observers, one a file: what the encoder does not tell.

pub mod coulomb;
pub mod velocity;

pub use coulomb::CoulombObserver;
pub use velocity::VelocityObserver;
