//! Faults on purpose, for tests of what is kept: one operation on files fails, or is the last that the program does.
//!
//! Whatever writes calls `strike` before each write, rename, sync and opening. Nothing is armed but by [`arm`], which only tests call.

use std::io;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering::SeqCst};

/// What happens at the operation that was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// It fails; those after it succeed again.
    Fails = 1,
    /// It and all after it fail, as on a full disk.
    FailsForGood = 2,
    /// The program ends there, without any cleaning up.
    Ends = 3,
}

/// Operations so far.
static DONE: AtomicU64 = AtomicU64::new(0);
/// The one to strike at, counted from 1; 0 where none is armed.
static AT: AtomicU64 = AtomicU64::new(0);
static KIND: AtomicU8 = AtomicU8::new(0);

/// Strikes at the `nth` operation of the program.
pub fn arm(fault: Fault, nth: u64) {
    KIND.store(fault as u8, SeqCst);
    AT.store(nth, SeqCst);
}

/// Operations so far.
pub fn operations() -> u64 {
    DONE.load(SeqCst)
}

/// Counts an operation, and fails or ends the program where it is the chosen one.
pub(super) fn strike() -> io::Result<()> {
    strike_after(|| ())
}

/// The same, with what still gets done where it strikes.
pub(super) fn strike_after(half: impl FnOnce()) -> io::Result<()> {
    let (now, at, kind) = (DONE.fetch_add(1, SeqCst) + 1, AT.load(SeqCst), KIND.load(SeqCst));
    let struck = at > 0 && (now == at || (now > at && kind == Fault::FailsForGood as u8));
    if !struck {
        return Ok(());
    }
    half();
    if kind == Fault::Ends as u8 {
        std::process::abort();
    }
    Err(io::Error::other(format!("fault at operation {now}")))
}
