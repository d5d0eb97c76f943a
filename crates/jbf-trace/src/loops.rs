//! Control loops with every observer and compensator, for fingerprints, benchmarks and firmware.
//!
//! A loop consists of encoder, velocity observer, control law, compensator and output limit.

use crate::hash::Hash;
use crate::shaft::{asked, Shaft, COUNTS_PER_RAD, DRIVE, LOOP_STEPS, LOOP_STEP_S};
use jbf_core::compensator::learning::{self, Learned, Learning, Rule};
use jbf_core::compensator::observed::{Observed, Settings};
use jbf_core::compensator::{Axis, Table};
use jbf_core::compensator::{ChainModel, FrictionModel, LawModel};
use jbf_core::compensator::{Compensator, Coulomb, NoCompensation, Repetitive};
use jbf_core::controller::{BaseLaw, Controller, Limits};
use jbf_core::effect::presliding::{self, Presliding};
use jbf_core::encoder::Encoder;
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::observer::{CoulombObserver, VelocityObserver};
use jbf_core::plant::Drive;
use jbf_core::{Bearing, Chain, Clock, Error, Real};

const LOAD_N: f64 = 104.0;
/// Number of entries of a look-up table, and of cells of a lap in a repetitive compensator.
const ENTRIES: usize = 64;

/// Operation on a control loop with a compensator of any type.
pub trait LoopVisitor<T: Real> {
    /// Performs the operation on one loop; `position` is true if its reference is an angle.
    fn visit<C: Compensator<T>>(
        &mut self,
        name: &'static str,
        controller: &Controller<T, C>,
        position: bool,
    );
}

/// Creates the control loop of Cohn (1998) with a compensator, for position or velocity control.
pub fn around<T: Real, C: Compensator<T>>(
    compensator: C,
    position: bool,
) -> Result<Controller<T, C>, Error> {
    let law = if position {
        BaseLaw::position(&Drive::THESIS).cast()
    } else {
        BaseLaw::velocity(&Drive::THESIS).cast()
    };
    Controller::new(
        Encoder::new(COUNTS_PER_RAD, 16, 100.0, LOOP_STEP_S)?,
        velocity_observer()?,
        law,
        compensator,
        Limits::new(DRIVE.limit_v)
            .with_moving_v(1.83)
            .with_patience_s(0.1),
        LOOP_STEP_S,
    )
}

/// Creates the velocity observer of Appendix E of Cohn (1998).
pub fn velocity_observer<T: Real>() -> Result<VelocityObserver<T>, Error> {
    VelocityObserver::with_feedforward(100.0, DRIVE.damping_1_s, DRIVE.input_rad_s2_v, LOOP_STEP_S)
}

/// Creates the Coulomb friction observer.
pub fn coulomb_observer<T: Real>(gain: f64, exponent: f64) -> Result<CoulombObserver<T>, Error> {
    CoulombObserver::new(gain, exponent, DRIVE.input_rad_s2_v, 5.0, LOOP_STEP_S)
}

/// Creates a compensator with the Coulomb friction observer.
pub fn coulomb<T: Real>(gain: f64, exponent: f64) -> Result<Coulomb<T>, Error> {
    Ok(Coulomb::new(coulomb_observer(gain, exponent)?, &DRIVE))
}

fn parameters<T: Real>() -> Parameters<T> {
    Parameters {
        f_m: T::of(0.26),
        u_tr_m_s: T::of(0.06128),
        k0: T::of(4.123e6),
        gamma: T::of(90.29),
    }
}

/// Creates a journal law without inertia, fitted to the loop of Cohn (1998).
pub fn reduced<T: Real>() -> Result<LawModel<T, Journal<T>>, Error> {
    Ok(bare(Journal::new(
        &Bearing::THESIS,
        LOAD_N,
        &parameters(),
        Clock::Thesis,
    )?))
}

/// Creates a journal law with inertia.
pub fn full<T: Real>() -> Result<LawModel<T, JournalFull<T>>, Error> {
    Ok(bare(JournalFull::new(
        &Bearing::THESIS,
        LOAD_N,
        &parameters(),
        Clock::Thesis,
    )?))
}

fn bare<T: Real, L>(law: L) -> LawModel<T, L> {
    LawModel::new(law, Bearing::THESIS.radius_m, DRIVE.volts_per_n, LOAD_N)
}

/// Creates a chain of a journal law without inertia and presliding.
pub fn chained<T: Real>() -> Result<ChainModel<T, Journal<T>, Presliding<T>>, Error> {
    let presliding = Presliding::new(presliding::Parameters {
        sigma: T::of(0.26 * COUNTS_PER_RAD / 0.0127),
    })?;
    let chain = Chain::new(reduced()?.law).with_effects(presliding);
    let chain = chain.on(&Bearing::THESIS);
    Ok(ChainModel::new(chain, DRIVE.volts_per_n, LOAD_N))
}

