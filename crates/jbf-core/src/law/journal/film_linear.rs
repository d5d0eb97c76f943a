//! Derivatives of the equations of motion of the film, in the co-rotating frame.
//!
//! ```text
//! slope = vr r + vt t, d slope/d eps = (vr_e, vt_e), d slope/d phi = (vr_phi - vt, vt_phi + vr)
//! J     = Q M Q^T,     M = [ d/d eps, (1/eps) d/d phi ],   Q = [ r, t ]
//! ```

use super::film_motion::{slope, square, Asperities, Film};
use super::{Journal, Loaded};
use crate::film::{FOUR_OVER_PI, PI_LESS_8_OVER_PI};
use crate::real::Real;
use crate::stepper::{Linear, StiffSystem, System, TwoByTwo};
use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use nalgebra::{Matrix2, Vector2};

/// Position of the journal centre in polar coordinates.
#[derive(Clone, Copy)]
pub(crate) struct Polar<T> {
    pub e: T,
    pub cos: T,
    pub sin: T,
    pub inverse_e: T,
}

impl<T: Real> Polar<T> {
    /// Creates a position from Cartesian coordinates, limited to the inside of the bearing in its
    /// own direction, as in [`Film`].
    #[inline]
    pub(crate) fn held(x: T, y: T) -> Self {
        let distance = (x * x + y * y).sqrt().max(T::of(1e-12));
        let inverse_e = T::ONE / distance;
        Self {
            e: distance.min(T::EPS_LIMIT),
            cos: x * inverse_e,
            sin: y * inverse_e,
            inverse_e,
        }
    }

    /// Returns the rotation `Q` of the co-rotating frame: its columns are the radial and the
    /// tangential direction.
    #[inline]
    fn rotation(&self) -> Matrix2<T> {
        Matrix2::new(self.cos, -self.sin, self.sin, self.cos)
    }

    /// Returns the matrix `Q M Q^T`, with the rotation `Q` of the co-rotating frame.
    #[inline]
    pub(crate) fn turned(&self, m: Matrix2<T>) -> Matrix2<T> {
        let q = self.rotation();
        q * m * q.transpose()
    }

    /// Returns the Cartesian vector with these radial and tangential components.
    #[inline]
    pub(crate) fn vector(&self, radial: T, tangential: T) -> Vector2<T> {
        self.rotation() * Vector2::new(radial, tangential)
    }
}

/// Returns the time derivative of the position and its Jacobian, for an asperity load and its
/// stiffness `dW/d eps`.
#[inline]
pub(super) fn linearise<T: Real>(
    load_number: T,
    at: &Polar<T>,
    [asperity_load, stiffness]: [T; 2],
    ub: T,
) -> Linear<T, 2> {
    let (e, c, s, fb) = (at.e, at.cos, at.sin, load_number);
    let d = (T::ONE - e) * (T::ONE + e);
    let root = d.sqrt();
    let inverse_d = T::ONE / d;
    let inverse_root = root * inverse_d;
    let ratio = T::of(FOUR_OVER_PI) * e * inverse_root;
    let ratio_e = T::of(FOUR_OVER_PI) * inverse_root * inverse_d;
    let determinant = T::of(FRAC_PI_2) + e * e * T::of(PI_LESS_8_OVER_PI);
    let inverse_determinant = T::ONE / determinant;
    let ease = d * d * root * inverse_determinant;
    let ease_e =
        -ease * e * (T::of(5.0) * inverse_d + T::of(2.0 * PI_LESS_8_OVER_PI) * inverse_determinant);
    let push = fb * (c - ratio * s) - asperity_load;
    let push_e = -fb * ratio_e * s - stiffness;
    let push_phi = -fb * (s + ratio * c);
    let squeeze = fb * T::of(FRAC_2_PI) * root;
    let radial = push * ease;
    let radial_e = push_e * ease + push * ease_e;
    let radial_phi = push_phi * ease;
    let tangential = T::of(0.5) * e * ub + ratio * radial - squeeze * s * d;
    let tangential_e =
        T::of(0.5) * ub + ratio_e * radial + ratio * radial_e + T::of(3.0) * squeeze * s * e;
    let tangential_phi = ratio * radial_phi - squeeze * c * d;
    Linear {
        slope: at.vector(radial, tangential),
        jacobian: at.turned(Matrix2::new(
            radial_e,
            (radial_phi - tangential) * at.inverse_e,
            tangential_e,
            (tangential_phi + radial) * at.inverse_e,
        )),
        by_input: at.vector(T::ZERO, T::of(0.5) * e),
    }
}

impl<T: Real> StiffSystem<T, 2> for Film<'_, T> {
    type Solver = TwoByTwo<T>;

    #[inline]
    fn linearise(&self, way: &Vector2<T>, ub: T) -> Linear<T, 2> {
        let to = self.from + way;
        let at = Polar::held(to.x, to.y);
        let touch = (at.e - self.loaded.eps_tr).max(T::ZERO);
        let stiffness = T::of(2.0) * self.law.k0 * touch;
        let asperities = [self.law.k0 * touch * touch, stiffness];
        linearise(self.loaded.load_number, &at, asperities, ub)
    }
}

/// Film equations with or without asperity contact at any eccentricity ratio.
///
/// These equations are smooth at eps_tr, where `W` of the law has a kink, so that a step with error
/// control may extend beyond eps_tr. The values outside the bearing are not finite.
#[derive(Clone, Copy, Debug)]
pub struct SmoothFilm<T> {
    load_number: T,
    eps_tr: T,
    /// Asperity stiffness constant `K0`, or zero for a film without contact.
    k0: T,
}

