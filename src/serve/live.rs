//! A run that is being trained: the loop hands over its parameters between two steps, when somebody has asked for them.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::{Progress, Source};
use crate::error::Result;
use crate::files::npz::Arrays;
use crate::training::model::Model;
use crate::training::outlook;
use crate::training::run::{LogPoint, Options};

/// Parameters this young are new enough: who drags asks for many views a second.
const FRESH: Duration = Duration::from_secs(2);

/// How long a view waits for the step that is being done, before it is rendered with what was there before.
const PATIENCE: Duration = Duration::from_millis(500);

/// What training and the server share.
pub(crate) struct Live {
    end: Options,
    began: Instant,
    /// Step and seconds that it began with.
    before: (u64, f64),
    step: AtomicU64,
    /// Whether somebody waits for parameters.
    wanted: AtomicBool,
    given: Mutex<Option<(u64, Arrays)>>,
    handed: Condvar,
    log: Mutex<Vec<LogPoint>>,
    /// The step of the parameters that views are rendered with, and when they came.
    at: Mutex<(u64, Option<Instant>)>,
}

impl Live {
    /// A run that goes on after these measurements.
    pub(crate) fn new(end: &Options, log: &[LogPoint]) -> Self {
        let before = log.last().map_or((0, 0.0), |point| (point.step, point.seconds));
        Live {
            end: end.clone(),
            began: Instant::now(),
            before,
            step: before.0.into(),
            wanted: false.into(),
            given: Mutex::default(),
            handed: Condvar::new(),
            log: Mutex::new(log.to_vec()),
            at: Mutex::new((before.0, None)),
        }
    }

    /// Between two steps: training's only work for the server, and next to none where nobody has asked.
    pub(crate) fn stepped(&self, step: u64, model: &dyn Model) {
        self.step.store(step, Relaxed);
        if self.wanted.swap(false, Relaxed) {
            *locked(&self.given) = Some((step, model.state()));
            self.handed.notify_all();
        }
    }

    /// A measurement.
    pub(crate) fn measured(&self, point: &LogPoint) {
        locked(&self.log).push(point.clone());
    }
}

impl Source for Live {
    fn progress(&self) -> Result<Progress> {
        let (step, log) = (self.step.load(Relaxed), locked(&self.log).clone());
        let seconds = self.before.1 + self.began.elapsed().as_secs_f64();
        let left = outlook::left(&self.end, self.before, (step, seconds));
        Ok(Progress { step, live: true, left, log })
    }

    fn newest(&self, model: &mut dyn Model) -> Result<u64> {
        let mut at = locked(&self.at);
        let old = at.1.is_none_or(|came| came.elapsed() >= FRESH);
        if old && at.0 != self.step.load(Relaxed) {
            self.wanted.store(true, Relaxed);
            let given = locked(&self.given);
            let waited = self.handed.wait_timeout_while(given, PATIENCE, |given| given.is_none());
            let (mut given, _) = waited.unwrap_or_else(PoisonError::into_inner);
            // What comes later is there for the next view.
            if let Some((step, state)) = given.take() {
                drop(given);
                model.restore(&state, "the run that is being trained")?;
                *at = (step, Some(Instant::now()));
            }
        }
        Ok(at.0)
    }
}

/// A lock whose holder can't have left it half done.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
