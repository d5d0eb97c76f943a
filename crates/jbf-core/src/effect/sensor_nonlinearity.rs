//! Sensor nonlinearity `F + c F^3`: a load cell with a curved characteristic.
//!
//! If a cell is symmetric in tension and compression, the error is an odd function of the force,
//! and the cubic is its first term. Nonlinearity in data sheets is a part of the combined error of
//! VDI/VDE 2638, and ISO 376 interpolates the reading of a transducer by a cubic. A gain error is
//! not an effect, because it is equivalent to a change of the force parameters of the law.
//!
//! The effect acts on the force that the cell carries. The filter (`sensor_lag`), a delayed
//! channel, and the zero and drift of the electronics follow and are linear.
//!
//! The reading never decreases with the force. For negative c, the characteristic is constant
//! beyond its maximum at `1/sqrt(-3 c)`, far outside the range in which the equation is valid.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Signal, Stage};
use crate::described::described;
use crate::motion::Motion;
use crate::real::Real;

/// Largest relative error of a reading, a limit that keeps the reading finite.
const MOST: f64 = 1e6;

/// Load cell whose characteristic has a cubic term.
#[derive(Clone, Copy, Debug)]
pub struct SensorNonlinearity<T> {
    cubic_1_n2: T,
}

impl<T: Real> SensorNonlinearity<T> {
    #[inline(always)]
    fn reading_n(&self, force_n: T) -> T {
        // The force is not squared: the square of a large force overflows single precision.
        let share = self.cubic_1_n2 * force_n * force_n;
        if share.value() < -1.0 / 3.0 {
            let turning_n = (T::ONE / self.cubic_1_n2.times(-3.0)).sqrt();
            return force_n.sign() * turning_n.times(2.0 / 3.0);
        }
        force_n + force_n * share.min(T::of(MOST))
    }
}

described! {
    named_effect SensorNonlinearity = Info::new::<T, Self>("sensor_nonlinearity", Stage::Instrument)
        .summary("nonlinear load cell: it reads large forces too large or too small")
        .equation("r = F + c F^3")
        .source("VDI/VDE 2638 (linearity error); ISO 376 (interpolation by a cubic)")
        .limits(
            "odd: equal in tension and compression; constant beyond 1/sqrt(-3c) for negative \
             c; a gain error belongs to the law",
        );
    c = "c", "1/N^2", "error of the reading per cube of the force",
        [-1e6, 1e6], [1e-4] null(0.0);
}

impl<T: Real> SensorNonlinearity<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { cubic_1_n2: p.c }
    }
}

impl<T: Real> Effect<T> for SensorNonlinearity<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    fn first_reading(&self, _state: &mut (), force_n: &mut T) {
        *force_n = self.reading_n(*force_n);
    }

    #[inline(always)]
    fn reading(&self, _state: &mut (), signal: &mut Signal<T>, _time_s: T, _dt_s: T) {
        *signal = Signal {
            begin_n: self.reading_n(signal.begin_n),
            end_n: self.reading_n(signal.end_n),
            now_n: self.reading_n(signal.now_n),
        };
    }
}
