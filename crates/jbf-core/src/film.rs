//! Film integrals of the short bearing, equations (3.11) to (3.13) of Cohn (1998).
//!
//! The scanned text prints J11 with the cube of `1 - eps^2`. The quadrature, Appendix C and the
//! square in (3.20) all imply the exponent 3/2.

use crate::real::Real;
use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

/// Constant `4 / pi`.
pub(crate) const FOUR_OVER_PI: f64 = 2.0 * FRAC_2_PI;
/// Constant `pi - 8 / pi`, from the determinant of the film integrals.
pub(crate) const PI_LESS_8_OVER_PI: f64 = PI - 4.0 * FRAC_2_PI;

/// The three film integrals at one eccentricity ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmIntegrals<T> {
    /// `J11 = (pi/2) d^(-3/2)`, with `d = 1 - eps^2`.
    pub j11: T,
    /// `J12 = -2 eps d^(-2)`.
    pub j12: T,
    /// `J22 = (pi/2) (1 + 2 eps^2) d^(-5/2)`.
    pub j22: T,
}

impl<T: Real> FilmIntegrals<T> {
    /// Evaluates the film integrals at `0 <= eps < 1`.
    pub fn at(eps: T) -> Self {
        // (1 - eps)(1 + eps) keeps the digits that 1 - eps^2 loses close to contact.
        let d = (T::ONE - eps) * (T::ONE + eps);
        let root = d.sqrt();
        let d32 = d * root;
        Self {
            j11: T::of(FRAC_PI_2) / d32,
            j12: T::of(-2.0) * eps / (d * d),
            j22: T::of(FRAC_PI_2) * (T::ONE + T::of(2.0) * eps * eps) / (d32 * d),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Film integrals equal the quadrature of their definitions.
    #[test]
    fn film_integrals_match_quadrature() {
        let reference = [
            (
                0.001,
                1.5707986829923322,
                -0.002000004000006,
                1.5708033953930933,
            ),
            (
                0.1,
                1.5946562712112506,
                -0.2040608101214162,
                1.6429791885206826,
            ),
            (
                0.5,
                2.4183991523122903,
                -1.7777777777777777,
                4.836798304624581,
            ),
            (
                0.9,
                18.96659958278074,
                -49.86149584487537,
                261.53942582571347,
            ),
            (
                0.9724,
                123.66982981440314,
                -656.2461884430445,
                6567.897009359941,
            ),
            (
                0.999,
                17575.21659223208,
                -499999.8748749053,
                26340862.46161103,
            ),
        ];
        for (eps, j11, j12, j22) in reference {
            let j = FilmIntegrals::at(eps);
            assert!((j.j11 / j11 - 1.0).abs() < 1e-12, "J11({eps})");
            assert!((j.j12 / j12 - 1.0).abs() < 1e-12, "J12({eps})");
            assert!((j.j22 / j22 - 1.0).abs() < 1e-12, "J22({eps})");
        }
    }

    #[test]
    fn determinant_of_the_film_integrals_has_its_closed_form() {
        for eps in [0.05, 0.4, 0.9, 0.99] {
            let j = FilmIntegrals::at(eps);
            let d: f64 = (1.0 - eps) * (1.0 + eps);
            let closed = (FRAC_PI_2 + eps * eps * PI_LESS_8_OVER_PI) / (d * d * d.sqrt());
            let direct = j.j22 - j.j12 * j.j12 / j.j11;
            assert!((closed / direct - 1.0).abs() < 1e-11, "{eps}");
        }
    }
}
