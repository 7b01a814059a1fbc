//! How a run gets on: how fast, and how long it still takes.

use super::run::{LogPoint, Options};

/// Seconds of the log over which speed is measured, where it has as many.
const OVER: f64 = 2.0;

/// Seconds that a run still takes, of a clock of its own; it has come from one step and second to another. `None` where its end isn't known.
pub fn left(end: &Options, from: (u64, f64), now: (u64, f64)) -> Option<f64> {
    let step = (now.0 > from.0).then(|| (now.1 - from.1) / (now.0 - from.0) as f64);
    let by_steps = end.steps.zip(step).map(|(all, step)| all.saturating_sub(now.0) as f64 * step);
    let by_seconds = end.seconds.map(|all| (all - now.1).max(0.0));
    [by_steps, by_seconds].into_iter().flatten().reduce(f64::min)
}

/// Points with forward and backward in a second, of late; `None` before the first measurement.
pub fn points_per_second(log: &[LogPoint]) -> Option<f64> {
    let last = log.last()?;
    let before = log.iter().rev().find(|point| last.seconds - point.seconds >= OVER);
    let (samples, seconds) = before.map_or((0, 0.0), |point| (point.samples, point.seconds));
    let speed = last.samples.saturating_sub(samples) as f64 / (last.seconds - seconds);
    speed.is_finite().then_some(speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_end_counts() {
        let end = |steps, seconds| Options { steps, seconds, ..Options::default() };
        let of = |steps, seconds| left(&end(steps, seconds), (100, 5.0), (200, 10.0));
        assert_eq!(of(Some(400), None), Some(10.0));
        assert_eq!(of(Some(400), Some(12.0)), Some(2.0));
        assert_eq!(of(Some(150), Some(9.0)), Some(0.0));
        assert_eq!(of(None, None), None);
        assert_eq!(left(&end(Some(400), None), (0, 0.0), (0, 1.0)), None, "no step is done yet");
    }

    #[test]
    fn speed_is_that_of_late() {
        let point = |seconds, samples| LogPoint {
            step: 1,
            seconds,
            samples,
            loss: 0.0,
            train_psnr: 0.0,
            val_probe: None,
            val_psnr: None,
            val_psnr_pooled: None,
            val_views: None,
        };
        assert_eq!(points_per_second(&[]), None);
        assert_eq!(points_per_second(&[point(0.0, 0)]), None);
        assert_eq!(points_per_second(&[point(0.5, 50)]), Some(100.0));
        let log = [point(1.0, 100), point(2.0, 200), point(3.0, 500), point(4.0, 1200)];
        assert_eq!(points_per_second(&log), Some(500.0));
    }
}
