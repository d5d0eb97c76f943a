//! Shared code of the benchmarks: the journal law of Table 4.2 (Cohn 1998) for any scalar type,
//! signal chains, and a sampled motion.

pub mod steps;

use jbf_core::effect::{Effects, Rig, CATALOGUE};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Chain, Clock, Motion, Real};

/// Load on the bearing in Table 4.2 of Cohn (1998), N.
pub const LOAD_N: f64 = 104.0;

/// Time step of the control loop of Cohn (1998), s.
pub const LOOP_STEP_S: f64 = 0.002;

/// Creates the journal law of Table 4.2 with the time scale [`Clock::Journal`].
///
/// `lift` converts parameter `i` to the scalar type, and may attach a derivative.
pub fn law<T: Real>(lift: impl Fn(usize, f64) -> T) -> Journal<T> {
    let p = Parameters::TABLE_4_2;
    let parameters = Parameters {
        f_m: lift(0, p.f_m),
        u_tr_m_s: lift(1, p.u_tr_m_s),
        k0: lift(2, p.k0),
        gamma: lift(3, p.gamma),
    };
    Journal::new(&Bearing::THESIS, LOAD_N, &parameters, Clock::Journal).expect("Table 4.2 is valid")
}

/// Creates a signal chain from the journal law of Table 4.2 and the named effects at their starting
/// values.
///
/// `lift` converts parameter `i` of the law to the scalar type, as in [`law`].
pub fn chain<T: Real>(effects: &[&str], lift: impl Fn(usize, f64) -> T) -> Chain<T, Journal<T>> {
    let mut all = Effects::NONE;
    for info in CATALOGUE.iter().filter(|info| effects.contains(&info.name)) {
        let values: Vec<T> = info.parameters.iter().map(|p| T::of(p.starts[0])).collect();
        all.set(info.name, &values)
            .expect("starting values are valid");
    }
    let rig = Rig {
        radius_m: T::of(Bearing::THESIS.radius_m),
        count: T::of(f64::from(Bearing::THESIS.count)),
        force_at_drive: false,
    };
    Chain {
        law: law(lift),
        effects: all,
        rig,
    }
}

/// Motion U = 0.127 sin(t) of chapter 4 of Cohn (1998), in both directions, at `time_s`.
pub fn two_way<T: Real>(time_s: f64) -> Motion<T> {
    let (sin, cos) = time_s.sin_cos();
    Motion {
        time_s: T::of(time_s),
        velocity_m_s: T::of(0.127 * sin),
        acceleration_m_s2: T::of(0.127 * cos),
        angle_rad: T::of(0.127 * (1.0 - cos) / Bearing::THESIS.radius_m),
        ..Motion::at_rest(T::of(LOAD_N))
    }
}

/// Samples of one period of [`two_way`], one per [`LOOP_STEP_S`].
///
/// A benchmark thus includes reversals and full film in realistic proportions.
pub fn period<T: Real>() -> Vec<Motion<T>> {
    (0..3142)
        .map(|i| two_way(LOOP_STEP_S * f64::from(i)))
        .collect()
}
