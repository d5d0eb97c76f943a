//! Thread pool of the process.
//!
//! A forked process (the default for worker processes on Linux) has no threads of its parent. The
//! global pool of rayon expects these threads and would wait for them forever. Each process
//! therefore creates its own pool when it first needs one.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Returns the pool of this process; `None` if threads cannot be created.
fn pool() -> Option<Arc<ThreadPool>> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match kept.take() {
        Some((owner, pool)) if owner == process::id() => {
            *kept = Some((owner, Arc::clone(&pool)));
            return Some(pool);
        }
        // Dropping the parent's pool would wait for its threads.
        Some((_, pool)) => std::mem::forget(pool),
        None => {}
    }
    let pool = Arc::new(ThreadPoolBuilder::new().build().ok()?);
    *kept = Some((process::id(), Arc::clone(&pool)));
    Some(pool)
}

/// Runs `work` with its parallel parts on the threads of this process.
pub fn on_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    match pool() {
        Some(pool) => pool.install(work),
        None => work(),
    }
}