/// Creates a compensator with a friction model and an observer, with the settings that `jbf control
/// tune` computes.
pub fn observed<T: Real, M: FrictionModel<T>>(
    model: M,
    position: bool,
) -> Result<Observed<T, M>, Error> {
    let settings = Settings::new(&DRIVE, 60.0, 0.05027, LOOP_STEP_S)
        .with_learning_1_s(2.0)
        .with_level_limit_v(0.73)
        .with_rest_limit_v(0.73);
    let settings = if position {
        settings
            .with_approach_1_s(10.0)
            .with_stiffer_v_rad(1.5317)
            .with_stiffer_v_s_rad(0.0491)
            .with_law_forward_v_s_rad(0.25164)
    } else {
        settings.with_law_forward_v_s_rad(0.295)
    };
    Observed::new(model, &settings)
}

/// Creates the learning compensator of Cohn (1998).
pub fn learning<T: Real>(position: bool) -> Result<Learning<T>, Error> {
    let p = Parameters {
        f_m: T::of(0.26),
        u_tr_m_s: T::of(0.05),
        k0: T::of(Learned::THESIS.k0),
        gamma: T::of(Learned::THESIS.gamma),
    };
    let law = Journal::new(&Bearing::THESIS, LOAD_N, &p, Clock::Thesis)?.with_eps_tr(0.9747)?;
    let learned = |k0, gamma| Learned { k0, gamma };
    let (rule, gain) = if position {
        (Rule::THESIS_POSITION, learned(12_500.0, 0.5))
    } else {
        (Rule::Velocity, learned(15_000.0, 2.0))
    };
    let radius_m = Bearing::THESIS.radius_m;
    let settings = learning::Settings::new(rule, Learned::THESIS, 25.5, radius_m, LOOP_STEP_S)
        .with_gain(gain)
        .with_least(learned(1.0, 1e-3))
        .with_most(learned(1e8, 1e4));
    Learning::new(law, &settings)
}

/// Creates a compensator with a look-up table against speed.
pub fn table<T: Real>() -> Result<Table<T, ENTRIES>, Error> {
    let level = |i: usize| T::of(0.7 - 0.4 * i as f64 / (i as f64 + 8.0));
    Table::new(core::array::from_fn(level), Axis::Speed, 0.5, 0.01)
}

/// Creates a repetitive compensator.
pub fn repetitive<T: Real>() -> Result<Repetitive<T, ENTRIES>, Error> {
    Repetitive::new(500, 0.6, 0.1, 0.02, 3.0, LOOP_STEP_S)
}

/// Calls `visit` with every loop in velocity control, and with those that differ in position
/// control.
pub fn each<T: Real>(visit: &mut impl LoopVisitor<T>) -> Result<(), Error> {
    macro_rules! on {
        ($($name:literal, $position:literal: $compensator:expr;)*) => {
            $(visit.visit($name, &around($compensator, $position)?, $position);)*
        };
    }
    on! {
        "none", false: NoCompensation;
        "coulomb/p=1", false: coulomb(0.01, 1.0)?;
        "coulomb/p=0.5", false: coulomb(0.01, 0.5)?;
        "coulomb/p=2", false: coulomb(0.01, 2.0)?;
        "table", false: table()?;
        "repetitive", false: repetitive()?;
        "learning", false: learning(false)?;
        "learning/position", true: learning(true)?;
        "observed/journal", false: observed(reduced()?, false)?;
        "observed/journal/position", true: observed(reduced()?, true)?;
        "observed/journal+presliding", false: observed(chained()?, false)?;
        "observed/journal_full", false: observed(full()?, false)?;
    }
    Ok(())
}

/// Computes the fingerprint of a loop with the simulated shaft, including the status flags.
pub fn run<T: Real, C: Compensator<T>>(
    controller: &Controller<T, C>,
    position: bool,
    stride: u32,
) -> Hash {
    let mut hash = Hash::default();
    let mut shaft = Shaft::default();
    let mut state = controller.start();
    for step in (0..LOOP_STEPS).step_by(stride as usize) {
        let (target, level_v) = asked(step, position);
        let counter = shaft.counter(step);
        let parts = controller.step(&mut state, counter, &target);
        shaft.push(parts.output_v, level_v);
        for number in [parts.velocity_rad_s, parts.error, parts.output_v] {
            hash.take(number);
        }
        hash.take(T::of(f64::from(parts.status.bits())));
    }
    hash
}

/// Interval between the steps of the excitation that are used.
///
/// A fifth of the steps is a demanding test, and short enough for a target that emulates double
/// precision.
const STRIDE: u32 = 5;

struct Take<'a>(&'a mut dyn FnMut(&'static str, &'static str, Hash));

impl<T: Real> LoopVisitor<T> for Take<'_> {
    fn visit<C: Compensator<T>>(
        &mut self,
        name: &'static str,
        controller: &Controller<T, C>,
        position: bool,
    ) {
        (self.0)("loop", name, run(controller, position, STRIDE));
    }
}

/// Passes the fingerprint of every loop to `take`.
pub(crate) fn loops<T: Real>(take: &mut dyn FnMut(&'static str, &'static str, Hash)) {
    if each::<T>(&mut Take(take)).is_err() {
        // The hash of no values, which a test looks for.
        take("loop", "refused", Hash::default());
    }
}
