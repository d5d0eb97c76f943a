//! Steady state of the film, equations (3.5) and (3.6) of Cohn (1998): the Stribeck curve.

use crate::film::FilmIntegrals;

/// Steady state of the film at one speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady {
    /// Eccentricity ratio.
    pub eps: f64,
    /// Attitude angle, rad.
    pub phi_rad: f64,
    /// Friction coefficient, with the sign of the speed.
    pub coefficient: f64,
}

/// Solves for the eccentricity ratio and the attitude angle (rad) that balance the load number `fb`
/// at `ub = |U|/U_tr`: `(W - J12 eps Ub/2)^2 + (J11 eps Ub/2)^2 = Fb^2`.
///
/// The left side grows with eps from 0 to infinity, so bisection always converges. The unknown is
/// `log(1 - eps)`, which is accurate both for light loads and near contact.
pub(crate) fn solve(fb: f64, ub: f64, asperity_load: impl Fn(f64) -> f64) -> (f64, f64) {
    let parts = |eps: f64| {
        let j = FilmIntegrals::at(eps);
        let radial = asperity_load(eps) - j.j12 * eps * ub / 2.0;
        (radial, j.j11 * eps * ub / 2.0)
    };
    let (mut low, mut high) = (-34.0_f64, 0.0_f64);
    for _ in 0..100 {
        let mid = 0.5 * (low + high);
        let (radial, tangential) = parts(1.0 - libm::exp(mid));
        if radial * radial + tangential * tangential > fb * fb {
            low = mid;
        } else {
            high = mid;
        }
    }
    let eps = 1.0 - libm::exp(0.5 * (low + high));
    let (radial, tangential) = parts(eps);
    (eps, libm::atan2(tangential, radial))
}
