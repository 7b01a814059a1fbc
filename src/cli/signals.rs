//! SIGINT and SIGTERM while a run is written: the first lets the step finish and be kept, the second ends the program at once.

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::SeqCst};
use std::sync::{Arc, OnceLock};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::output;

/// What the handlers, which stay for as long as the program, read and write.
struct Handlers {
    /// Whether a signal ends the program: always but while somebody listens and hasn't heard one yet.
    at_once: Arc<AtomicBool>,
    /// The last signal; 0: none.
    heard: Arc<AtomicUsize>,
}

static HANDLERS: OnceLock<Option<Handlers>> = OnceLock::new();

/// Listens until it is dropped.
pub(super) struct Signals(Option<&'static Handlers>);

impl Signals {
    /// Begins to listen. Where the system has no such handlers, signals do what they always do.
    pub(super) fn listen() -> Self {
        let handlers = HANDLERS.get_or_init(|| install().ok()).as_ref();
        if let Some(Handlers { at_once, heard }) = handlers {
            heard.store(0, SeqCst);
            at_once.store(false, SeqCst);
        }
        Signals(handlers)
    }

    /// The signal that came.
    pub(super) fn heard(&self) -> Option<Signal> {
        let number = self.0.map_or(0, |handlers| handlers.heard.load(SeqCst));
        (number > 0).then_some(Signal(number as i32))
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        if let Some(handlers) = self.0 {
            handlers.at_once.store(true, SeqCst);
        }
    }
}

/// A signal that came.
#[derive(Clone, Copy)]
pub(super) struct Signal(i32);

impl Signal {
    /// Says what stopped the run and what comes `next`; the exit code that it asks for: 128 and its number.
    pub(super) fn end(self, next: &str) -> ExitCode {
        let name = if self.0 == SIGINT { "SIGINT" } else { "SIGTERM" };
        output::say(&format!("stopped by {name}; {next}"));
        ExitCode::from(128 + self.0 as u8)
    }
}

fn install() -> std::io::Result<Handlers> {
    let handlers = Handlers { at_once: Arc::default(), heard: Arc::default() };
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first of two signals finds that it isn't the second.
        flag::register_conditional_shutdown(signal, 128 + signal, handlers.at_once.clone())?;
        flag::register(signal, handlers.at_once.clone())?;
        flag::register_usize(signal, handlers.heard.clone(), signal as usize)?;
    }
    Ok(handlers)
}
