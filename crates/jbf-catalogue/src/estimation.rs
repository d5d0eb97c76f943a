//! Treatment of the parameters of laws and effects in a fit.

/// Quantity of the data from which a fit computes the start value of a parameter.
///
/// Machines differ in size, from a watch to a press, so most parameters of a law in newtons have no
/// common start value. The forces of other laws are proportional to the load; with these laws, the
/// start values of the catalogue apply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// Start values of the catalogue.
    #[default]
    Catalogue,
    /// Mean friction in motion.
    Kinetic,
    /// Friction at the start of motion (breakaway).
    Breakaway,
    /// Excess of friction at the start of motion over friction in motion.
    BreakawayExcess,
    /// Slope of friction over speed.
    Viscous,
    /// Low speed, over which friction falls (Stribeck speed).
    StribeckSpeed,
    /// Typical speed.
    UsualSpeed,
    /// Inverse of a typical speed.
    Slowness,
    /// Friction divided by the distance over which a contact deflects.
    Stiffness,
    /// Small fraction of a typical stroke.
    SlipDistance,
    /// Small fraction of friction divided by a typical speed.
    Damping,
    /// Small fraction of the friction in motion.
    Drag,
    /// Mass that explains the force during acceleration.
    Mass,
    /// Pitches (spatial periods) with which the force varies along the travel.
    Pitch,
    /// Pitches (spatial periods) with which the force in the direction of motion varies.
    RipplePitch,
    /// Fraction of the duration of a typical run.
    RunTime,
    /// Temperature for which the viscosity of the rig is given, otherwise the mean recorded
    /// temperature, C.
    ReferenceTemperature,
    /// Half-width of a load-cell hysteresis: a small fraction of the largest recorded force.
    CellPlay,
    /// Cubic coefficient that corresponds to a small nonlinearity at the largest recorded force.
    CellCubic,
    /// Middle of the travel of the runs.
    StrokeMiddle,
    /// Half of the travel of the runs.
    StrokeHalf,
    /// Start values of the catalogue, and smaller values down to a fraction of the sampling
    /// interval.
    Lateness,
    /// Backlash of a small fraction of a stroke, on a linear axis.
    DrivePlay,
    /// Stiffness of a drive that deflects by a small fraction of a stroke, on a linear axis.
    DriveStiffness,
    /// Mass that oscillates fast relative to a stroke, on a linear axis.
    DriveInertia,
    /// Damping that is considerable at a typical speed, on a linear axis.
    DriveDamping,
}

impl Start {
    /// Returns the name used in files and in Python.
    pub const fn name(self) -> &'static str {
        match self {
            Start::Catalogue => "catalogue",
            Start::Kinetic => "kinetic",
            Start::Breakaway => "breakaway",
            Start::BreakawayExcess => "breakaway_excess",
            Start::Viscous => "viscous",
            Start::StribeckSpeed => "stribeck_speed",
            Start::UsualSpeed => "usual_speed",
            Start::Slowness => "slowness",
            Start::Stiffness => "stiffness",
            Start::SlipDistance => "slip_distance",
            Start::Damping => "damping",
            Start::Drag => "drag",
            Start::Mass => "mass",
            Start::Pitch => "pitch",
            Start::RipplePitch => "ripple_pitch",
            Start::RunTime => "run_time",
            Start::ReferenceTemperature => "reference_temperature",
            Start::CellPlay => "cell_play",
            Start::CellCubic => "cell_cubic",
            Start::StrokeMiddle => "stroke_middle",
            Start::StrokeHalf => "stroke_half",
            Start::Lateness => "lateness",
            Start::DrivePlay => "drive_play",
            Start::DriveStiffness => "drive_stiffness",
            Start::DriveInertia => "drive_inertia",
            Start::DriveDamping => "drive_damping",
        }
    }
}

/// Upper bound of a parameter in a fit, in addition to the bounds of the catalogue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bound {
    /// No additional bound.
    #[default]
    Catalogue,
    /// Highest recorded speed, for the speed at which a film carries the whole load.
    ///
    /// Values far above the recorded speeds have no visible effect.
    TransitionSpeed,
}

impl Bound {
    /// Returns the name used in files and in Python.
    pub const fn name(self) -> &'static str {
        match self {
            Bound::Catalogue => "catalogue",
            Bound::TransitionSpeed => "transition_speed",
        }
    }
}

