//! Counter of checked steps, to detect a property that checks nothing.

use core::cell::Cell;

thread_local! {
    static SEEN: Cell<u64> = const { Cell::new(0) };
}

/// Counts one checked step.
pub fn seen() {
    SEEN.set(SEEN.get() + 1);
}

/// Returns the number of steps that this thread has checked.
#[must_use]
pub fn all_seen() -> u64 {
    SEEN.get()
}
