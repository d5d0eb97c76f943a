//! Film equations with derivatives: partial derivatives with respect to the few inputs, which the
//! chain rule combines once with the derivatives that the inputs carry.
//!
//! Otherwise each of about sixty operations would carry all derivatives, instead of about a dozen.
//! With
//!
//! ```text
//! g = d^(5/2) / (eps D)      h = (4/pi) d^2 / D      q = (2/pi) d^(3/2) / eps^2
//! push = Fb x/eps - W - (4/pi) Fb y / sqrt(d)
//! radial = g push            turn = h push - q Fb y + |Ub|/2
//! ```
//!
//! (`d = 1 - eps^2`, `D = pi/2 + (pi - 8/pi) eps^2`) the slope is `radial (x, y) + turn (-y, x)`.
//! The value is identical bit for bit to that of [`plain`].

use super::film_motion::{plain, Asperities, Gap};
use crate::film::{FOUR_OVER_PI, PI_LESS_8_OVER_PI};
use crate::friction::Friction;
use crate::real::Real;
use core::f64::consts::FRAC_2_PI;
use nalgebra::Vector2;

/// Time derivative of the position in the film at `e2 = x^2 + y^2`, with combined derivatives.
#[inline(always)]
pub(super) fn motion<T: Real>(
    fb: T,
    xy: Vector2<T>,
    e2: f64,
    asperities: &Asperities<T>,
    ub: T,
) -> Vector2<T> {
    let gap = Gap::at(e2);
    let held = asperities.plain();
    let place = xy.map(T::value);
    let (x, y) = (place.x, place.y);
    let f = fb.value();
    let load = held.load(gap.e);
    let slope = plain(&gap, f, place, load, ub.value());

    let touch = held.touch(gap.e);
    let touch = if load > 0.0 || !held.part { touch } else { 0.0 };
    let stiffness = 2.0 * held.k0 * touch;
    // 1/eps^2, 1/d and 1/D from the one inverse.
    let by_e2 = gap.d * gap.determinant * gap.inverse;
    let by_d = gap.e2 * gap.determinant * gap.inverse;
    let by_det = gap.e2 * gap.d * gap.inverse;
    let by_e = gap.e * by_e2;
    let by_root = gap.root * by_d;
    let bend = PI_LESS_8_OVER_PI * by_det;
    let g = gap.d * gap.d * gap.root * by_e * by_det;
    let h = FOUR_OVER_PI * gap.d * gap.d * by_det;
    let q = FRAC_2_PI * gap.d * gap.root * by_e2;
    let push_fb = x * by_e - FOUR_OVER_PI * y * by_root;
    let push = f * push_fb - load;
    let (radial, turn) = (g * push, h * push - q * f * y + 0.5 * ub.value());
    // Derivatives with respect to eps^2, then x and y, which include the change of eps^2.
    let push_e2 =
        -0.5 * (f * x * by_e * by_e2 + stiffness * by_e + FOUR_OVER_PI * f * y * by_root * by_d);
    let radial_e2 = g * push_e2 - radial * (2.5 * by_d + 0.5 * by_e2 + bend);
    let turn_e2 = h * (push_e2 - push * (2.0 * by_d + bend)) + q * f * y * (1.5 * by_d + by_e2);
    let push_x = f * by_e;
    let push_y = -FOUR_OVER_PI * f * by_root;
    let radial_x = g * push_x + 2.0 * x * radial_e2;
    let radial_y = g * push_y + 2.0 * y * radial_e2;
    let turn_x = h * push_x + 2.0 * x * turn_e2;
    let turn_y = h * push_y - q * f + 2.0 * y * turn_e2;
    // Contribution of the asperity load to the push, computed once for both components.
    let pressed = T::joined(
        0.0,
        [
            (asperities.k0, -touch * touch),
            (asperities.eps_tr, stiffness),
        ],
    );
    let (along, across) = (g * x - h * y, g * y + h * x);
    let turn_fb = -q * y;
    Vector2::new(
        T::joined(
            slope.x,
            [
                (xy.x, radial + radial_x * x - turn_x * y),
                (xy.y, radial_y * x - turn_y * y - turn),
                (pressed, along),
                (fb, along * push_fb - turn_fb * y),
                (ub, -0.5 * y),
            ],
        ),
        T::joined(
            slope.y,
            [
                (xy.x, radial_x * y + turn_x * x + turn),
                (xy.y, radial + radial_y * y + turn_y * x),
                (pressed, across),
                (fb, across * push_fb + turn_fb * x),
                (ub, 0.5 * x),
            ],
        ),
    )
}

