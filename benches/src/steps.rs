//! List of every component that a control loop can step, each with a name.
//!
//! Criterion, the time budget and the instruction counts use this list. Laws and effects of the
//! catalogues are included automatically. To add another kind of component, write a function like
//! those below and call it in [`all`].
//!
//! All components run through whole periods of U = 0.127 sin(t) at 2 ms, so that reversals, contact
//! and full film occur in realistic proportions.

use crate::{chain, law, period, LOAD_N, LOOP_STEP_S};
use jbf_core::compensator::Compensator;
use jbf_core::controller::Controller;
use jbf_core::effect::CATALOGUE;
use jbf_core::law::journal::Parameters;
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::{self, with_law, Law, Named, Visitor};
use jbf_core::stepper::{Euler, Rk4, Rodas3, Rodas5P};
use jbf_core::JournalMotion;
use jbf_core::{Bearing, Clock, Dual, Motion, Real};
use jbf_trace::loops::{coulomb_observer, each, velocity_observer, LoopVisitor};
use jbf_trace::{asked, Shaft, LOOP_STEPS};
use std::hint::black_box;

/// Steps per period of the motion U = 0.127 sin(t).
pub const PERIOD: u64 = 3141;

/// Receiver of the components, which measures their steps.
pub trait Watch {
    /// Measures the component `name`; `steps(n)` makes `n` further steps of the component.
    fn watch(&mut self, name: &str, steps: &mut dyn FnMut(u64));
}

/// Passes every component to `watch`.
pub fn all(watch: &mut impl Watch) {
    laws::<f64>(watch, "f64");
    laws::<f32>(watch, "f32");
    steppers::<f64>(watch, "f64");
    steppers::<f32>(watch, "f32");
    chains(watch);
    loops::<f64>(watch, "f64");
    loops::<f32>(watch, "f32");
}

/// Passes a component to `watch`, which calls `step` with the motion at the start and the end of
/// each step.
fn along<T: Real, O>(
    watch: &mut impl Watch,
    name: &str,
    mut step: impl FnMut(&Motion<T>, &Motion<T>) -> O,
) {
    let motions = period::<T>();
    let mut at = 0;
    watch.watch(name, &mut |n| {
        for _ in 0..n {
            black_box(step(&motions[at], &motions[at + 1]));
            at = (at + 1) % (motions.len() - 1);
        }
    });
}

/// Absolute surface speeds |U| at the start, middle and end of a step.
fn speeds<T: Real>(from: &Motion<T>, to: &Motion<T>) -> [T; 3] {
    let (u0, u1) = (from.velocity_m_s, to.velocity_m_s);
    [u0, (u0 + u1) * T::of(0.5), u1].map(T::abs)
}

struct Bare<'a, W> {
    watch: &'a mut W,
    name: String,
}

impl<T: Real, W: Watch> Visitor<T> for Bare<'_, W> {
    type Output = ();

    /// Steps a law without effects: its state (film or frictional memory), friction and bristle.
    fn visit<L: Named<T>>(self, law: L) {
        let mut state = law.start(T::of(LOAD_N));
        let mut before = T::ZERO;
        let dt_s = T::of(LOOP_STEP_S);
        along(self.watch, &self.name, |from: &Motion<T>, to| {
            law.advance(&mut state, speeds(from, to), T::ONE, dt_s);
            let sliding = law.friction(&state, to.velocity_m_s);
            if !L::HAS_BRISTLE {
                return sliding.along(to.velocity_m_s.sign());
            }
            let levels = [before, sliding.jump];
            before = sliding.jump;
            let (from, to) = (JournalMotion::from(from), JournalMotion::from(to));
            law.bend(&mut state, &from, &to, levels, dt_s) + sliding.smooth
        });
    }
}

/// Steps every law of the catalogue with its own integration method, at its starting values.
fn laws<T: Real>(watch: &mut impl Watch, kind: &str) {
    for page in law::CATALOGUE {
        let values: Vec<T> = page.parameters.iter().map(|p| T::of(p.starts[0])).collect();
        let name = format!("law/{}/{kind}", page.name);
        let bearing = Some(&Bearing::THESIS);
        let bare = Bare { watch, name };
        with_law(
            page.name,
            bearing,
            Some(LOAD_N),
            &values,
            Clock::Journal,
            bare,
        )
        .expect("starting values are valid");
    }
}

