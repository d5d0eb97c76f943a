//! Fingerprints (hashes of results) of every integration method with the films that it supports.

use crate::hash::Hash;
use crate::motion::{motions, STEP_S};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::Law;
use jbf_core::stepper::{Euler, Rk4, Rodas3, Rodas5P};
use jbf_core::{Bearing, Clock, Motion, Real};

/// Computes the hash of the results of `step` along the common motion.
///
/// The arguments of `step` are the motion, |U| at the start, middle and end of the step, and the
/// length of the step.
fn along<T: Real>(mut step: impl FnMut(&Motion<T>, [T; 3], T) -> [T; 2]) -> Hash {
    let mut hash = Hash::default();
    let mut before = T::ZERO;
    for motion in motions::<T>() {
        let after = motion.velocity_m_s;
        let middle = (before + after) * T::of(0.5);
        let speeds = [before.abs(), middle.abs(), after.abs()];
        for number in step(&motion, speeds, T::of(STEP_S)) {
            hash.take(number);
        }
        before = after;
    }
    hash
}

fn parameters<T: Real>() -> Parameters<T> {
    let p = Parameters::TABLE_4_2;
    Parameters {
        f_m: T::of(p.f_m),
        u_tr_m_s: T::of(p.u_tr_m_s),
        k0: T::of(p.k0),
        gamma: T::of(p.gamma),
    }
}

/// Passes the fingerprint of every integration method to `take`.
pub(crate) fn steppers<T: Real>(take: &mut dyn FnMut(&'static str, &'static str, Hash)) {
    let bearing = Bearing::THESIS;
    let (Ok(law), Ok(full)) = (
        Journal::<T>::new(&bearing, 104.0, &parameters(), Clock::Journal),
        JournalFull::<T>::new(&bearing, 104.0, &parameters(), Clock::Thesis),
    ) else {
        return;
    };
    macro_rules! on {
        ($law:ident, $advance:ident, $stepper:expr, $name:literal) => {
            let mut state = $law.start(T::of(104.0));
            let hash = along(|motion: &Motion<T>, speeds, dt_s| {
                $law.set_load(&mut state, motion.load_n);
                $law.$advance(&$stepper, &mut state, speeds, T::ONE, dt_s);
                let v = motion.velocity_m_s;
                [state.eps(), $law.friction(&state, v).along(v.sign())]
            });
            take("stepper", $name, hash);
        };
    }
    on!(law, advance_with, Euler, "euler/journal");
    on!(law, advance_with, Rk4, "rk4/journal");
    on!(law, advance_stiff_with, Rodas3, "rodas3/journal");
    on!(law, advance_stiff_with, Rodas5P, "rodas5p/journal");
    on!(full, advance_with, Rodas3, "rodas3/journal_full");
    on!(full, advance_with, Rodas5P, "rodas5p/journal_full");
}
