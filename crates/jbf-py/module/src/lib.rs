//! The extension module `jbf._core`.

use pyo3::prelude::*;

/// The extension module `jbf._core`. Its classes do not change once they are made: it asks for no
/// interpreter lock.
#[pymodule(gil_used = false)]
fn _core(m: &Bound<'_, PyModule>) -> PyResult<()> {
    jbf_py::register(m)
}
