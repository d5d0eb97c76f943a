//! Every compensator of the core, by name, in a loop behind one face.

use super::model::{ModelSpec, Using};
use super::settings::LoopSpec;
use crate::bearing::{refused, Sizes};
use jbf_core::compensator::carried::Whole;
use jbf_core::compensator::learning::{Learned, Rule};
use jbf_core::compensator::observed::{Observed, Settings};
use jbf_core::compensator::repetitive::Repetitive;
use jbf_core::compensator::table::{Axis, Table};
use jbf_core::compensator::{Answer, Compensator, Coulomb, Learning, NoCompensation};
use jbf_core::controller::{Controller, Parts, State};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::Named;
use jbf_core::observer::CoulombObserver;
use jbf_core::reference::Target;
use jbf_core::{Chain, Clock, Real};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Entries of a look-up table and cells of a lap on the bench.
const ENTRIES: usize = 64;
const CELLS: usize = 256;

/// A loop that is being run.
pub trait Stepping: Send {
    /// One step, in double precision outside whatever it is inside.
    fn step(&mut self, counter: u32, target: Target<f64>) -> Parts<f64>;
}

struct Running<T: Real, C: Compensator<T>> {
    controller: Controller<T, C>,
    state: State<T, C::State>,
}

impl<T: Real, C: Compensator<T> + Send> Stepping for Running<T, C>
where
    C::State: Send,
{
    fn step(&mut self, counter: u32, target: Target<f64>) -> Parts<f64> {
        let target = Target {
            value: T::of(target.value),
            rate: T::of(target.rate),
        };
        let p = self.controller.step(&mut self.state, counter, &target);
        let a = p.compensation;
        Parts {
            angle_rad: p.angle_rad.value(),
            velocity_rad_s: p.velocity_rad_s.value(),
            error: p.error.value(),
            base_v: p.base_v.value(),
            compensation: Answer {
                sum_v: a.sum_v.value(),
                friction_v: a.friction_v.value(),
                correction_v: a.correction_v.value(),
                forward_v: a.forward_v.value(),
                learned: a.learned.map(T::value),
            },
            output_v: p.output_v.value(),
            status: p.status,
        }
    }
}

