//! Compensation by the Coulomb friction observer, [`crate::observer::coulomb`].
//!
//! Source: Friedland & Park (1992); Amin (1996); Cohn (1998), section 6.2.

use super::{Compensator, Input, Output};
use crate::observer::coulomb::{CoulombObserver, State};
use crate::plant::Drive;
use crate::real::Real;

/// Compensator `F_hat = a_hat sgn(v_hat)` with an estimated friction level `a_hat` and the
/// estimated speed `v_hat`.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Coulomb<T> {
    /// Observer that estimates the friction level.
    pub observer: CoulombObserver<T>,
    /// Damping `a` of the plant, 1/s.
    pub damping_1_s: T,
    /// Input gain `b` of the plant, rad/s^2/V.
    pub input_rad_s2_v: T,
    /// Initial friction level, V: zero, or the level that an earlier run estimated.
    pub start_v: T,
}

impl<T: Real> Coulomb<T> {
    /// Creates a compensator from an observer and the damping and input gain of a drive.
    #[must_use]
    pub fn new(observer: CoulombObserver<T>, drive: &Drive) -> Self {
        Self {
            observer,
            damping_1_s: T::of(drive.damping_1_s),
            input_rad_s2_v: T::of(drive.input_rad_s2_v),
            start_v: T::ZERO,
        }
    }
}

impl<T: Real> Compensator<T> for Coulomb<T> {
    type State = State<T>;

    fn start(&self) -> State<T> {
        self.observer.learned(self.start_v)
    }

    #[inline]
    fn step(&self, state: &mut State<T>, input: &Input<T>) -> Output<T> {
        let v = input.velocity_rad_s;
        let power = self.observer.power(v);
        let level_v = self.observer.level_v(state, &power);
        if input.may_learn {
            let free = self.input_rad_s2_v * input.base_v - self.damping_1_s * v;
            self.observer.learn(state, &power, v, free);
        }
        let friction_v = level_v * v.sign();
        Output::of(friction_v, [level_v, T::ZERO])
    }
}
