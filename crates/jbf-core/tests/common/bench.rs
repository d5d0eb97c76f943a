//! Control loop with a simulated shaft, without noise, for tests of controllers.

use super::{chain_round, law};
use jbf_core::compensator::learning::{self, Learned, Rule};
use jbf_core::compensator::observed::Settings;
use jbf_core::compensator::Axis;
use jbf_core::compensator::ChainModel;
use jbf_core::compensator::{
    Compensator, Coulomb, LawModel, Learning, NoCompensation, Observed, Repetitive, Table,
};
use jbf_core::controller::{BaseLaw, Controller, Limits, Signals, State};
use jbf_core::encoder::Encoder;
use jbf_core::law::journal::Journal;
use jbf_core::observer::{CoulombObserver, VelocityObserver};
use jbf_core::plant::{Drive, Plant, State as PlantState};
use jbf_core::reference::Target;
use jbf_core::{Chain, Clock, Real};

/// Time step of the control loop, s.
pub const DT_S: f64 = 0.002;
/// Encoder counts per radian.
pub const COUNTS_PER_RAD: f64 = 2387.3;
/// Drive of Cohn (1998) with 0.03 V per newton of friction.
pub const DRIVE: Drive = Drive::THESIS.with_volts_per_n(0.03);
/// Load on the bearing, N.
pub const LOAD_N: f64 = 104.0;

/// Simulated shaft with the friction of Table 4.2 (Cohn 1998) and effects, in steps of 1 ms.
pub fn plant(effects: &[(&str, &[f64])]) -> Plant<f64, Journal<f64>> {
    let chain: Chain<f64, Journal<f64>> = chain_round(law(Clock::Journal), effects);
    Plant::new(chain, DRIVE, DT_S / 2.0).expect("the thesis's drive")
}

/// Controlled quantity: speed or angle.
#[derive(Clone, Copy, PartialEq)]
pub enum Control {
    Position,
    Velocity,
}

/// Creates the control loop with a compensator and with fault detection.
pub fn controller<T: Real, C: Compensator<T>>(
    control: Control,
    compensator: C,
) -> Controller<T, C> {
    let encoder = Encoder::new(COUNTS_PER_RAD, 16, 68.0, DT_S).expect("encoder");
    let (observer, base) = match control {
        Control::Position => (
            VelocityObserver::with_feedforward(15.0, DRIVE.damping_1_s, DRIVE.input_rad_s2_v, DT_S),
            BaseLaw::position(&Drive::THESIS).cast(),
        ),
        Control::Velocity => (
            VelocityObserver::new(15.0, DT_S),
            BaseLaw::velocity(&Drive::THESIS).cast(),
        ),
    };
    let limits = Limits::new(10.0).with_moving_v(3.0).with_patience_s(0.1);
    Controller::new(
        encoder,
        observer.expect("observer"),
        base,
        compensator,
        limits,
        DT_S,
    )
    .expect("limits")
}

/// Creates a compensator with the Coulomb friction observer.
pub fn coulomb<T: Real>() -> Coulomb<T> {
    let observer = CoulombObserver::new(0.01, 1.0, DRIVE.input_rad_s2_v, 3.0, DT_S);
    Coulomb::new(observer.expect("gains"), &DRIVE)
}

/// Creates the learning compensator of Cohn (1998).
pub fn learning<T: Real>(control: Control) -> Learning<T> {
    let rule = match control {
        Control::Position => Rule::THESIS_POSITION,
        Control::Velocity => Rule::Velocity,
    };
    let l = |k0, gamma| Learned { k0, gamma };
    let settings = learning::Settings::new(rule, Learned::THESIS, 5.1, 0.0127, DT_S)
        .with_gain(l(12_500.0, 0.5))
        .with_least(l(1.0, 1e-3))
        .with_most(l(1e7, 1e3));
    Learning::new(law(Clock::Thesis), &settings).expect("gains")
}

/// Settings of the compensator with a friction model and an observer, for this shaft.
pub fn settings(control: Control) -> Settings {
    let s = Settings::new(&DRIVE, 60.0, 0.05, DT_S)
        .with_learning_1_s(2.0)
        .with_level_limit_v(0.8)
        .with_rest_limit_v(0.8);
    match control {
        Control::Position => s
            .with_approach_1_s(10.0)
            .with_stiffer_v_rad(1.53)
            .with_stiffer_v_s_rad(0.049)
            .with_law_forward_v_s_rad(0.25164),
        Control::Velocity => s.with_law_forward_v_s_rad(0.295),
    }
}