/// Treatment of one parameter in a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ParameterTreatment {
    /// Quantity of the data from which a fit computes the start value.
    pub start: Start,
    /// Upper bound in a fit, in addition to that of the catalogue.
    pub bound: Bound,
    /// True for a parameter that is specified instead of estimated.
    ///
    /// A fit holds such a parameter at its start value, or at a value given by the user. The
    /// parameter is a reference for others, or records do not determine it in addition to them.
    pub stated: bool,
}

/// Treatment of an effect in a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EffectTreatment {
    /// True if the initial state depends on the motion before the run, and only a reversal of the
    /// input erases its influence.
    pub unknown_start: bool,
    /// True if the initial state depends on the motion before the run, and sliding erases its
    /// influence.
    pub erased_by_sliding: bool,
    /// True if a parameter changes the instants at which friction jumps.
    ///
    /// A fit must then exclude the samples next to such a jump.
    pub moves_jumps: bool,
    /// True if the predicted force depends on a jump for longer than the step of the jump.
    ///
    /// An error in the instant of the jump then affects more samples than those next to it.
    pub spreads_jumps: bool,
    /// Name of the parameter along which the likelihood may have several maxima; a fit then
    /// searches for higher ones.
    pub multimodal_in: Option<&'static str>,
}

/// Laws and effects, the name of a parameter that they have, and its start value.
const STARTS: &[(&[&str], &str, Start)] = &[
    (
        &[
            "coulomb",
            "stribeck",
            "seven_parameter",
            "dahl",
            "lugre",
            "maxwell_slip",
            "elasto_plastic",
        ],
        "F_c",
        Start::Kinetic,
    ),
    (&["coulomb", "stribeck", "lugre"], "F_s", Start::Breakaway),
    (
        &[
            "coulomb",
            "stribeck",
            "seven_parameter",
            "dahl",
            "lugre",
            "maxwell_slip",
            "elasto_plastic",
            "rate_and_state",
        ],
        "F_v",
        Start::Viscous,
    ),
    (
        &[
            "stribeck",
            "seven_parameter",
            "lugre",
            "stribeck_excess",
            "stribeck_asymmetry",
        ],
        "v_s",
        Start::StribeckSpeed,
    ),
    (&["seven_parameter"], "k_t", Start::Stiffness),
    (&["seven_parameter"], "F_s_inf", Start::BreakawayExcess),
    (
        &["dahl", "lugre", "maxwell_slip", "elasto_plastic"],
        "sigma_0",
        Start::Stiffness,
    ),
    (&["lugre"], "sigma_1", Start::Damping),
    (&["lugre"], "v_d", Start::UsualSpeed),
    (&["rate_and_state"], "F_0", Start::Kinetic),
    (&["rate_and_state"], "a", Start::Drag),
    (&["rate_and_state"], "b", Start::Drag),
    (&["rate_and_state"], "D_c", Start::SlipDistance),
    (&["rate_and_state"], "v_0", Start::UsualSpeed),
    (&["drive_compliance"], "k", Start::DriveStiffness),
    (&["drive_compliance"], "c", Start::DriveDamping),
    (&["drive_compliance"], "J", Start::DriveInertia),
    (&["backlash"], "gap", Start::DrivePlay),
    (
        &[
            "vogel_viscosity",
            "dry_temperature_dependence",
            "viscous_temperature_dependence",
        ],
        "T_0_c",
        Start::ReferenceTemperature,
    ),
    (&["stribeck_excess"], "a", Start::BreakawayExcess),
    (&["viscous_asymmetry"], "b", Start::Damping),
    (&["viscous_thinning"], "w", Start::Slowness),
    (&["stribeck_asymmetry"], "c", Start::BreakawayExcess),
    (&["stroke_dependence"], "x_0", Start::StrokeMiddle),
    (&["stroke_dependence"], "h", Start::StrokeHalf),
    (
        &["pitch_ripple", "pitch_ripple_2"],
        "pitch",
        Start::RipplePitch,
    ),
    (&["warm_up"], "tau_s", Start::RunTime),
    (&["presliding"], "sigma", Start::Stiffness),
    (&["coulomb_drag"], "F_d", Start::Drag),
    (&["inertia"], "m_e", Start::Mass),
    (&["gravity"], "G", Start::Kinetic),
    (&["cogging", "cogging_2"], "A", Start::Drag),
    (&["cogging", "cogging_2"], "pitch", Start::Pitch),
    (&["sensor_hysteresis"], "w", Start::CellPlay),
    (&["sensor_nonlinearity"], "c", Start::CellCubic),
    (&["sensor_lag", "time_delay"], "tau_s", Start::Lateness),
];

