//! Observers, one per file, of quantities that the encoder does not measure.

pub mod coulomb;
pub mod velocity;

pub use coulomb::CoulombObserver;
pub use velocity::VelocityObserver;
