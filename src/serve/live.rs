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

/// The state of a model after a step.
struct Given {
    step: u64,
    came: Instant,
    state: Arrays,
}

/// What training and the server share.
pub(crate) struct Live {
    end: Options,
    began: Instant,
    /// Step and seconds that it began with.
    before: (u64, f64),
    step: AtomicU64,
    /// Whether somebody waits for parameters.
    wanted: AtomicBool,
    given: Mutex<Option<Given>>,
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
            *locked(&self.given) = Some(Given { step, came: Instant::now(), state: model.state() });
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
        if old
            && at.0 != self.step.load(Relaxed)
            && let Some(Given { step, came, state }) = self.asked()
        {
            model.restore(&state, "the run that is being trained")?;
            *at = (step, Some(came));
        }
        Ok(at.0)
    }
}

impl Live {
    /// Parameters as new as a step takes no longer than [`PATIENCE`]; otherwise those that came too late for the last view, and what
    /// comes too late for this one is there for the next.
    fn asked(&self) -> Option<Given> {
        let mut given = locked(&self.given);
        let late = given.take();
        if late.as_ref().is_some_and(|late| late.came.elapsed() < FRESH) {
            return late;
        }
        self.wanted.store(true, Relaxed);
        let waited = self.handed.wait_timeout_while(given, PATIENCE, |given| given.is_none());
        waited.unwrap_or_else(PoisonError::into_inner).0.take().or(late)
    }
}

/// A lock whose holder can't have left it half done.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;
    use crate::scene::{self, Scene};
    use crate::training::nerf::{NerfModel, NerfSettings};

    fn model(scene: &Scene, seed: u64) -> NerfModel {
        let mut settings = NerfSettings::new(scene.near, scene.far, scene.background);
        settings.set_width(8);
        settings.seed = seed;
        NerfModel::new(settings)
    }

    /// Copied when somebody asks and at no other time; what came too late is there for the next, and isn't taken for new later on.
    #[test]
    fn parameters_are_handed_over_when_asked_for() {
        let scene = scene::load("builtin:blob,size=8", &scene::Options::default()).unwrap();
        let (trained, mut shown) = (model(&scene, 1), model(&scene, 2));
        let live = Live::new(&Options::default(), &[]);
        let taken = |live: &Live| locked(&live.given).is_some();
        live.stepped(1, &trained);
        assert!(!taken(&live), "nobody has asked");
        assert_ne!(shown.state(), trained.state());
        assert_eq!(live.newest(&mut shown).unwrap(), 0, "no step was done while it waited");
        live.stepped(2, &trained);
        assert!(taken(&live));
        assert_eq!(live.newest(&mut shown).unwrap(), 2);
        assert_eq!(shown.state(), trained.state());
        live.stepped(3, &trained);
        assert!(!taken(&live) && live.newest(&mut shown).unwrap() == 2, "that is new enough");
        let aged = |age: u64| Some(Instant::now() - Duration::from_secs(age));
        locked(&live.at).1 = aged(60);
        let step = thread::scope(|threads| {
            let asking = threads.spawn(|| live.newest(&mut shown).unwrap());
            while !live.wanted.load(Relaxed) {
                thread::yield_now();
            }
            live.stepped(4, &trained);
            asking.join().unwrap()
        });
        assert_eq!((step, taken(&live)), (4, false));
        // One that came too late, a minute ago: better than nothing, and asked for anew.
        live.stepped(9, &trained);
        locked(&live.at).1 = aged(90);
        *locked(&live.given) = Some(Given { step: 5, came: aged(60).unwrap(), state: trained.state() });
        assert_eq!(live.newest(&mut shown).unwrap(), 5);
        assert!(live.wanted.load(Relaxed));
    }
}
