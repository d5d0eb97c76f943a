//! Motion at one instant.

use crate::real::Real;

/// Motion at one instant, the input of a [`Chain`](crate::Chain).
///
/// Create it from [`Motion::at_rest`] with the quantities that differ from rest:
///
/// ```
/// use jbf_core::Motion;
/// let turning = Motion { time_s: 2.0, velocity_m_s: 0.02, ..Motion::at_rest(104.0) };
/// assert_eq!((turning.load_n, turning.angle_rad), (104.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motion<T> {
    /// Time since the start of the run, s.
    pub time_s: T,
    /// Sliding speed, signed, m/s; rad/s where the friction is a torque.
    pub velocity_m_s: T,
    /// Rate of change of the sliding speed, m/s^2.
    pub acceleration_m_s2: T,
    /// Shaft angle, unwrapped, rad; the position (m) of a linear axis.
    pub angle_rad: T,
    /// Angle of the weight minus the shaft angle, rad.
    ///
    /// The difference is zero except for a joint that follows other moving joints, whose link turns
    /// with all of them.
    pub weight_offset_rad: T,
    /// Normal load on one bearing, N.
    pub load_n: T,
    /// Recorded temperature, C.
    ///
    /// If it is `None`, all effects behave as at their reference temperature.
    pub temperature_c: Option<T>,
}

impl<T: Real> Default for Motion<T> {
    /// Returns a motion at rest without load, at time and angle zero.
    fn default() -> Self {
        Self::at_rest(T::ZERO)
    }
}

impl<T: Real> Motion<T> {
    /// Creates a motion at rest under a load (N), at time and angle zero.
    #[must_use]
    pub fn at_rest(load_n: T) -> Self {
        Self {
            time_s: T::ZERO,
            velocity_m_s: T::ZERO,
            acceleration_m_s2: T::ZERO,
            angle_rad: T::ZERO,
            weight_offset_rad: T::ZERO,
            load_n,
            temperature_c: None,
        }
    }

    /// Returns true if every quantity is finite.
    #[inline(always)]
    pub fn is_finite(&self) -> bool {
        self.time_s.is_finite()
            && self.velocity_m_s.is_finite()
            && self.acceleration_m_s2.is_finite()
            && self.angle_rad.is_finite()
            && self.weight_offset_rad.is_finite()
            && self.load_n.is_finite()
            && self.temperature_c.is_none_or(T::is_finite)
    }

    /// Converts to another number type, without derivatives.
    #[inline(always)]
    pub(crate) fn cast<U: Real>(&self) -> Motion<U> {
        let cast = |value: T| U::of(value.value());
        Motion {
            time_s: cast(self.time_s),
            velocity_m_s: cast(self.velocity_m_s),
            acceleration_m_s2: cast(self.acceleration_m_s2),
            angle_rad: cast(self.angle_rad),
            weight_offset_rad: cast(self.weight_offset_rad),
            load_n: cast(self.load_n),
            temperature_c: self.temperature_c.map(cast),
        }
    }

    /// Interpolates the motion at a `fraction` of the step to `other`.
    ///
    /// Every quantity is linear except the angle, which is a parabola for a linear speed. (With
    /// linear interpolation over a sample of 20 ms, the error would be one step of an encoder,
    /// which a stiff drive converts to a considerable force.)
    #[inline(always)]
    pub(crate) fn towards(&self, other: &Self, fraction: T, radius_m: T) -> Self {
        let line = |a: T, b: T| a + (b - a) * fraction;
        let dt_s = other.time_s - self.time_s;
        let bend = (other.velocity_m_s - self.velocity_m_s) * dt_s / radius_m;
        Self {
            time_s: line(self.time_s, other.time_s),
            velocity_m_s: line(self.velocity_m_s, other.velocity_m_s),
            acceleration_m_s2: line(self.acceleration_m_s2, other.acceleration_m_s2),
            angle_rad: line(self.angle_rad, other.angle_rad) - sag(fraction) * bend,
            weight_offset_rad: line(self.weight_offset_rad, other.weight_offset_rad),
            load_n: line(self.load_n, other.load_n),
            temperature_c: match (self.temperature_c, other.temperature_c) {
                (Some(from), Some(to)) => Some(line(from, to)),
                (_, to) => to,
            },
        }
    }
}

