//! Threads that can't change a result: fixed chunks, folded in order. The only file that names rayon.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};
use std::thread;

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
    let results: Vec<Mutex<Option<T>>> = (0..n).map(|_| Mutex::new(None)).collect();
    let set = |i: usize| {
        let result = f(i);
        *results[i].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
    };
    each(n, &set);
    let result = |slot: Mutex<Option<T>>| slot.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.into_iter().map(|slot| result(slot).expect("every index is done")).collect()
}

/// `f` of every index, in any order. Here and below `dyn` lets all callers share one build of what rayon does: it was one in
/// thirteen of all lines that LLVM is given.
fn each(n: usize, f: &(dyn Fn(usize) + Sync)) {
    (0..n).into_par_iter().for_each(f);
}

/// The same of work that waits for other programs, or is long: each on a thread of its own, in order, as many at once as there are
/// threads. Nothing of one is done in the middle of another.
pub fn map_apart<T: Send>(n: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mine = std::iter::repeat_with(|| next.fetch_add(1, Relaxed)).take_while(|&i| i < n);
        with_threads(Some(1), || mine.map(|i| (i, f(i))).collect::<Vec<_>>())
    };
    let mut all: Vec<(usize, T)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads().min(n)).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)))
            .collect()
    });
    all.sort_by_key(|(i, _)| *i);
    all.into_iter().map(|(_, result)| result).collect()
}

/// `f(i, chunk)` for consecutive chunks of `size` entries (the last may be shorter).
pub fn for_chunks<T: Send>(data: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
    let f: &(dyn Fn(usize, &mut [T]) + Sync) = &f;
    data.par_chunks_mut(size).enumerate().for_each(|(i, chunk)| f(i, chunk));
}

/// `f(&mut item)` for every item; items own their data, so the order of execution can't matter.
pub fn for_each<T: Send>(items: &mut [T], f: impl Fn(&mut T) + Sync + Send) {
    let f: &(dyn Fn(&mut T) + Sync) = &f;
    items.par_iter_mut().for_each(f);
}

/// The same; meanwhile an item has one of `spare` to itself, or a new one, and leaves it as it found it: nobody says which.
pub fn for_each_with<T: Send, S: Send + Default>(
    items: &mut [T],
    spare: &mut Vec<S>,
    f: impl Fn(&mut T, &mut S) + Sync + Send,
) {
    let spare = Mutex::new(spare);
    let spare = || spare.lock().unwrap_or_else(PoisonError::into_inner);
    for_each(items, |item| {
        let mut own = spare().pop().unwrap_or_default();
        f(item, &mut own);
        spare().push(own);
    });
}

/// Runs both closures, on two threads if there are two.
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}