/// Steps every integration method with the films that it supports, and evaluates the friction after
/// each step.
fn steppers<T: Real>(watch: &mut impl Watch, kind: &str) {
    let reduced = law::<T>(|_, v| T::of(v));
    let p = Parameters::TABLE_4_2;
    let parameters = Parameters {
        f_m: T::of(p.f_m),
        u_tr_m_s: T::of(p.u_tr_m_s),
        k0: T::of(p.k0),
        gamma: T::of(p.gamma),
    };
    let full = JournalFull::new(&Bearing::THESIS, LOAD_N, &parameters, Clock::Journal)
        .expect("Table 4.2 is valid");
    let dt_s = T::of(LOOP_STEP_S);
    macro_rules! on {
        ($($name:literal: $law:ident.$advance:ident($stepper:expr);)*) => {$({
            let mut state = $law.start(T::of(LOAD_N));
            along(watch, &format!("step/{}/{kind}", $name), |from: &Motion<T>, to| {
                $law.$advance(&$stepper, &mut state, speeds(from, to), T::ONE, dt_s);
                let u = to.velocity_m_s;
                $law.friction(&state, u).along(u.sign())
            });
        })*};
    }
    on! {
        "euler": reduced.advance_with(Euler);
        "rk4": reduced.advance_with(Rk4);
        "rodas3": reduced.advance_stiff_with(Rodas3);
        "rodas5p": reduced.advance_stiff_with(Rodas5P);
        "rodas3_full": full.advance_with(Rodas3);
        "rodas5p_full": full.advance_with(Rodas5P);
    }
}

fn one_chain<T: Real>(
    watch: &mut impl Watch,
    name: &str,
    effects: &[&str],
    lift: impl Fn(usize, f64) -> T,
) {
    let chain = chain(effects, lift);
    let mut state = chain.start(&period::<T>()[0]);
    let dt_s = T::of(LOOP_STEP_S);
    along(watch, name, |_, to| chain.step(&mut state, to, dt_s));
}

/// Steps the signal chain of the first law of the catalogue.
///
/// There is one component without effects, one with each effect, one with all effects, and one with
/// derivatives with respect to the four parameters.
fn chains(watch: &mut impl Watch) {
    let all: Vec<&str> = CATALOGUE.iter().map(|info| info.name).collect();
    one_chain(watch, "chain/none/f64", &[], |_, v| v);
    for name in &all {
        one_chain(watch, &format!("chain/{name}/f64"), &[name], |_, v| v);
    }
    one_chain(watch, "chain/all/f64", &all, |_, v| v);
    one_chain(watch, "chain/none/f32", &[], |_, v| v as f32);
    one_chain(watch, "chain/all/f32", &all, |_, v| v as f32);
    let dual = |i, v| Dual::<4>::parameter(v, i);
    one_chain(watch, "chain/none/dual4", &[], dual);
    one_chain(watch, "chain/all/dual4", &all, dual);
}

struct Looped<'a, W> {
    watch: &'a mut W,
    kind: &'a str,
}

impl<T: Real, W: Watch> LoopVisitor<T> for Looped<'_, W> {
    /// Steps a complete control loop, from encoder counter to voltage, along recorded encoder
    /// readings.
    ///
    /// With a closed loop, the time would include that of the simulated shaft.
    fn visit<C: Compensator<T>>(
        &mut self,
        name: &'static str,
        controller: &Controller<T, C>,
        position: bool,
    ) {
        let (mut state, mut shaft) = (controller.start(), Shaft::default());
        let seen: Vec<_> = (0..LOOP_STEPS)
            .map(|step| {
                let (target, level_v) = asked(step, position);
                let counter = shaft.counter(step);
                let parts = controller.step(&mut state, counter, &target);
                shaft.push(parts.output_v, level_v);
                (counter, target)
            })
            .collect();
        let (mut state, mut at) = (controller.start(), 0);
        let name = format!("loop/{name}/{}", self.kind);
        self.watch.watch(&name, &mut |n| {
            for _ in 0..n {
                let (counter, target) = &seen[at];
                black_box(controller.step(&mut state, *counter, target));
                at = (at + 1) % seen.len();
            }
        });
    }
}

/// Steps the velocity and friction observers without a loop, and a control loop with each
/// compensator.
fn loops<T: Real>(watch: &mut impl Watch, kind: &str) {
    let observer = velocity_observer::<T>().expect("valid");
    let mut velocity = T::ZERO;
    let name = format!("observer/velocity/{kind}");
    along(watch, &name, |from: &Motion<T>, to| {
        velocity = observer.correct(velocity, to.angle_rad - from.angle_rad);
        velocity = observer.predict(velocity, T::ONE);
        velocity
    });
    for exponent in [1.0, 0.5] {
        let observer = coulomb_observer::<T>(0.01, exponent).expect("valid");
        let mut state = observer.learned(T::ZERO);
        let name = format!("observer/coulomb/p={exponent}/{kind}");
        along(watch, &name, |_: &Motion<T>, to| {
            let v = to.velocity_m_s * T::of(100.0);
            let power = observer.power(v);
            let level = observer.level_v(&state, &power);
            observer.learn(&mut state, &power, v, level);
            level
        });
    }
    each::<T>(&mut Looped { watch, kind }).expect("every loop is valid");
}
