//! How often a run is saved: so often that little is lost, so seldom that it costs little.

use std::time::{Duration, Instant};

use super::checkpoint::{Checkpoint, RunFolder};
use crate::error::Result;
use crate::files::npz::Array;

/// The longest that may be lost where a checkpoint costs little: seconds of wall clock.
const EVERY: f64 = 10.0;

/// The share of a run's time that checkpoints may take.
const SHARE: f64 = 0.01;

/// When the next checkpoint is due.
#[derive(Debug)]
pub(super) struct Pace {
    last: Instant,
    interval: f64,
}

impl Pace {
    pub(super) fn new() -> Self {
        Pace { last: Instant::now(), interval: EVERY }
    }

    pub(super) fn due(&self) -> bool {
        self.last.elapsed().as_secs_f64() >= self.interval
    }

    /// Writes a checkpoint; one with a number in it that is none isn't kept, and the last good one stays.
    pub(super) fn save<State: Iterator<Item = (String, Array)>>(
        &mut self,
        folder: &RunFolder,
        checkpoint: impl Fn() -> Checkpoint<State>,
    ) -> Result<Saved> {
        let began = Instant::now();
        if let Some((name, _)) = checkpoint().state.find(|(_, array)| !finite(array)) {
            return Ok(Saved::Spoiled(name));
        }
        folder.save(checkpoint())?;
        Ok(self.saved(began.elapsed()))
    }

    fn saved(&mut self, cost: Duration) -> Saved {
        let usual = self.interval == EVERY;
        (self.last, self.interval) = (Instant::now(), interval(cost));
        if usual && self.interval > EVERY {
            return Saved::Slow { cost: cost.as_secs_f64(), every: self.interval };
        }
        Saved::Usual
    }
}

/// What became of a checkpoint.
#[derive(Debug, PartialEq)]
pub(super) enum Saved {
    /// It was written.
    Usual,
    /// It was written, and for the first time took so many seconds that the next comes later than usual.
    Slow { cost: f64, every: f64 },
    /// The array of this name has a number that isn't finite.
    Spoiled(String),
}

fn finite(array: &Array) -> bool {
    match array {
        Array::F64(array) => array.iter().all(|x| x.is_finite()),
        Array::F32(array) => array.iter().all(|x| x.is_finite()),
        _ => true,
    }
}

fn interval(cost: Duration) -> f64 {
    EVERY.max(cost.as_secs_f64() / SHARE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_checkpoint_is_written_less_often() {
        assert_eq!(interval(Duration::from_millis(20)), 10.0);
        assert_eq!(interval(Duration::from_millis(300)), 30.0);
        let mut pace = Pace::new();
        assert!(!pace.due());
        assert_eq!(pace.saved(Duration::from_millis(50)), Saved::Usual);
        assert_eq!(pace.saved(Duration::from_millis(500)), Saved::Slow { cost: 0.5, every: 50.0 });
        assert_eq!(pace.saved(Duration::from_millis(600)), Saved::Usual, "said once");
        pace.interval = 0.0;
        assert!(pace.due());
    }
}
