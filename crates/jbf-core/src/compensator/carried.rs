//! A friction model as a compensator carries it: moved by the shaft's speed, it gives the
//! friction in volts, in the part that takes the sign of the motion and the rest.

use crate::chain::{self, Chain};
use crate::effect::{EffectSet, Effects};
use crate::friction::Friction;
use crate::law::Law;
use crate::motion::Motion;
use crate::real::Real;

/// A friction model in a loop.
pub trait Carried<T: Real> {
    /// What the model remembers.
    type State: Copy;

    /// The model on a shaft that has stood still.
    fn start(&self) -> Self::State;

    /// Move on by `dt_s` to a speed (rad/s) and an angle (rad).
    fn advance(&self, state: &mut Self::State, velocity_rad_s: T, angle_rad: T, dt_s: T);

    /// Friction at the speed that the model was last moved to, V.
    fn friction(&self, state: &Self::State) -> Friction<T>;

    /// How [`Friction::smooth`] would grow from rest to a speed (rad/s, not zero), per speed, V s/rad
    /// and not below zero: its viscous part alone, no weight, no spring. A model of steep viscous
    /// friction that does not tell makes an observer ring.
    #[inline]
    fn slope(&self, state: &Self::State, velocity_rad_s: T) -> T {
        let _ = (state, velocity_rad_s);
        T::ZERO
    }
}

/// A law alone, without effects: the smallest and fastest. A law with a bristle is taken as if
/// it slid at once.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Bare<T, L> {
    /// The law.
    pub law: L,
    /// Journal radius, m.
    pub radius_m: T,
    /// What one newton of friction on one bearing is in volts.
    pub volts_per_n: T,
    /// Load on one bearing, N.
    pub load_n: T,
}

impl<T: Real, L> Bare<T, L> {
    /// A law on a journal of a radius (m), with the volts that a newton of its friction on one
    /// bearing makes, under a load (N).
    #[must_use]
    pub fn new(law: L, radius_m: f64, volts_per_n: f64, load_n: f64) -> Self {
        Self {
            law,
            radius_m: T::of(radius_m),
            volts_per_n: T::of(volts_per_n),
            load_n: T::of(load_n),
        }
    }
}

/// A law's state with the speed it was last given.
#[derive(Clone, Copy, Debug)]
pub struct Moving<T, S> {
    law: S,
    velocity_m_s: T,
}

impl<T: Real, L: Law<T>> Carried<T> for Bare<T, L> {
    type State = Moving<T, L::State>;

    fn start(&self) -> Self::State {
        Moving {
            law: self.law.start(self.load_n),
            velocity_m_s: T::ZERO,
        }
    }

    #[inline]
    fn advance(&self, state: &mut Self::State, velocity_rad_s: T, _angle_rad: T, dt_s: T) {
        let before = state.velocity_m_s.abs();
        state.velocity_m_s = velocity_rad_s * self.radius_m;
        let now = state.velocity_m_s.abs();
        let middle = (before + now) * T::of(0.5);
        self.law
            .advance(&mut state.law, [before, middle, now], T::ONE, dt_s);
    }

    #[inline]
    fn friction(&self, state: &Self::State) -> Friction<T> {
        let sliding = self.law.friction(&state.law, state.velocity_m_s);
        let volts = self.volts_per_n * self.law.pressed_n(self.load_n);
        sliding.times(volts)
    }

    #[inline]
    fn slope(&self, state: &Self::State, velocity_rad_s: T) -> T {
        let sliding = self
            .law
            .friction(&state.law, velocity_rad_s * self.radius_m);
        let volts = self.volts_per_n * self.law.pressed_n(self.load_n);
        (sliding.smooth * volts / velocity_rad_s).max(T::ZERO)
    }
}

/// A whole chain: a law with the effects of a fitted model.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Whole<T: Real, L, E = Effects<T>> {
    /// The chain.
    pub chain: Chain<T, L, E>,
    /// What one newton of friction on one bearing is in volts.
    pub volts_per_n: T,
    /// Load on one bearing, N.
    pub load_n: T,
}

impl<T: Real, L, E> Whole<T, L, E> {
    /// A chain, with the volts that a newton of its friction on one bearing makes, under a load
    /// (N).
    #[must_use]
    pub fn new(chain: Chain<T, L, E>, volts_per_n: f64, load_n: f64) -> Self {
        Self {
            chain,
            volts_per_n: T::of(volts_per_n),
            load_n: T::of(load_n),
        }
    }
}

impl<T: Real, L: Law<T>, E: EffectSet<T>> Carried<T> for Whole<T, L, E> {
    type State = chain::State<T, L::State, E>;

    fn start(&self) -> Self::State {
        self.chain.start(&Motion::at_rest(self.load_n))
    }

    #[inline]
    fn advance(&self, state: &mut Self::State, velocity_rad_s: T, angle_rad: T, dt_s: T) {
        let velocity_m_s = velocity_rad_s * self.chain.rig.radius_m;
        let change = velocity_m_s - state.motion().velocity_m_s;
        let to = Motion {
            time_s: state.motion().time_s + dt_s,
            velocity_m_s,
            acceleration_m_s2: change / dt_s,
            angle_rad,
            load_n: self.load_n,
            temperature_c: None,
        };
        self.chain.step(state, &to, dt_s);
    }

    #[inline]
    fn friction(&self, state: &Self::State) -> Friction<T> {
        self.chain.felt(state).times(self.volts_per_n)
    }

    #[inline]
    fn slope(&self, state: &Self::State, velocity_rad_s: T) -> T {
        let speed_m_s = velocity_rad_s * self.chain.rig.radius_m;
        let viscous_n = self.chain.viscous_n(state, speed_m_s);
        (viscous_n * self.volts_per_n / velocity_rad_s).max(T::ZERO)
    }
}
