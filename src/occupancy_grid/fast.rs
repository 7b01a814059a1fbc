//! f32 occupancy bits, and a traversal that skips empty cells and empty bricks of cells.

/// Cells along a brick's edge: 4^3 bits are a word, so that an empty word lets a ray skip 64 cells.
const BRICK: usize = 4;

/// A cubic grid of cells over the unit box.
#[derive(Clone, Debug, PartialEq)]
pub struct Occupancy {
    /// Cells along an edge, a multiple of 4.
    pub resolution: usize,
    /// The largest density of late, (R^3), index x + R (y + R z).
    pub density: Vec<f32>,
    bits: Vec<u64>,
}

impl Occupancy {
    /// Every cell occupied, no density known.
    pub fn full(resolution: usize) -> Self {
        let bricks = (resolution / BRICK).pow(3);
        Occupancy { resolution, density: vec![0.0; resolution.pow(3)], bits: vec![!0; bricks] }
    }

    /// A grid from its parts, as [`Self::density`] and [`Self::bits`] gave them; none where lengths don't fit.
    pub fn from_parts(resolution: usize, density: Vec<f32>, bits: Vec<u64>) -> Option<Self> {
        let fits = density.len() == resolution.pow(3) && bits.len() == (resolution / BRICK).pow(3);
        fits.then_some(Occupancy { resolution, density, bits })
    }

    /// The occupied cells, a word for each brick of 4^3.
    pub fn bits(&self) -> &[u64] {
        &self.bits
    }

    #[inline(always)]
    fn along(&self, x: f32) -> usize {
        // The conversion saturates: NaN and what lies below the box become 0.
        ((x * self.resolution as f32) as usize).min(self.resolution - 1)
    }

    /// Index of the cell that holds a point of the unit box.
    #[inline(always)]
    pub fn cell(&self, p: [f32; 3]) -> usize {
        (self.along(p[2]) * self.resolution + self.along(p[1])) * self.resolution + self.along(p[0])
    }

    /// Whether the cell with this index is occupied.
    pub fn occupied(&self, cell: usize) -> bool {
        let (r, bricks) = (self.resolution, self.resolution / BRICK);
        let (x, y, z) = (cell % r, cell / r % r, cell / r / r);
        let word = self.bits[(z / BRICK * bricks + y / BRICK) * bricks + x / BRICK];
        word >> ((z % BRICK * BRICK + y % BRICK) * BRICK + x % BRICK) & 1 == 1
    }

    /// Share of the cells that are occupied.
    pub fn fraction(&self) -> f64 {
        let ones: u32 = self.bits.iter().map(|b| b.count_ones()).sum();
        f64::from(ones) / self.density.len() as f64
    }

    /// Raises the cells of the points to their densities.
    pub fn raise(&mut self, points: &[[f32; 3]], sigmas: &[f32]) {
        for (&p, &sigma) in points.iter().zip(sigmas) {
            let cell = self.cell(p);
            self.density[cell] = self.density[cell].max(sigma);
        }
    }

    /// All densities times `decay`.
    pub fn decay(&mut self, decay: f32) {
        self.density.iter_mut().for_each(|d| *d *= decay);
    }

    /// Occupied are from now on the cells denser than `threshold`.
    pub fn apply_threshold(&mut self, threshold: f32) {
        let (r, bricks) = (self.resolution, self.resolution / BRICK);
        self.bits.fill(0);
        for (row, densities) in self.density.chunks_exact(r).enumerate() {
            let (y, z) = (row % r, row / r);
            let first = (z / BRICK * bricks + y / BRICK) * bricks;
            let shift = (z % BRICK * BRICK + y % BRICK) * BRICK;
            for (brick, four) in densities.chunks_exact(BRICK).enumerate() {
                let nibble = (0..BRICK).fold(0, |bits, x| bits | u64::from(four[x] > threshold) << x);
                self.bits[first + brick] |= nibble << shift;
            }
        }
    }

    /// The same densities in cells of another size.
    pub fn resampled(&self, resolution: usize) -> Self {
        let mut out = Occupancy::full(resolution);
        let at = |i: usize| i * self.resolution / resolution;
        for (i, density) in out.density.iter_mut().enumerate() {
            let (x, y, z) =
                (at(i % resolution), at(i / resolution % resolution), at(i / resolution / resolution));
            *density = self.density[(z * self.resolution + y) * self.resolution + x];
        }
        out
    }

    /// Calls `visit(k, p)` for the points t = (k + u) step, t in [near, far), that lie in occupied cells.
    ///
    /// `o` and `d` are in units of the box; p is clamped to it.
    #[inline(always)]
    pub fn march(
        &self,
        o: [f32; 3],
        d: [f32; 3],
        near: f32,
        far: f32,
        step: f32,
        u: f32,
        mut visit: impl FnMut(f32, [f32; 3]),
    ) {
        // From here on lengths are cells and time is steps.
        let r = self.resolution as f32;
        let start: [f32; 3] = std::array::from_fn(|a| (o[a] + u * step * d[a]) * r);
        let speed: [f32; 3] = std::array::from_fn(|a| d[a] * step * r);
        let inverse = speed.map(|s| if s == 0.0 { f32::MAX } else { 1.0 / s });
        let ahead = speed.map(|s| i32::from(s >= 0.0));
        let (top, bricks) = (self.resolution as i32 - 1, (self.resolution / BRICK) as i32);
        let (mut k, last) = ((near / step - u).ceil(), far / step - u);
        while k < last {
            let x: [f32; 3] = std::array::from_fn(|a| start[a] + k * speed[a]);
            let c = x.map(|x| (x as i32).max(0).min(top));
            let word = self.bits[(((c[2] >> 2) * bricks + (c[1] >> 2)) * bricks + (c[0] >> 2)) as usize];
            if word >> ((c[2] & 3) << 4 | (c[1] & 3) << 2 | c[0] & 3) & 1 == 1 {
                visit(k, x.map(|x| (x / r).clamp(0.0, 1.0)));
                k += 1.0;
                continue;
            }
            // On to the first lattice point behind the empty cell, or brick.
            let edge = if word == 0 { BRICK as i32 } else { 1 };
            let mut exit = f32::INFINITY;
            for a in 0..3 {
                let face = (c[a] & -edge) + ahead[a] * edge;
                let at = (face as f32 - start[a]) * inverse[a];
                exit = if at < exit { at } else { exit };
            }
            let next = exit.ceil();
            k = if next > k { next } else { k + 1.0 };
        }
    }
}

/// Distances at which a ray enters and leaves the unit box; enter > leave where it misses.
#[inline(always)]
pub fn ray_box(o: [f32; 3], d: [f32; 3]) -> (f32, f32) {
    let (mut enter, mut leave) = (f32::NEG_INFINITY, f32::INFINITY);
    for a in 0..3 {
        if d[a] == 0.0 {
            if o[a] < 0.0 || o[a] > 1.0 {
                return (f32::INFINITY, f32::NEG_INFINITY);
            }
            continue;
        }
        let (t0, t1) = (-o[a] / d[a], (1.0 - o[a]) / d[a]);
        enter = enter.max(t0.min(t1));
        leave = leave.min(t0.max(t1));
    }
    (enter, leave)
}
