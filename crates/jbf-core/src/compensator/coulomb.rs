//! Compensation by the Coulomb friction observer, [`crate::observer::coulomb`].
//!
//! Source: Friedland & Park (1992); Amin (1996); Cohn (1998), section 6.2.

use super::{Answer, Compensator, Sense};
use crate::observer::coulomb::{CoulombObserver, State};
use crate::real::Real;

/// `F_hat = a_hat sgn(v_hat)`.
#[derive(Clone, Copy, Debug)]
pub struct Coulomb<T> {
    /// The observer.
    pub observer: CoulombObserver<T>,
    /// The plant's damping `a`, 1/s.
    pub damping_1_s: T,
    /// The plant's input gain `b`, rad/s^2/V.
    pub input_rad_s2_v: T,
    /// Level at the start, V: zero, or what an earlier run learned.
    pub start_v: T,
}

impl<T: Real> Compensator<T> for Coulomb<T> {
    type State = State<T>;

    fn start(&self) -> State<T> {
        self.observer.learned(self.start_v)
    }

    #[inline]
    fn step(&self, state: &mut State<T>, sense: &Sense<T>) -> Answer<T> {
        let v = sense.velocity_rad_s;
        let power = self.observer.power(v);
        let level_v = self.observer.level_v(state, &power);
        if sense.may_learn {
            let free = self.input_rad_s2_v * sense.base_v - self.damping_1_s * v;
            self.observer.learn(state, &power, v, free);
        }
        let friction_v = level_v * v.sign();
        Answer {
            sum_v: friction_v,
            friction_v,
            correction_v: T::ZERO,
            forward_v: T::ZERO,
            learned: [level_v, T::ZERO],
        }
    }
}
