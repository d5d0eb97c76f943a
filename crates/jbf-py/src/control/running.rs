//! A loop of any compensator and any kind of number, behind one face.

use super::settings::LoopSpec;
use jbf_core::compensator::Compensator;
use jbf_core::controller::{Controller, Parts, State};
use jbf_core::reference::Target;
use jbf_core::Real;
use pyo3::prelude::*;

/// A loop that is being run.
pub trait Stepping: Send {
    /// One step, in double precision outside whatever it is inside.
    fn step(&mut self, counter: u32, target: Target<f64>) -> Parts<f64>;
}

struct Running<T: Real, C: Compensator<T>> {
    controller: Controller<T, C>,
    state: State<T, C::State>,
}

impl<T: Real, C: Compensator<T> + Send> Stepping for Running<T, C>
where
    C::State: Send,
{
    fn step(&mut self, counter: u32, target: Target<f64>) -> Parts<f64> {
        let target = Target {
            value: T::of(target.value),
            rate: T::of(target.rate),
        };
        self.controller
            .step(&mut self.state, counter, &target)
            .lift()
    }
}

/// The loop of `settings` round a compensator, at its start.
pub fn boxed<T: Real, C>(settings: &LoopSpec, compensator: C) -> PyResult<Box<dyn Stepping>>
where
    C: Compensator<T> + Send + 'static,
    C::State: Send + 'static,
{
    let controller = settings.round(compensator)?;
    let state = controller.start();
    Ok(Box::new(Running { controller, state }))
}
