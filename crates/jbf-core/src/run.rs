//! Prediction of the friction along a whole recorded run.

pub use crate::prediction::predict;
pub use crate::record::Record;
