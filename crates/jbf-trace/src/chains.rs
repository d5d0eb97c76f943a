//! Laws by name, effects by name, and all effects that go with a law.

use crate::hash::Hash;
use crate::motion::{motions, STEP_S};
use jbf_core::effect::{self, Effects, Rig};
use jbf_core::law::{self, with_law, Named, Visitor};
use jbf_core::{Bearing, Chain, Clock, Real};

/// No page has more parameters.
const MOST: usize = 16;

/// Values at which a page's fits start, as many as it has.
fn starts<T: Real>(pages: &[effect::Parameter]) -> ([T; MOST], usize) {
    let mut values = [T::ZERO; MOST];
    for (value, page) in values.iter_mut().zip(pages) {
        *value = T::of(page.starts.first().copied().unwrap_or_default());
    }
    (values, pages.len().min(MOST))
}

struct Along<T: Real>(Effects<T>);

impl<T: Real> Visitor<T> for Along<T> {
    type Output = Hash;

    fn visit<L: Named<T>>(self, law: L) -> Hash {
        let rig = Rig {
            radius_m: T::of(Bearing::THESIS.radius_m),
            count: T::of(f64::from(Bearing::THESIS.count)),
        };
        let effects = self.0;
        let chain = Chain { law, effects, rig };
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

/// A law along the motion, an effect added where `wanted`. What cannot be built shows as the hash
/// of nothing.
fn along<T: Real>(page: &law::Info, wanted: impl Fn(&effect::Info) -> bool) -> Hash {
    let mut effects = Effects::NONE;
    for info in effect::CATALOGUE {
        if wanted(info) && info.lacking(page).is_none() {
            let (values, n) = starts::<T>(info.parameters);
            if effects.set(info.name, &values[..n]).is_err() {
                return Hash::default();
            }
        }
    }
    let (values, n) = starts::<T>(page.parameters);
    let load_n = Some(104.0);
    let bearing = Some(&Bearing::THESIS);
    with_law(
        page.name,
        bearing,
        load_n,
        &values[..n],
        Clock::Journal,
        Along(effects),
    )
    .unwrap_or_default()
}

type Take<'a> = &'a mut dyn FnMut(&'static str, &'static str, Hash);

/// Every law without effects.
pub(crate) fn laws<T: Real>(take: Take<'_>) {
    for page in law::CATALOGUE {
        take("law", page.name, along::<T>(page, |_| false));
    }
}

/// Every effect round the first law.
pub(crate) fn effects<T: Real>(take: Take<'_>) {
    for info in effect::CATALOGUE {
        let hash = along::<T>(&law::CATALOGUE[0], |i| i.name == info.name);
        take("effect", info.name, hash);
    }
}

/// Every law with all effects that go with it.
pub(crate) fn together<T: Real>(take: Take<'_>) {
    for page in law::CATALOGUE {
        take("chain", page.name, along::<T>(page, |_| true));
    }
}
