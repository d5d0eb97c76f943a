//! Steps for `benches/counts.py`, which runs this under callgrind: a call of the mark parts one
//! thing from the next, and the names go to standard output in their order.

use jbf_benches::steps::{all, Watch, PERIOD};
use std::hint::black_box;

/// Callgrind writes down what it counted since the last mark.
#[inline(never)]
fn jbf_counts_mark() {
    black_box(());
}

struct Counted;

impl Watch for Counted {
    fn watch(&mut self, name: &str, steps: &mut dyn FnMut(u64)) {
        println!("{name}");
        // Half a period first, so that no run counts its own beginning.
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
