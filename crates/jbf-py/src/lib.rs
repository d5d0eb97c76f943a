//! Python bindings of `jbf-core`, one file per Python type.
//!
//! Input and output are arrays, and the global interpreter lock is released during a computation.
//! The bindings contain no physics.

mod batch;
mod bearing;
mod catalogue;
mod chain;
mod control;
mod curves;
mod film_paths;
mod filter;
mod instrument;
mod motion;
mod motion_errors;
mod names;
mod pool;
mod recorded_motion;
mod share;
mod trajectory;

use jbf_core::internals;
use jbf_core::law::lugre::LuGre;
use jbf_core::law::seven_parameter::SevenParameter;
use jbf_core::law::Law;
use pyo3::prelude::*;

/// Adds every class and function to the extension module `jbf._core`.
///
/// # Errors
/// Errors of the Python interpreter.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    m.add("FASTEST_FILM_1_S", internals::FASTEST_FILM_1_S)?;
    m.add(
        "DRIVE_COMPLIANCE_MOST_INNER_STEPS",
        internals::DRIVE_COMPLIANCE_MOST_INNER_STEPS,
    )?;
    m.add(
        "DRIVE_COMPLIANCE_LONGEST_INNER_STEP",
        internals::DRIVE_COMPLIANCE_LONGEST_INNER_STEP,
    )?;
    m.add(
        "DRIVE_COMPLIANCE_SHORTEST_STEP_S",
        internals::DRIVE_COMPLIANCE_SHORTEST_STEP_S,
    )?;
    m.add("LUGRE_LONGEST_STEP_S", internals::LUGRE_LONGEST_STEP_S)?;
    m.add("LUGRE_STEPS_PER_SAMPLE", LuGre::<f64>::ENOUGH_STEPS)?;
    m.add(
        "SEVEN_PARAMETER_LONGEST_STEP_S",
        internals::SEVEN_PARAMETER_LONGEST_STEP_S,
    )?;
    m.add(
        "SEVEN_PARAMETER_STEPS_PER_SAMPLE",
        SevenParameter::<f64>::ENOUGH_STEPS,
    )?;
    m.add(
        "SEVEN_PARAMETER_DELAY_POINTS",
        internals::SEVEN_PARAMETER_DELAY_POINTS,
    )?;
    m.add("RATE_AND_STATE_AGES_S", internals::RATE_AND_STATE_AGES_S)?;
    m.add("RATE_AND_STATE_LONGEST", internals::RATE_AND_STATE_LONGEST)?;
    m.add(
        "RATE_AND_STATE_FAR_ABOVE_CREEP",
        internals::RATE_AND_STATE_FAR_ABOVE_CREEP,
    )?;
    m.add_class::<motion::Motion>()?;
    m.add_class::<chain::Chain>()?;
    m.add_class::<batch::BatchRig>()?;
    m.add_class::<recorded_motion::MotionReadings>()?;
    m.add_class::<recorded_motion::SmoothedMotion>()?;
    m.add_class::<motion_errors::MotionErrorChain>()?;
    m.add_class::<motion_errors::MotionWhitening>()?;
    m.add_function(wrap_pyfunction!(catalogue::effects, m)?)?;
    m.add_function(wrap_pyfunction!(catalogue::laws, m)?)?;
    m.add_function(wrap_pyfunction!(curves::film_integrals, m)?)?;
    m.add_function(wrap_pyfunction!(curves::transition_eccentricity, m)?)?;
    m.add_function(wrap_pyfunction!(curves::steady_friction, m)?)?;
    m.add_function(wrap_pyfunction!(curves::maxwell_slip_elements, m)?)?;
    m.add_function(wrap_pyfunction!(filter::first_order_filter, m)?)?;
    m.add_function(wrap_pyfunction!(instrument::read_force, m)?)?;
    m.add_function(wrap_pyfunction!(trajectory::trajectories, m)?)?;
    m.add_function(wrap_pyfunction!(control::constants::thesis_bearing, m)?)?;
    m.add_function(wrap_pyfunction!(control::constants::control_constants, m)?)?;
    m.add_function(wrap_pyfunction!(control::constants::control_gains, m)?)?;
    m.add_function(wrap_pyfunction!(control::control_reference, m)?)?;
    m.add_function(wrap_pyfunction!(control::control_run, m)?)?;
    Ok(())
}
