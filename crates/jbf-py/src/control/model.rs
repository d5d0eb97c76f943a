//! A friction model as Python hands it over, and the chain that comes of it.

use crate::bearing::{refused, Sizes};
use jbf_core::effect::{Effects, Rig, CATALOGUE};
use jbf_core::law::{with_law, Named, Visitor};
use jbf_core::{Chain, Clock, Error, Real};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Law, effects and their values, in the order of the catalogue's pages.
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

/// Something to do with a chain of any law.
pub trait Using<T: Real> {
    type Output;
    fn with<L: Named<T>>(self, chain: Chain<T, L>) -> Self::Output;
}

struct Wrap<T: Real, U> {
    effects: Effects<T>,
    rig: Rig<T>,
    then: U,
}

impl<T: Real, U: Using<T>> Visitor<T> for Wrap<T, U> {
    type Output = U::Output;

    fn visit<L: Named<T>>(self, law: L) -> U::Output {
        self.then.with(Chain {
            law,
            effects: self.effects,
            rig: self.rig,
        })
    }
}

impl ModelSpec {
    /// Build the chain and hand it on.
    pub fn chain<T: Real, U: Using<T>>(&self, then: U) -> PyResult<U::Output> {
        let clock = Clock::from_name(&self.clock)
            .ok_or_else(|| PyValueError::new_err("clock is neither journal nor thesis"))?;
        let bearing = match &self.bearing {
            Some(sizes) => Some(sizes.clone().checked()?),
            None => None,
        };
        let lift = |values: &[f64]| values.iter().map(|&v| T::of(v)).collect::<Vec<T>>();
        let mut effects = Effects::NONE;
        for (name, values) in &self.effects {
            debug_assert!(CATALOGUE.iter().any(|e| e.name == name));
            effects.set(name, &lift(values)).map_err(refused)?;
        }
        let rig = Rig {
            radius_m: T::of(bearing.as_ref().map_or(1.0, |b| b.radius_m)),
            count: T::of(bearing.as_ref().map_or(1.0, |b| f64::from(b.count))),
        };
        with_law(
            &self.law,
            bearing.as_ref(),
            Some(self.load_n),
            &lift(&self.parameters),
            clock,
            Wrap { effects, rig, then },
        )
        .map_err(|e: Error| refused(e))
    }
}
