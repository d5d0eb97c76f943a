//! Time of one step of every component of a control loop.

use criterion::Criterion;
use jbf_benches::steps::{all, Watch};
use std::time::Instant;

struct Timed(Criterion);

impl Watch for Timed {
    fn watch(&mut self, name: &str, steps: &mut dyn FnMut(u64)) {
        self.0.bench_function(name, |b| {
            b.iter_custom(|n| {
                let begin = Instant::now();
                steps(n);
                begin.elapsed()
            });
        });
    }
}

fn main() {
    let mut timed = Timed(Criterion::default().configure_from_args());
    all(&mut timed);
    timed.0.final_summary();
}
