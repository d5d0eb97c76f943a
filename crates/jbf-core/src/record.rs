//! Recorded run as slices: the imposed motion at each sample.

use crate::motion::Motion;
use crate::real::Real;

/// Imposed motion of a run, one value per sample; all slices have the same length.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Time, s, ascending; its origin is arbitrary.
    pub time_s: &'a [f64],
    /// Surface speed, m/s.
    pub velocity_m_s: &'a [f64],
    /// Rate of change of the surface speed, m/s^2.
    pub acceleration_m_s2: &'a [f64],
    /// Shaft angle, unwrapped, rad.
    pub angle_rad: &'a [f64],
    /// Angle of the weight minus the shaft angle, rad; zero if it is `None`.
    pub weight_offset_rad: Option<&'a [f64]>,
    /// Load on one bearing, N.
    pub load_n: &'a [f64],
    /// Recorded temperature, C, if any.
    pub temperature_c: Option<&'a [f64]>,
}

impl Record<'_> {
    /// Returns the motion at sample `i`; `None` beyond the shortest slice.
    #[inline(always)]
    pub fn motion<T: Real>(&self, i: usize) -> Option<Motion<T>> {
        Some(self.sample(i)?.cast())
    }

    /// Returns the motion at sample `i` without derivatives; `None` beyond the shortest slice.
    #[inline(always)]
    pub(crate) fn sample(&self, i: usize) -> Option<Motion<f64>> {
        Some(Motion {
            time_s: *self.time_s.get(i)? - *self.time_s.first()?,
            velocity_m_s: *self.velocity_m_s.get(i)?,
            acceleration_m_s2: *self.acceleration_m_s2.get(i)?,
            angle_rad: *self.angle_rad.get(i)?,
            weight_offset_rad: match self.weight_offset_rad {
                Some(all) => *all.get(i)?,
                None => 0.0,
            },
            load_n: *self.load_n.get(i)?,
            temperature_c: match self.temperature_c {
                Some(all) => Some(*all.get(i)?),
                None => None,
            },
        })
    }
}
