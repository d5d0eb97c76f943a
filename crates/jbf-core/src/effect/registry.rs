//! The macro behind the signal chain: from the list of effects in `effect/mod.rs` it makes
//! the modules, the catalogue, and the functions that run each stage in its fixed order.

macro_rules! signal_chain {
    (
        drive: [$($drive:ident::$Drive:ident),* $(,)?],
        lubricant: [$($lubricant:ident::$Lubricant:ident),* $(,)?],
        film: [$($film:ident::$Film:ident),* $(,)?],
        contact: [$($contact:ident::$Contact:ident),* $(,)?],
        bristle: [$($bristle:ident::$Bristle:ident),* $(,)?],
        other: [$($other:ident::$Other:ident),* $(,)?],
        instrument: [$($instrument:ident::$Instrument:ident),* $(,)?],
    ) => {
        $crate::effect::registry::signal_chain!(@types
            $($drive::$Drive,)* $($lubricant::$Lubricant,)* $($film::$Film,)* $($contact::$Contact,)*
            $($bristle::$Bristle,)* $($other::$Other,)* $($instrument::$Instrument,)*);

        impl<T: Real> Effects<T> {
            /// The journal's motion at the end of the step.
            #[inline(always)]
            pub(crate) fn drive(
                &self,
                states: &mut States<T>,
                from: &Motion<T>,
                to: &Motion<T>,
                resistance: &Resistance<T>,
                rig: &Rig<T>,
                dt_s: T,
            ) -> JournalMotion<T> {
                $(if let Some(e) = &self.$drive {
                    if let Some(s) = &mut states.$drive {
                        return e.step(s, from, to, resistance, rig, dt_s);
                    }
                })*
                JournalMotion::from(to)
            }

            /// What a soft drive hands on to the commanded side, N a bearing.
            pub(crate) fn transmitted_n(
                &self,
                states: &States<T>,
                motion: &Motion<T>,
                rig: &Rig<T>,
            ) -> Option<T> {
                $(if let (Some(e), Some(s)) = (&self.$drive, &states.$drive) {
                    return Some(e.transmitted_n(s, motion, rig));
                })*
                None
            }

            /// Factor on the speed that the film feels.
            #[inline(always)]
            pub(crate) fn lubricant(&self, states: &States<T>, journal: &JournalMotion<T>) -> T {
                let mut factor = T::ONE;
                $(if let (Some(e), Some(s)) = (&self.$lubricant, &states.$lubricant) {
                    factor *= e.factor(s, journal);
                })*
                factor
            }

            /// Factor on the film's clock.
            #[inline(always)]
            pub(crate) fn film_rate(&self, states: &States<T>) -> T {
                let mut rate = T::ONE;
                $(if let (Some(e), Some(s)) = (&self.$film, &states.$film) {
                    rate *= e.rate(s);
                })*
                rate
            }

            /// The same factor where it makes the film faster, else one.
            pub(crate) fn fastest_film(&self) -> f64 {
                let mut rate = 1.0_f64;
                $(if let Some(e) = &self.$film {
                    rate *= e.fastest();
                })*
                rate
            }

            /// Let the lubricant take the friction power of the step.
            #[inline(always)]
            pub(crate) fn warm(&self, states: &mut States<T>, power_w: [T; 2], dt_s: T) {
                $(if let (Some(e), Some(s)) = (&self.$lubricant, &mut states.$lubricant) {
                    e.step(s, power_w, dt_s);
                })*
            }

            /// Sliding friction between the surfaces.
            #[inline(always)]
            pub(crate) fn contact(
                &self,
                states: &mut States<T>,
                from: &JournalMotion<T>,
                to: &JournalMotion<T>,
                sliding: &mut Sliding<T>,
                dt_s: T,
            ) {
                $(if let (Some(e), Some(s)) = (&self.$contact, &mut states.$contact) {
                    e.step(s, from, to, dt_s);
                    e.apply(s, to, sliding);
                })*
            }

            /// The contact's coefficient, signed, through the bristle where there is one.
            #[inline(always)]
            pub(crate) fn bristle(
                &self,
                states: &mut States<T>,
                from: &JournalMotion<T>,
                to: &JournalMotion<T>,
                magnitude: [T; 2],
                dt_s: T,
            ) -> Option<T> {
                $(if let (Some(e), Some(s)) = (&self.$bristle, &mut states.$bristle) {
                    return Some(if dt_s > T::ZERO {
                        e.step(s, from, to, magnitude, dt_s)
                    } else {
                        e.first(s, to, magnitude[1])
                    });
                })*
                None
            }

            /// Forces beside the bearing's: the level that takes the motion's sign, and the rest.
            #[inline(always)]
            pub(crate) fn other(
                &self,
                states: &States<T>,
                journal: &JournalMotion<T>,
            ) -> (T, T) {
                let (mut level_n, mut smooth_n) = (T::ZERO, T::ZERO);
                $(if let (Some(e), Some(s)) = (&self.$other, &states.$other) {
                    level_n += e.level_n();
                    smooth_n += e.smooth_n(s, journal);
                })*
                (level_n, smooth_n)
            }

            /// The first reading of a run.
            pub(crate) fn first_reading(&self, states: &mut States<T>, force_n: T) -> T {
                let mut reading = force_n;
                $(if let (Some(e), Some(s)) = (&self.$instrument, &mut states.$instrument) {
                    reading = e.first(s, reading);
                })*
                reading
            }

            /// The reading at the end of the step.
            #[inline(always)]
            pub(crate) fn reading(
                &self,
                states: &mut States<T>,
                force: Signal<T>,
                time_s: T,
                dt_s: T,
            ) -> T {
                let mut signal = force;
                $(if let (Some(e), Some(s)) = (&self.$instrument, &mut states.$instrument) {
                    signal = e.step(s, signal, time_s, dt_s);
                })*
                signal.now_n
            }
        }
    };
    (@types $($module:ident::$Type:ident,)*) => {
        $(pub mod $module;)*

        /// Any subset of the catalogue.
        #[derive(Clone, Copy, Debug)]
        pub struct Effects<T: Real> {
            $(pub(crate) $module: Option<$module::$Type<T>>,)*
        }

        /// The states of that subset.
        #[derive(Clone, Copy, Debug)]
        pub struct States<T: Real> {
            $(pub(crate) $module: Option<<$module::$Type<T> as Effect<T>>::State>,)*
        }

        /// Every effect, in the order of the signal chain.
        pub const CATALOGUE: &[Info] = &[$(<$module::$Type<f64> as Effect<f64>>::INFO,)*];

        impl<T: Real> Effects<T> {
            /// No effect at all: the bare law.
            pub const NONE: Self = Self { $($module: None,)* };

            /// Add (or replace) the effect of that name, or take it out where its
            /// parameters stand at an infinite null.
            ///
            /// # Errors
            /// Names the parameter that breaks its rule; an unknown name is reported as
            /// the parameter `effect`.
            pub fn set(&mut self, name: &str, parameters: &[T]) -> Result<(), ParameterError> {
                match name {
                    $(stringify!($module) => {
                        let info = <$module::$Type<T> as Effect<T>>::INFO;
                        info.check(parameters)?;
                        self.$module = if info.absent(parameters) {
                            None
                        } else {
                            Some(<$module::$Type<T> as Effect<T>>::new(parameters)?)
                        };
                        Ok(())
                    })*
                    _ => Err(ParameterError {
                        name: "effect",
                        value: f64::NAN,
                        rule: "is not in the catalogue",
                    }),
                }
            }

            /// The longest inner step that suits every effect here, s.
            pub fn longest_step_s(&self) -> f64 {
                let mut longest = f64::INFINITY;
                $(if self.$module.is_some() {
                    longest = longest.min(<$module::$Type<T> as Effect<T>>::INFO.longest_step_s);
                })*
                longest
            }

            /// States at the start of a run.
            pub(crate) fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> States<T> {
                States {
                    $($module: self.$module.as_ref().map(|e| e.start(motion, rig)),)*
                }
            }
        }
    };
}

pub(crate) use signal_chain;
