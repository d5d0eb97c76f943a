//! Look-up of laws, clocks and effects by their Python names.

use jbf_core::effect::{Info, CATALOGUE};
use jbf_core::{law, Clock};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Returns the law with this name.
pub fn law(name: &str) -> PyResult<&'static law::Info> {
    law::CATALOGUE
        .iter()
        .find(|info| info.name == name)
        .ok_or_else(|| PyValueError::new_err(format!("law {name:?} is not in the catalogue")))
}

/// Returns the clock with this name.
pub fn clock(name: &str) -> PyResult<Clock> {
    Clock::from_name(name).ok_or_else(|| {
        PyValueError::new_err(format!("clock {name:?} is not known: journal or thesis"))
    })
}

/// Returns the effect with this name, if it applies to the law.
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
