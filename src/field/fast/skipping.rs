//! Samples that a step leaves out: in empty cells, and after the early stop.

use super::CHUNK;
use super::rays::Rays;
use crate::volume_rendering::fast::RayWeights;

/// What is left out of a batch of rays; nothing by default.
///
/// A sample that is not live has density 0 and is never evaluated; its density gets no gradient, which is the whole approximation. The
/// step lengths of the others stay what they are. A ray ends after the first sample with T < `stop` (see
/// [`live_samples`](crate::early_stop::live_samples)): the light that is left goes on to the background, and a color moves by at most
/// `stop`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Skipping<'a> {
    /// Samples (R, N) that may have a density; all of them if `None`.
    pub live: Option<&'a [bool]>,
    /// The smallest transmittance that is followed; 0: rays have no early end.
    pub stop: f32,
}

impl Skipping<'_> {
    /// Samples that are evaluated, of `all`.
    pub fn points(&self, all: usize) -> usize {
        self.live.map_or(all, |live| live.iter().filter(|&&l| l).count())
    }

    /// The same for rays `from` to `to`, with `samples` samples each.
    pub(super) fn part(&self, from: usize, to: usize, samples: usize) -> Self {
        Skipping { live: self.live.map(|live| &live[from * samples..to * samples]), ..*self }
    }

    /// Chunks of consecutive rays: as many as have [`CHUNK`] live samples, at least one. Depends on the rays and on what is live
    /// alone; where everything is live, the chunks are those of the dense step.
    pub(super) fn spans(&self, rays: &Rays) -> Vec<(usize, usize)> {
        let (mut spans, mut from, mut points) = (vec![], 0, 0);
        for r in 0..rays.len() {
            let span = r * rays.samples..(r + 1) * rays.samples;
            let count = self.live.map_or(rays.samples, |live| live[span].iter().filter(|&&l| l).count());
            if r > from && points + count > CHUNK {
                spans.push((from, r));
                (from, points) = (r, 0);
            }
            points += count;
        }
        if from < rays.len() {
            spans.push((from, rays.len()));
        }
        spans
    }

    /// Ends every ray after the first sample with T < `stop`: no more light is lost. The samples behind it are not active, so their
    /// weights are never read.
    pub(super) fn end(&self, rays: &mut RayWeights, samples: usize) {
        for behind in rays.behind.chunks_mut(samples) {
            // A NaN is not below `stop`: it stays, and shows in the result.
            if let Some(last) = behind.iter().position(|&t| t < self.stop) {
                let rest = behind[last];
                behind[last + 1..].fill(rest);
            }
        }
    }
}

/// Scatters the values of the first rows to the samples that the rows belong to (ascending); the others become 0.
pub(super) fn spread(values: &mut Vec<f32>, samples_of_rows: &[usize], samples: usize) {
    values.truncate(samples_of_rows.len());
    values.resize(samples, 0.0);
    // From the end, so that a value moves to a place that is already free.
    for (row, &sample) in samples_of_rows.iter().enumerate().rev() {
        let value = std::mem::take(&mut values[row]);
        values[sample] = value;
    }
}
