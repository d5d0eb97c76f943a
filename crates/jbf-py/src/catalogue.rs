//! Catalogues of laws and effects, as lists of dictionaries.

use crate::names;
use jbf_core::effect::{Parameter, CATALOGUE};
use jbf_core::law;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

fn parameters<'py>(
    py: Python<'py>,
    owner: &str,
    list: &[Parameter],
) -> PyResult<Bound<'py, PyList>> {
    let out = PyList::empty(py);
    for p in list {
        let (d, fit) = (PyDict::new(py), jbf_catalogue::parameter(owner, p.name));
        d.set_item("name", p.name)?;
        d.set_item("unit", p.unit)?;
        d.set_item("meaning", p.meaning)?;
        d.set_item("lower", p.lower)?;
        d.set_item("upper", p.upper)?;
        d.set_item("null", p.null)?;
        d.set_item("starts", p.starts.to_vec())?;
        d.set_item("log", p.log)?;
        d.set_item("period", p.period)?;
        d.set_item("start", fit.start.name())?;
        d.set_item("bound", fit.bound.name())?;
        d.set_item("stated", fit.stated)?;
        out.append(d)?;
    }
    Ok(out)
}

/// Descriptions of all effects, in the order of the signal chain.
#[pyfunction]
pub fn effects(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let out = PyList::empty(py);
    for info in CATALOGUE {
        let (d, fit) = (PyDict::new(py), jbf_catalogue::effect(info.name));
        d.set_item("name", info.name)?;
        d.set_item("stage", info.stage.to_string())?;
        d.set_item("summary", info.summary)?;
        d.set_item("equation", info.equation)?;
        d.set_item("source", info.source)?;
        d.set_item("limits", info.limits)?;
        let needs: Vec<&str> = info.needs.iter().map(|&n| names::need(n)).collect();
        d.set_item("needs", needs)?;
        let refused = PyDict::new(py);
        for law in law::CATALOGUE {
            if let Some(need) = info.lacking(law) {
                refused.set_item(law.name, names::why_not(need))?;
            }
        }
        d.set_item("refused", refused)?;
        d.set_item("moves_jumps", fit.moves_jumps)?;
        d.set_item("spreads_jumps", fit.spreads_jumps)?;
        d.set_item("peaks", fit.multimodal_in)?;
        d.set_item("longest_step_s", info.longest_step_s)?;
        d.set_item("further_of", info.further_of)?;
        d.set_item("unknown_start", fit.unknown_start)?;
        d.set_item("erased_by_sliding", fit.erased_by_sliding)?;
        d.set_item("rust_type", info.rust_type)?;
        d.set_item("parameters", parameters(py, info.name, info.parameters)?)?;
        out.append(d)?;
    }
    Ok(out)
}

/// Descriptions of all laws with their parameters.
#[pyfunction]
pub fn laws(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let out = PyList::empty(py);
    for info in law::CATALOGUE {
        let d = PyDict::new(py);
        d.set_item("name", info.name)?;
        d.set_item("summary", info.summary)?;
        d.set_item("equation", info.equation)?;
        d.set_item("source", info.source)?;
        d.set_item("limits", info.limits)?;
        d.set_item("needs_bearing", info.needs_bearing)?;
        d.set_item("has_film", info.has_film)?;
        d.set_item("has_bristle", info.has_bristle)?;
        d.set_item("has_memory", info.has_memory)?;
        d.set_item("rust_type", info.rust_type)?;
        d.set_item("parameters", parameters(py, info.name, info.parameters)?)?;
        out.append(d)?;
    }
    Ok(out)
}
