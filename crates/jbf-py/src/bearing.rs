//! Bearing passed from Python as a dictionary of its sizes.

use jbf_core::{Bearing, Error};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Sizes of a [`Bearing`], from a dictionary with these keys.
#[derive(Clone, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Sizes {
    radius_m: f64,
    length_m: f64,
    clearance_m: f64,
    mass_kg: f64,
    count: u32,
    viscosity_pa_s: f64,
}

impl Sizes {
    /// Returns the bearing with these sizes, or a `ValueError` if a size is invalid.
    pub fn checked(self) -> PyResult<Bearing> {
        Bearing::new()
            .with_radius_m(self.radius_m)
            .with_length_m(self.length_m)
            .with_clearance_m(self.clearance_m)
            .with_mass_kg(self.mass_kg)
            .with_count(self.count)
            .with_viscosity_pa_s(self.viscosity_pa_s)
            .checked()
            .map_err(refused)
    }
}

/// Converts an error of `jbf_core` to a `ValueError`.
pub fn refused(error: Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}
