//! Runs each component for `benches/counts.py`, which counts the instructions of this program with
//! callgrind.
//!
//! A call of `jbf_counts_mark` separates the components; their names are printed in order.

use jbf_benches::steps::{all, Watch, PERIOD};
use std::hint::black_box;

/// Marks the end of the measurement of a component.
///
/// Callgrind writes the instruction counts since the previous call.
#[inline(never)]
fn jbf_counts_mark() {
    black_box(());
}

struct Counted;

impl Watch for Counted {
    fn watch(&mut self, name: &str, steps: &mut dyn FnMut(u64)) {
        println!("{name}");
        // Run half a period first, so that the initial steps are not counted.
        steps(PERIOD / 2);
        jbf_counts_mark();
        steps(PERIOD);
        jbf_counts_mark();
    }
}

fn main() {
    println!("steps {PERIOD}");
    all(&mut Counted);
}
