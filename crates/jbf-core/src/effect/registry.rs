//! Macro that generates the types of the catalogue of effects, and the look-up of an effect by
//! name.
//!
//! The list in `catalogue.rs` is its input. The macro generates two structs with one field per
//! stage: the selected effects, and their states.

use super::place::Place;
use super::EffectSet;
use crate::error::ParameterError;
use crate::real::Real;

/// Optional effects of one stage of the catalogue, as nested pairs.
pub(crate) trait Shelf<T: Real>: EffectSet<T> {
    /// Stage without effects.
    const EMPTY: Self;

    /// Returns true if no effect of the stage is selected.
    fn is_empty(&self) -> bool;

    /// Selects the effect `name` with these parameters, or removes it if a parameter has its null
    /// value and this is infinite.
    ///
    /// Returns `None` if the stage has no effect with this name.
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

/// Defines the type that implements [`Shelf`] for the effects of one stage, in their order.
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
        /// Types of the effects of each stage; each type has the name of its stage.
        #[allow(non_camel_case_types)]
        mod line {
            $(pub(crate) type $stage<T> = $crate::effect::registry::shelf!(T $Place: $($module::$Type),*);)*
        }

        /// Effects selected from the catalogue by name at run time.
        ///
        /// The type reserves memory for every effect. A [typed set](super::set) reserves memory
        /// only for its members.
        #[derive(Clone, Copy, Debug)]
        pub struct Effects<T: Real> {
            $($stage: line::$stage<T>,)*
        }

        /// States of the selected effects.
        #[derive(Clone, Copy, Debug)]
        pub struct States<T: Real> {
            $($stage: <line::$stage<T> as EffectSet<T>>::State,)*
        }

        /// Stages of the signal chain at which an effect is selected.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct OccupiedStages {
            $(
                #[doc = concat!("True where the stage `", stringify!($stage), "` has an effect.")]
                pub $stage: bool,
            )*
        }

        /// Descriptions of all effects, in the order of the signal chain.
        pub const CATALOGUE: &[Info] = &[
            $($(<$Place<$module::$Type<f64>> as Place<f64>>::INFO,)*)*
        ];

        /// Returns true if a parameter of the effect changes the instants at which friction jumps;
        /// see [`Effect::MOVES_JUMPS`].
        pub fn moves_jumps(name: &str) -> bool {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::MOVES_JUMPS,)*)*
                _ => false,
            }
        }

        /// Returns true if the predicted force depends on a jump for longer than the step of the
        /// jump; see [`Effect::SPREADS_JUMPS`].
        pub fn spreads_jumps(name: &str) -> bool {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::SPREADS_JUMPS,)*)*
                _ => false,
            }
        }

        /// Returns the parameter of the effect along which the likelihood may have several maxima;
        /// see [`Effect::PEAKS`].
        pub fn peaks(name: &str) -> Option<&'static str> {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::PEAKS,)*)*
                _ => None,
            }
        }

        /// Returns the Rust types of the effect `name`: `PLACE` and `TYPE` in `effect::PLACE` and
        /// `effect::NAME::TYPE`.
        pub fn type_names(name: &str) -> Option<(&'static str, &'static str)> {
            match name {
                $($(stringify!($module) => Some((stringify!($Place), stringify!($Type))),)*)*
                _ => None,
            }
        }

        impl<T: Real> Effects<T> {
            /// No effect: the base law.
            pub const NONE: Self = Self { $($stage: Shelf::EMPTY,)* };

            /// Returns the stages at which an effect is selected.
            pub fn occupied_stages(&self) -> OccupiedStages {
                OccupiedStages { $($stage: !self.$stage.is_empty(),)* }
            }

            /// Adds or replaces the effect `name`.
            ///
            /// The effect is removed instead if the null value of a parameter is infinite and the
            /// parameter has this value.
            ///
            /// # Errors
            /// Reports the parameter that violates its rule, or an unknown name.
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
