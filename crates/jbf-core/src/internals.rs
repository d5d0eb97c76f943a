//! Items for the other crates of this workspace, which are not part of the interface of this crate.
//!
//! Any release may change or remove them. They are constants of the numerical methods, which the
//! code generators repeat; parts of a prediction and of a trajectory that a fit calls separately; and
//! films stored for the lanes of vector registers.

pub use crate::driver::side_by_side::{follow_side_by_side, step as step_side_by_side, Along};
pub use crate::effect::catalogue::OccupiedStages;
pub use crate::film::FilmIntegrals;
pub use crate::law::journal::side_by_side::SideBySide;
pub use crate::prediction::{
    film_rate_1_s, inner_step_s, inner_steps, predict_by, read_force, Steps, FASTEST_FILM_1_S,
};
pub use crate::real::sealed::Sealed;
pub use crate::transition::transition_eccentricity;

use crate::effect::drive_compliance;
use crate::law::{lugre, rate_and_state, seven_parameter};

/// Shortest step that advances a chain, s.
pub const SHORTEST_STEP_S: f64 = crate::chain::SHORTEST_STEP_S;

/// Largest number of inner steps of the effect `drive_compliance` in one step.
pub const DRIVE_COMPLIANCE_MOST_INNER_STEPS: f64 = drive_compliance::MOST_INNER_STEPS;
/// Longest inner step of the effect `drive_compliance`, in radians of its free oscillation.
pub const DRIVE_COMPLIANCE_LONGEST_INNER_STEP: f64 = drive_compliance::LONGEST_INNER_STEP;
/// Shortest step over which the effect `drive_compliance` computes an acceleration, s.
pub const DRIVE_COMPLIANCE_SHORTEST_STEP_S: f64 = drive_compliance::SHORTEST_STEP_S;

/// Longest step with which the law `lugre` is accurate, s.
pub const LUGRE_LONGEST_STEP_S: f64 = lugre::LONGEST_STEP_S;

/// Longest step with which the law `seven_parameter` is accurate, s.
pub const SEVEN_PARAMETER_LONGEST_STEP_S: f64 = seven_parameter::LONGEST_STEP_S;
/// Number of points of the delay line of the law `seven_parameter`.
pub const SEVEN_PARAMETER_DELAY_POINTS: usize = seven_parameter::DELAY_POINTS;

/// Smallest and largest age of a contact of the law `rate_and_state`, s.
pub const RATE_AND_STATE_AGES_S: [f64; 2] = rate_and_state::AGES_S;
/// Longest sliding distance in one step of the law `rate_and_state`, in slip lengths.
pub const RATE_AND_STATE_LONGEST: f64 = rate_and_state::LONGEST;
/// Argument from which the inverse hyperbolic sine of the law `rate_and_state` is a logarithm.
pub const RATE_AND_STATE_FAR_ABOVE_CREEP: f64 = rate_and_state::FAR_ABOVE_CREEP;
