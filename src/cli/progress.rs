//! Progress on stderr.

use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::output;
use crate::training::outlook;
use crate::training::run::{LogPoint, Options};

/// How often what stands beside a bar of training is made anew.
const ANEW: Duration = Duration::from_millis(250);

/// A bar over `length` steps, a spinner where the length isn't known. Silent where stderr is no terminal, or nothing is to be said.
pub(super) fn bar(length: Option<u64>, what: &'static str) -> ProgressBar {
    match length {
        Some(n) => styled(Some(n), what, "{prefix} [{bar:30}] {pos}/{len} {elapsed} (left {eta}) {msg}"),
        None => styled(None, what, "{prefix} {spinner} {pos} {elapsed} {msg}"),
    }
}

fn styled(length: Option<u64>, what: &'static str, template: &str) -> ProgressBar {
    let bar = length.map_or_else(ProgressBar::new_spinner, ProgressBar::new);
    if output::quiet() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    let style = ProgressStyle::with_template(template).expect("a valid template").progress_chars("=> ");
    bar.with_style(style).with_prefix(what)
}

/// The bar of a run: its steps, or its seconds where those end it; beside it what is left, the last measurement and the speed.
pub(super) struct Training<'a> {
    bar: ProgressBar,
    end: &'a Options,
    log: Vec<LogPoint>,
    began: Instant,
    /// Step and seconds that it began with.
    from: (u64, f64),
    told: Option<Instant>,
}

impl<'a> Training<'a> {
    /// A run that goes on after these measurements.
    pub(super) fn new(end: &'a Options, log: &[LogPoint]) -> Self {
        let from = log.last().map_or((0, 0.0), |point| (point.step, point.seconds));
        let bar = match (end.steps, end.seconds) {
            (Some(steps), _) => {
                styled(Some(steps), "train", "{prefix} [{bar:30}] {pos}/{len} {elapsed}{msg}")
            }
            // Tenths, so that it moves.
            (None, Some(seconds)) => {
                styled(Some((10.0 * seconds) as u64), "train", "{prefix} [{bar:30}] {elapsed}{msg}")
            }
            (None, None) => styled(None, "train", "{prefix} {spinner} {pos} {elapsed}{msg}"),
        };
        Training { bar, end, log: log.to_vec(), began: Instant::now(), from, told: None }
    }

    /// A step has been done.
    pub(super) fn stepped(&mut self, step: u64) {
        if self.bar.is_hidden() || self.told.is_some_and(|told| told.elapsed() < ANEW) {
            return;
        }
        self.told = Some(Instant::now());
        let seconds = self.from.1 + self.began.elapsed().as_secs_f64();
        let by_seconds = self.end.steps.is_none() && self.end.seconds.is_some();
        self.bar.set_position(if by_seconds { (10.0 * seconds) as u64 } else { step });
        let left = outlook::left(self.end, self.from, (step, seconds));
        self.bar.set_message(beside(left, by_seconds.then_some(step), &self.log));
    }

    /// A measurement has been made.
    pub(super) fn measured(&mut self, point: &LogPoint) {
        self.log.push(point.clone());
        self.told = None;
        self.stepped(point.step);
    }

    /// That checkpoints come less often than usual, as each takes `cost` seconds.
    pub(super) fn say_slow(&self, cost: f64, every: f64) {
        self.bar.suspend(|| say_slow(cost, every));
    }

    /// It has ended.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// What stands beside the bar: seconds left, the step where the bar doesn't have it, loss, PSNR, points a second.
fn beside(left: Option<f64>, step: Option<u64>, log: &[LogPoint]) -> String {
    let mut words = vec![];
    if let Some(left) = left.filter(|left| *left < 1e9) {
        words.push(format!(" (left {:#})", HumanDuration(Duration::from_secs_f64(left.round()))));
    }
    words.extend(step.map(|step| format!(" step {step}")));
    if let Some(last) = log.last() {
        let psnr = log.iter().rev().find_map(|point| point.val_psnr.or(point.val_probe));
        words.push(format!(" loss {:.5}, val {} dB", last.loss, output::decibels(psnr)));
    }
    if let Some(speed) = outlook::points_per_second(log) {
        words.push(format!(", {:.2} M points/s", speed / 1e6));
    }
    words.concat()
}

/// That checkpoints come less often than usual, as each takes `cost` seconds.
pub(super) fn say_slow(cost: f64, every: f64) {
    output::note(&format!(
        "a checkpoint takes {cost:.1} s here: one every {every:.0} s, so that they cost no more than 1%"
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_beside_a_bar() {
        let point = |step, seconds, samples, val_probe| LogPoint {
            step,
            seconds,
            samples,
            loss: 0.01,
            train_psnr: 20.0,
            val_probe,
            val_psnr: None,
            val_psnr_pooled: None,
            val_views: None,
        };
        assert_eq!(beside(None, None, &[]), "");
        let log = [point(10, 1.0, 1_000_000, Some(18.0)), point(30, 3.0, 5_000_000, None)];
        assert_eq!(
            beside(Some(65.2), Some(30), &log),
            " (left 65s) step 30 loss 0.01000, val 18.00 dB, 2.00 M points/s"
        );
    }
}
