//! One step of the whole chain: without effects, with each, with all, and with the
//! derivatives of the four parameters carried along.

use criterion::Criterion;
use jbf_benches::{chain, period, LOOP_STEP_S};
use jbf_core::effect::CATALOGUE;
use jbf_core::{Dual, Real};

fn step<T: Real>(c: &mut Criterion, name: &str, effects: &[&str], lift: impl Fn(usize, f64) -> T) {
    let chain = chain(effects, lift);
    let motions = period::<T>();
    let mut state = chain.start(&motions[0]);
    let dt = T::of(LOOP_STEP_S);
    let mut i = 0;
    c.bench_function(name, |b| {
        b.iter(|| {
            i = (i + 1) % motions.len();
            chain.step(&mut state, &motions[i], dt)
        });
    });
}

fn steps(c: &mut Criterion) {
    let all: Vec<&str> = CATALOGUE.iter().map(|info| info.name).collect();
    step(c, "chain/none/f64", &[], |_, v| v);
    for name in &all {
        step(c, &format!("chain/{name}/f64"), &[name], |_, v| v);
    }
    step(c, "chain/all/f64", &all, |_, v| v);
    step(c, "chain/none/f32", &[], |_, v| v as f32);
    step(c, "chain/all/f32", &all, |_, v| v as f32);
    step(c, "chain/none/dual4", &[], |i, v| {
        Dual::<4>::parameter(v, i)
    });
    step(c, "chain/all/dual4", &all, |i, v| {
        Dual::<4>::parameter(v, i)
    });
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    steps(&mut criterion);
    criterion.final_summary();
}
