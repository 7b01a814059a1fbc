//! Which pixels of a picture count: masks of what moved, of the photographer, of a lens' rim.

/// The pixels that count, row by row, one of them at least.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    counts: Vec<bool>,
    /// Their numbers.
    those: Vec<u32>,
}

impl Mask {
    /// Of a truth value a pixel; `None` where none counts.
    pub fn new(counts: Vec<bool>) -> Option<Mask> {
        let those: Vec<u32> = (0..counts.len()).filter(|&n| counts[n]).map(|n| n as u32).collect();
        (!those.is_empty()).then_some(Mask { counts, those })
    }

    /// Number of pixels, whether they count or not.
    pub fn len(&self) -> usize {
        self.counts.len()
    }

    /// Whether there is no pixel: never.
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }

    /// Whether every pixel counts.
    pub fn is_full(&self) -> bool {
        self.those.len() == self.counts.len()
    }

    /// Whether pixel `n` counts.
    pub fn counts(&self, n: usize) -> bool {
        self.counts[n]
    }

    /// How many count.
    pub fn count(&self) -> usize {
        self.those.len()
    }

    /// The `k`-th of those that count.
    pub fn of(&self, k: usize) -> usize {
        self.those[k] as usize
    }

    /// The mask of a picture with a pixel for each whole square of `n` x `n`: one that counts in all its pixels, or, where there is none,
    /// in any.
    pub(super) fn shrunk(&self, height: usize, width: usize, n: usize) -> Option<Mask> {
        let (h, w) = (height / n, width / n);
        let square = |m: usize| {
            let (j, i) = (m / w * n, m % w * n);
            (0..n * n).map(move |k| (j + k / n) * width + i + k % n)
        };
        let all = (0..h * w).map(|m| square(m).all(|k| self.counts[k])).collect();
        Mask::new(all).or_else(|| Mask::new((0..h * w).map(|m| square(m).any(|k| self.counts[k])).collect()))
    }
}
