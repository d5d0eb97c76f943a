//! Longest stable step of a law under the loads and temperatures of a run.

use super::Chain;
use crate::effect::Effect;
use crate::law::Law;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use crate::record::Record;

impl<T: Real, L: Law<T>, E: Effect<T>> Chain<T, L, E> {
    /// Longest stable step of the law at the top speed (m/s), under the lightest and the heaviest
    /// load of a run, s.
    pub(crate) fn longest_film_step_s(&self, record: &Record<'_>, top_m_s: f64) -> f64 {
        let Some(first) = record.motion(0) else {
            return self.law.longest_step_s(top_m_s);
        };
        let mut states = self.effects.start(&first, &self.rig);
        let factors = self.lubricant_factors(&states, record, &first);
        let longest_of = |law: &L| {
            let steps = factors.map(|[factor, rate]| law.longest_step_s(top_m_s * factor) / rate);
            steps[0].min(steps[1])
        };
        let mut longest = longest_of(&self.law);
        let loads = record.load_n.iter();
        let (light, heavy) = loads.fold((f64::INFINITY, 0.0_f64), |(low, high), &n| {
            (low.min(n), high.max(n))
        });
        for load_n in [light, heavy] {
            if let Some(law) = self.scaled(&mut states, T::of(load_n)) {
                longest = longest.min(longest_of(&law));
            }
        }
        longest
    }

    /// Factors of the lubricant at the coldest and the warmest sample of a run.
    ///
    /// Each pair holds the factor on the speed and the factor on the rate of the film.
    fn lubricant_factors(
        &self,
        states: &E::State,
        record: &Record<'_>,
        first: &Motion<T>,
    ) -> [[f64; 2]; 2] {
        let Some(all) = record.temperature_c else {
            return [[1.0; 2]; 2];
        };
        let rest = Motion {
            velocity_m_s: T::ZERO,
            temperature_c: None,
            ..*first
        };
        let rate_of = |motion: &Motion<T>| {
            let mut rate = T::ONE;
            let journal = JournalMotion::from(motion);
            self.effects.film_rate(states, &journal, &mut rate);
            rate.value()
        };
        let usual = rate_of(&rest);
        let ends = all
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &c| {
                [low.min(c), high.max(c)]
            });
        ends.map(|c| {
            let motion = Motion {
                temperature_c: Some(T::of(c)),
                ..rest
            };
            let mut factor = T::ONE;
            let journal = JournalMotion::from(&motion);
            self.effects.lubricant(states, &journal, &mut factor);
            [factor.value(), rate_of(&motion) / usual]
        })
    }
}
