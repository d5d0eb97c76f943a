//! Extension module `jbf._core`.

use pyo3::prelude::*;

/// Extension module `jbf._core`.
///
/// Its classes are immutable, so that they do not need the global interpreter lock.
#[pymodule(gil_used = false)]
fn _core(m: &Bound<'_, PyModule>) -> PyResult<()> {
    jbf_py::register(m)
}
