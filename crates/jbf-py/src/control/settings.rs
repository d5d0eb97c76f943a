//! The loop round a compensator, as Python hands it over.

use crate::bearing::refused;
use jbf_core::compensator::Compensator;
use jbf_core::controller::{BaseLaw, Controller, Limits};
use jbf_core::encoder::Encoder;
use jbf_core::observer::VelocityObserver;
use jbf_core::Real;
use pyo3::prelude::*;

/// Encoder, observer, control law and limits.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct LoopSpec {
    pub dt_s: f64,
    /// Position control, else velocity control.
    pub position: bool,
    /// k1 and k2, or g and C.
    gains: (f64, f64),
    observer_1_s: f64,
    observer_damping_1_s: f64,
    observer_input_rad_s2_v: f64,
    counts_per_rad: f64,
    counter_bits: u32,
    top_speed_rad_s: f64,
    output_limit_v: f64,
    moving_v: f64,
    patience_s: f64,
}

impl LoopSpec {
    /// The loop round a compensator.
    pub fn round<T: Real, C: Compensator<T>>(&self, compensator: C) -> PyResult<Controller<T, C>> {
        let encoder = Encoder::new(
            self.counts_per_rad,
            self.counter_bits,
            self.top_speed_rad_s,
            self.dt_s,
        )
        .map_err(refused)?;
        let observer = VelocityObserver::fed_forward(
            self.observer_1_s,
            self.observer_damping_1_s,
            self.observer_input_rad_s2_v,
            self.dt_s,
        )
        .map_err(refused)?;
        let (first, second) = (T::of(self.gains.0), T::of(self.gains.1));
        let law = if self.position {
            BaseLaw::Position {
                angle_v_rad: first,
                speed_v_s_rad: second,
            }
        } else {
            BaseLaw::Velocity {
                speed_v_s_rad: first,
                forward_v_s_rad: second,
            }
        };
        let limits = Limits {
            output_v: self.output_limit_v,
            moving_v: self.moving_v,
            patience_s: self.patience_s,
        };
        Controller::new(encoder, observer, law, compensator, limits, self.dt_s).map_err(refused)
    }
}
