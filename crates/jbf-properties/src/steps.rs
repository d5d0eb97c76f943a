//! Counts the steps that were checked: a property that checks none is not tested.

use core::cell::Cell;

thread_local! {
    static SEEN: Cell<u64> = const { Cell::new(0) };
}

/// Counts one step.
pub fn seen() {
    SEEN.set(SEEN.get() + 1);
}

/// Number of steps that this thread has checked.
#[must_use]
pub fn all_seen() -> u64 {
    SEEN.get()
}
