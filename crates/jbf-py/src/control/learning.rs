//! Learning compensator, passed from Python.

use super::settings::LoopSpec;
use crate::bearing::{refused, Sizes};
use crate::names;
use jbf_core::compensator::learning::{Learned, Learning, Rule, Settings};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::Real;
use pyo3::prelude::*;

/// Film model and settings of a learning compensator; a gain of `None` is that of Cohn (1998).
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct LearningSpec {
    bearing: Sizes,
    load_n: f64,
    clock: String,
    f_m: f64,
    u_tr_m_s: f64,
    k0: f64,
    gamma: f64,
    eps_tr: Option<f64>,
    volts: f64,
    k0_gain: Option<f64>,
    gamma_gain: Option<f64>,
    k0_bounds: (f64, f64),
    gamma_bounds: (f64, f64),
}

impl LearningSpec {
    /// Creates the learning compensator for a loop.
    pub fn compensator<T: Real>(self, settings: &LoopSpec) -> PyResult<Learning<T>> {
        let bearing = self.bearing.checked()?;
        let clock = names::clock(&self.clock)?;
        let parameters = Parameters {
            f_m: T::of(self.f_m),
            u_tr_m_s: T::of(self.u_tr_m_s),
            k0: T::of(self.k0),
            gamma: T::of(self.gamma),
        };
        let law = Journal::new(&bearing, self.load_n, &parameters, clock)
            .and_then(|law| match self.eps_tr {
                Some(eps_tr) => law.with_eps_tr(eps_tr),
                None => Ok(law),
            })
            .map_err(refused)?;
        let rule = if settings.position {
            Rule::THESIS_POSITION
        } else {
            Rule::Velocity
        };
        let begin = Learned {
            k0: self.k0,
            gamma: self.gamma,
        };
        let learning = Settings::new(rule, begin, self.volts, bearing.radius_m, settings.dt_s);
        let learning = learning
            .with_gain(Learned {
                k0: self.k0_gain.unwrap_or(learning.gain.k0),
                gamma: self.gamma_gain.unwrap_or(learning.gain.gamma),
            })
            .with_least(Learned {
                k0: self.k0_bounds.0,
                gamma: self.gamma_bounds.0,
            })
            .with_most(Learned {
                k0: self.k0_bounds.1,
                gamma: self.gamma_bounds.1,
            });
        Learning::new(law, &learning).map_err(refused)
    }
}
