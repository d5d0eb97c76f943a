//! Macro that generates the catalogue of effects, and its types.
//!
//! From the list in `catalogue.rs` it generates the two structs with one field per stage, and the
//! look-up by name.

use super::place::Place;
use super::EffectSet;
use crate::error::ParameterError;
use crate::real::Real;

/// Effects of one stage of the catalogue, each optional.
pub(crate) trait Shelf<T: Real>: EffectSet<T> {
    /// Value without any effect.
    const EMPTY: Self;

    /// True if no effect of this stage is set.
    fn is_empty(&self) -> bool;

    /// Sets the effect of that name, or removes it if a parameter equals its null and is infinite.
    ///
    /// Returns `None` if this stage has no effect of that name.
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

/// Type of a stage's [`Shelf`]: its effects from left to right.
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
        /// Type of the shelf of each stage, under the name of the stage.
        #[allow(non_camel_case_types)]
        mod line {
            $(pub(crate) type $stage<T> = $crate::effect::registry::shelf!(T $Place: $($module::$Type),*);)*
        }

        /// Any subset of the catalogue, selected by name at run time.
        ///
        /// It reserves memory for every effect. A [typed set](super::set) reserves memory only for
        /// its members.
        #[derive(Clone, Copy, Debug)]
        pub struct Effects<T: Real> {
            $($stage: line::$stage<T>,)*
        }

        /// States of the subset.
        #[derive(Clone, Copy, Debug)]
        pub struct States<T: Real> {
            $($stage: <line::$stage<T> as EffectSet<T>>::State,)*
        }

        /// Stages of the signal chain in which a subset has an effect.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct OccupiedStages {
            $(
                #[doc = concat!("True where the stage `", stringify!($stage), "` has an effect.")]
                pub $stage: bool,
            )*
        }

        /// All effects, in the order of the signal chain.
        pub const CATALOGUE: &[Info] = &[
            $($(<$Place<$module::$Type<f64>> as Place<f64>>::INFO,)*)*
        ];

        /// True if a parameter of the effect of that name moves the instants at which friction
        /// jumps; see [`Effect::MOVES_JUMPS`].
        pub fn moves_jumps(name: &str) -> bool {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::MOVES_JUMPS,)*)*
                _ => false,
            }
        }

        /// True if an error in the instant of a jump affects the readings for a long time; see
        /// [`Effect::SPREADS_JUMPS`].
        pub fn spreads_jumps(name: &str) -> bool {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::SPREADS_JUMPS,)*)*
                _ => false,
            }
        }

        /// Parameter of the effect of that name along which likelihoods have several peaks; see
        /// [`Effect::PEAKS`].
        pub fn peaks(name: &str) -> Option<&'static str> {
            match name {
                $($(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::PEAKS,)*)*
                _ => None,
            }
        }

        /// Rust types of the effect of that name, as in `effect::PLACE` and `effect::NAME::TYPE`.
        pub fn type_names(name: &str) -> Option<(&'static str, &'static str)> {
            match name {
                $($(stringify!($module) => Some((stringify!($Place), stringify!($Type))),)*)*
                _ => None,
            }
        }

        impl<T: Real> Effects<T> {
            /// No effects: the base law.
            pub const NONE: Self = Self { $($stage: Shelf::EMPTY,)* };

            /// Stages that have an effect.
            pub fn occupied_stages(&self) -> OccupiedStages {
                OccupiedStages { $($stage: !self.$stage.is_empty(),)* }
            }

            /// Adds or replaces the effect of that name.
            ///
            /// If the null of a parameter is infinite and the parameter equals it, the effect is
            /// removed instead.
            ///
            /// # Errors
            /// Names the parameter that violates its rule, or reports that there is no such effect.
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
