//! Differences as people take them, of which robust losses are.

use super::super::arrays::pair;
use crate::contract::arrays::{Arrays, input};

/// Which difference.
pub(super) const DIFFERENCE: [&str; 7] = [
    "p - t",
    "clamp(p, 0, 1) - t",
    "clamp(p, 0, 1) - clamp(t, 0, 1)",
    "(p - t)^2",
    "p - t + 1e-8",
    "p - t + 1e-6",
    "(p - t) / (t + 1e-8)",
];

/// All differences, and how many each color has, and each entry of the first axis.
pub(super) struct Differences {
    pub(super) d: Vec<f64>,
    pub(super) channels: usize,
    pub(super) first: usize,
}

impl Differences {
    pub(super) fn new(a: &Arrays, choice: usize) -> Self {
        let [p, t] = pair(a);
        let one = |(p, t): (&f64, &f64)| match choice {
            1 => p.clamp(0.0, 1.0) - t,
            2 => p.clamp(0.0, 1.0) - t.clamp(0.0, 1.0),
            3 => (p - t) * (p - t),
            4 => p - t + 1e-8,
            5 => p - t + 1e-6,
            6 => (p - t) / (t + 1e-8),
            _ => p - t,
        };
        let shape = input(a, "prediction").shape();
        let channels = shape.last().copied().unwrap_or(1).max(1);
        let first = shape.iter().skip(1).product::<usize>().max(1);
        Differences { d: p.iter().zip(&t).map(one).collect(), channels, first }
    }

    /// The mean of their sizes to this power.
    pub(super) fn mean(&self, power: i32) -> f64 {
        self.d.iter().map(|d| d.abs().powi(power)).sum::<f64>() / self.d.len() as f64
    }

    /// The sums of squares of colors.
    pub(super) fn squares(&self) -> Vec<f64> {
        self.d.chunks(self.channels).map(|d| d.iter().map(|d| d * d).sum()).collect()
    }
}
