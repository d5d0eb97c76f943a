//! Property: the output of any control loop is finite and within its limit, and the speed is
//! finite, for any counter and target.
//!
//! The loop is valid again after some steps with a constant counter and target.

use crate::bytes::{between, number};
use crate::compensators::{any, Loop, With};
use crate::steps::seen;
use arbitrary::{Result, Unstructured};
use jbf_core::compensator::Compensator;
use jbf_core::controller::{BaseLaw, Controller, Limits};
use jbf_core::encoder::Encoder;
use jbf_core::observer::VelocityObserver;
use jbf_core::plant::Drive;
use jbf_core::reference::Target;
use jbf_core::Real;

/// Largest number of steps per input, which limits the duration of a test.
const STEPS: usize = 64;

struct Running<T: Real> {
    encoder: Encoder<T>,
    observer: VelocityObserver<T>,
    law: BaseLaw<T>,
    limits: Limits,
    dt_s: f64,
    most_counts: i64,
}

impl<T: Real> With<T> for Running<T> {
    fn with<C: Compensator<T>>(
        self,
        bytes: &mut Unstructured<'_>,
        name: &str,
        compensator: C,
    ) -> Result<()> {
        let Self {
            encoder,
            observer,
            law,
            limits,
            dt_s,
            most_counts,
        } = self;
        let Ok(controller) = Controller::new(encoder, observer, law, compensator, limits, dt_s)
        else {
            return Ok(());
        };
        let mut state = controller.start();
        let mut counter = 0_u32;
        let mut moving = 0_i64;
        for _ in 0..STEPS {
            if bytes.is_empty() {
                break;
            }
            let kind: u8 = bytes.arbitrary()?;
            match kind & 7 {
                // Frozen, jumping, or moving at a speed that may change.
                0 | 1 => moving = 0,
                2 => counter = bytes.arbitrary()?,
                3 | 4 => moving = bytes.int_in_range(-most_counts..=most_counts)?,
                _ => {}
            }
            counter = counter.wrapping_add(moving as u32);
            let mut any = || -> Result<T> {
                Ok(match bytes.int_in_range(0..=15_u8)? {
                    0 => T::of(f64::NAN),
                    1 => T::of(f64::INFINITY),
                    2 => T::ZERO,
                    _ => T::of(number(bytes, 1e30)?),
                })
            };
            let target = Target {
                value: any()?,
                rate: any()?,
            };
            // A period of constant input, as with a frozen counter and a constant target.
            let stretch = if kind & 0xe0 == 0xe0 { 64 } else { 1 };
            for _ in 0..stretch {
                let parts = controller.step(&mut state, counter & 0xffff, &target);
                let told = || format!("{name}: {counter} {target:?} {limits:?} {dt_s}: {parts:?}");
                seen();
                let most = T::of(limits.output_v);
                assert!(parts.output_v.abs() <= most, "{}", told());
                assert!(parts.velocity_rad_s.is_finite(), "{}", told());
                assert!(parts.angle_rad.is_finite(), "{}", told());
            }
        }
        Ok(())
    }
}

fn run<T: Real>(bytes: &mut Unstructured<'_>) -> Result<()> {
    let dt_s = between(bytes, 1e-5, 2e-2)?;
    let drive = if bytes.arbitrary()? {
        Drive::THESIS
    } else {
        Drive::new(between(bytes, 0.1, 1e3)?, between(bytes, 1.0, 1e4)?)
            .with_volts_per_n(between(bytes, 1e-4, 1.0)?)
            .with_limit_v(between(bytes, 0.1, 100.0)?)
    };
    let law = match bytes.int_in_range(0..=2)? {
        0 => BaseLaw::position(&drive),
        1 => BaseLaw::velocity(&drive),
        _ => BaseLaw::pole_placement(between(bytes, 1.0, 100.0)?, &drive),
    };
    let counts_per_rad = between(bytes, 1.0, 1e5)?;
    let top = drive.top_speed_rad_s();
    let encoder = Encoder::<T>::new(counts_per_rad, 16, top, dt_s);
    let gain = between(bytes, 0.1, 1e3)?;
    let observer = if bytes.arbitrary()? {
        VelocityObserver::<T>::new(gain, dt_s)
    } else {
        VelocityObserver::with_feedforward(gain, drive.damping_1_s, drive.input_rad_s2_v, dt_s)
    };
    let (Ok(encoder), Ok(observer)) = (encoder, observer) else {
        return Ok(());
    };
    let limits = Limits::new(drive.limit_v)
        .with_moving_v(drive.limit_v * between(bytes, 1e-3, 1.0)?)
        .with_patience_s(between(bytes, 0.0, 1.0)?);
    let running = Running {
        encoder,
        observer,
        law: law.cast(),
        limits,
        dt_s,
        most_counts: (counts_per_rad * top * dt_s) as i64,
    };
    any(bytes, &Loop { drive, law, dt_s }, running)
}

/// Checks that the output of a control loop with any compensator is finite and within its limit,
/// for any counter and target.
pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    if bytes.arbitrary()? {
        run::<f32>(bytes)
    } else {
        run::<f64>(bytes)
    }
}
