//! Threads that can't change a result: fixed chunks, folded in order. The only file that names rayon.

use rayon::prelude::*;

use crate::error::{Error, Result};

/// Runs `work` with `threads` threads (all cores where `None`).
///
/// # Panics
/// Where they can't be started; [`on_threads`] says so.
pub fn with_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> T {
    on_threads(threads, || Ok(work())).expect("threads can be started")
}

/// The same of work that may fail.
///
/// # Errors
/// Those of `work`, and where so many threads can't be started.
pub fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let Some(n) = threads else { return work() };
    let refused = |error| Error::usage("threads", n, format!("as many as the system starts ({error})"));
    rayon::ThreadPoolBuilder::new().num_threads(n).build().map_err(refused)?.install(work)
}

/// The number of threads in use.
pub fn threads() -> usize {
    rayon::current_num_threads()
}

/// `f(0), f(1), ..., f(n - 1)`, in order, on all threads.
pub fn map<T: Send>(n: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    (0..n).into_par_iter().map(f).collect()
}

/// `f(i, chunk)` for consecutive chunks of `size` entries (the last may be shorter).
pub fn for_chunks<T: Send>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
    data.par_chunks_mut(size).enumerate().for_each(|(i, chunk)| f(i, chunk));
}

/// `f(&mut item)` for every item; items own their data, so the order of execution can't matter.
pub fn for_each<T: Send>(items: &mut [T], f: impl Fn(&mut T) + Sync + Send) {
    items.par_iter_mut().for_each(f);
}

/// Runs both closures, on two threads if there are two.
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}
