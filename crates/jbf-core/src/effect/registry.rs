//! The macro behind the signal chain: from the list of effects in `effect/mod.rs` it makes
//! the modules, the catalogue, and the functions that run each stage in its fixed order.

macro_rules! signal_chain {
    (
        drive: [$($drive:ident::$Drive:ident),* $(,)?],
        lubricant: [$($lubricant:ident::$Lubricant:ident),* $(,)?],
        load: [$($load:ident::$Load:ident),* $(,)?],
        film: [$($film:ident::$Film:ident),* $(,)?],
        contact: [$($contact:ident::$Contact:ident),* $(,)?],
        bristle: [$($bristle:ident::$Bristle:ident),* $(,)?],
        other: [$($other:ident::$Other:ident),* $(,)?],
        instrument: [$($instrument:ident::$Instrument:ident),* $(,)?],
    ) => {
        $crate::effect::registry::signal_chain!(@types
            $($drive::$Drive,)* $($lubricant::$Lubricant,)* $($load::$Load,)* $($film::$Film,)* $($contact::$Contact,)*
            $($bristle::$Bristle,)* $($other::$Other,)* $($instrument::$Instrument,)*);

        impl<T: Real, O: Own<T>> Effects<T, O> {
            /// The journal's motion at the end of the step.
            #[inline(always)]
            pub(crate) fn drive(
                &self,
                states: &mut States<T, O>,
                to: &Motion<T>,
                resistance: &[Resistance<T>; 2],
                rig: &Rig<T>,
                dt_s: T,
            ) -> JournalMotion<T> {
                let mut journal = JournalMotion::from(to);
                $(if let (Some(e), Some(s)) = (&self.$drive, &mut states.$drive) {
                    journal = e.step(s, &journal, resistance, rig, dt_s);
                })*
                journal
            }

            /// The law's parameters under a load of `share` times the rig's; none where they
            /// stay as they are.
            #[inline(always)]
            pub(crate) fn scales(
                &self,
                states: &mut States<T, O>,
                share: impl Fn() -> T,
            ) -> Option<Scales<T>> {
                let mut found = None;
                $(if let (Some(e), Some(s)) = (&self.$load, &mut states.$load) {
                    let own = e.scales(s, share());
                    let before = found.unwrap_or(Scales {
                        transition_speed: T::ONE,
                        stiffness: T::ONE,
                    });
                    found = Some(Scales {
                        transition_speed: before.transition_speed * own.transition_speed,
                        stiffness: before.stiffness * own.stiffness,
                    });
                })*
                found
            }

            /// What a soft drive hands on to the commanded side, N a bearing.
            pub(crate) fn transmitted_n(
                &self,
                states: &States<T, O>,
                motion: &Motion<T>,
                rig: &Rig<T>,
            ) -> Option<T> {
                $(if let (Some(e), Some(s)) = (&self.$drive, &states.$drive) {
                    let force_n = e.transmitted_n(s, motion, rig);
                    if force_n.is_some() {
                        return force_n;
                    }
                })*
                None
            }

            /// True where the journal may part from the commanded side.
            pub(crate) fn has_drive(&self) -> bool {
                false $(|| self.$drive.is_some())*
            }

            /// Factor on the speed that the film feels.
            #[inline(always)]
            pub(crate) fn lubricant(&self, states: &States<T, O>, journal: &JournalMotion<T>) -> T {
                let mut factor = T::ONE;
                $(if let (Some(e), Some(s)) = (&self.$lubricant, &states.$lubricant) {
                    factor *= e.factor(s, journal);
                })*
                factor
            }

            /// Factor on the film's clock.
            #[inline(always)]
            pub(crate) fn film_rate(&self, states: &States<T, O>) -> T {
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
            pub(crate) fn warm(&self, states: &mut States<T, O>, power_w: [T; 2], dt_s: T) {
                $(if let (Some(e), Some(s)) = (&self.$lubricant, &mut states.$lubricant) {
                    e.step(s, power_w, dt_s);
                })*
            }

            /// Sliding friction between the surfaces.
            #[inline(always)]
            pub(crate) fn contact(
                &self,
                states: &mut States<T, O>,
                from: &JournalMotion<T>,
                to: &JournalMotion<T>,
                sliding: &mut Sliding<T>,
                dt_s: T,
            ) {
                $(if let (Some(e), Some(s)) = (&self.$contact, &mut states.$contact) {
                    e.step(s, from, to, dt_s);
                    e.apply(s, to, sliding);
                })*
                self.own.contact(&mut states.own, from, to, sliding, dt_s);
            }

            /// The contact's coefficient, signed, through the bristle where there is one.
            #[inline(always)]
            pub(crate) fn bristle(
                &self,
                states: &mut States<T, O>,
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
                states: &States<T, O>,
                journal: &JournalMotion<T>,
            ) -> (T, T) {
                let (mut level_n, mut smooth_n) = self.own.other(&states.own, journal);
                $(if let (Some(e), Some(s)) = (&self.$other, &states.$other) {
                    level_n += e.level_n();
                    smooth_n += e.smooth_n(s, journal);
                })*
                (level_n, smooth_n)
            }

            /// The first reading of a run.
            pub(crate) fn first_reading(&self, states: &mut States<T, O>, force_n: T) -> T {
                let mut reading = force_n;
                $(if let (Some(e), Some(s)) = (&self.$instrument, &mut states.$instrument) {
                    reading = e.first(s, reading);
                })*
                self.own.first(&mut states.own, reading)
            }

            /// The reading at the end of the step.
            #[inline(always)]
            pub(crate) fn reading(
                &self,
                states: &mut States<T, O>,
                force: Signal<T>,
                time_s: T,
                dt_s: T,
            ) -> T {
                let mut signal = force;
                $(if let (Some(e), Some(s)) = (&self.$instrument, &mut states.$instrument) {
                    signal = e.step(s, signal, time_s, dt_s);
                })*
                self.own.step(&mut states.own, signal, time_s, dt_s).now_n
            }
        }
    };
    (@types $($module:ident::$Type:ident,)*) => {
        $(pub mod $module;)*

        /// Any subset of the catalogue, and an effect of one's own beside it.
        #[derive(Clone, Copy, Debug)]
        pub struct Effects<T: Real, O: Own<T> = Nothing> {
            $(pub(crate) $module: Option<$module::$Type<T>>,)*
            own: O,
        }

        /// The states of that subset.
        #[derive(Clone, Copy, Debug)]
        pub struct States<T: Real, O: Own<T> = Nothing> {
            $(pub(crate) $module: Option<<$module::$Type<T> as Effect<T>>::State>,)*
            own: O::State,
        }

        /// Every effect, in the order of the signal chain.
        pub const CATALOGUE: &[Info] = &[$(<$module::$Type<f64> as Effect<f64>>::INFO,)*];

        /// True where a parameter of the effect of that name moves the instants at which
        /// friction jumps; see [`Effect::MOVES_JUMPS`].
        pub fn moves_jumps(name: &str) -> bool {
            match name {
                $(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::MOVES_JUMPS,)*
                _ => false,
            }
        }

        /// The parameter of the effect of that name along which likelihoods have many peaks; see
        /// [`Effect::PEAKS`].
        pub fn peaks(name: &str) -> Option<&'static str> {
            match name {
                $(stringify!($module) => <$module::$Type<f64> as Effect<f64>>::PEAKS,)*
                _ => None,
            }
        }

        impl<T: Real> Effects<T> {
            /// No effect at all: the bare law.
            pub const NONE: Self = Self { $($module: None,)* own: Nothing };

            /// The same effects with one's own beside them; see [`own`].
            pub fn with<O: Own<T>>(self, own: O) -> Effects<T, O> {
                Effects { $($module: self.$module,)* own }
            }
        }

        impl<T: Real, O: Own<T>> Effects<T, O> {

            /// Add (or replace) the effect of that name, or take it out where its
            /// parameters stand at an infinite null.
            ///
            /// # Errors
            /// Names the parameter that breaks its rule, or says that there is no such effect.
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
                    _ => Err(ParameterError::UnknownEffect),
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
            pub(crate) fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> States<T, O> {
                States {
                    $($module: self.$module.as_ref().map(|e| e.start(motion, rig)),)*
                    own: self.own.start(motion, rig),
                }
            }
        }
    };
}

pub(crate) use signal_chain;
