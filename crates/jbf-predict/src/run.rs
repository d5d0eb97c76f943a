//! Prediction along a record with a chain of any law.

use crate::model::FilmPath;
use crate::outlined::Outlined;
use jbf_batch::film_path::OnPath;
use jbf_batch::InstructionSet;
use jbf_catalogue::Using;
use jbf_core::effect::Effect;
use jbf_core::internals::{self, Steps};
use jbf_core::law::{Law, Named};
use jbf_core::run::Record;
use jbf_core::{Chain, Motion, Real};
use std::cell::RefCell;

/// Predicts the readings along a record: `sink` receives the index of each sample and its reading
/// (N).
pub struct Run<'a, T, I> {
    pub record: &'a Record<'a>,
    pub max_step_s: f64,
    /// Path of the film and the parameters of the law; `None` if the film must be integrated.
    pub path: Option<(FilmPath<'a>, &'a [T])>,
    pub instructions: I,
    pub sink: &'a mut dyn FnMut(usize, T),
}

impl<T: Real, I: InstructionSet> Run<'_, T, I> {
    /// Predicts with the code of all effects inlined: the fastest to run, and the slowest to
    /// compile.
    fn inlined<L: Law<T>, E: Effect<T>>(self, chain: &Chain<T, L, E>, steps: Steps) {
        self.instructions.call(
            #[inline(always)]
            || internals::predict_by(chain, self.record, self.max_step_s, steps, self.sink),
        );
    }

    /// Predicts with a function call per stage with effects; the code of these functions is common
    /// to all laws.
    fn with_calls<L: Law<T>>(self, chain: Chain<T, L>) {
        let Chain { law, effects, rig } = chain;
        // Placeholder until the start of the chain replaces it.
        let states = RefCell::new(effects.start(&Motion::at_rest(T::ONE), &rig));
        let effects = Outlined::new(&effects, &states, self.instructions);
        self.inlined(&Chain { law, effects, rig }, Steps::Every);
    }
}

impl<T: Real, I: InstructionSet> Using<T> for Run<'_, T, I> {
    type Output = ();

    fn with<L: Named<T>>(self, chain: Chain<T, L>) {
        // The constant avoids compiling the path for laws without a film.
        if const { L::FILM_PARAMETERS.is_none() } {
            return self.with_calls(chain);
        }
        let (Some((path, p)), Some([first, second])) = (self.path, L::FILM_PARAMETERS) else {
            return self.with_calls(chain);
        };
        // Hot path in the diagnosis of a bearing, therefore inlined.
        let law = OnPath::new(chain.law, [p[first], p[second]], path.places);
        let (law, steps) = if chain.effects.has_memory() {
            (law, Steps::Every)
        } else {
            (law.at(path.ends), Steps::Last)
        };
        let on_path = Chain {
            law,
            effects: chain.effects,
            rig: chain.rig,
        };
        self.inlined(&on_path, steps);
    }
}
