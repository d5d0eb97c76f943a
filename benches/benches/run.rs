//! Time to predict the friction along a record of 60 s at 50 samples/s, with inner steps of 2 ms
//! and of 20 ms.
//!
//! A fit makes such predictions, without derivatives and with derivatives with respect to four
//! parameters.

use criterion::{Criterion, Throughput};
use jbf_benches::{chain, two_way};
use jbf_core::run::{predict, Record};
use jbf_core::{Dual, Motion, Real};

fn record() -> [Vec<f64>; 5] {
    let motions: Vec<Motion<f64>> = (0..=3000).map(|i| two_way(0.02 * f64::from(i))).collect();
    let column = |f: fn(&Motion<f64>) -> f64| motions.iter().map(f).collect();
    [
        column(|m| m.time_s),
        column(|m| m.velocity_m_s),
        column(|m| m.acceleration_m_s2),
        column(|m| m.angle_rad),
        column(|m| m.load_n),
    ]
}

fn run<T: Real>(c: &mut Criterion, name: &str, step_s: f64, lift: impl Fn(usize, f64) -> T) {
    let chain = chain(&[], lift);
    let [time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n] = &record();
    let record = Record {
        time_s,
        velocity_m_s,
        acceleration_m_s2,
        angle_rad,
        weight_offset_rad: None,
        load_n,
        temperature_c: None,
    };
    let mut group = c.benchmark_group("run");
    group.throughput(Throughput::Elements((60.0 / step_s) as u64));
    group.bench_function(name, |b| {
        b.iter(|| {
            let mut sum = T::ZERO;
            predict(&chain, &record, step_s, |_, f| sum += f);
            sum
        });
    });
    group.finish();
}

fn runs(c: &mut Criterion) {
    run(c, "60s_at_2ms/f64", 0.002, |_, v| v);
    run(c, "60s_at_20ms/f64", 0.02, |_, v| v);
    run(c, "60s_at_20ms/dual4", 0.02, |i, v| {
        Dual::<4>::parameter(v, i)
    });
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    runs(&mut criterion);
    criterion.final_summary();
}
