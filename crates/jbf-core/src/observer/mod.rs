//! Observers of quantities that the encoder does not measure, one per file.

pub mod coulomb;
mod velocity;

pub use coulomb::CoulombObserver;
pub use velocity::VelocityObserver;