/// A compensator as Python hands it over.
// What tells one from another is which keys it has; the last has one that means nothing else.
#[derive(FromPyObject)]
pub enum Spec {
    Observed(ObservedSpec),
    Learning(LearningSpec),
    Repetitive(RepetitiveSpec),
    Table(TableSpec),
    Coulomb(CoulombSpec),
    Nothing(#[allow(dead_code)] NothingSpec),
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct NothingSpec {
    #[allow(dead_code)]
    nothing: bool,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct CoulombSpec {
    gain: f64,
    exponent: f64,
    damping_1_s: f64,
    input_rad_s2_v: f64,
    limit_v: f64,
    start_v: f64,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct LearningSpec {
    bearing: Sizes,
    load_n: f64,
    clock: String,
    f_m: f64,
    u_tr_m_s: f64,
    k0: f64,
    gamma: f64,
    eps_tr: Option<f64>,
    volts: f64,
    k0_gain: f64,
    gamma_gain: f64,
    k0_bounds: (f64, f64),
    gamma_bounds: (f64, f64),
    gate_rad: f64,
    clip_rad: f64,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TableSpec {
    levels_v: Vec<f64>,
    by_angle: bool,
    width: f64,
    viscous_v_s: f64,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RepetitiveSpec {
    steps_per_lap: u32,
    lap_gain: f64,
    smooth: f64,
    lead_s: f64,
    limit_v: f64,
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ObservedSpec {
    model: ModelSpec,
    volts_per_n: f64,
    damping_1_s: f64,
    input_rad_s2_v: f64,
    bandwidth_rad_s: f64,
    learning_1_s: f64,
    level_limit_v: f64,
    rest_limit_v: f64,
    slow_rad_s: f64,
    approach_1_s: f64,
    breakaway: f64,
    stiffer_v_rad: f64,
    stiffer_v_s_rad: f64,
    law_forward_v_s_rad: f64,
    start: (f64, f64),
}

struct Carry<'a, T> {
    spec: &'a ObservedSpec,
    settings: &'a LoopSpec,
    number: core::marker::PhantomData<T>,
}

impl<T: Real> Using<T> for Carry<'_, T> {
    type Output = PyResult<Box<dyn Stepping>>;

    fn with<L: Named<T>>(self, chain: Chain<T, L>) -> Self::Output {
        let s = self.spec;
        let model = Whole {
            chain,
            volts_per_n: T::of(s.volts_per_n),
            load_n: T::of(s.model.load_n),
        };
        let compensator = Observed::new(model, &s.settings(self.settings.dt_s))
            .map_err(refused)?
            .resumed(jbf_core::compensator::observed::Learned {
                level_v: T::of(s.start.0),
                rest_v: T::of(s.start.1),
            });
        boxed(self.settings, compensator)
    }
}

impl ObservedSpec {
    fn settings(&self, dt_s: f64) -> Settings {
        Settings {
            damping_1_s: self.damping_1_s,
            input_rad_s2_v: self.input_rad_s2_v,
            bandwidth_rad_s: self.bandwidth_rad_s,
            learning_1_s: self.learning_1_s,
            level_limit_v: self.level_limit_v,
            rest_limit_v: self.rest_limit_v,
            slow_rad_s: self.slow_rad_s,
            approach_1_s: self.approach_1_s,
            breakaway: self.breakaway,
            stiffer_v_rad: self.stiffer_v_rad,
            stiffer_v_s_rad: self.stiffer_v_s_rad,
            law_forward_v_s_rad: self.law_forward_v_s_rad,
            dt_s,
        }
    }
}

fn boxed<T: Real, C>(settings: &LoopSpec, compensator: C) -> PyResult<Box<dyn Stepping>>
where
    C: Compensator<T> + Send + 'static,
    C::State: Send + 'static,
{
    let controller = settings.round(compensator)?;
    let state = controller.start();
    Ok(Box::new(Running { controller, state }))
}

impl LearningSpec {
    fn compensator<T: Real>(self, settings: &LoopSpec) -> PyResult<Learning<T>> {
        let bearing = self.bearing.checked()?;
        let clock = Clock::from_name(&self.clock)
            .ok_or_else(|| PyValueError::new_err("clock is neither journal nor thesis"))?;
        let parameters = Parameters {
            f_m: T::of(self.f_m),
            u_tr_m_s: T::of(self.u_tr_m_s),
            k0: T::of(self.k0),
            gamma: T::of(self.gamma),
        };
        let law = Journal::new(&bearing, self.load_n, &parameters, clock)
            .and_then(|law| match self.eps_tr {
                Some(eps_tr) => law.with_eps_tr(eps_tr),
                None => Ok(law),
            })
            .map_err(refused)?;
        let rule = if settings.position {
            Rule::Position {
                gate_rad: T::of(self.gate_rad),
                clip_rad: T::of(self.clip_rad),
            }
        } else {
            Rule::Velocity
        };
        let learned = |k0, gamma| Learned { k0, gamma };
        Learning::new(
            law,
            self.gamma,
            rule,
            learned(self.k0_gain, self.gamma_gain),
            [
                learned(self.k0_bounds.0, self.gamma_bounds.0),
                learned(self.k0_bounds.1, self.gamma_bounds.1),
            ],
            self.volts,
            bearing.radius_m,
            settings.dt_s,
        )
        .map_err(refused)
    }
}

impl Spec {
    /// The loop of `settings` round this compensator.
    pub fn into_loop<T: Real>(self, settings: &LoopSpec) -> PyResult<Box<dyn Stepping>> {
        match self {
            Spec::Nothing(_) => boxed::<T, _>(settings, NoCompensation),
            Spec::Coulomb(s) => {
                let observer = CoulombObserver::new(
                    s.gain,
                    s.exponent,
                    s.input_rad_s2_v,
                    s.limit_v,
                    settings.dt_s,
                )
                .map_err(refused)?;
                boxed::<T, _>(
                    settings,
                    Coulomb {
                        observer,
                        damping_1_s: T::of(s.damping_1_s),
                        input_rad_s2_v: T::of(s.input_rad_s2_v),
                        start_v: T::of(s.start_v),
                    },
                )
            }
            Spec::Learning(s) => boxed::<T, _>(settings, s.compensator(settings)?),
            Spec::Table(s) => {
                let levels: [f64; ENTRIES] = s.levels_v.try_into().map_err(|_| {
                    PyValueError::new_err(format!("a table has {ENTRIES} entries here"))
                })?;
                let axis = if s.by_angle { Axis::Angle } else { Axis::Speed };
                let table =
                    Table::new(levels.map(T::of), axis, s.width, s.viscous_v_s).map_err(refused)?;
                boxed::<T, _>(settings, table)
            }
            Spec::Repetitive(s) => {
                let lap: Repetitive<T, CELLS> = Repetitive::new(
                    s.steps_per_lap,
                    s.lap_gain,
                    s.smooth,
                    s.lead_s,
                    s.limit_v,
                    settings.dt_s,
                )
                .map_err(refused)?;
                boxed::<T, _>(settings, lap)
            }
            Spec::Observed(s) => s.model.chain(Carry::<T> {
                spec: &s,
                settings,
                number: core::marker::PhantomData,
            })?,
        }
    }
}
