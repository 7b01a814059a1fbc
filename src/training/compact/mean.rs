//! What pictures are made of: not the parameters after the last step, which its noise has moved, but their running mean over the last
//! sixteenth of all steps (Polyak and Juditsky 1992, in the exponential form that Instant-NGP and others use). Training doesn't see it.

use super::CompactModel;
use super::networks::Weights;
use super::parts::Part;
use crate::hash_grid::fast::{self as hash_grid, Entry, Level};
use crate::parallel;

/// Steps between two moves of the mean: a move reads all tables.
const EVERY: u64 = 16;

/// The step at which the mean begins: until then noise is small beside what each step learns.
const FIRST: u64 = 256;

/// How far the mean goes to where the parameters are after a step, if it moves: all the way at first, then so far that it remembers a
/// sixteenth of the steps.
fn rate(step: u64) -> Option<f32> {
    let moves = step >= FIRST && step.is_multiple_of(EVERY);
    moves.then(|| FIRST as f32 / step as f32)
}

impl CompactModel {
    /// After a step.
    pub(super) fn average(&mut self, step: u64) {
        let Some(rate) = rate(step).filter(|_| self.averages()) else { return };
        let arch = self.arch;
        parallel::for_each(&mut self.levels, |level| hash_grid::average(arch, level, rate));
        self.nets.mean.approach(&self.nets.weights, rate);
    }

    fn averages(&self) -> bool {
        !self.settings.without.contains(&Part::Averaging)
    }

    fn rests(&self) -> bool {
        self.averages() && self.step >= FIRST
    }

    /// The networks' weights for pictures.
    pub(super) fn weights_at_rest(&self) -> &Weights {
        if self.rests() { &self.nets.mean } else { &self.nets.weights }
    }

    /// A level's table for pictures.
    pub(super) fn table_at_rest<'a>(&self, level: &'a Level) -> &'a [Entry] {
        if self.rests() { level.mean() } else { level.table() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_begins_as_the_parameters_and_remembers_a_sixteenth() {
        assert_eq!([255, 257, 271].map(rate), [None; 3]);
        assert_eq!(rate(FIRST), Some(1.0));
        // 16 steps of 100.
        assert_eq!(rate(1600), Some(0.16));
        // A parameter that is the number of its step: its mean lags behind by what is remembered, less half a move.
        let mut mean = 0.0;
        for step in 1..=16_000 {
            mean += rate(step).unwrap_or(0.0) * (step as f32 - mean);
        }
        assert!((16_000.0 - mean - 1000.0).abs() < 100.0, "{mean}");
    }
}
