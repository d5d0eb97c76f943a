//! How many steps were looked at: a property that looks at none holds for nothing.

use core::cell::Cell;

thread_local! {
    static SEEN: Cell<u64> = const { Cell::new(0) };
}

/// One more.
pub fn seen() {
    SEEN.set(SEEN.get() + 1);
}

/// All that this thread has looked at.
#[must_use]
pub fn all_seen() -> u64 {
    SEEN.get()
}
