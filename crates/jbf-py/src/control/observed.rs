//! Compensator with a friction model and an observer, passed from Python.

use super::model::{ModelSpec, Using};
use super::running::{boxed, Stepping};
use super::settings::LoopSpec;
use crate::bearing::refused;
use core::marker::PhantomData;
use jbf_core::compensator::observed::{Learned, Observed, Settings};
use jbf_core::compensator::ChainModel;
use jbf_core::law::Named;
use jbf_core::{Chain, Real};
use pyo3::prelude::*;

/// Friction model and settings of a compensator with an observer, and the corrections that an
/// earlier run learned.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ObservedSpec {
    model: ModelSpec,
    settings: TunedSpec,
    start: (f64, f64),
}

/// Settings that `jbf control tune` computes for the compensator and its loop.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct TunedSpec {
    bandwidth_rad_s: f64,
    learning_1_s: f64,
    level_limit_v: f64,
    rest_limit_v: f64,
    slow_rad_s: f64,
    loop_rad_s: f64,
    breakaway: f64,
}

impl TunedSpec {
    fn beside(&self, settings: &LoopSpec) -> Settings {
        let drive = settings.drive.drive();
        Settings::new(&drive, self.bandwidth_rad_s, self.slow_rad_s, settings.dt_s)
            .with_learning_1_s(self.learning_1_s)
            .with_level_limit_v(self.level_limit_v)
            .with_rest_limit_v(self.rest_limit_v)
            .with_breakaway(self.breakaway)
            .with_control_law(&settings.law(), self.loop_rad_s)
    }
}

struct Carry<'a, T> {
    spec: &'a ObservedSpec,
    settings: &'a LoopSpec,
    number: PhantomData<T>,
}

impl<T: Real> Using<T> for Carry<'_, T> {
    type Output = PyResult<Box<dyn Stepping>>;

    fn with<L: Named<T>>(self, chain: Chain<T, L>) -> Self::Output {
        let s = self.spec;
        let volts_per_n = self.settings.drive.drive().volts_per_n;
        let model = ChainModel::new(chain, volts_per_n, s.model.load_n);
        let compensator = Observed::new(model, &s.settings.beside(self.settings))
            .map_err(refused)?
            .resumed(Learned {
                level_v: T::of(s.start.0),
                rest_v: T::of(s.start.1),
            });
        boxed(self.settings, compensator)
    }
}

impl ObservedSpec {
    /// Creates the control loop of `settings` with this compensator.
    pub fn into_loop<T: Real>(self, settings: &LoopSpec) -> PyResult<Box<dyn Stepping>> {
        self.model.chain(Carry::<T> {
            spec: &self,
            settings,
            number: PhantomData,
        })?
    }
}
