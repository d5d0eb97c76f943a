//! Catalogue of effects in the order in which the signal chain evaluates them.

use super::place::{
    AsBristle, Beside, InContact, InDrive, InFilm, InInstrument, InLubricant, InTransmission,
    Place, UnderLoad,
};
use super::registry::{signal_chain, Shelf};
use super::{
    backlash, cogging, cogging_2, coulomb_drag, direction_asymmetry, drive_compliance,
    dry_asymmetry, dry_load_dependence, dry_temperature_dependence, dwell_stiction, film_memory,
    gravity, inertia, load_dependence, pitch_ripple, pitch_ripple_2, position_ripple, presliding,
    quadratic_drag, running_in, sensor_drift, sensor_hysteresis, sensor_lag, sensor_nonlinearity,
    sensor_offset, shear_thinning, stribeck_asymmetry, stribeck_excess, stroke_dependence,
    thermal_thinning, time_delay, torque_proportional, viscous_asymmetry, viscous_load_dependence,
    viscous_temperature_dependence, viscous_thinning, vogel_viscosity, warm_up,
    zero_load_dependence,
};
use super::{Effect, EffectSet, Info, Resistance, Rig, Signal};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::page::{same, values_fit};
use crate::real::Real;

// Inside a stage, effects act from left to right.
signal_chain! {
    drive: InDrive [drive_compliance::DriveCompliance, backlash::Backlash],
    lubricant: InLubricant [
        shear_thinning::ShearThinning,
        thermal_thinning::ThermalThinning,
        vogel_viscosity::VogelViscosity,
    ],
    load: UnderLoad [load_dependence::LoadDependence],
    film: InFilm [film_memory::FilmMemory],
    contact: InContact [
        running_in::RunningIn,
        dwell_stiction::DwellStiction,
        stribeck_excess::StribeckExcess,
        dry_load_dependence::DryLoadDependence,
        viscous_load_dependence::ViscousLoadDependence,
        viscous_asymmetry::ViscousAsymmetry,
        dry_temperature_dependence::DryTemperatureDependence,
        viscous_temperature_dependence::ViscousTemperatureDependence,
        viscous_thinning::ViscousThinning,
        dry_asymmetry::DryAsymmetry,
        stribeck_asymmetry::StribeckAsymmetry,
        direction_asymmetry::DirectionAsymmetry,
        position_ripple::PositionRipple,
        stroke_dependence::StrokeDependence,
        pitch_ripple::PitchRipple,
        pitch_ripple_2::SecondPitchRipple,
        warm_up::WarmUp,
    ],
    transmission: InTransmission [torque_proportional::TorqueProportional],
    bristle: AsBristle [presliding::Presliding],
    other: Beside [
        coulomb_drag::CoulombDrag,
        quadratic_drag::QuadraticDrag,
        inertia::Inertia,
        zero_load_dependence::ZeroLoadDependence,
        gravity::Gravity,
        cogging::Cogging,
        cogging_2::SecondCogging,
    ],
    instrument: InInstrument [
        sensor_hysteresis::SensorHysteresis,
        sensor_nonlinearity::SensorNonlinearity,
        sensor_lag::SensorLag,
        time_delay::TimeDelay,
        sensor_offset::SensorOffset,
        sensor_drift::SensorDrift,
    ],
}

impl<T: Real> Effects<T> {
    /// Combines the selected effects of the catalogue with user-defined ones, which act last at
    /// every stage; see [`super::place`].
    pub fn with<E: EffectSet<T>>(self, own: E) -> (Self, E) {
        (self, own)
    }
}

