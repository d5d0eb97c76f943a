//! Simulated shaft for a control loop, and the excitation of the loop.
//!
//! The excitation takes sixteen seconds and contains all conditions that make a step slow or a
//! result wrong.
//!
//! ```text
//! v' = -a v + b (u - F),   F holds up to a level that jumps with the load
//! ```
//!
//! A step is implicit in F, so that the shaft sticks. The model is as simple as possible, because a
//! microcontroller runs it between the steps of the loop under test.

use jbf_core::plant::Drive;
use jbf_core::reference::{Reference, Target, Wave};
use jbf_core::Real;

/// Time step of the control loop, s.
pub const LOOP_STEP_S: f64 = 0.002;

/// Number of steps of the whole excitation.
pub const LOOP_STEPS: u32 = 8000;

/// Number of steps in one of the eight parts of the excitation.
const PART: u32 = 1000;

/// Drive of Cohn (1998), with the friction scale for which the friction of these loops was fitted.
pub const DRIVE: Drive = Drive::THESIS.with_volts_per_n(0.02827);
/// Counts per radian of the encoder; its counter has 16 bits.
pub const COUNTS_PER_RAD: f64 = 2387.3;

/// Friction level at rest under the nominal load, V.
const LEVEL_V: f64 = 0.7;

/// Reference of each part: waveform, amplitude (rad/s), frequency (rad/s), and the load relative to
/// the nominal load.
const PARTS: [(Wave, f64, f64, f64); 8] = [
    (Wave::Sine, 10.0, 2.0, 1.0),
    (Wave::Triangle, 4.0, 4.0, 1.0),
    // Beyond the limit of the voltage.
    (Wave::Square, 60.0, 9.0, 1.0),
    // Creep.
    (Wave::Sine, 0.05, 3.0, 1.0),
    // The load jumps up, and down below its usual value.
    (Wave::Sine, 6.0, 7.0, 2.0),
    (Wave::Sine, 6.0, 7.0, 0.4),
    // The cable of the encoder breaks for a while, then its counter jumps.
    (Wave::Sine, 10.0, 2.0, 1.0),
    (Wave::Triangle, 8.0, 20.0, 1.0),
];

/// Range of steps with a frozen encoder.
///
/// The counter jumps at step `JUMP`.
const DEAD: core::ops::Range<u32> = 6200..6500;
const JUMP: u32 = 6800;

/// Target of the loop and friction level (V) at a step.
///
/// The reference of position control is the same wave, with a tenth of the amplitude.
pub fn asked<T: Real>(step: u32, position: bool) -> (Target<T>, T) {
    let part = (step / PART % PARTS.len() as u32) as usize;
    let (wave, size, frequency_rad_s, load) = PARTS[part];
    let size = if position { 0.1 * size } else { size };
    let target = Reference::new(wave, -size, size, frequency_rad_s)
        .map(|r| r.at(f64::from(step % PART) * LOOP_STEP_S))
        .unwrap_or_default();
    let lifted = Target {
        value: T::of(target.value),
        rate: T::of(target.rate),
    };
    (lifted, T::of(LEVEL_V * load))
}

/// State of motor, shaft and encoder.
#[derive(Clone, Copy, Debug)]
pub struct Shaft<T> {
    speed_rad_s: T,
    angle_rad: T,
    counter: u32,
    keep: T,
    gain: T,
}

impl<T: Real> Default for Shaft<T> {
    fn default() -> Self {
        let keep = Real::exp(-DRIVE.damping_1_s * LOOP_STEP_S);
        Self {
            speed_rad_s: T::ZERO,
            angle_rad: T::ZERO,
            counter: 0,
            keep: T::of(keep),
            gain: T::of(DRIVE.input_rad_s2_v / DRIVE.damping_1_s * (1.0 - keep)),
        }
    }
}

impl<T: Real> Shaft<T> {
    /// Returns the value of the encoder counter at a step.
    pub fn counter(&mut self, step: u32) -> u32 {
        if !DEAD.contains(&step) {
            let counts = self.angle_rad * T::of(COUNTS_PER_RAD);
            let shift = if step < JUMP { 0 } else { 20_000 };
            self.counter = (counts.floor_i32().wrapping_add(shift) as u32) & 0xffff;
        }
        self.counter
    }

    /// Advances the shaft by one step under a voltage (V), with friction up to a level (V).
    pub fn push(&mut self, volts: T, level_v: T) {
        let before = self.speed_rad_s;
        let free = self.keep * before + self.gain * volts;
        let hold = self.gain * level_v;
        self.speed_rad_s = free - free.max(-hold).min(hold);
        self.angle_rad += (before + self.speed_rad_s) * T::of(0.5 * LOOP_STEP_S);
    }
}
