//! Fingerprints (hashes of results) of laws, of effects, and of laws with all effects that apply to
//! them.

use crate::hash::Hash;
use crate::motion::{motions, STEP_S};
use jbf_catalogue::{Spec, Using};
use jbf_core::effect::{self, Need};
use jbf_core::law::{self, Named};
use jbf_core::{Bearing, Chain, Clock, Real};

/// Largest number of parameters of a law or an effect.
const MOST: usize = 16;

/// Start values of a fit of a law or an effect.
struct Starts<T> {
    values: [T; MOST],
    count: usize,
}

impl<T: Real> Starts<T> {
    fn of(pages: &[effect::Parameter]) -> Self {
        let mut values = [T::ZERO; MOST];
        for (value, page) in values.iter_mut().zip(pages) {
            *value = T::of(page.starts.first().copied().unwrap_or_default());
        }
        let count = pages.len().min(MOST);
        Self { values, count }
    }
}

impl<T> AsRef<[T]> for Starts<T> {
    fn as_ref(&self) -> &[T] {
        &self.values[..self.count]
    }
}

/// Computes the hash of the readings of a chain along the common motion.
struct Along;

impl<T: Real> Using<T> for Along {
    type Output = Hash;

    fn with<L: Named<T>>(self, chain: Chain<T, L>) -> Hash {
        let mut hash = Hash::default();
        let mut motions = motions::<T>();
        let Some(first) = motions.next() else {
            return hash;
        };
        let mut state = chain.start(&first);
        hash.take(state.reading_n);
        for motion in motions {
            hash.take(chain.step(&mut state, &motion, T::of(STEP_S)));
        }
        hash
    }
}

/// Computes the hash of a law along the common motion, with the effects for which `wanted` is true.
///
/// If the chain is invalid, the result is the hash of an empty sequence.
fn along<T: Real>(page: &law::Info, wanted: impl Fn(&effect::Info) -> bool) -> Hash {
    let effects = effect::CATALOGUE
        .iter()
        .filter(|info| wanted(info) && info.lacking(page).is_none())
        .map(|info| (info.name, Starts::<T>::of(info.parameters)));
    let values = Starts::<T>::of(page.parameters);
    let spec = Spec {
        law: page.name,
        values: values.as_ref(),
        bearing: Some(&Bearing::THESIS),
        load_n: Some(104.0),
        clock: Clock::Journal,
    };
    spec.chain(effects, Along).unwrap_or_default()
}

type Take<'a> = &'a mut dyn FnMut(&'static str, &'static str, Hash);

/// Passes the fingerprint of every law without effects to `take`.
pub(crate) fn laws<T: Real>(take: Take<'_>) {
    for page in law::CATALOGUE {
        take("law", page.name, along::<T>(page, |_| false));
    }
}

/// Passes the fingerprint of every effect to `take`, with the first law to which it applies and
/// with the effects that it requires.
pub(crate) fn effects<T: Real>(take: Take<'_>) {
    for info in effect::CATALOGUE {
        let mut laws = law::CATALOGUE.iter();
        let Some(page) = laws.find(|page| info.lacking(page).is_none()) else {
            continue;
        };
        take(
            "effect",
            info.name,
            along::<T>(page, |i| {
                let needed = i.transmitted && info.needs.contains(&Need::Transmitted);
                needed || i.name == info.name
            }),
        );
    }
}

/// Passes the fingerprint of every law with all effects that apply to it to `take`.
pub(crate) fn together<T: Real>(take: Take<'_>) {
    for page in law::CATALOGUE {
        take("chain", page.name, along::<T>(page, |_| true));
    }
}
