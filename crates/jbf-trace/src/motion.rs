//! Common motion of all fingerprints.
//!
//! The motion consists of two sines with many reversals, contact and full film, a rest, a jump of
//! the load, and a rising temperature. It is computed with sums, products and the sine of
//! `jbf-core` only.

use jbf_core::{Bearing, Motion, Real};

/// Length of a step, s.
pub const STEP_S: f64 = 0.005;

const STEPS: u32 = 600;

/// Amplitude (m/s), frequency (rad/s) and phase (rad) of the two sines.
const WAVES: [[f64; 3]; 2] = [[0.08, 3.0, 0.0], [0.04, 7.1, 1.0]];

/// Range of samples at which the journal is at rest.
const REST: core::ops::Range<u32> = 240..280;

/// Sample at which the load jumps, and the loads (N) before and after it.
const JUMP: (u32, f64, f64) = (400, 104.0, 150.0);

/// Initial temperature, C.
///
/// `RISE_C_S` is its rate of change.
const FIRST_C: f64 = 28.0;
const RISE_C_S: f64 = 1.5;

/// Iterates over the samples of the motion.
pub fn motions<T: Real>() -> impl Iterator<Item = Motion<T>> {
    let mut angle_rad = 0.0_f64;
    let mut before_m_s = 0.0_f64;
    (0..=STEPS).map(move |i| {
        let time_s = STEP_S * f64::from(i);
        let (mut speed, mut rate) = (0.0, 0.0);
        if !REST.contains(&i) {
            for [size, omega, phase] in WAVES {
                speed += size * Real::sin(omega * time_s + phase);
                rate += size * omega * Real::cos(omega * time_s + phase);
            }
        }
        angle_rad += 0.5 * STEP_S * (before_m_s + speed) / Bearing::THESIS.radius_m;
        before_m_s = speed;
        Motion {
            time_s: T::of(time_s),
            velocity_m_s: T::of(speed),
            acceleration_m_s2: T::of(rate),
            angle_rad: T::of(angle_rad),
            temperature_c: Some(T::of(FIRST_C + RISE_C_S * time_s)),
            ..Motion::at_rest(T::of(if i < JUMP.0 { JUMP.1 } else { JUMP.2 }))
        }
    })
}