/// Effects of the catalogue as one set; each stage of the signal chain calls only the effects of
/// that stage.
///
/// The code of all effects is inlined in a chain with `Effects`. With debug assertions each stage
/// is a separate function instead, which reduces the compile time of tests to a fraction.
impl<T: Real> EffectSet<T> for Effects<T> {
    type State = States<T>;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> States<T> {
        States {
            drive: self.drive.start(motion, rig),
            lubricant: self.lubricant.start(motion, rig),
            load: self.load.start(motion, rig),
            film: self.film.start(motion, rig),
            contact: self.contact.start(motion, rig),
            transmission: self.transmission.start(motion, rig),
            bristle: self.bristle.start(motion, rig),
            other: self.other.start(motion, rig),
            instrument: self.instrument.start(motion, rig),
        }
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        let film = self
            .drive
            .longest_step_s()
            .min(self.lubricant.longest_step_s());
        let film = film
            .min(self.load.longest_step_s())
            .min(self.film.longest_step_s());
        let contact = self
            .contact
            .longest_step_s()
            .min(self.transmission.longest_step_s())
            .min(self.bristle.longest_step_s());
        let after = self
            .other
            .longest_step_s()
            .min(self.instrument.longest_step_s());
        film.min(contact).min(after)
    }
    #[inline]
    fn remembers(&self) -> bool {
        let film = self.drive.remembers()
            || self.lubricant.remembers()
            || self.load.remembers()
            || self.film.remembers();
        let contact =
            self.contact.remembers() || self.transmission.remembers() || self.bristle.remembers();
        film || contact || self.other.remembers() || self.instrument.remembers()
    }
    #[inline(always)]
    fn has_drive(&self) -> bool {
        self.drive.has_drive()
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn drive(&self, s: &mut States<T>, journal: &mut JournalMotion<T>, rig: &Rig<T>, dt_s: T) {
        self.drive.drive(&mut s.drive, journal, rig, dt_s);
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn resist(&self, s: &mut States<T>, resistance: &Resistance<T>, dt_s: T) {
        self.drive.resist(&mut s.drive, resistance, dt_s);
    }
    #[inline]
    fn transmitted_n(&self, s: &States<T>, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        self.drive.transmitted_n(&s.drive, motion, rig)
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lubricant(&self, s: &States<T>, journal: &JournalMotion<T>, factor: &mut T) {
        self.lubricant.lubricant(&s.lubricant, journal, factor);
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn warm(&self, s: &mut States<T>, power_w: T, dt_s: T) {
        self.lubricant.warm(&mut s.lubricant, power_w, dt_s);
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn scales(
        &self,
        s: &mut States<T>,
        share: impl Fn() -> T + Copy,
        scales: &mut Option<Scales<T>>,
    ) {
        self.load.scales(&mut s.load, share, scales);
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn film_rate(&self, s: &States<T>, journal: &JournalMotion<T>, rate: &mut T) {
        self.lubricant.film_rate(&s.lubricant, journal, rate);
        self.film.film_rate(&s.film, journal, rate);
    }
    #[inline]
    fn fastest_film(&self) -> f64 {
        self.film.fastest_film()
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn contact(
        &self,
        s: &mut States<T>,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        self.contact
            .contact(&mut s.contact, from, to, sliding, dt_s);
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn bristle(
        &self,
        s: &mut States<T>,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> Option<T> {
        self.bristle
            .bristle(&mut s.bristle, from, to, magnitude, dt_s)
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn other(
        &self,
        s: &States<T>,
        journal: &JournalMotion<T>,
        all_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        self.other.other(&s.other, journal, all_n, transmitted_n);
        self.instrument
            .other(&s.instrument, journal, all_n, transmitted_n);
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn transmission(&self, s: &States<T>, transmitted_n: T, sliding: &mut Friction<T>) {
        self.transmission
            .transmission(&s.transmission, transmitted_n, sliding);
    }
    #[inline]
    fn first(&self, s: &mut States<T>, force_n: T) -> T {
        self.instrument.first(&mut s.instrument, force_n)
    }
    #[cfg_attr(debug_assertions, inline(never))]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn reading(&self, s: &mut States<T>, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        self.instrument
            .reading(&mut s.instrument, signal, time_s, dt_s)
    }
}

/// Returns true if the catalogue has an effect with this name and the values are valid for its
/// parameters.
///
/// There must be one value per parameter, each within the bounds. The function can check constants
/// at compile time, for example those that `jbf export` writes.
///
/// ```
/// const _: () = assert!(jbf_core::effect::fits("coulomb_drag", &[0.8]));
/// ```
pub const fn fits(name: &str, values: &[f64]) -> bool {
    let mut i = 0;
    while i < CATALOGUE.len() {
        if same(CATALOGUE[i].name, name) {
            return values_fit(CATALOGUE[i].parameters, values);
        }
        i += 1;
    }
    false
}
