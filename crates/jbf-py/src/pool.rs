//! The threads that work is shared among.
//!
//! A process that was forked off another (Python's default for worker processes on Linux) has none of
//! its parent's threads, but rayon's own pool believes that they live, and waits for them for ever.
//! So each process makes its pool when it first needs one.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// This process's pool; none where threads cannot be made.
fn pool() -> Option<Arc<ThreadPool>> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match kept.take() {
        Some((owner, pool)) if owner == process::id() => {
            *kept = Some((owner, Arc::clone(&pool)));
            return Some(pool);
        }
        // To drop the parent's pool would be to wait for its threads.
        Some((_, pool)) => std::mem::forget(pool),
        None => {}
    }
    let pool = Arc::new(ThreadPoolBuilder::new().build().ok()?);
    *kept = Some((process::id(), Arc::clone(&pool)));
    Some(pool)
}

/// Do `work`, whose parallel parts run on this process's threads.
pub fn on_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    match pool() {
        Some(pool) => pool.install(work),
        None => work(),
    }
}
