//! Laws and effects of `jbf-core` by name, and how estimators treat their parameters.
//!
//! Programs on a host need this crate in addition to the descriptions in
//! [`jbf_core::law::CATALOGUE`] and [`jbf_core::effect::CATALOGUE`]; a control loop does not. The
//! crate contains:
//!
//! - [`Spec`]: construction of a signal chain from names and lists of values.
//! - [`parameter`]: start value and bound of a parameter in a fit, and whether it is estimated.
//! - [`effect`]: properties of an effect that decide which samples a fit uses and how it searches.
//!
//! A law or an effect without an entry in this crate has the default treatment.
#![no_std]
#![forbid(unsafe_code)]

mod estimation;
mod spec;

pub use estimation::{effect, parameter, Bound, EffectTreatment, ParameterTreatment, Start};
pub use spec::{Spec, Using};
