//! Tests that a chain on the stored path of a film has the same readings, bit for bit, as one that
//! integrates the film.

#[path = "../../jbf-core/tests/common/mod.rs"]
mod common;

use common::motion::Sines;
use jbf_batch::film_path::{FilmStep, FilmSteps, OnPath, Place};
use jbf_core::effect::{Effect, Effects, CATALOGUE};
use jbf_core::internals::{inner_step_s, predict_by, Steps};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::Law;
use jbf_core::run::{predict, Record};
use jbf_core::{Bearing, Chain, Clock, Dual, Motion, Real};
use std::cell::RefCell;

const MAX_STEP_S: f64 = 0.02;

/// Journal law of Table 4.2 (Cohn 1998); `lifted` may attach derivatives to f_m, U_tr and K0.
fn law<T: Real>(lifted: impl Fn(f64, usize) -> T) -> Journal<T> {
    let p = Parameters::TABLE_4_2;
    let parameters = Parameters {
        f_m: lifted(p.f_m, 0),
        u_tr_m_s: lifted(p.u_tr_m_s, 1),
        k0: lifted(p.k0, 2),
        gamma: T::of(p.gamma),
    };
    Journal::new(&Bearing::THESIS, 104.0, &parameters, Clock::Journal).expect("valid")
}

fn chain<T: Real, L: Law<T>>(law: L) -> Chain<T, L, Effects<T>> {
    with(
        law,
        &[
            ("coulomb_drag", &[1.0]),
            ("presliding", &[2e4]),
            ("sensor_lag", &[0.05]),
        ],
    )
}

fn with<T: Real, L: Law<T>>(law: L, named: &[(&str, &[f64])]) -> Chain<T, L, Effects<T>> {
    let mut effects = Effects::NONE;
    for (name, values) in named {
        let lifted: Vec<T> = values.iter().map(|&v| T::of(v)).collect();
        effects.set(name, &lifted).expect("valid");
    }
    Chain::new(law).with_effects(effects).on(&Bearing::THESIS)
}

/// Columns of a motion in both directions with uneven sampling intervals, some so long that inner
/// steps are needed.
struct Columns([Vec<f64>; 5]);

impl Columns {
    fn new() -> Self {
        let sines = Sines::two_way(1.0);
        let mut time_s = 0.0;
        let motions: Vec<Motion<f64>> = (0..600)
            .map(|i| {
                time_s += if i % 7 == 0 { 0.05 } else { 0.013 };
                sines.at(time_s)
            })
            .collect();
        let column = |f: fn(&Motion<f64>) -> f64| motions.iter().map(f).collect();
        Self([
            column(|m| m.time_s),
            column(|m| m.velocity_m_s),
            column(|m| m.acceleration_m_s2),
            column(|m| m.angle_rad),
            column(|m| m.load_n),
        ])
    }

    fn record(&self) -> Record<'_> {
        let [time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n] = &self.0;
        Record {
            time_s,
            velocity_m_s,
            acceleration_m_s2,
            angle_rad,
            weight_offset_rad: None,
            load_n,
            temperature_c: None,
        }
    }
}

/// States of the film along the steps of a record, with derivatives with respect to the parameters
/// `by`.
fn path<const N: usize>(record: &Record<'_>, by: [usize; 2]) -> Vec<Place> {
    let inner_s = inner_step_s(&chain(law(|v, _| v)), record, MAX_STEP_S);
    path_and_ends::<N>(record, by, inner_s).0
}

/// States of the film as from [`path`], and for each sample except the first the index of the last
/// step before it.
fn path_and_ends<const N: usize>(
    record: &Record<'_>,
    by: [usize; 2],
    inner_s: f64,
) -> (Vec<Place>, Vec<u32>) {
    let asked: RefCell<Vec<FilmStep>> = RefCell::new(Vec::new());
    let asks = Chain::new(FilmSteps::new(|s| asked.borrow_mut().push(s)));
    let mut ends = Vec::new();
    predict(&asks, record, inner_s, |i, _| {
        if i > 0 {
            ends.push(u32::try_from(asked.borrow().len()).expect("few") - 1);
        }
    });
    let alone = law(Dual::<N>::parameter);
    let load = |s: &FilmStep| Dual::of(s.load_n);
    let mut film = alone.start(load(&asked.borrow()[0]));
    let steps = asked.into_inner();
    let place = |s: &FilmStep| {
        alone.set_load(&mut film, load(s));
        alone.advance(
            &mut film,
            s.speed_m_s.map(Dual::of),
            Dual::ONE,
            Dual::of(s.dt_s),
        );
        let e2 = alone.film(&film);
        Place {
            film: e2.value,
            slopes: by.map(|n| e2.slope[n]),
        }
    };
    (steps.iter().map(place).collect(), ends)
}

