//! Names of time scales, waveforms, requirements and status flags in Python.

use jbf_core::controller::Status;
use jbf_core::effect::Need;
use jbf_core::reference::Wave;
use jbf_core::Clock;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Status flags of a control loop by name.
pub const STATUS: [(&str, Status); 5] = [
    ("saturated", Status::SATURATED),
    ("frozen", Status::FROZEN),
    ("jumped", Status::JUMPED),
    ("not_finite", Status::NOT_FINITE),
    ("fallback", Status::FALLBACK),
];

/// Returns the time scale of the film with this name, or a `ValueError`.
pub fn clock(name: &str) -> PyResult<Clock> {
    match name {
        "journal" => Ok(Clock::Journal),
        "thesis" => Ok(Clock::Thesis),
        _ => Err(PyValueError::new_err(format!(
            "clock {name:?} is not known: journal or thesis"
        ))),
    }
}

/// Returns the waveform of a reference with this name, or a `ValueError`.
pub fn wave(name: &str) -> PyResult<Wave> {
    match name {
        "sine" => Ok(Wave::Sine),
        "triangle" => Ok(Wave::Triangle),
        "square" => Ok(Wave::Square),
        _ => Err(PyValueError::new_err(format!(
            "wave {name:?} is not known: sine, triangle or square"
        ))),
    }
}

/// Returns the name of a requirement of an effect.
pub fn need(need: Need) -> &'static str {
    match need {
        Need::Film => "film",
        Need::NoFilm => "no_film",
        Need::NoBristle => "no_bristle",
        Need::NoDryLevel => "no_dry_level",
        Need::Transmitted => "transmitted",
        Need::Angle => "angle",
        Need::Path => "path",
        Need::Position => "position",
        Need::Loads => "loads",
        Need::Temperatures => "temperatures",
    }
}

/// Returns the reason why a law that does not meet the requirement excludes the effect, as the
/// continuation of "the law ...".
///
/// Requirements on other effects and on the record do not concern the law.
pub fn why_not(need: Need) -> &'static str {
    match need {
        Need::Film => "has no lubricant film",
        Need::NoFilm => "is a bearing law: its friction depends on the load and the film",
        Need::NoBristle => "contains presliding already",
        Need::NoDryLevel => "contains a load-independent dry friction already",
        Need::Transmitted
        | Need::Angle
        | Need::Path
        | Need::Position
        | Need::Loads
        | Need::Temperatures => "meets the requirement",
    }
}
