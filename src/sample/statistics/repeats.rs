//! Repetition and correlation: draws that come again, mirrored or as they were, at some distance in the sequence of all of them.

use super::{confidence, count_slack};

/// Neighbors in value that a number is compared with: where more agree, there is repetition enough among these.
const MOST: usize = 64;

/// The numbers of a sequence by size, each with its place.
pub(super) struct Sorted(Vec<(f64, usize)>);

impl Sorted {
    pub(super) fn new(values: &[f64]) -> Sorted {
        let mut sorted: Vec<(f64, usize)> = values.iter().copied().zip(0..).collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        Sorted(sorted)
    }

    /// 1 less each of them.
    pub(super) fn mirrored(&self) -> Sorted {
        Sorted(self.0.iter().rev().map(|&(x, i)| (1.0 - x, i)).collect())
    }
}

/// The distance at which most numbers of a sequence come again, and how many do, where that is more than chance brings. `other` is the
/// sequence that is compared: itself, or mirrored.
///
/// Along one distance, independent draws agree within `tolerance` like tosses of a coin that falls with a probability of at most
/// `chance`, or as often as any two do (a law that isn't uniform): Bernstein's inequality, over all distances at once.
pub(super) fn distance(
    values: &Sorted,
    other: &Sorted,
    tolerance: f64,
    chance: f64,
) -> Option<(usize, usize)> {
    let (Sorted(left), Sorted(right), n) = (values, other, values.0.len());
    let (mut counts, mut start, mut pairs) = (vec![0; n], 0, 0.0);
    for &(x, i) in left {
        while start < n && right[start].0 < x - tolerance {
            start += 1;
        }
        for &(_, k) in right[start..].iter().take_while(|(y, _)| *y <= x + tolerance).take(MOST) {
            // Each pair once: the later one comes again.
            if k > i {
                counts[k - i] += 1;
                pairs += 1.0;
            }
        }
    }
    let any_two = 2.0 * pairs / (n as f64 * n as f64);
    let p = chance.max(any_two).min(1.0);
    let (most, at) = (1..n).map(|lag| (counts[lag], lag)).max_by_key(|(count, lag)| (*count, n - lag))?;
    (f64::from(most) > n as f64 * p + count_slack(n, p, n)).then_some((at, most as usize))
}

/// The correlation of numbers of a mean and a variance with those so many places further on, over pairs that share none, where chance
/// alone doesn't bring it: each product is at most 3 in size (Hoeffding). `tests` correlations are looked at in all.
pub(super) fn correlation(
    values: &[f64],
    lag: usize,
    [mean, variance]: [f64; 2],
    tests: usize,
) -> Option<f64> {
    let pairs = values.chunks_exact(2 * lag).flat_map(|both| both[..lag].iter().zip(&both[lag..]));
    let (sum, n) = pairs.fold((0.0, 0), |(sum, n), (a, b)| (sum + (a - mean) * (b - mean) / variance, n + 1));
    let slack = 3.0 * (2.0 * confidence(tests) / f64::from(n)).sqrt();
    (n > 0 && (sum / f64::from(n)).abs() > slack).then(|| sum / f64::from(n))
}