/// Creates a compensator with a friction law, without effects, and an observer.
pub fn observed<T: Real>(control: Control) -> Observed<T, LawModel<T, Journal<T>>> {
    let model = LawModel::new(law(Clock::Journal), 0.0127, DRIVE.volts_per_n, LOAD_N);
    Observed::new(model, &settings(control)).expect("settings")
}

/// Creates a compensator with a friction chain with effects, and an observer.
pub fn observed_with<T: Real>(
    control: Control,
    effects: &[(&str, &[f64])],
) -> Observed<T, ChainModel<T, Journal<T>>> {
    let chain = chain_round(law(Clock::Journal), effects);
    let model = ChainModel::new(chain, DRIVE.volts_per_n, LOAD_N);
    Observed::new(model, &settings(control)).expect("settings")
}

/// Creates a compensator with a table of friction levels against speed.
pub fn table<T: Real>() -> Table<T, 8> {
    let levels = [0.8, 0.7, 0.6, 0.5, 0.4, 0.35, 0.3, 0.25];
    Table::new(levels.map(T::of), Axis::Speed, 0.5, 0.0).expect("table")
}

/// Creates a repetitive compensator with a period of two seconds.
pub fn repetitive<T: Real>() -> Repetitive<T, 64> {
    Repetitive::new(1000, 0.5, 0.1, 0.02, 3.0, DT_S).expect("lap")
}

/// Runs a block of code for a loop with each compensator of `jbf_core`.
#[macro_export]
macro_rules! with_each_compensator {
    ($t:ty, $control:expr, |$name:ident, $controller:ident| $body:block) => {{
        use $crate::common::bench;
        macro_rules! one {
            ($label:expr, $compensator:expr) => {{
                let $name = $label;
                let $controller = bench::controller::<$t, _>($control, $compensator);
                $body
            }};
        }
        one!("none", jbf_core::compensator::NoCompensation);
        one!("coulomb", bench::coulomb::<$t>());
        one!("learning", bench::learning::<$t>($control));
        one!("table", bench::table::<$t>());
        one!("repetitive", bench::repetitive::<$t>());
        one!("observed", bench::observed::<$t>($control));
        one!(
            "observed, with effects",
            bench::observed_with::<$t>(
                $control,
                &[("presliding", &[5e4]), ("coulomb_drag", &[2.0])]
            )
        );
    }};
}

/// Control loop with its simulated shaft.
pub struct Bench<T: Real, C: Compensator<T>> {
    pub plant: Plant<f64, Journal<f64>>,
    pub shaft: PlantState<f64, jbf_core::law::journal::State<f64>>,
    pub controller: Controller<T, C>,
    pub state: State<T, C::State>,
    pub load_n: f64,
    pub frozen: bool,
    pub shift: i64,
    counter: u32,
}

impl<T: Real, C: Compensator<T>> Bench<T, C> {
    pub fn new(plant: Plant<f64, Journal<f64>>, controller: Controller<T, C>) -> Self {
        Self {
            shaft: plant.start(LOAD_N, 30.0),
            plant,
            state: controller.start(),
            controller,
            load_n: LOAD_N,
            frozen: false,
            shift: 0,
            counter: 0,
        }
    }

    /// Advances the loop to a reference value and rate, and the shaft with the output of the loop.
    pub fn step(&mut self, value: f64, rate: f64) -> Signals<T> {
        if !self.frozen {
            let counts = (self.shaft.angle_rad * COUNTS_PER_RAD).floor() as i64 + self.shift;
            self.counter = counts as u32 & 0xffff;
        }
        let target = Target {
            value: T::of(value),
            rate: T::of(rate),
        };
        let parts = self.controller.step(&mut self.state, self.counter, &target);
        assert!(
            parts.output_v.is_finite() && parts.output_v.abs() <= T::of(10.0),
            "{:?}",
            parts.output_v
        );
        for _ in 0..2 {
            self.plant
                .step(&mut self.shaft, parts.output_v.value(), self.load_n);
        }
        parts
    }
}

/// Type of the control law without compensation.
pub type Plain = NoCompensation;
