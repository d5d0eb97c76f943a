//! `F + c F^3`: a load cell whose line bends.
//!
//! Of a cell that is alike in pull and push the error is odd, and the cubic is its first term: what
//! data sheets call nonlinearity (the combined error of VDI/VDE 2638 has it as a part; ISO 376
//! interpolates a transducer's reading by a cubic). A gain that is off is no effect: every force
//! parameter of the law says it.
//!
//! It acts on the force that the cell carries, before anything that the amplifier adds: its filter
//! (`sensor_lag`), a late channel, a zero and a drift of the electronics are read straight.
//!
//! A cell never reads less under more. Where c is negative the line is level from its turning point
//! `1/sqrt(-3 c)` on, far beyond where the form holds.

use super::{Effect, Info, Instrument, Parameter, Rig, Signal, Stage};
use crate::error::ParameterError;
use crate::motion::Motion;
use crate::page::Start;
use crate::real::Real;

/// The share by which a reading may be too large: so that it stays finite.
const MOST: f64 = 1e6;

/// A load cell with a cubic term.
#[derive(Clone, Copy, Debug)]
pub struct SensorNonlinearity<T> {
    cubic_1_n2: T,
}

impl<T: Real> SensorNonlinearity<T> {
    #[inline(always)]
    fn reading_n(&self, force_n: T) -> T {
        // No force squared: that of a large one is out of single precision's reach.
        let share = self.cubic_1_n2 * force_n * force_n;
        if share.value() < -1.0 / 3.0 {
            let turning_n = (T::ONE / self.cubic_1_n2.times(-3.0)).sqrt();
            return force_n.sign() * turning_n.times(2.0 / 3.0);
        }
        force_n + force_n * share.min(T::of(MOST))
    }
}

impl<T: Real> Effect<T> for SensorNonlinearity<T> {
    const INFO: Info = Info::new("sensor_nonlinearity", Stage::Instrument)
        .summary("the load cell's line bends: it reads large forces too large or too small")
        .equation("r = F + c F^3")
        .source("VDI/VDE 2638 (linearity error); ISO 376 (interpolation by a cubic)")
        .limits(
            "odd: the same in pull and push; of a negative c level beyond 1/sqrt(-3c); a gain that \
                 is off is the law's",
        )
        .parameters(&[Parameter::new(
            "c_1_n2",
            "1/N^2",
            "error of the reading over the cube of the force",
            [-1e6, 1e6],
            &[1e-4],
        )
        .null(0.0)
        .start(Start::CellCubic)]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            cubic_1_n2: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Instrument<T> for SensorNonlinearity<T> {
    fn first(&self, _state: &mut (), force_n: T) -> T {
        self.reading_n(force_n)
    }

    #[inline(always)]
    fn step(&self, _state: &mut (), signal: Signal<T>, _time_s: T, _dt_s: T) -> Signal<T> {
        Signal {
            begin_n: self.reading_n(signal.begin_n),
            end_n: self.reading_n(signal.end_n),
            now_n: self.reading_n(signal.now_n),
        }
    }
}
