//! Trajectories of a film with a given accuracy, for analysis.
//!
//! The step size follows from the error of the friction coefficient. Steps end at each reversal and
//! at each beginning or end of asperity contact, where the model has kinks. Samples are evaluated
//! with a polynomial along each step, so their number has no influence on the steps. A control loop
//! uses [`Law::advance`](crate::law::Law::advance) instead.
//!
//! ```
//! use jbf_core::driver::{trajectory, Sine};
//! use jbf_core::law::journal::{Journal, Parameters};
//! use jbf_core::{Bearing, Clock};
//! let law = Journal::new(&Bearing::THESIS, 104.0, &Parameters::TABLE_4_2, Clock::Journal)?;
//! let motion = Sine::new(0.127, 1.0)?; // U = 0.127 sin(t)
//! let times_s = [0.125663706143592, 1.5707963267949, 6.47168086639497];
//! let mut f = [0.0; 3];
//! trajectory(&law, &motion, &times_s, 1e-9, &mut f)?;
//! assert!((f[0] - 0.04785707000713).abs() < 1e-9);
//! assert!((f[2] - 0.09170630580666).abs() < 1e-9);
//! # Ok::<(), jbf_core::Error>(())
//! ```

mod excitation;
mod film;
mod follow;
mod goal;
mod kinks;
mod sampled;
pub(crate) mod side_by_side;
mod stretch;
mod trial;

pub use excitation::{Excitation, Function, Sine};
pub use film::Film;
pub use follow::follow;
pub use sampled::Sampled;

use crate::error::{check, positive, Error};
use crate::law::journal::START_PHI_RAD;
use crate::real::Real;
use nalgebra::Vector2;

/// Time and state of the film at the start of a trajectory.
///
/// The default is time zero with the state of [`Law::start`](crate::law::Law::start): asperities
/// just in contact, attitude angle 0.15 rad, no velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<T> {
    /// Start time, s.
    pub time_s: f64,
    /// Eccentricity ratio; `None` for eps_tr, at which asperity contact begins.
    pub eps: Option<T>,
    /// Attitude angle, rad.
    pub phi_rad: T,
}

impl<T: Real> Default for Start<T> {
    fn default() -> Self {
        Self {
            time_s: 0.0,
            eps: None,
            phi_rad: T::of(START_PHI_RAD),
        }
    }
}

/// State of the film at one sample.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Sample<T> {
    /// Position `eps cos(phi)` and `eps sin(phi)`.
    pub xy: Vector2<T>,
    /// Eccentricity ratio.
    pub eps: T,
    /// Friction coefficient with the sign of the speed. At rest, it does not include the asperity
    /// part, which is set-valued there.
    pub coefficient: T,
}

/// Computational cost of a trajectory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Cost {
    /// Number of accepted steps.
    pub steps: u32,
    /// Number of steps discarded because the error was too large or a kink was inside.
    pub rejected: u32,
    /// Number of evaluations of the equations of motion.
    pub slopes: u32,
    /// Number of evaluations of the equations with their derivatives.
    pub linearisations: u32,
    /// Number of steps at the resolution of time, which are accepted regardless of their error.
    pub forced: u32,
}

/// Computes the friction coefficients at `times_s` (s, ascending, from zero), with an error of
/// about `tolerance`.
///
/// `out` receives as many values as it has elements.
///
/// # Errors
/// Reports the name of the argument that violates its rule: `tolerance` must be positive and
/// finite, `times_s` ascending and finite. A tolerance above 0.1 is treated as 0.1, and rounding
/// limits the accuracy for very small ones.
pub fn trajectory<T: Real, F: Film<T, N>, E: Excitation, const N: usize>(
    film: &F,
    excitation: &E,
    times_s: &[f64],
    tolerance: f64,
    out: &mut [T],
) -> Result<Cost, Error> {
    follow(
        film,
        excitation,
        &Start::default(),
        times_s,
        tolerance,
        |i, sample: &Sample<T>| {
            if let Some(place) = out.get_mut(i) {
                *place = sample.coefficient;
            }
        },
    )
}

fn checked<T: Real>(start: &Start<T>, times_s: &[f64], tolerance: f64) -> Result<(), Error> {
    positive("tolerance", tolerance)?;
    check(
        start.time_s.is_finite(),
        "time_s",
        start.time_s,
        "of the start must be finite",
    )?;
    let eps = start.eps.map_or(0.5, Real::value);
    check(
        eps > 0.0 && eps < 1.0,
        "eps",
        eps,
        "of the start must lie between 0 and 1",
    )?;
    let phi_rad = start.phi_rad.value();
    check(
        phi_rad.is_finite(),
        "phi_rad",
        phi_rad,
        "of the start must be finite",
    )?;
    let mut before = start.time_s;
    for &t in times_s {
        check(
            t >= before && t.is_finite(),
            "times_s",
            t,
            "must be finite, increasing, and not before the start",
        )?;
        before = t;
    }
    Ok(())
}