/// Fraction of a step at which a speed that is linear from `from` to `to` crosses zero.
///
/// Returns `None` if the speed does not change sign inside the step.
#[inline(always)]
pub(crate) fn crossing<T: Real>(from: T, to: T) -> Option<T> {
    if from.value() * to.value() < 0.0 {
        Some(from / (from - to))
    } else {
        None
    }
}

/// Difference between a chord and its parabola at a fraction of the step, relative to the change of
/// slope over the step.
#[inline(always)]
pub(crate) fn sag<T: Real>(share: T) -> T {
    T::of(0.5) * share * (T::ONE - share)
}

/// Motion of the journal, the surface at which the friction acts; the output of the drive.
///
/// It equals the commanded [`Motion`] unless the drive is compliant or has backlash.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct JournalMotion<T> {
    /// Surface speed of the journal, m/s.
    pub velocity_m_s: T,
    /// Rate of change of the surface speed, m/s^2.
    pub acceleration_m_s2: T,
    /// Acceleration of the side on which the force is measured, m/s^2: that of the drive, or of the
    /// journal ([`Rig::force_at_drive`](crate::effect::Rig::force_at_drive)).
    pub measured_acceleration_m_s2: T,
    /// Inertial force of the part behind a spring, minus that of the same mass on the drive's side,
    /// N; a correction of `inertia`. Zero unless the force is measured at the drive.
    pub spring_inertia_n: T,
    /// Journal angle, rad.
    pub angle_rad: T,
    /// Angle of the weight minus the journal angle, rad.
    pub weight_offset_rad: T,
    /// Value of the set-valued sgn(v): -1 or +1 in sliding.
    ///
    /// The value is between -1 and +1 while the journal sticks under a force smaller than the
    /// sliding friction.
    pub direction: T,
    /// Time since the start of the run, s.
    pub time_s: T,
    /// Recorded load, N.
    pub load_n: T,
    /// Recorded temperature, C, if any.
    pub temperature_c: Option<T>,
}

impl<T: Real> JournalMotion<T> {
    /// Returns the direction of motion for friction: the sign of the speed.
    ///
    /// At rest, it is the sign of the friction force, because the motion may start in either
    /// direction.
    #[inline(always)]
    pub(crate) fn way(&self) -> T {
        if self.velocity_m_s == T::ZERO {
            self.direction.sign()
        } else {
            self.velocity_m_s.sign()
        }
    }

    /// Returns the sliding distance from this instant to `to`, m, for a linear speed; motion in
    /// both directions is added.
    #[inline(always)]
    pub(crate) fn distance_m(&self, to: &Self, dt_s: T) -> T {
        let (v0, v1) = (self.velocity_m_s, to.velocity_m_s);
        let half = T::of(0.5) * dt_s;
        if crossing(v0, v1).is_some() {
            half * (v0 * v0 + v1 * v1) / (v0.abs() + v1.abs())
        } else {
            half * (v0 + v1).abs()
        }
    }
}

impl<T: Real> From<&Motion<T>> for JournalMotion<T> {
    #[inline(always)]
    fn from(m: &Motion<T>) -> Self {
        Self {
            velocity_m_s: m.velocity_m_s,
            acceleration_m_s2: m.acceleration_m_s2,
            measured_acceleration_m_s2: m.acceleration_m_s2,
            spring_inertia_n: T::ZERO,
            angle_rad: m.angle_rad,
            weight_offset_rad: m.weight_offset_rad,
            direction: m.velocity_m_s.sign(),
            time_s: m.time_s,
            load_n: m.load_n,
            temperature_c: m.temperature_c,
        }
    }
}
