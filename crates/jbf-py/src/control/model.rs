//! Friction model passed from Python, and the chain that is created from it.

use crate::bearing::{refused, Sizes};
use crate::names;
use jbf_catalogue::Spec;
use jbf_core::Real;
use pyo3::prelude::*;

pub use jbf_catalogue::Using;

/// Names of the law and the effects, and the values of their parameters in the order of the
/// catalogue.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ModelSpec {
    law: String,
    bearing: Option<Sizes>,
    pub load_n: f64,
    clock: String,
    parameters: Vec<f64>,
    effects: Vec<(String, Vec<f64>)>,
}

impl ModelSpec {
    /// Creates the chain and passes it to the operation `then`.
    pub fn chain<T: Real, U: Using<T>>(&self, then: U) -> PyResult<U::Output> {
        let clock = names::clock(&self.clock)?;
        let bearing = match &self.bearing {
            Some(sizes) => Some(sizes.clone().checked()?),
            None => None,
        };
        let cast = |values: &[f64]| values.iter().map(|&v| T::of(v)).collect::<Vec<T>>();
        let effects = self.effects.iter();
        let effects = effects.map(|(name, values)| (name.as_str(), cast(values)));
        let spec = Spec {
            law: &self.law,
            values: &cast(&self.parameters),
            bearing: bearing.as_ref(),
            load_n: Some(self.load_n),
            clock,
        };
        spec.chain(effects, then).map_err(refused)
    }
}