impl<T: Real> SmoothFilm<T> {
    pub(crate) fn new(law: &Journal<T>, loaded: &Loaded<T>, touching: bool) -> Self {
        Self {
            load_number: loaded.load_number,
            eps_tr: loaded.eps_tr,
            k0: if touching { law.k0 } else { T::ZERO },
        }
    }
}

impl SmoothFilm<f64> {
    /// Placeholder film without asperity load, whose values stay finite.
    pub(crate) const NONE: Self = Self {
        load_number: 1.0,
        eps_tr: 0.5,
        k0: 0.0,
    };
}

impl<T: Copy> SmoothFilm<T> {
    /// Returns the dimensionless load, eps_tr, and `K0` or zero.
    #[inline(always)]
    pub(crate) fn parts(&self) -> [T; 3] {
        [self.load_number, self.eps_tr, self.k0]
    }

    /// Creates the film from the values of [`Self::parts`].
    #[inline(always)]
    pub(crate) fn of_parts([load_number, eps_tr, k0]: [T; 3]) -> Self {
        Self {
            load_number,
            eps_tr,
            k0,
        }
    }
}

impl<T: Real> System<T, 2> for SmoothFilm<T> {
    #[inline]
    fn slope(&self, xy: &Vector2<T>, ub: T) -> Vector2<T> {
        let asperities = Asperities {
            k0: self.k0,
            eps_tr: self.eps_tr,
            part: false,
        };
        slope(self.load_number, *xy, square(xy), &asperities, ub)
    }
}

impl<T: Real> StiffSystem<T, 2> for SmoothFilm<T> {
    type Solver = TwoByTwo<T>;

    #[inline]
    fn linearise(&self, xy: &Vector2<T>, ub: T) -> Linear<T, 2> {
        let e = square(xy).sqrt();
        let inverse_e = T::ONE / e;
        let at = Polar {
            e,
            cos: xy.x * inverse_e,
            sin: xy.y * inverse_e,
            inverse_e,
        };
        let touch = at.e - self.eps_tr;
        let stiffness = T::of(2.0) * self.k0 * touch;
        linearise(
            self.load_number,
            &at,
            [self.k0 * touch * touch, stiffness],
            ub,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::journal::Parameters;
    use crate::law::journal_full::motion::FullFilm;
    use crate::law::journal_full::JournalFull;
    use crate::{Bearing, Clock, Dual};
    use nalgebra::{SVector, Vector4};

    type D = Dual<5>;

    fn full() -> JournalFull<D> {
        let p = Parameters::TABLE_4_2;
        let parameters = Parameters {
            f_m: D::of(p.f_m),
            u_tr_m_s: D::of(p.u_tr_m_s),
            k0: D::of(p.k0),
            gamma: D::of(p.gamma),
        };
        JournalFull::new(&Bearing::THESIS, 104.0, &parameters, Clock::Journal).expect("valid")
    }

    /// Checks analytical derivatives against those of dual numbers.
    fn agree<const N: usize>(system: &impl StiffSystem<D, N>, state: SVector<f64, N>, ub: f64) {
        let lifted = SVector::from_fn(|i, _| D::parameter(state[i], i));
        let exact = system.slope(&lifted, D::parameter(ub, 4));
        let got = system.linearise(&state.map(D::of), D::of(ub));
        for (i, row) in exact.iter().enumerate() {
            let size = row.slope.iter().fold(1e-9, |m: f64, s| m.max(s.abs()));
            let near = |a: f64, b: f64| {
                assert!((a - b).abs() < 1e-9 * size, "row {i}: {a} {b} of {size}");
            };
            near(got.slope[i].value, row.value);
            for (j, by_state) in row.slope[..N].iter().enumerate() {
                near(got.jacobian[(i, j)].value, *by_state);
            }
            near(got.by_input[i].value, row.slope[4]);
        }
    }

    #[test]
    fn film_jacobians_match_dual_numbers() {
        let law = full();
        let film = law.reduced();
        let loaded = film.nominal();
        let places = [
            (0.99, 0.02),
            (0.98, 0.12),
            (0.96, 0.22),
            (0.5, 1.1),
            (0.98, -2.0),
        ];
        for (eps, phi) in places {
            let (x, y) = (eps * libm::cos(phi), eps * libm::sin(phi));
            let (law_film, from) = (film, Vector2::zeros());
            let held = Film {
                law: law_film,
                loaded: &loaded,
                from,
                from_e2: D::ZERO,
            };
            let xy = Vector2::new(x, y);
            agree(&held, xy, 0.7);
            let state = Vector4::new(x, y, 0.03, -0.2);
            agree(&FullFilm::held(&law, &loaded, from), state, 0.7);
            for touching in [false, true] {
                agree(&SmoothFilm::new(film, &loaded, touching), xy, 0.7);
                agree(&FullFilm::smooth(&law, &loaded, touching), state, 0.7);
            }
            let touching = eps > loaded.eps_tr.value;
            let smooth = SmoothFilm::new(film, &loaded, touching);
            let at = xy.map(D::of);
            let (a, b) = (smooth.slope(&at, D::of(0.7)), held.slope(&at, D::of(0.7)));
            assert!((a[0] - b[0]).value.abs() + (a[1] - b[1]).value.abs() < 1e-11);
        }
    }
}
