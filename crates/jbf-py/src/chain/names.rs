//! Laws, clocks and effects by the names that Python uses.

use jbf_core::effect::{Info, CATALOGUE};
use jbf_core::{law, Clock};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The law of that name.
pub fn law(name: &str) -> PyResult<&'static law::Info> {
    law::CATALOGUE
        .iter()
        .find(|info| info.name == name)
        .ok_or_else(|| PyValueError::new_err(format!("law {name:?} is not in the catalogue")))
}

/// The clock of that name.
pub fn clock(name: &str) -> PyResult<Clock> {
    Clock::from_name(name).ok_or_else(|| {
        PyValueError::new_err(format!("clock {name:?} is neither journal nor thesis"))
    })
}

/// The effect of that name, if it goes with the law.
pub fn effect(name: &str, law: &law::Info) -> PyResult<&'static Info> {
    let info = CATALOGUE
        .iter()
        .find(|info| info.name == name)
        .ok_or_else(|| PyValueError::new_err(format!("effect {name:?} is not in the catalogue")))?;
    match info.lacking(law) {
        None => Ok(info),
        Some(need) => Err(PyValueError::new_err(format!(
            "effect {name} does not apply: the law {} {}",
            law.name,
            need.why_not()
        ))),
    }
}
