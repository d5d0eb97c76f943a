//! Simulated shaft for a closed loop, and the references of the loop.
//!
//! The references are sixteen seconds with all conditions that make a step costly or a result
//! wrong.
//!
//! ```text
//! v' = -a v + b (u - F),   F holds up to a level that jumps with the load
//! ```
//!
//! A step is implicit in F, so that the shaft sticks. It is as small as possible, because a
//! microcontroller must run it between the steps of the loop that it tests.

use jbf_core::encoder::THESIS_COUNTS_PER_RAD;
use jbf_core::plant::Drive;
use jbf_core::reference::{Reference, Target, Wave};
use jbf_core::Real;

/// Time step of the loop, s.
pub const LOOP_STEP_S: f64 = 0.002;

/// Number of steps of the whole excitation.
pub const LOOP_STEPS: u32 = 8000;

/// Number of steps of one part of the excitation.
const PART: u32 = 1000;

/// Drive of the thesis, with the friction scale to which the friction of these loops was fitted.
pub const DRIVE: Drive = Drive::THESIS.with_volts_per_n(0.02827);
/// Counts per radian of the encoder; its counter has 16 bits.
pub const COUNTS_PER_RAD: f64 = THESIS_COUNTS_PER_RAD;

/// Holding level of friction, V, under the load of the thesis.
const LEVEL_V: f64 = 0.7;

/// Velocity reference of each part, rad/s, and its load relative to the usual load.
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

/// Range of steps with a dead encoder, and the step at which its counter jumps.
const DEAD: core::ops::Range<u32> = 6200..6500;
const JUMP: u32 = 6800;

/// Target of the loop at a step, and the friction level, V.
///
/// A position reference is the same wave, a tenth as large.
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

/// Motor, shaft and encoder.
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
    /// Value of the encoder's counter at a step.
    pub fn counter(&mut self, step: u32) -> u32 {
        if !DEAD.contains(&step) {
            let counts = self.angle_rad * T::of(COUNTS_PER_RAD);
            let shift = if step < JUMP { 0 } else { 20_000 };
            self.counter = (counts.floor_i32().wrapping_add(shift) as u32) & 0xffff;
        }
        self.counter
    }

    /// Advances one step under a voltage, against friction of a level, V.
    pub fn push(&mut self, volts: T, level_v: T) {
        let before = self.speed_rad_s;
        let free = self.keep * before + self.gain * volts;
        let hold = self.gain * level_v;
        self.speed_rad_s = free - free.max(-hold).min(hold);
        self.angle_rad += (before + self.speed_rad_s) * T::of(0.5 * LOOP_STEP_S);
    }
}
