//! Constants of `jbf_core` for Python: the rig of Cohn (1998), the gains of the control laws, and
//! the status flags of a loop.

use super::compensators::ENTRIES;
use crate::names;
use jbf_core::controller::BaseLaw;
use jbf_core::plant::Drive;
use jbf_core::Bearing;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Counts per radian of the encoder in Cohn (1998).
const COUNTS_PER_RAD: f64 = 2387.3;
/// Number of bits of the encoder counter in Cohn (1998).
const COUNTER_BITS: u32 = 16;
/// Gain `k` of the velocity observer in Cohn (1998), 1/s.
pub(super) const OBSERVER_1_S: f64 = 15.0;

/// Sizes of the bearing of Cohn (1998), and its lubricant.
#[pyfunction]
pub fn thesis_bearing(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let (d, b) = (PyDict::new(py), Bearing::THESIS);
    d.set_item("radius_m", b.radius_m)?;
    d.set_item("length_m", b.length_m)?;
    d.set_item("clearance_m", b.clearance_m)?;
    d.set_item("mass_kg", b.mass_kg)?;
    d.set_item("count", b.count)?;
    d.set_item("viscosity_pa_s", b.viscosity_pa_s)?;
    Ok(d)
}

/// Drive, encoder and velocity observer of Cohn (1998), the number of table entries, and the status
/// flags of a loop by name.
#[pyfunction]
pub fn control_constants(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let (d, drive, thesis) = (PyDict::new(py), PyDict::new(py), Drive::THESIS);
    drive.set_item("damping_1_s", thesis.damping_1_s)?;
    drive.set_item("input_rad_s2_v", thesis.input_rad_s2_v)?;
    drive.set_item("volts_per_n", thesis.volts_per_n)?;
    drive.set_item("limit_v", thesis.limit_v)?;
    d.set_item("drive", drive)?;
    d.set_item("counts_per_rad", COUNTS_PER_RAD)?;
    d.set_item("counter_bits", COUNTER_BITS)?;
    d.set_item("observer_1_s", OBSERVER_1_S)?;
    d.set_item("table_entries", ENTRIES)?;
    let flags = PyDict::new(py);
    for (name, flag) in names::STATUS {
        flags.set_item(name, flag.bits())?;
    }
    d.set_item("flags", flags)?;
    Ok(d)
}

/// Gains of the control laws of Cohn (1998) for a drive: k1 and k2 for the position, or g and C for
/// the velocity.
#[pyfunction]
pub fn control_gains(position: bool, damping_1_s: f64, input_rad_s2_v: f64) -> (f64, f64) {
    let drive = Drive::new(damping_1_s, input_rad_s2_v);
    let law = if position {
        BaseLaw::position(&drive)
    } else {
        BaseLaw::velocity(&drive)
    };
    law.gains().into()
}
