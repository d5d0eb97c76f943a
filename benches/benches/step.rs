//! One step of the bare law, Euler and Runge-Kutta, in single and double precision.

use criterion::Criterion;
use jbf_benches::{law, period, LOAD_N, LOOP_STEP_S};
use jbf_core::law::Law;
use jbf_core::stepper::{Euler, Rk4, Stepper};
use jbf_core::Real;

fn step<T: Real>(c: &mut Criterion, name: &str, stepper: &impl Stepper) {
    let law = law(|_, v| T::of(v));
    let speeds: Vec<T> = period::<T>().iter().map(|m| m.velocity_m_s).collect();
    let mut state = law.start(T::of(LOAD_N));
    let dt = T::of(LOOP_STEP_S);
    let mut i = 0;
    c.bench_function(name, |b| {
        b.iter(|| {
            let [from, to] = [speeds[i], speeds[i + 1]];
            i = (i + 1) % (speeds.len() - 1);
            let middle = (from + to) * T::of(0.5);
            let u = [from, middle, to].map(T::abs);
            law.advance_with(stepper, &mut state, u, T::ONE, dt);
            law.friction(&state, to).coefficient(to.sign())
        });
    });
}

fn steps(c: &mut Criterion) {
    step::<f32>(c, "step/euler/f32", &Euler);
    step::<f64>(c, "step/euler/f64", &Euler);
    step::<f32>(c, "step/rk4/f32", &Rk4);
    step::<f64>(c, "step/rk4/f64", &Rk4);
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    steps(&mut criterion);
    criterion.final_summary();
}