/// Laws whose parameter `U_tr_m_s` is bounded by [`Bound::TransitionSpeed`].
const BOUNDED: &[(&[&str], &str)] = &[(&["journal", "journal_full"], "U_tr_m_s")];

/// Laws and effects, and the name of a parameter that is specified instead of estimated.
const STATED: &[(&[&str], &str)] = &[
    (&["rate_and_state"], "v_0"),
    (
        &["vogel_viscosity", "viscous_temperature_dependence"],
        "C_c",
    ),
    (
        &[
            "vogel_viscosity",
            "dry_temperature_dependence",
            "viscous_temperature_dependence",
        ],
        "T_0_c",
    ),
    (&["stroke_dependence"], "x_0"),
    (&["stroke_dependence"], "h"),
];

/// Returns the treatment of the parameter `name` of a law or an effect.
pub fn parameter(owner: &str, name: &str) -> ParameterTreatment {
    let is = |owners: &[&str], parameter: &str| parameter == name && owners.contains(&owner);
    ParameterTreatment {
        start: STARTS
            .iter()
            .find(|(owners, parameter, _)| is(owners, parameter))
            .map_or(Start::Catalogue, |&(_, _, start)| start),
        bound: if BOUNDED
            .iter()
            .any(|(owners, parameter)| is(owners, parameter))
        {
            Bound::TransitionSpeed
        } else {
            Bound::Catalogue
        },
        stated: STATED
            .iter()
            .any(|(owners, parameter)| is(owners, parameter)),
    }
}

/// Returns the treatment of an effect.
pub fn effect(name: &str) -> EffectTreatment {
    let usual = EffectTreatment::default();
    match name {
        // The drive rings, often faster than half the sampling rate. Frequencies that the samples
        // cannot distinguish each give a peak of the likelihood.
        "drive_compliance" => EffectTreatment {
            multimodal_in: Some("J"),
            ..usual
        },
        "backlash" | "time_delay" => EffectTreatment {
            moves_jumps: true,
            ..usual
        },
        "dwell_stiction" | "presliding" => EffectTreatment {
            erased_by_sliding: true,
            ..usual
        },
        "sensor_hysteresis" => EffectTreatment {
            unknown_start: true,
            ..usual
        },
        "sensor_lag" => EffectTreatment {
            spreads_jumps: true,
            ..usual
        },
        _ => usual,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jbf_core::{effect, law};

    /// Returns true if a law or an effect has a parameter with this name.
    fn exists(owner: &str, parameter: &str) -> bool {
        let laws = law::CATALOGUE
            .iter()
            .map(|info| (info.name, info.parameters));
        let effects = effect::CATALOGUE
            .iter()
            .map(|info| (info.name, info.parameters));
        laws.chain(effects)
            .any(|(name, all)| name == owner && all.iter().any(|p| p.name == parameter))
    }

    #[test]
    fn every_entry_names_a_parameter_of_the_catalogue() {
        let starts = STARTS
            .iter()
            .map(|(owners, parameter, _)| (owners, parameter));
        let others = BOUNDED
            .iter()
            .chain(STATED)
            .map(|(owners, parameter)| (owners, parameter));
        for (owners, parameter) in starts.chain(others) {
            for owner in *owners {
                assert!(exists(owner, parameter), "{owner}.{parameter}");
            }
        }
        for info in effect::CATALOGUE {
            if let Some(name) = super::effect(info.name).multimodal_in {
                assert!(exists(info.name, name), "{}.{name}", info.name);
            }
        }
    }

    #[test]
    fn laws_and_effects_have_different_names() {
        for law in law::CATALOGUE {
            assert!(effect::CATALOGUE.iter().all(|info| info.name != law.name));
        }
    }

    #[test]
    fn parameter_without_an_entry_is_estimated_from_the_start_values_of_the_catalogue() {
        assert_eq!(parameter("lugre", "no_such"), ParameterTreatment::default());
        assert_eq!(super::effect("gravity"), EffectTreatment::default());
    }
}
