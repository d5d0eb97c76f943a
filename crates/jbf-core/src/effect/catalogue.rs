//! Catalogue of effects in the order in which the signal chain evaluates them.

use super::compose::{forward_stages, stages};
use super::registry::{signal_chain, StageEffects};
use super::{
    backlash, cogging, cogging_2, coulomb_drag, direction_asymmetry, drive_compliance,
    dry_asymmetry, dry_load_dependence, dry_temperature_dependence, dwell_stiction, film_memory,
    gravity, inertia, load_dependence, pitch_ripple, pitch_ripple_2, position_ripple, presliding,
    quadratic_drag, running_in, sensor_drift, sensor_hysteresis, sensor_lag, sensor_nonlinearity,
    sensor_offset, shear_thinning, spring, stribeck_asymmetry, stribeck_excess, stroke_dependence,
    thermal_thinning, time_delay, torque_proportional, viscous_asymmetry, viscous_load_dependence,
    viscous_temperature_dependence, viscous_thinning, vogel_viscosity, warm_up,
    zero_load_dependence,
};
use super::{Effect, Info, Named, Resistance, Rig, Signal, Stage};
use crate::error::Error;
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

// Inside a stage, effects act from left to right.
signal_chain! {
    drive: Drive [drive_compliance::DriveCompliance, backlash::Backlash],
    lubricant: Lubricant [
        shear_thinning::ShearThinning,
        thermal_thinning::ThermalThinning,
        vogel_viscosity::VogelViscosity,
    ],
    load: Film [load_dependence::LoadDependence],
    film: Film [film_memory::FilmMemory],
    contact: Contact [
        running_in::RunningIn,
        dwell_stiction::DwellStiction,
        stribeck_excess::StribeckExcess,
        dry_load_dependence::DryLoadDependence,
        viscous_load_dependence::ViscousLoadDependence,
        viscous_asymmetry::ViscousAsymmetry,
        dry_temperature_dependence::DryTemperatureDependence,
        viscous_temperature_dependence::ViscousTemperatureDependence,
        viscous_thinning::ViscousThinning,
        dry_asymmetry::DryAsymmetry,
        stribeck_asymmetry::StribeckAsymmetry,
        direction_asymmetry::DirectionAsymmetry,
        position_ripple::PositionRipple,
        stroke_dependence::StrokeDependence,
        pitch_ripple::PitchRipple,
        pitch_ripple_2::SecondPitchRipple,
        warm_up::WarmUp,
    ],
    transmission: Contact [torque_proportional::TorqueProportional],
    bristle: Contact [presliding::Presliding],
    other: Other [
        coulomb_drag::CoulombDrag,
        quadratic_drag::QuadraticDrag,
        inertia::Inertia,
        zero_load_dependence::ZeroLoadDependence,
        gravity::Gravity,
        spring::Spring,
        cogging::Cogging,
        cogging_2::SecondCogging,
    ],
    instrument: Instrument [
        sensor_hysteresis::SensorHysteresis,
        sensor_nonlinearity::SensorNonlinearity,
        sensor_lag::SensorLag,
        time_delay::TimeDelay,
        sensor_offset::SensorOffset,
        sensor_drift::SensorDrift,
    ],
}
