//! Code shared by several test files.
//!
//! Each test file is a separate crate, so not every one uses all of the code.
#![allow(dead_code)]

pub mod bench;
pub mod constant_law;
pub mod drive;
pub mod motion;
pub mod random;
pub mod table;

use jbf_core::effect::{Effects, Info, Need, Rig};
use jbf_core::law::coulomb::{self, Coulomb};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::Law;
use jbf_core::{Bearing, Chain, Clock, Motion, Real};

/// Load on the bearing in Table 4.2 of Cohn (1998), N.
pub const LOAD_N: f64 = 104.0;

/// Parameters of Table 4.2 of Cohn (1998) for any scalar type.
pub fn table_4_2<T: Real>() -> Parameters<T> {
    let p = Parameters::TABLE_4_2;
    Parameters {
        f_m: T::of(p.f_m),
        u_tr_m_s: T::of(p.u_tr_m_s),
        k0: T::of(p.k0),
        gamma: T::of(p.gamma),
    }
}

/// Journal law of Table 4.2 of Cohn (1998) with a time scale of the film.
pub fn law<T: Real>(clock: Clock) -> Journal<T> {
    Journal::new(&Bearing::THESIS, LOAD_N, &table_4_2(), clock).expect("Table 4.2 is valid")
}

/// Law in newtons with dry and viscous friction, `(F_c + F_v |v|) sgn v` in motion.
pub fn newtons(kinetic_n: f64, viscous_n_s_m: f64) -> Coulomb<f64> {
    Coulomb::new(coulomb::Parameters {
        f_c: kinetic_n,
        f_s: kinetic_n,
        f_v: viscous_n_s_m,
    })
    .expect("a sound law")
}

/// Chain of the journal law of Table 4.2 and effects, with the physical time scale and the rig of
/// Cohn (1998).
pub fn chain<T: Real>(effects: &[(&str, &[f64])]) -> Chain<T, Journal<T>> {
    chain_round(law(Clock::Journal), effects)
}

/// Chain of any law and effects in the rig of Cohn (1998).
pub fn chain_round<T: Real, L>(law: L, effects: &[(&str, &[f64])]) -> Chain<T, L> {
    let rig = Rig {
        radius_m: T::of(Bearing::THESIS.radius_m),
        count: T::of(f64::from(Bearing::THESIS.count)),
        force_at_drive: false,
    };
    Chain {
        rig,
        ..on_drive(law, effects)
    }
}

/// Chain of any law and effects on a linear axis whose force is that of the drive.
pub fn on_drive<T: Real, L>(law: L, effects: &[(&str, &[f64])]) -> Chain<T, L> {
    let mut all = Effects::NONE;
    for (name, values) in effects {
        let lifted: Vec<T> = values.iter().map(|&v| T::of(v)).collect();
        all.set(name, &lifted)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
    }
    Chain {
        law,
        effects: all,
        rig: Rig::default(),
    }
}

/// Further effects that an effect needs to have an influence: a weight if it needs a transmitted
/// force.
pub fn company(info: &Info) -> Vec<(&'static str, &'static [f64])> {
    const WEIGHT: &[f64] = &[40.0, 0.3];
    let needs = info.needs.contains(&Need::Transmitted);
    needs.then_some(("gravity", WEIGHT)).into_iter().collect()
}

/// Readings (N) of a chain along a motion: the first sample, then `steps` steps of `dt_s`.
pub fn readings<T: Real, L: Law<T>>(
    chain: &Chain<T, L>,
    dt_s: f64,
    steps: u32,
    motion: impl Fn(f64) -> Motion<T>,
) -> Vec<T> {
    let mut state = chain.start(&motion(0.0));
    let mut out = vec![state.reading_n];
    out.extend(
        (1..=steps).map(|i| chain.step(&mut state, &motion(dt_s * f64::from(i)), T::of(dt_s))),
    );
    out
}
