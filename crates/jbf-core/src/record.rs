//! A recorded run as slices: the imposed motion, sample by sample.

use crate::motion::Motion;
use crate::real::Real;

/// The imposed motion of a run, one value a sample; all slices of one length.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Time, s, rising; where it starts does not matter.
    pub time_s: &'a [f64],
    /// Surface speed, m/s.
    pub velocity_m_s: &'a [f64],
    /// Its rate of change, m/s^2.
    pub acceleration_m_s2: &'a [f64],
    /// Shaft angle, unwrapped, rad.
    pub angle_rad: &'a [f64],
    /// Load on one bearing, N.
    pub load_n: &'a [f64],
    /// Recorded temperature, C, where there is one.
    pub temperature_c: Option<&'a [f64]>,
}

impl Record<'_> {
    /// The motion at sample `i`; none past the shortest slice.
    #[inline(always)]
    pub fn motion<T: Real>(&self, i: usize) -> Option<Motion<T>> {
        Some(self.sample(i)?.lift())
    }

    /// The same in plain numbers.
    #[inline(always)]
    pub(crate) fn sample(&self, i: usize) -> Option<Motion<f64>> {
        Some(Motion {
            time_s: *self.time_s.get(i)? - *self.time_s.first()?,
            velocity_m_s: *self.velocity_m_s.get(i)?,
            acceleration_m_s2: *self.acceleration_m_s2.get(i)?,
            angle_rad: *self.angle_rad.get(i)?,
            load_n: *self.load_n.get(i)?,
            temperature_c: match self.temperature_c {
                Some(all) => Some(*all.get(i)?),
                None => None,
            },
        })
    }
}
