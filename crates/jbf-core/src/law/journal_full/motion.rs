//! Equations of motion of the journal in its film, with inertia and with their derivatives.
//!
//! The system has four states, `(x, y)` and its time derivative, and the input `|Ub|`.

use super::JournalFull;
use crate::film::FilmIntegrals;
use crate::law::journal::film_linear::Polar;
use crate::law::journal::Loaded;
use crate::real::Real;
use crate::stepper::{Linear, SecondOrder, StiffSystem, System};
use core::f64::consts::FRAC_PI_2;
use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

/// Equations of motion of the journal in its film, with inertia.
#[derive(Clone, Copy, Debug)]
pub struct FullFilm<T> {
    inverse_mass: T,
    load_number: T,
    eps_tr: T,
    k0: T,
    /// Values of `x` and `y` at the start of the step.
    ///
    /// The state is the displacement from this position, because single precision resolves it much
    /// better than the position.
    from: Vector2<T>,
    /// True if every stage is limited to the inside of the bearing, and asperity contact ends below
    /// eps_tr.
    held: bool,
}

impl<T: Real> FullFilm<T> {
    /// Creates the equations of the law for a control loop: every stage of a step is finite.
    pub(crate) fn held(law: &JournalFull<T>, loaded: &Loaded<T>, from: Vector2<T>) -> Self {
        Self {
            inverse_mass: law.inverse_mass_number,
            load_number: loaded.load_number,
            eps_tr: loaded.eps_tr,
            k0: law.film.k0,
            from,
            held: true,
        }
    }

    /// Creates equations with or without asperity contact at any eccentricity ratio.
    ///
    /// These equations are smooth at eps_tr, where `W` of the law has a kink. The values outside
    /// the bearing are not finite.
    pub(crate) fn smooth(law: &JournalFull<T>, loaded: &Loaded<T>, touching: bool) -> Self {
        Self {
            k0: if touching { law.film.k0 } else { T::ZERO },
            held: false,
            ..Self::held(law, loaded, Vector2::zeros())
        }
    }

    #[inline]
    fn polar(&self, state: &Vector4<T>) -> Polar<T> {
        let (x, y) = (self.from.x + state.x, self.from.y + state.y);
        if self.held {
            return Polar::held(x, y);
        }
        let e = (x * x + y * y).sqrt();
        let inverse_e = T::ONE / e;
        Polar {
            e,
            cos: x * inverse_e,
            sin: y * inverse_e,
            inverse_e,
        }
    }

    #[inline]
    fn touch(&self, e: T) -> T {
        let touch = e - self.eps_tr;
        if self.held {
            touch.max(T::ZERO)
        } else {
            touch
        }
    }
}

impl<T: Real> System<T, 4> for FullFilm<T> {
    #[inline]
    fn slope(&self, state: &Vector4<T>, ub: T) -> Vector4<T> {
        let at = self.polar(state);
        let (vx, vy) = (state.z, state.w);
        let (e, fb) = (at.e, self.load_number);
        let d = (T::ONE - e) * (T::ONE + e);
        let inverse_d = T::ONE / d;
        // Integrals of (3.11) to (3.13) from one root and one division.
        let j11 = T::of(FRAC_PI_2) * d.sqrt() * inverse_d * inverse_d;
        let j12 = T::of(-2.0) * e * inverse_d * inverse_d;
        let j22 = j11 * inverse_d * (T::ONE + T::of(2.0) * e * e);
        let radial = vx * at.cos + vy * at.sin;
        // Tangential velocity relative to oil that rotates at half the journal's speed.
        let slip = vy * at.cos - vx * at.sin - T::of(0.5) * e * ub;
        let touch = self.touch(e);
        let outward = fb * at.cos - self.k0 * touch * touch - j22 * radial - j12 * slip;
        let forward = -fb * at.sin - j12 * radial - j11 * slip;
        let a = at.vector(outward * self.inverse_mass, forward * self.inverse_mass);
        Vector4::new(vx, vy, a.x, a.y)
    }
}

impl<T: Real> StiffSystem<T, 4> for FullFilm<T> {
    type Solver = SecondOrder<T>;

    /// Computes [`System::slope`], and the derivatives of each force with respect to eps and phi.
    ///
    /// For phi the velocity is held constant: `radial' = tangential velocity`, `slip' = -radial`.
    #[inline]
    fn linearise(&self, state: &Vector4<T>, ub: T) -> Linear<T, 4> {
        let at = self.polar(state);
        let (vx, vy) = (state.z, state.w);
        let (e, fb, inverse_mass) = (at.e, self.load_number, self.inverse_mass);
        let FilmIntegrals { j11, j12, j22 } = FilmIntegrals::at(e);
        let inverse_d = T::ONE / ((T::ONE - e) * (T::ONE + e));
        let j11_e = T::of(3.0) * e * j11 * inverse_d;
        let j12_e = T::of(4.0) * e * j12 * inverse_d - T::of(2.0) * inverse_d * inverse_d;
        let j22_e = e * inverse_d * (T::of(5.0) * j22 + T::of(4.0) * j11);

        let radial = vx * at.cos + vy * at.sin;
        let tangential = vy * at.cos - vx * at.sin;
        let half = T::of(0.5) * ub;
        let slip = tangential - half * e;
        let touch = self.touch(e);
        let outward = fb * at.cos - self.k0 * touch * touch - j22 * radial - j12 * slip;
        let forward = -fb * at.sin - j12 * radial - j11 * slip;
        let outward_e = -T::of(2.0) * self.k0 * touch - j22_e * radial - j12_e * slip + j12 * half;
        let forward_e = -j12_e * radial - j11_e * slip + j11 * half;
        let outward_phi = -fb * at.sin - j22 * tangential + j12 * radial;
        let forward_phi = -fb * at.cos - j12 * tangential + j11 * radial;

        let stiffness = at.turned(Matrix2::new(
            outward_e,
            (outward_phi - forward) * at.inverse_e,
            forward_e,
            (forward_phi + outward) * at.inverse_e,
        )) * inverse_mass;
        let damping = at.turned(Matrix2::new(-j22, -j12, -j12, -j11)) * inverse_mass;
        let a = at.vector(outward * inverse_mass, forward * inverse_mass);
        let drag = T::of(0.5) * e * inverse_mass;
        let by_input = at.vector(j12 * drag, j11 * drag);
        let (zero, one) = (T::ZERO, T::ONE);
        let (k, d) = (stiffness, damping);
        Linear {
            slope: Vector4::new(vx, vy, a.x, a.y),
            #[rustfmt::skip]
            jacobian: Matrix4::new(
                zero, zero, one, zero,
                zero, zero, zero, one,
                k.m11, k.m12, d.m11, d.m12,
                k.m21, k.m22, d.m21, d.m22,
            ),
            by_input: Vector4::new(zero, zero, by_input.x, by_input.y),
        }
    }
}
