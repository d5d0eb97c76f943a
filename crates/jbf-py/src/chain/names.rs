//! Look-up of laws and effects by their Python names.

use crate::names::why_not;
use jbf_core::effect::{Info, CATALOGUE};
use jbf_core::law;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Returns the description of the law with this name, or a `ValueError`.
pub fn law(name: &str) -> PyResult<&'static law::Info> {
    law::CATALOGUE
        .iter()
        .find(|info| info.name == name)
        .ok_or_else(|| PyValueError::new_err(format!("law {name:?} is not in the catalogue")))
}

/// Returns the description of the effect with this name, or a `ValueError` if it does not apply to
/// the law.
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
            why_not(need)
        ))),
    }
}
