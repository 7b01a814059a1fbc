//! Steps, wrong on purpose, on their way into volume rendering.

use super::catalogue::{DELTA_SCALED, OWN_STEP};
use super::march::LAST_STEP;
use crate::contract::arrays::{Arrays, row};

/// The steps of ray r as the mistakes have them.
pub(super) fn wrong_deltas(a: &Arrays, r: usize, wrong: &[&str]) -> Vec<f64> {
    let mut deltas = row(a, "deltas", if wrong.contains(&"first_ray_deltas") { 0 } else { r });
    let n = deltas.len();
    for name in wrong {
        match *name {
            "delta_missing" => deltas.fill(1.0),
            "delta_unit_interval" => deltas.fill(1.0 / n as f64),
            "delta_over_n_minus_1" if n > 1 => {
                deltas.iter_mut().for_each(|delta| *delta *= n as f64 / (n - 1) as f64)
            }
            "delta_of_the_whole_ray" => deltas.iter_mut().for_each(|delta| *delta *= n as f64),
            "backward_delta" if n > 0 => {
                deltas.rotate_right(1);
                deltas[0] = 0.0;
            }
            "delta_differenced_twice" if n > 0 => {
                deltas = (1..n).map(|i| deltas[i] - deltas[i - 1]).chain([1e10]).collect()
            }
            "last_step_repeated" if n > 1 => deltas[n - 1] = deltas[n - 2],
            "steps_moved_on" if n > 0 => {
                let first = deltas[0];
                deltas.rotate_right(1);
                deltas[0] = first;
            }
            "steps_averaged" => {
                let before = |i: usize| if i == 0 { 0.0 } else { deltas[i - 1] };
                deltas = (0..n).map(|i| 0.5 * (before(i) + deltas[i])).collect();
            }
            "first_gap_for_all" if n > 0 => deltas = vec![deltas[0]; n],
            "gaps_summed" => deltas = vec![deltas.iter().sum(); n],
            _ => {}
        }
    }
    if let Some(step) = OWN_STEP.among(wrong) {
        deltas.fill(step);
    }
    if let (Some(step), Some(last)) = (LAST_STEP.among(wrong), deltas.last_mut()) {
        *last = step;
    }
    let scale = DELTA_SCALED.among(wrong).unwrap_or(1.0);
    deltas.into_iter().map(|delta| scale * delta).collect()
}
