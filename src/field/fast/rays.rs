//! What goes into rendering, and what comes out.

use crate::ndc::cube::Cube;

/// Rays with N samples each. Geometry is f64: its cost is negligible beside the network, and 2^9 pi x magnifies its rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rays<'a> {
    /// Origins (R, 3).
    pub origins: &'a [f64],
    /// Directions (R, 3); unit in the profile `cs180`.
    pub directions: &'a [f64],
    /// Sample distances (R, N).
    pub t: &'a [f64],
    /// Step lengths (R, N).
    pub deltas: &'a [f64],
    /// N.
    pub samples: usize,
    /// What positions are taken in, where it isn't the world.
    pub cube: Option<&'a Cube>,
}

/// Rendered rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rendered {
    /// Colors over the background (R, 3).
    pub colors: Vec<f32>,
    /// Opacity, the sum of the weights (R).
    pub opacity: Vec<f32>,
    /// sum w t (R), not divided by the opacity.
    pub depth: Vec<f32>,
}

impl<'a> Rays<'a> {
    /// R.
    ///
    /// # Panics
    /// Where the arrays don't hold as many rays and samples.
    #[allow(clippy::len_without_is_empty, reason = "nobody asks")]
    pub fn len(&self) -> usize {
        let rays = self.origins.len() / 3;
        assert_eq!(self.directions.len(), 3 * rays, "directions and origins: one each a ray");
        assert_eq!(self.t.len(), rays * self.samples, "t and origins: `samples` for a ray");
        assert_eq!(self.deltas.len(), self.t.len(), "deltas and t: one each a sample");
        rays
    }

    /// Rays that make up a chunk.
    pub(super) fn in_chunk(&self) -> usize {
        (super::CHUNK / self.samples).max(1)
    }

    pub(super) fn part(&self, from: usize, to: usize) -> Rays<'a> {
        let n = self.samples;
        Rays {
            origins: &self.origins[from * 3..to * 3],
            directions: &self.directions[from * 3..to * 3],
            t: &self.t[from * n..to * n],
            deltas: &self.deltas[from * n..to * n],
            samples: n,
            cube: self.cube,
        }
    }

    /// o + t d of sample n of all samples (R, N), or where that is in the cube.
    pub fn position(&self, n: usize) -> [f64; 3] {
        let (ray, t) = (n / self.samples * 3, self.t[n]);
        let (o, d) = (&self.origins[ray..ray + 3], &self.directions[ray..ray + 3]);
        let x = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
        self.cube.map_or(x, |cube| cube.point(x))
    }

    /// Positions of the samples named (M, 3).
    pub(super) fn positions(&self, samples: &[usize], out: &mut Vec<f64>) {
        out.clear();
        out.extend(samples.iter().flat_map(|&n| self.position(n)));
    }
}
