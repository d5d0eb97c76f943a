//! Film memory: a factor on the rate of the film dynamics.
//!
//! The film follows the speed faster or more slowly than short-bearing theory predicts.
//!
//! Source: Cohn (1998): the bearing is of medium length (section 3.2), and the control programs use
//! a different time scale of the film (appendices D and E).

use super::{Effect, Film, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::motion::Motion;
use crate::real::Real;

/// Factor on the rate of the film dynamics.
#[derive(Clone, Copy, Debug)]
pub struct FilmMemory<T> {
    factor: T,
}

impl<T: Real> Effect<T> for FilmMemory<T> {
    const INFO: Info = Info::new("film_memory", Stage::Film)
        .summary("lubricant film that follows the speed more slowly (or faster) than in the law")
        .equation("d(eps, phi)/dt -> factor d(eps, phi)/dt")
        .source("Cohn 1998, section 3.2 and appendices D, E")
        .limits("one factor for squeeze and wedge; the steady state does not change")
        .parameters(&[Parameter::new(
            "factor",
            "-",
            "rate factor of the film",
            [1e-3, 1e3],
            &[0.5, 2.0],
        )
        .log()
        .null(1.0)])
        .needs(&[Need::Film]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            factor: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Film<T> for FilmMemory<T> {
    #[inline(always)]
    fn rate(&self, _state: &()) -> T {
        self.factor
    }
    #[inline(always)]
    fn fastest(&self) -> f64 {
        self.factor.value().max(1.0)
    }
}