/// Friction coefficient, equation (3.14) of Cohn (1998), from `f_m`, `gamma (C R/L^2) 2 pi / U_tr`
/// and `1/Fb`, with combined derivatives.
#[inline(always)]
pub(super) fn sliding<T: Real>(
    [f_m, viscous_s_m, per_load]: [T; 3],
    asperities: &Asperities<T>,
    e2: T,
    velocity_m_s: T,
) -> Friction<T> {
    let gap = Gap::at(e2.value());
    let held = asperities.plain();
    let load = held.load(gap.e);
    let touch = if load > 0.0 { held.touch(gap.e) } else { 0.0 };
    let (coefficient, share) = (f_m.value(), per_load.value());
    let per_touch = coefficient * share * (2.0 * held.k0 * touch);
    let per_e2 = if touch > 0.0 { 0.5 / gap.e } else { 0.0 };
    let (inverse_root, speed) = (gap.inverse_root(), velocity_m_s.value());
    let viscous = viscous_s_m.value() * share * speed * inverse_root;
    Friction {
        jump: T::joined(
            coefficient * share * load,
            [
                (f_m, share * load),
                (per_load, coefficient * load),
                (asperities.k0, coefficient * share * (touch * touch)),
                (asperities.eps_tr, -per_touch),
                (e2, per_touch * per_e2),
            ],
        ),
        smooth: T::joined(
            viscous,
            [
                (viscous_s_m, share * speed * inverse_root),
                (per_load, viscous_s_m.value() * speed * inverse_root),
                (velocity_m_s, viscous_s_m.value() * share * inverse_root),
                (e2, viscous * (0.5 * inverse_root * inverse_root)),
            ],
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::film_motion::square;
    use super::*;
    use crate::law::journal::{Journal, Parameters};
    use crate::{Bearing, Clock, Dual};

    type D = Dual<7>;

    fn near(got: &D, exact: &D) {
        assert_eq!(got.value.to_bits(), exact.value.to_bits());
        for (i, (a, b)) in got.slope.iter().zip(&exact.slope).enumerate() {
            // For differences of large terms the tolerance is the rounding of the largest.
            let size = exact
                .slope
                .iter()
                .fold(b.abs(), |m, s| m.max(1e-6 * s.abs()));
            assert!((a - b).abs() <= 1e-9 * size, "input {i}: {a} {b}");
        }
    }

    /// Combined derivatives equal those carried through each operation, for every input.
    #[test]
    fn combined_film_derivatives_equal_those_carried_through_each_operation() {
        for (eps, phi, ub) in [
            (0.99, 0.02, 0.7),
            (0.98, 0.12, 0.0),
            (0.96, 0.22, 2.0),
            (0.5, 1.1, 0.1),
            (0.98, -2.0, 3.0),
            (1e-3, 2.0, 1.0),
        ] {
            for part in [true, false] {
                let xy = Vector2::new(libm::cos(phi), libm::sin(phi)) * eps;
                let xy = Vector2::new(D::parameter(xy.x, 0), D::parameter(xy.y, 1));
                let asperities = Asperities {
                    k0: D::parameter(7.5e5, 2),
                    eps_tr: D::parameter(0.972, 3),
                    part,
                };
                let (fb, ub) = (D::parameter(323.5, 4), D::parameter(ub, 5));
                let e2 = square(&xy);
                let gap = Gap::at(e2);
                let exact = plain(&gap, fb, xy, asperities.load(gap.e), ub);
                let got = motion(fb, xy, e2.value, &asperities, ub);
                near(&got.x, &exact.x);
                near(&got.y, &exact.y);
            }
        }
    }

    #[test]
    fn combined_friction_derivatives_equal_those_carried_through_each_operation() {
        for (eps, speed) in [(0.99, -0.03), (0.975, 0.1), (0.4, 0.1), (0.0, 0.2)] {
            let asperities = Asperities {
                k0: D::parameter(7.5e5, 0),
                eps_tr: D::parameter(0.972, 1),
                part: true,
            };
            let law = [0.26, 30.0, 1.0 / 323.5];
            let law = core::array::from_fn(|i| D::parameter(law[i], 2 + i));
            let [f_m, viscous_s_m, per_load] = law;
            let (e2, v) = (D::parameter(eps * eps, 5), D::parameter(speed, 6));
            let gap = Gap::at(e2);
            let got = sliding(law, &asperities, e2, v);
            near(&got.jump, &(f_m * per_load * asperities.load(gap.e)));
            let viscous = viscous_s_m * per_load * v * gap.inverse_root();
            // At the centre itself the root has no slope for a dual number.
            if eps > 0.0 {
                near(&got.smooth, &viscous);
            } else {
                assert_eq!(got.smooth.value, viscous.value);
            }
        }
    }

    /// The value does not depend on whether derivatives are carried.
    #[test]
    fn friction_has_the_same_bits_with_and_without_derivatives() {
        let plain = Journal::new(
            &Bearing::THESIS,
            104.0,
            &Parameters::TABLE_4_2,
            Clock::Journal,
        )
        .expect("valid");
        let p = Parameters::TABLE_4_2;
        let lifted = Parameters {
            f_m: Dual::<2>::parameter(p.f_m, 0),
            u_tr_m_s: Dual::parameter(p.u_tr_m_s, 1),
            k0: Dual::of(p.k0),
            gamma: Dual::of(p.gamma),
        };
        let dual = Journal::new(&Bearing::THESIS, 104.0, &lifted, Clock::Journal).expect("valid");
        for eps in [0.2, 0.9, 0.97, 0.98, 0.99] {
            let one = plain.sliding(&plain.nominal(), eps * eps, 0.05);
            let other = dual.sliding(&dual.nominal(), Dual::of(eps * eps), Dual::of(0.05));
            assert_eq!(one.jump.to_bits(), other.jump.value.to_bits());
            assert_eq!(one.smooth.to_bits(), other.smooth.value.to_bits());
        }
    }
}
