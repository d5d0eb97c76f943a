//! Compensators of `jbf_core`, passed from Python as dictionaries with the key `kind`.

use super::learning::LearningSpec;
use super::observed::ObservedSpec;
use super::running::{boxed, Stepping};
use super::settings::LoopSpec;
use crate::bearing::refused;
use jbf_core::compensator::repetitive::Repetitive;
use jbf_core::compensator::{Axis, Table};
use jbf_core::compensator::{Coulomb, NoCompensation};
use jbf_core::observer::CoulombObserver;
use jbf_core::Real;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Number of entries of a look-up table.
pub const ENTRIES: usize = 64;
/// Number of cells of a lap in a repetitive compensator.
const CELLS: usize = 256;

/// Compensator with its settings, selected by the key `kind`.
pub enum Spec {
    Nothing,
    Coulomb(CoulombSpec),
    Learning(LearningSpec),
    Table(TableSpec),
    Repetitive(RepetitiveSpec),
    Observed(ObservedSpec),
}

impl<'py> FromPyObject<'_, 'py> for Spec {
    type Error = PyErr;

    fn extract(spec: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let kind: String = spec.get_item("kind")?.extract()?;
        Ok(match kind.as_str() {
            "none" => Spec::Nothing,
            "coulomb" => Spec::Coulomb(spec.extract()?),
            "learning" => Spec::Learning(spec.extract()?),
            "table" => Spec::Table(spec.extract()?),
            "repetitive" => Spec::Repetitive(spec.extract()?),
            "observed" => Spec::Observed(spec.extract()?),
            _ => {
                let said = format!("compensator kind {kind:?} is not known");
                return Err(PyValueError::new_err(said));
            }
        })
    }
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct CoulombSpec {
    gain: f64,
    exponent: f64,
    limit_v: f64,
    start_v: f64,
}

impl CoulombSpec {
    fn compensator<T: Real>(self, settings: &LoopSpec) -> PyResult<Coulomb<T>> {
        let drive = settings.drive.drive();
        let observer = CoulombObserver::new(
            self.gain,
            self.exponent,
            drive.input_rad_s2_v,
            self.limit_v,
            settings.dt_s,
        );
        let mut compensator = Coulomb::new(observer.map_err(refused)?, &drive);
        compensator.start_v = T::of(self.start_v);
        Ok(compensator)
    }
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TableSpec {
    levels_v: Vec<f64>,
    by_angle: bool,
    width: f64,
    viscous_v_s: f64,
}

impl TableSpec {
    fn compensator<T: Real>(self) -> PyResult<Table<T, ENTRIES>> {
        let levels: [f64; ENTRIES] = self
            .levels_v
            .try_into()
            .map_err(|_| PyValueError::new_err(format!("a table must have {ENTRIES} entries")))?;
        let axis = if self.by_angle {
            Axis::Angle
        } else {
            Axis::Speed
        };
        Table::new(levels.map(T::of), axis, self.width, self.viscous_v_s).map_err(refused)
    }
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RepetitiveSpec {
    steps_per_lap: u32,
    lap_gain: f64,
    smooth: f64,
    lead_s: f64,
    limit_v: f64,
}

impl RepetitiveSpec {
    fn compensator<T: Real>(self, dt_s: f64) -> PyResult<Repetitive<T, CELLS>> {
        Repetitive::new(
            self.steps_per_lap,
            self.lap_gain,
            self.smooth,
            self.lead_s,
            self.limit_v,
            dt_s,
        )
        .map_err(refused)
    }
}

impl Spec {
    /// Creates the control loop of `settings` with this compensator.
    pub fn into_loop<T: Real>(self, settings: &LoopSpec) -> PyResult<Box<dyn Stepping>> {
        match self {
            Spec::Nothing => boxed::<T, _>(settings, NoCompensation),
            Spec::Coulomb(s) => boxed::<T, _>(settings, s.compensator(settings)?),
            Spec::Learning(s) => boxed::<T, _>(settings, s.compensator(settings)?),
            Spec::Table(s) => boxed::<T, _>(settings, s.compensator()?),
            Spec::Repetitive(s) => boxed::<T, _>(settings, s.compensator(settings.dt_s)?),
            Spec::Observed(s) => s.into_loop::<T>(settings),
        }
    }
}
