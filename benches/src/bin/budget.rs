//! Prints a table of the time per step of each component, relative to the 2 ms of a control loop.
//!
//! An argument selects the components whose names contain it:
//!
//! `cargo run --release -p jbf-benches --bin budget -- chain/`

use jbf_benches::steps::{all, Watch, PERIOD};
use jbf_benches::LOOP_STEP_S;
use std::time::Instant;

/// Number of timed periods of the motion; the reported time is the median.
const BATCHES: usize = 41;

struct Budget {
    wanted: Option<String>,
}

impl Watch for Budget {
    fn watch(&mut self, name: &str, steps: &mut dyn FnMut(u64)) {
        if !self.wanted.as_ref().is_none_or(|w| name.contains(w)) {
            return;
        }
        steps(PERIOD);
        let mut ns: Vec<f64> = (0..BATCHES)
            .map(|_| {
                let begin = Instant::now();
                steps(PERIOD);
                begin.elapsed().as_secs_f64() * 1e9 / PERIOD as f64
            })
            .collect();
        ns.sort_by(f64::total_cmp);
        let (least, middle) = (ns[0], ns[BATCHES / 2]);
        let share = middle * 1e-9 / LOOP_STEP_S;
        println!(
            "| `{name}` | {least:.0} | {middle:.0} | {:.4} % | {:.0} |",
            100.0 * share,
            1.0 / share
        );
    }
}

fn main() {
    let wanted = std::env::args().nth(1);
    println!("| step of | least, ns | median, ns | share of 2 ms | fit into 2 ms |");
    println!("|---|---|---|---|---|");
    all(&mut Budget { wanted });
}
