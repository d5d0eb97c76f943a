//! Macro that generates the types of the catalogue of effects, and the look-up of an effect by
//! name.
//!
//! The list in `catalogue.rs` is its input. The macro generates two structs with one field per
//! stage: the selected effects, and their states.

use super::{Effect, Named};
use crate::error::Error;
use crate::real::Real;

/// Implements [`Named`] for an effect with `Parameters`.
macro_rules! named_effect {
    ($Owner:ident $info:expr) => {
        impl<T: $crate::real::Real> $crate::effect::Named<T> for $Owner<T> {
            const INFO: $crate::effect::Info =
                $info.rust_type(stringify!($Owner)).parameters(PARAMETERS);

            fn build(values: &[T]) -> Result<Self, $crate::error::Error> {
                Parameters::of(values).map(Self::with_parameters)
            }
        }
    };
}

/// Optional effects of one stage of the catalogue, as nested pairs.
pub(crate) trait StageEffects<T: Real>: Effect<T> {
    /// Stage without effects.
    const EMPTY: Self;

    /// Returns true if no effect of the stage is selected.
    fn is_empty(&self) -> bool;

    /// Selects the effect `name` with these parameters, or removes it if a parameter has its null
    /// value and this is infinite.
    ///
    /// Returns `None` if the stage has no effect with this name.
    fn set(&mut self, name: &str, parameters: &[T]) -> Option<Result<(), Error>>;
}

impl<T: Real> StageEffects<T> for () {
    const EMPTY: Self = ();

    fn is_empty(&self) -> bool {
        true
    }

    fn set(&mut self, _name: &str, _parameters: &[T]) -> Option<Result<(), Error>> {
        None
    }
}

impl<T: Real, E: Named<T>, S: StageEffects<T>> StageEffects<T> for (Option<E>, S) {
    const EMPTY: Self = (None, S::EMPTY);

    fn is_empty(&self) -> bool {
        self.0.is_none() && self.1.is_empty()
    }

    fn set(&mut self, name: &str, parameters: &[T]) -> Option<Result<(), Error>> {
        if name != E::INFO.name {
            return self.1.set(name, parameters);
        }
        Some(E::INFO.check(parameters).and_then(|()| {
            self.0 = if E::INFO.absent(parameters) {
                None
            } else {
                Some(E::build(parameters)?)
            };
            Ok(())
        }))
    }
}

/// Defines the type that implements [`StageEffects`] for the effects of one stage, in their order.
macro_rules! stage_effects {
    ($T:ident:) => { () };
    ($T:ident: $module:ident::$Type:ident $(, $more:ident::$More:ident)*) => {
        (
            Option<$crate::effect::$module::$Type<$T>>,
            $crate::effect::registry::stage_effects!($T: $($more::$More),*),
        )
    };
}

macro_rules! signal_chain {
    ($($field:ident: $Stage:ident [$($module:ident::$Type:ident),* $(,)?],)*) => {
        /// Types of the effects of each stage; each type has the name of its stage.
        #[allow(non_camel_case_types)]
        mod stage_types {
            $(pub(crate) type $field<T> = $crate::effect::registry::stage_effects!(T: $($module::$Type),*);)*
        }

        /// Effects selected from the catalogue by name at run time.
        ///
        /// The type reserves memory for every effect. A [typed set](Effect) reserves memory only
        /// for its members.
        #[derive(Clone, Copy, Debug)]
        pub struct Effects<T: Real> {
            $($field: stage_types::$field<T>,)*
        }

        /// States of the selected effects.
        #[derive(Clone, Copy, Debug)]
        pub struct States<T: Real> {
            $($field: <stage_types::$field<T> as Effect<T>>::State,)*
        }

        /// Stages of the signal chain at which an effect is selected.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct OccupiedStages {
            $(
                #[doc = concat!("True where the stage `", stringify!($field), "` has an effect.")]
                pub $field: bool,
            )*
        }

        /// Descriptions of all effects, in the order of the signal chain.
        pub const CATALOGUE: &[Info] = &[
            $($({
                const INFO: Info = <$module::$Type<f64> as Named<f64>>::INFO;
                assert!(
                    matches!(INFO.stage, Stage::$Stage),
                    "the description of an effect has another stage than the catalogue"
                );
                INFO
            },)*)*
        ];

        impl<T: Real> Effects<T> {
            /// No effect: the base law.
            pub const NONE: Self = Self { $($field: StageEffects::EMPTY,)* };

            /// Returns the stages at which an effect is selected.
            #[doc(hidden)]
            pub fn occupied_stages(&self) -> OccupiedStages {
                OccupiedStages { $($field: !self.$field.is_empty(),)* }
            }

            /// Adds or replaces the effect `name`.
            ///
            /// The effect is removed instead if the null value of a parameter is infinite and the
            /// parameter has this value.
            ///
            /// # Errors
            /// Reports the parameter that violates its rule, or an unknown name.
            pub fn set(&mut self, name: &str, parameters: &[T]) -> Result<(), Error> {
                $(if let Some(done) = self.$field.set(name, parameters) {
                    return done;
                })*
                Err(Error::UnknownEffect)
            }
        }

        /// Effects of the catalogue as one set; each method calls only the effects of its stages.
        impl<T: Real> Effect<T> for Effects<T> {
            type State = States<T>;

            fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> States<T> {
                States { $($field: self.$field.start(motion, rig),)* }
            }
            forward_stages!(stages [$($field)*]);
        }
    };
}

pub(crate) use {named_effect, signal_chain, stage_effects};
