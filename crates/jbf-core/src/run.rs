//! A whole recorded run through a chain: the samples as slices, inner steps between them.

use crate::chain::{Chain, State};
use crate::law::Law;
use crate::motion::Motion;
use crate::real::Real;

/// The imposed motion of a run, one value a sample; all slices of one length.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Time, s, rising.
    pub time_s: &'a [f64],
    /// Surface speed, m/s.
    pub velocity_m_s: &'a [f64],
    /// Its rate of change, m/s^2.
    pub acceleration_m_s2: &'a [f64],
    /// Shaft angle, unwrapped, rad.
    pub angle_rad: &'a [f64],
    /// Load on one bearing, N.
    pub load_n: &'a [f64],
}

impl Record<'_> {
    /// The motion at sample `i`; none past the shortest slice.
    pub fn motion<T: Real>(&self, i: usize) -> Option<Motion<T>> {
        Some(Motion {
            time_s: T::of(*self.time_s.get(i)?),
            velocity_m_s: T::of(*self.velocity_m_s.get(i)?),
            acceleration_m_s2: T::of(*self.acceleration_m_s2.get(i)?),
            angle_rad: T::of(*self.angle_rad.get(i)?),
            load_n: T::of(*self.load_n.get(i)?),
        })
    }
}

/// Run `chain` along `record` with inner steps of at most `max_step_s` (shorter where the law
/// asks for it; landing on every reversal), and hand each
/// sample's reading (N) to `sink` with its index.
pub fn predict<T: Real, L: Law<T>>(
    chain: &Chain<T, L>,
    record: &Record<'_>,
    max_step_s: f64,
    mut sink: impl FnMut(usize, T),
) {
    let Some(mut from) = record.motion::<T>(0) else {
        return;
    };
    let top = record
        .velocity_m_s
        .iter()
        .fold(0.0_f64, |top, &v| top.max(libm::fabs(v)));
    let max_step_s = max_step_s
        .min(chain.law.longest_step_s(top))
        .min(chain.effects.longest_step_s());
    let mut state = chain.start(&from);
    sink(0, state.reading_n);
    let mut i = 1;
    while let Some(to) = record.motion::<T>(i) {
        if let Some(zero) = crossing(&from, &to) {
            between(chain, &mut state, &from, &zero, max_step_s);
            between(chain, &mut state, &zero, &to, max_step_s);
        } else {
            between(chain, &mut state, &from, &to, max_step_s);
        }
        sink(i, state.reading_n);
        from = to;
        i += 1;
    }
}

/// The instant between two samples at which the speed is zero, if it changes sign there:
/// friction jumps at it, so a step must land on it.
fn crossing<T: Real>(from: &Motion<T>, to: &Motion<T>) -> Option<Motion<T>> {
    let (v0, v1) = (from.velocity_m_s, to.velocity_m_s);
    if v0.value() * v1.value() >= 0.0 {
        return None;
    }
    let mut zero = from.towards(to, v0 / (v0 - v1));
    zero.velocity_m_s = T::ZERO;
    Some(zero)
}

/// Equal inner steps from one motion to the next.
fn between<T: Real, L: Law<T>>(
    chain: &Chain<T, L>,
    state: &mut State<T, L::State>,
    from: &Motion<T>,
    to: &Motion<T>,
    max_step_s: f64,
) {
    let dt = to.time_s.value() - from.time_s.value();
    let steps = libm::ceil(dt / max_step_s - 1e-9).clamp(1.0, 1e6);
    let inner = T::of(dt / steps);
    for k in 1..=steps as u32 {
        let motion = from.towards(to, T::of(f64::from(k) / steps));
        chain.step(state, &motion, inner);
    }
}