fn readings<T: Real, L: Law<T>>(law: L, record: &Record<'_>) -> Vec<T> {
    let mut out = Vec::new();
    predict(&chain(law), record, MAX_STEP_S, |_, f| out.push(f));
    out
}

#[test]
fn readings_on_a_stored_film_path_have_the_same_bits_and_derivatives() {
    let columns = Columns::new();
    let record = columns.record();
    let by = <Journal<f64> as Law<f64>>::FILM_PARAMETERS.expect("a film");
    let path = path::<3>(&record, by);
    assert!(path.len() > 600, "reversals and inner steps are steps");

    let plain = law(|v, _| v);
    let of = |n: usize| [plain_parameter(by[0]), plain_parameter(by[1])][n];
    let followed = readings(OnPath::new(plain, [of(0), of(1)], &path), &record);
    let stepped = readings(plain, &record);
    assert!(followed
        .iter()
        .zip(&stepped)
        .all(|(a, b)| a.to_bits() == b.to_bits()));

    let lifted = law(Dual::<3>::parameter);
    let parameters = by.map(|n| Dual::<3>::parameter(plain_parameter(n), n));
    let followed = readings(OnPath::new(lifted, parameters, &path), &record);
    let stepped = readings(lifted, &record);
    for (a, b) in followed.iter().zip(&stepped) {
        assert_eq!(a.value.to_bits(), b.value.to_bits());
        assert_eq!(a.slope, b.slope);
    }
    assert!(stepped
        .iter()
        .any(|f| f.slope[1] != 0.0 && f.slope[2] != 0.0));
}

/// The last step before each sample determines the reading if no effect has memory.
#[test]
fn last_step_before_each_sample_suffices_for_effects_without_memory() {
    let columns = Columns::new();
    let record = columns.record();
    let inner_s = inner_step_s(&with(law(|v, _| v), &[]), &record, MAX_STEP_S);
    let (path, ends) = path_and_ends::<3>(&record, [1, 2], inner_s);
    let on_path = || OnPath::new(law(|v, _| v), [1, 2].map(plain_parameter), &path);
    let mut told = 0;
    for info in CATALOGUE {
        let start: Vec<f64> = info.parameters.iter().map(|p| p.starts[0]).collect();
        let stepped = with(on_path(), &[(info.name, &start)]);
        let before_film = inner_step_s(&stepped, &record, MAX_STEP_S) != inner_s;
        if before_film || stepped.effects.has_memory() {
            continue;
        }
        told += 1;
        let at_samples = with(on_path().at(&ends), &[(info.name, &start)]);
        let mut expected = Vec::new();
        predict(&stepped, &record, MAX_STEP_S, |_, f| expected.push(f));
        predict_by(
            &at_samples,
            &record,
            MAX_STEP_S,
            Steps::Last,
            |i, f: f64| {
                assert_eq!(f.to_bits(), expected[i].to_bits(), "{} {i}", info.name);
            },
        );
    }
    assert!(told > 15, "{told}");
    let remembers = |name, start: &[f64]| with(on_path(), &[(name, start)]).effects.has_memory();
    assert!(remembers("sensor_lag", &[0.05]) && remembers("presliding", &[2e4]));
    assert!(!remembers("coulomb_drag", &[1.0]) && !remembers("sensor_offset", &[0.1]));
}

/// Value of the parameter `number` of the law of Table 4.2: U_tr or K0.
fn plain_parameter(number: usize) -> f64 {
    let p = Parameters::TABLE_4_2;
    [p.f_m, p.u_tr_m_s, p.k0, p.gamma][number]
}

/// After the end of a path, the film is integrated from the last eccentricity of the path.
#[test]
fn readings_beyond_the_end_of_a_film_path_are_finite() {
    let columns = Columns::new();
    let record = columns.record();
    let path = path::<3>(&record, [1, 2]);
    let followed = readings(
        OnPath::new(law(|v, _| v), [0.06, 7.5e5], &path[..100]),
        &record,
    );
    assert!(followed.iter().all(|f| f.is_finite()));
}
