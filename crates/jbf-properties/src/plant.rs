//! Property: the motion of the simulated shaft with any friction is finite, friction is passive,
//! and the number of trials per step is bounded.

use crate::bytes::{between, clock, effects, number, parameters};
use crate::steps::seen;
use arbitrary::{Result, Unstructured};
use core::cell::Cell;
use jbf_core::effect::Effects;
use jbf_core::law::{self, with_law, Law, Named, Scales, Visitor};
use jbf_core::plant::{Drive, Plant};
use jbf_core::JournalMotion;
use jbf_core::{Bearing, Chain, Friction, Real};

/// Largest load, N.
const LARGEST: f64 = 1e4;

/// Largest number of evaluations of friction per step: for both solution methods, and for the shaft
/// at rest.
const MOST_TRIALS: u32 = 56;

thread_local! {
    static TRIALS: Cell<u32> = const { Cell::new(0) };
}

/// Law that counts the calls that advance it.
#[derive(Clone, Copy, Debug)]
struct Counted<L>(L);

impl<T: Real, L: Law<T>> Law<T> for Counted<L> {
    type State = L::State;
    const HAS_BRISTLE: bool = L::HAS_BRISTLE;
    const BENDS_WHOLE: bool = L::BENDS_WHOLE;
    const HAS_STATIC_LEVEL: bool = L::HAS_STATIC_LEVEL;

    fn start(&self, load_n: T) -> L::State {
        self.0.start(load_n)
    }

    fn pressed_n(&self, load_n: T) -> T {
        self.0.pressed_n(load_n)
    }

    fn load_share(&self, load_n: T) -> T {
        self.0.load_share(load_n)
    }

    fn scaled(&self, scales: &Scales<T>) -> Option<Self> {
        self.0.scaled(scales).map(Counted)
    }

    fn set_load(&self, state: &mut L::State, load_n: T) {
        self.0.set_load(state, load_n);
    }

    fn friction(&self, state: &L::State, velocity_m_s: T) -> Friction<T> {
        self.0.friction(state, velocity_m_s)
    }

    fn longest_step_s(&self, top_speed_m_s: f64) -> f64 {
        self.0.longest_step_s(top_speed_m_s)
    }

    fn advance(&self, state: &mut L::State, speed_m_s: [T; 3], rate: T, dt_s: T) {
        TRIALS.set(TRIALS.get() + 1);
        self.0.advance(state, speed_m_s, rate, dt_s);
    }

    fn bend(
        &self,
        state: &mut L::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        level: [T; 2],
        dt_s: T,
    ) -> T {
        self.0.bend(state, from, to, level, dt_s)
    }
}

struct Turning<'a, 'b, T: Real> {
    bytes: &'a mut Unstructured<'b>,
    values: &'a [T],
    effects: Effects<T>,
}

impl<T: Real> Visitor<T> for Turning<'_, '_, T> {
    type Output = Result<()>;

    fn visit<L: Named<T>>(self, law: L) -> Result<()> {
        let bytes = self.bytes;
        let drive = Drive::new(between(bytes, 0.1, 1e3)?, between(bytes, 0.1, 1e4)?)
            .with_volts_per_n(between(bytes, 1e-6, 1.0)?);
        let step_s = between(bytes, 1e-5, 1e-2)?;
        let parts = (self.values, self.effects);
        let chain = Chain::new(Counted(law))
            .with_effects(self.effects)
            .on(&Bearing::THESIS);
        let Ok(plant) = Plant::new(chain, drive, step_s) else {
            return Ok(());
        };
        let mut load_n = T::of(104.0);
        let mut state = plant.start(load_n, 0.0);
        for _ in 0..64 {
            if bytes.is_empty() {
                break;
            }
            if bytes.ratio(1, 8)? {
                load_n = T::of(number(bytes, LARGEST)?);
            }
            let input_v = T::of(number(bytes, 1e9)?);
            TRIALS.set(0);
            plant.step(&mut state, input_v, load_n);
            seen();
            let trials = TRIALS.get();
            let told = || {
                let there = (state.angle_rad, state.speed_rad_s, state.friction_v);
                format!(
                    "{} {drive:?} {step_s} {input_v:?} {load_n:?} {there:?} of {parts:?}",
                    L::INFO.name
                )
            };
            assert!(trials <= MOST_TRIALS, "{trials} trials: {}", told());
            let finite = [state.angle_rad, state.speed_rad_s, state.friction_v];
            assert!(finite.iter().all(|x| x.is_finite()), "{}", told());
        }
        Ok(())
    }
}

fn run<T: Real>(bytes: &mut Unstructured<'_>) -> Result<()> {
    let page = bytes.choose(law::CATALOGUE)?;
    let values = parameters::<T>(bytes, page.parameters)?;
    let effects = effects(bytes, page)?;
    let clock = clock(bytes)?;
    let bearing = Some(&Bearing::THESIS);
    let turning = Turning {
        bytes,
        values: &values,
        effects,
    };
    with_law(page.name, bearing, Some(104.0), &values, clock, turning).unwrap_or(Ok(()))
}

/// Checks that the motion of a shaft with any friction is finite, and that a step needs few trials,
/// if voltages and loads jump.
pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    if bytes.arbitrary()? {
        run::<f32>(bytes)
    } else {
        run::<f64>(bytes)
    }
}
