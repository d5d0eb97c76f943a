//! The macro behind the catalogue of effects, and what its lists are made of. From the list in
//! `catalogue.rs` it makes the two structs with a field a stage, and what is looked up by name.

use super::place::Place;
use super::EffectSet;
use crate::error::ParameterError;
use crate::real::Real;

/// The effects of one stage of the catalogue, each there or not.
pub(crate) trait Shelf<T: Real>: EffectSet<T> {
    /// None of them is there.
    const EMPTY: Self;

    /// True if no effect of this stage is set.
    fn is_empty(&self) -> bool;

    /// Put the effect of that name here, or take it out where its parameters stand at an infinite
    /// null; nothing where this shelf has no effect of that name.
    fn set(&mut self, name: &str, parameters: &[T]) -> Option<Result<(), ParameterError>>;
}

impl<T: Real> Shelf<T> for () {
    const EMPTY: Self = ();

    fn is_empty(&self) -> bool {
        true
    }

    fn set(&mut self, _name: &str, _parameters: &[T]) -> Option<Result<(), ParameterError>> {
        None
    }
}

impl<T: Real, P: Place<T>, S: Shelf<T>> Shelf<T> for (Option<P>, S) {
    const EMPTY: Self = (None, S::EMPTY);

    fn is_empty(&self) -> bool {
        self.0.is_none() && self.1.is_empty()
    }

    fn set(&mut self, name: &str, parameters: &[T]) -> Option<Result<(), ParameterError>> {
        if name != P::INFO.name {
            return self.1.set(name, parameters);
        }
        Some(P::INFO.check(parameters).and_then(|()| {
            self.0 = if P::INFO.absent(parameters) {
                None
            } else {
                Some(P::new(parameters)?)
            };
            Ok(())
        }))
    }
}

/// The type of a stage's [`Shelf`]: its effects from left to right.
macro_rules! shelf {
    ($T:ident $Place:ident:) => { () };
    ($T:ident $Place:ident: $module:ident::$Type:ident $(, $more:ident::$More:ident)*) => {
        (
            Option<$crate::effect::$Place<$crate::effect::$module::$Type<$T>>>,
            $crate::effect::registry::shelf!($T $Place: $($more::$More),*),
        )
    };
}

macro_rules! signal_chain {
    ($($stage:ident: $Place:ident [$($module:ident::$Type:ident),* $(,)?],)*) => {
        /// The type of each stage's shelf, under the stage's name.
        #[allow(non_camel_case_types)]
        mod line {
            $(pub(crate) type $stage<T> = $crate::effect::registry::shelf!(T $Place: $($module::$Type),*);)*
        }

        /// Any subset of the catalogue, chosen by name while a program runs: it keeps room for
        /// every effect. A [typed set](super::set) keeps room for what is in it.
        #[derive(Clone, Copy, Debug)]
        pub struct Effects<T: Real> {
            $($stage: line::$stage<T>,)*
        }

        /// The states of that subset.
        #[derive(Clone, Copy, Debug)]
        pub struct States<T: Real> {
            $($stage: <line::$stage<T> as EffectSet<T>>::State,)*
        }

        /// The stages of the signal chain in which a subset has an effect.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct OccupiedStages {
            $(
                #[doc = concat!("True where the stage `", stringify!($stage), "` has an effect.")]
                pub $stage: bool,
            )*
        }

        /// Every effect, in the order of the signal chain.
        pub const CATALOGUE: &[Info] = &[
            $($(<$Place<$module::$Type<f64>> as Place<f64>>::INFO,)*)*
        ];

        /// True where a parameter of the effect of that name moves the instants at which
        /// friction jumps; see [`Effect::MOVES_JUMPS`].
        pub fn moves_jumps(name: &str) -> bool {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::MOVES_JUMPS,)*)*
                _ => false,
            }
        }

        /// True where an error in the instant of a jump is read for long; see
        /// [`Effect::SPREADS_JUMPS`].
        pub fn spreads_jumps(name: &str) -> bool {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::SPREADS_JUMPS,)*)*
                _ => false,
            }
        }

        /// The parameter of the effect of that name along which likelihoods have many peaks; see
        /// [`Effect::PEAKS`].
        pub fn peaks(name: &str) -> Option<&'static str> {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::PEAKS,)*)*
                _ => None,
            }
        }

        /// The Rust types of the effect of that name, as `effect::PLACE` and `effect::NAME::TYPE`
        /// have them.
        pub fn type_names(name: &str) -> Option<(&'static str, &'static str)> {
            match name {
                $($(stringify!($module) => Some((stringify!($Place), stringify!($Type))),)*)*
                _ => None,
            }
        }

        impl<T: Real> Effects<T> {
            /// No effect at all: the bare law.
            pub const NONE: Self = Self { $($stage: Shelf::EMPTY,)* };

            /// The stages that have an effect.
            pub fn occupied_stages(&self) -> OccupiedStages {
                OccupiedStages { $($stage: !self.$stage.is_empty(),)* }
            }

            /// Add (or replace) the effect of that name, or take it out where its
            /// parameters stand at an infinite null.
            ///
            /// # Errors
            /// Names the parameter that breaks its rule, or says that there is no such effect.
            pub fn set(&mut self, name: &str, parameters: &[T]) -> Result<(), ParameterError> {
                $(if let Some(done) = self.$stage.set(name, parameters) {
                    return done;
                })*
                Err(ParameterError::UnknownEffect)
            }
        }
    };
}

pub(crate) use {shelf, signal_chain};
