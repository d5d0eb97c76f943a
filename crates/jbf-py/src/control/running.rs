//! Control loop with any compensator and any number type.

use super::settings::LoopSpec;
use jbf_core::compensator::Compensator;
use jbf_core::controller::{Controller, Signals, State};
use jbf_core::reference::Target;
use jbf_core::Real;
use pyo3::prelude::*;

/// Control loop in the course of a run, with any compensator and any number type.
pub trait Stepping: Send {
    /// Computes one step of the loop, with input and output in double precision.
    fn step(&mut self, counter: u32, target: Target<f64>) -> Signals<f64>;
}

struct Running<T: Real, C: Compensator<T>> {
    controller: Controller<T, C>,
    state: State<T, C::State>,
}

impl<T: Real, C: Compensator<T> + Send> Stepping for Running<T, C>
where
    C::State: Send,
{
    fn step(&mut self, counter: u32, target: Target<f64>) -> Signals<f64> {
        let target = Target {
            value: T::of(target.value),
            rate: T::of(target.rate),
        };
        self.controller
            .step(&mut self.state, counter, &target)
            .cast()
    }
}

/// Creates the control loop of `settings` with a compensator, in its initial state.
pub fn boxed<T: Real, C>(settings: &LoopSpec, compensator: C) -> PyResult<Box<dyn Stepping>>
where
    C: Compensator<T> + Send + 'static,
    C::State: Send + 'static,
{
    let controller = settings.round(compensator)?;
    let state = controller.start();
    Ok(Box::new(Running { controller, state }))
}
