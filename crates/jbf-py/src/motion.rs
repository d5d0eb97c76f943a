//! Python class of the imposed motion of one run, checked once and stored in Rust.

use crate::film_paths::FilmPaths;
use jbf_core::run::Record;
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Imposed motion of one run, as arrays of the same length; Python may set further attributes.
#[pyclass(frozen, dict, module = "jbf._core")]
pub struct Motion {
    time_s: Vec<f64>,
    velocity_m_s: Vec<f64>,
    acceleration_m_s2: Vec<f64>,
    angle_rad: Vec<f64>,
    weight_offset_rad: Option<Vec<f64>>,
    load_n: Vec<f64>,
    temperature_c: Option<Vec<f64>>,
    paths: FilmPaths,
}

impl Motion {
    /// Returns the cache of the states of films along this motion.
    pub fn film_paths(&self) -> &FilmPaths {
        &self.paths
    }

    pub fn record(&self) -> Record<'_> {
        Record {
            time_s: &self.time_s,
            velocity_m_s: &self.velocity_m_s,
            acceleration_m_s2: &self.acceleration_m_s2,
            angle_rad: &self.angle_rad,
            weight_offset_rad: self.weight_offset_rad.as_deref(),
            load_n: &self.load_n,
            temperature_c: self.temperature_c.as_deref(),
        }
    }

    pub fn len(&self) -> usize {
        self.time_s.len()
    }
}

#[pymethods]
impl Motion {
    #[new]
    #[pyo3(signature = (time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n,
                        temperature_c=None, weight_offset_rad=None))]
    fn new(
        time_s: PyReadonlyArray1<'_, f64>,
        velocity_m_s: PyReadonlyArray1<'_, f64>,
        acceleration_m_s2: PyReadonlyArray1<'_, f64>,
        angle_rad: PyReadonlyArray1<'_, f64>,
        load_n: PyReadonlyArray1<'_, f64>,
        temperature_c: Option<PyReadonlyArray1<'_, f64>>,
        weight_offset_rad: Option<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<Self> {
        let n = time_s.len();
        let column = |name: &str, a: &PyReadonlyArray1<'_, f64>| -> PyResult<Vec<f64>> {
            if a.len() != n {
                return Err(PyValueError::new_err(format!(
                    "{name} has {} values, time_s has {n}",
                    a.len()
                )));
            }
            let values: Vec<f64> = a.as_array().iter().copied().collect();
            if let Some(i) = values.iter().position(|v| !v.is_finite()) {
                return Err(PyValueError::new_err(format!("{name}[{i}] is not finite")));
            }
            Ok(values)
        };
        let motion = Self {
            time_s: column("time_s", &time_s)?,
            velocity_m_s: column("velocity_m_s", &velocity_m_s)?,
            acceleration_m_s2: column("acceleration_m_s2", &acceleration_m_s2)?,
            angle_rad: column("angle_rad", &angle_rad)?,
            load_n: column("load_n", &load_n)?,
            temperature_c: temperature_c
                .map(|values| column("temperature_c", &values))
                .transpose()?,
            weight_offset_rad: weight_offset_rad
                .map(|values| column("weight_offset_rad", &values))
                .transpose()?,
            paths: FilmPaths::default(),
        };
        if let Some(i) = motion.time_s.windows(2).position(|w| w[1] <= w[0]) {
            return Err(PyValueError::new_err(format!(
                "time_s[{}] is not increasing",
                i + 1
            )));
        }
        if let Some(i) = motion.load_n.iter().position(|&l| l <= 0.0) {
            return Err(PyValueError::new_err(format!(
                "load_n[{i}] is not positive"
            )));
        }
        Ok(motion)
    }

    fn __len__(&self) -> usize {
        self.len()
    }
}
