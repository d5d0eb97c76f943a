//! Settings of a control loop without its compensator, passed from Python.

use super::constants::OBSERVER_1_S;
use super::plant::DriveSpec;
use crate::bearing::refused;
use jbf_core::compensator::Compensator;
use jbf_core::controller::{BaseLaw, Controller, Limits};
use jbf_core::encoder::Encoder;
use jbf_core::observer::VelocityObserver;
use jbf_core::{Error, Real};
use pyo3::prelude::*;

/// Assumed drive and encoder of a control loop, and the limits for the detection of faults.
///
/// The control law and the velocity observer are those of Cohn (1998) for this drive.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct LoopSpec {
    pub dt_s: f64,
    /// True for position control, false for velocity control.
    pub position: bool,
    pub drive: DriveSpec,
    counts_per_rad: f64,
    counter_bits: u32,
    /// Voltage that certainly moves the shaft, V; `None` if an unchanged counter is never frozen.
    moving_v: Option<f64>,
    patience_s: Option<f64>,
}

impl LoopSpec {
    /// Returns the control law of the loop.
    pub fn law(&self) -> BaseLaw<f64> {
        let drive = self.drive.drive();
        if self.position {
            BaseLaw::position(&drive)
        } else {
            BaseLaw::velocity(&drive)
        }
    }

    /// Creates the control loop with a compensator.
    pub fn round<T: Real, C: Compensator<T>>(&self, compensator: C) -> PyResult<Controller<T, C>> {
        let drive = self.drive.drive();
        let top_speed_rad_s = drive.top_speed_rad_s();
        let encoder = Encoder::new(
            self.counts_per_rad,
            self.counter_bits,
            top_speed_rad_s,
            self.dt_s,
        )
        .map_err(refused)?;
        let observer = self.observer().map_err(refused)?;
        let mut limits = Limits::new(drive.limit_v);
        if let Some(moving_v) = self.moving_v {
            limits = limits.with_moving_v(moving_v);
        }
        if let Some(patience_s) = self.patience_s {
            limits = limits.with_patience_s(patience_s);
        }
        let law = self.law().cast();
        Controller::new(encoder, observer, law, compensator, limits, self.dt_s).map_err(refused)
    }

    /// Returns the velocity observer of Cohn (1998): that of Appendix E for position control, that
    /// of Appendix D for velocity control.
    fn observer<T: Real>(&self) -> Result<VelocityObserver<T>, Error> {
        if self.position {
            let drive = self.drive.drive();
            let (a, b) = (drive.damping_1_s, drive.input_rad_s2_v);
            VelocityObserver::with_feedforward(OBSERVER_1_S, a, b, self.dt_s)
        } else {
            VelocityObserver::new(OBSERVER_1_S, self.dt_s)
        }
    }
}
