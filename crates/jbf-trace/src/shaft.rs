//! A shaft to close a loop round, and what is asked of the loop: sixteen seconds with all that makes
//! a step dear or a result wrong.
//!
//! ```text
//! v' = -a v + b (u - F),   F holds up to a level that jumps with the load
//! ```
//!
//! A step is implicit in F, so that the shaft sticks. It is as light as can be: a microcontroller
//! has to run it between the steps of the loop that it tests.

use jbf_core::encoder::THESIS_COUNTS_PER_RAD;
use jbf_core::plant::Drive;
use jbf_core::reference::{Reference, Target, Wave};
use jbf_core::Real;

/// Step of the loop, s.
pub const LOOP_STEP_S: f64 = 0.002;

/// Steps of the whole excitation.
pub const LOOP_STEPS: u32 = 8000;

/// Steps of one part of it.
const PART: u32 = 1000;

/// The thesis's drive, with the friction scale that these loops' friction was fitted with.
pub const DRIVE: Drive = Drive::THESIS.with_volts_per_n(0.02827);
/// Counts of the encoder in a radian; its counter has 16 bits.
pub const COUNTS_PER_RAD: f64 = THESIS_COUNTS_PER_RAD;

/// Friction holds up to this, V, under the load of the thesis.
const LEVEL_V: f64 = 0.7;

/// Reference of each part for velocity control, rad/s, and what the load is of its usual.
const PARTS: [(Wave, f64, f64, f64); 8] = [
    (Wave::Sine, 10.0, 2.0, 1.0),
    (Wave::Triangle, 4.0, 4.0, 1.0),
    // Beyond what the voltage can do.
    (Wave::Square, 60.0, 9.0, 1.0),
    // Crawling.
    (Wave::Sine, 0.05, 3.0, 1.0),
    // The load jumps up, and down below its usual.
    (Wave::Sine, 6.0, 7.0, 2.0),
    (Wave::Sine, 6.0, 7.0, 0.4),
    // The encoder's cable breaks for a while, then its counter jumps.
    (Wave::Sine, 10.0, 2.0, 1.0),
    (Wave::Triangle, 8.0, 20.0, 1.0),
];

/// Steps with a dead encoder, and the step at which its counter jumps.
const DEAD: core::ops::Range<u32> = 6200..6500;
const JUMP: u32 = 6800;

/// What is asked of the loop at a step: the target, and the friction's level, V. A position
/// reference is the same wave, a tenth as large.
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
    /// What the encoder's counter shows at a step.
    pub fn counter(&mut self, step: u32) -> u32 {
        if !DEAD.contains(&step) {
            let counts = self.angle_rad * T::of(COUNTS_PER_RAD);
            let shift = if step < JUMP { 0 } else { 20_000 };
            self.counter = (counts.floor_i32().wrapping_add(shift) as u32) & 0xffff;
        }
        self.counter
    }

    /// One step under a voltage, against friction of a level, V.
    pub fn push(&mut self, volts: T, level_v: T) {
        let before = self.speed_rad_s;
        let free = self.keep * before + self.gain * volts;
        let hold = self.gain * level_v;
        self.speed_rad_s = free - free.max(-hold).min(hold);
        self.angle_rad += (before + self.speed_rad_s) * T::of(0.5 * LOOP_STEP_S);
    }
}
