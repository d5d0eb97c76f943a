//! The extension module `jbf._core`.

use pyo3::prelude::*;

/// The extension module `jbf._core`.
///
/// Its classes are immutable, so that it does not need the interpreter lock.
#[pymodule(gil_used = false)]
fn _core(m: &Bound<'_, PyModule>) -> PyResult<()> {
    jbf_py::register(m)
}
