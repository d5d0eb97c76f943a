//! Friction models for use inside a compensator.
//!
//! The input of a model is the speed of the shaft. The output is the friction in volts, separated
//! into the part with the sign of the motion and the remaining part.

use crate::chain::{self, Chain};
use crate::effect::{Effect, Effects};
use crate::friction::Friction;
use crate::law::Law;
use crate::motion::Motion;
use crate::real::Real;

/// Friction model that a compensator evaluates in a control loop.
pub trait FrictionModel<T: Real> {
    /// State of the model.
    type State: Copy;

    /// Returns the state of the model on a shaft that has been at rest.
    fn start(&self) -> Self::State;

    /// Advances the state by `dt_s` to a speed (rad/s) and an angle (rad).
    fn advance(&self, state: &mut Self::State, velocity_rad_s: T, angle_rad: T, dt_s: T);

    /// Returns the friction at the speed of the last [`FrictionModel::advance`], V.
    fn friction(&self, state: &Self::State) -> Friction<T>;

    /// Returns the slope of [`Friction::smooth`] between rest and a speed (rad/s, not zero), V
    /// s/rad.
    ///
    /// The slope includes viscous friction only, not a weight or a spring, and is not negative. The
    /// default is zero. An observer oscillates if a model with steep viscous friction returns zero.
    #[inline]
    fn slope(&self, state: &Self::State, velocity_rad_s: T) -> T {
        let _ = (state, velocity_rad_s);
        T::ZERO
    }
}

/// Friction model that is a law without effects, the smallest and fastest model.
///
/// The deflection of a bristle before it slides is neglected; [`ChainModel`] includes it.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LawModel<T, L> {
    /// The friction law.
    pub law: L,
    /// Journal radius, m; 1 for a shaft whose friction is a torque.
    pub radius_m: T,
    /// Voltage that corresponds to one newton of friction on one bearing, V/N.
    pub volts_per_n: T,
    /// Load on one bearing, N; not used by laws in newtons.
    pub load_n: T,
}

impl<T: Real, L> LawModel<T, L> {
    /// Creates a model from a law, the journal radius (m), the voltage per newton of friction on
    /// one bearing (V/N) and the load (N).
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

/// State of a law, and the speed at the last step.
#[derive(Clone, Copy, Debug)]
pub struct Moving<T, S> {
    law: S,
    velocity_m_s: T,
}

impl<T: Real, L: Law<T>> FrictionModel<T> for LawModel<T, L> {
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

/// Friction model that is a chain: a law with the effects of a fitted model.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ChainModel<T: Real, L, E = Effects<T>> {
    /// Law with its effects.
    pub chain: Chain<T, L, E>,
    /// Voltage that corresponds to one newton of friction on one bearing, V/N.
    pub volts_per_n: T,
    /// Load on one bearing, N; not used by laws in newtons.
    pub load_n: T,
}

impl<T: Real, L, E> ChainModel<T, L, E> {
    /// Creates a model from a chain, the voltage per newton of friction on one bearing (V/N) and
    /// the load (N).
    #[must_use]
    pub fn new(chain: Chain<T, L, E>, volts_per_n: f64, load_n: f64) -> Self {
        Self {
            chain,
            volts_per_n: T::of(volts_per_n),
            load_n: T::of(load_n),
        }
    }
}

impl<T: Real, L: Law<T>, E: Effect<T>> FrictionModel<T> for ChainModel<T, L, E> {
    type State = chain::State<T, L::State, E>;

    fn start(&self) -> Self::State {
        self.chain.start(&Motion::at_rest(self.load_n))
    }

    #[inline]
    fn advance(&self, state: &mut Self::State, velocity_rad_s: T, angle_rad: T, dt_s: T) {
        let velocity_m_s = velocity_rad_s * self.chain.rig.radius_m;
        let change = velocity_m_s - state.motion.velocity_m_s;
        let to = Motion {
            time_s: state.motion.time_s + dt_s,
            velocity_m_s,
            acceleration_m_s2: change / dt_s,
            angle_rad,
            weight_offset_rad: T::ZERO,
            load_n: self.load_n,
            temperature_c: None,
        };
        self.chain.step(state, &to, dt_s);
    }

    #[inline]
    fn friction(&self, state: &Self::State) -> Friction<T> {
        self.chain.reaction_n(state).times(self.volts_per_n)
    }

    #[inline]
    fn slope(&self, state: &Self::State, velocity_rad_s: T) -> T {
        let speed_m_s = velocity_rad_s * self.chain.rig.radius_m;
        let viscous_n = self.chain.viscous_n(state, speed_m_s);
        (viscous_n * self.volts_per_n / velocity_rad_s).max(T::ZERO)
    }
}
