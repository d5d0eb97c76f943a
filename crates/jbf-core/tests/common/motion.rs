//! Imposed motions for tests of a chain.

use super::random::Random;
use super::LOAD_N;
use jbf_core::{Bearing, Motion, Real};

/// Sum of sines `U = offset + sum of amplitude sin(omega t + phase)`, with exact acceleration and
/// angle.
///
/// The load is constant. A `sign` of -1 mirrors the motion. The shaft does not move during the
/// rest.
#[derive(Clone, Debug)]
pub struct Sines {
    pub offset_m_s: f64,
    /// Amplitude in m/s, angular frequency in rad/s, phase in rad.
    pub waves: Vec<[f64; 3]>,
    pub sign: f64,
    /// Start and duration of a rest, s.
    pub rest_s: Option<[f64; 2]>,
}

impl Sines {
    /// Returns the motion with an additional rest.
    pub fn resting(mut self, from_s: f64, length_s: f64) -> Self {
        self.rest_s = Some([from_s, length_s]);
        self
    }

    /// Motion in both directions of chapter 4 of Cohn (1998), at 104 N.
    pub fn two_way(omega_rad_s: f64) -> Self {
        Self {
            offset_m_s: 0.0,
            waves: vec![[0.127, omega_rad_s, 0.0]],
            sign: 1.0,
            rest_s: None,
        }
    }

    /// Motion in one direction of chapter 4 of Cohn (1998), at 104 N.
    pub fn one_way(omega_rad_s: f64) -> Self {
        Self {
            offset_m_s: 0.0728,
            waves: vec![[0.0595, omega_rad_s, 0.0]],
            sign: 1.0,
            rest_s: None,
        }
    }

    /// Motion of three sines with random amplitude, frequency and phase.
    pub fn random(random: &mut Random) -> Self {
        let wave = |r: &mut Random| {
            [
                r.log_uniform(1e-4, 1.0),
                r.log_uniform(0.05, 5.0),
                r.uniform(0.0, 6.3),
            ]
        };
        let offset_m_s = if random.chance(0.5) {
            0.0
        } else {
            random.uniform(-0.3, 0.3)
        };
        Self {
            offset_m_s,
            waves: (0..3).map(|_| wave(random)).collect(),
            sign: 1.0,
            rest_s: None,
        }
    }

    pub fn mirrored(&self) -> Self {
        Self {
            sign: -self.sign,
            ..self.clone()
        }
    }

    /// Temperature at a time, C, as in a room with intermittent heating.
    pub fn temperature_c(time_s: f64) -> f64 {
        31.0 + 6.0 * (0.7 * time_s).sin()
    }

    /// Returns the motion at a time under another load (N).
    pub fn under<T: Real>(&self, load_n: f64, time_s: f64) -> Motion<T> {
        Motion {
            load_n: T::of(load_n),
            ..self.at(time_s)
        }
    }

    pub fn at<T: Real>(&self, time_s: f64) -> Motion<T> {
        let (since, still) = match self.rest_s {
            Some([from, length]) if time_s >= from => {
                ((time_s - length).max(from), time_s < from + length)
            }
            _ => (time_s, false),
        };
        let (mut v, mut a) = (self.offset_m_s, 0.0);
        let mut path_m = self.offset_m_s * since;
        for &[size, omega, phase] in &self.waves {
            let (sin, cos) = (omega * since + phase).sin_cos();
            v += size * sin;
            a += size * omega * cos;
            path_m += size / omega * (phase.cos() - cos);
        }
        if still {
            (v, a) = (0.0, 0.0);
        }
        Motion {
            time_s: T::of(time_s),
            velocity_m_s: T::of(self.sign * v),
            acceleration_m_s2: T::of(self.sign * a),
            angle_rad: T::of(self.sign * path_m / Bearing::THESIS.radius_m),
            temperature_c: Some(T::of(Self::temperature_c(time_s))),
            ..Motion::at_rest(T::of(LOAD_N))
        }
    }
}

/// Motion at a constant speed that starts at angle zero.
pub fn constant<T: Real>(velocity_m_s: f64, time_s: f64) -> Motion<T> {
    Sines {
        offset_m_s: velocity_m_s,
        waves: vec![],
        sign: 1.0,
        rest_s: None,
    }
    .at(time_s)
}

/// State of rest at an angle, rad.
pub fn held<T: Real>(angle_rad: f64, time_s: f64) -> Motion<T> {
    Motion {
        time_s: T::of(time_s),
        angle_rad: T::of(angle_rad),
        ..Motion::at_rest(T::of(LOAD_N))
    }
}
