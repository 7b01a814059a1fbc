//! The traversal in f32: sixteen rays march side by side, a lane each, over bits, past empty cells, bricks and blocks.
//!
//! A single ray is latency-bound: each step needs the bit that the step before led to. Sixteen rays share that latency, in vector
//! registers; a lane whose ray has ended takes the next.

use pulp::{Arch, Simd, WithSimd};

use super::walk::{LANES, Walk};
use super::{BLOCK, BRICK, Occupancy};

/// A ray's samples: the points t = (k + u) step, t in [near, far), in units of the box.
#[derive(Clone, Copy, Debug)]
pub struct MarchRay {
    /// Origin.
    pub o: [f32; 3],
    /// Direction.
    pub d: [f32; 3],
    /// Where samples start.
    pub near: f32,
    /// Where they end.
    pub far: f32,
    /// Jitter in [0, 1).
    pub u: f32,
    /// The ray ends after so many samples in opaque cells, at least 1.
    pub patience: u32,
}

impl MarchRay {
    /// Sample k, clamped to the box.
    #[inline(always)]
    pub fn at(&self, k: f32, step: f32) -> [f32; 3] {
        let t = (k + self.u) * step;
        let [o, d] = [self.o, self.d];
        let x = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
        [x[0].clamp(0.0, 1.0), x[1].clamp(0.0, 1.0), x[2].clamp(0.0, 1.0)]
    }
}

/// The samples of rays that lie in occupied cells; buffers that are used again.
#[derive(Default)]
pub struct Steps {
    /// The range of a ray's samples in `k`.
    pub(super) room: usize,
    k: Vec<f32>,
    pub(super) count: Vec<usize>,
    pub(super) patience: Vec<u32>,
}

impl Steps {
    /// k of a ray's samples, ascending.
    #[inline(always)]
    pub fn of(&self, ray: usize) -> &[f32] {
        &self.k[ray * self.room..][..self.count[ray]]
    }

    /// Whether the ray ran out of patience: there may be more samples after the last one.
    #[inline(always)]
    pub fn cut(&self, ray: usize) -> bool {
        self.patience[ray] == 0
    }

    /// No samples yet; sized for the longest rays.
    #[inline(always)]
    fn begin(&mut self, march_rays: &[MarchRay], step: f32) {
        let longest =
            march_rays.iter().map(|march_ray| (march_ray.far - march_ray.near) / step).fold(0.0, f32::max);
        // One more for the rounding of each end, and one spare slot after the last.
        self.room = longest as usize + 3;
        let places = march_rays.len() * self.room;
        assert!(
            places < u32::MAX as usize,
            "{} rays of {longest} steps: at most 2^32 at once",
            march_rays.len()
        );
        // The last slot is for lanes that no ray has entered yet.
        if self.k.len() <= places {
            self.k.resize(places + 1, 0.0);
        }
        self.count.clear();
        self.count.resize(march_rays.len(), 0);
        self.patience.clear();
        self.patience.extend(march_rays.iter().map(|march_ray| march_ray.patience));
    }
}

/// Walks rays over a grid.
struct March<'a> {
    grid: &'a Occupancy,
    march_rays: &'a [MarchRay],
    step: f32,
    steps: &'a mut Steps,
}

impl WithSimd for March<'_> {
    type Output = ();

    /// Where a ray has ended, the next that meets the grid takes its lane.
    #[inline(always)]
    fn with_simd<S: Simd>(self, s: S) {
        let March { grid, march_rays, step, steps } = self;
        let mut walk = Walk::new(steps.k.len() - 1);
        let mut waiting =
            march_rays.iter().enumerate().filter(|(_, march_ray)| march_ray.near < march_ray.far);
        loop {
            let mut idle = walk.idle();
            while idle != 0 {
                let lane = idle.trailing_zeros() as usize;
                idle &= idle - 1;
                walk.leave(lane, steps);
                match waiting.next() {
                    Some(march_ray) => walk.enter(lane, march_ray, step, grid.resolution as f32, steps.room),
                    None if walk.held == 0 => return,
                    None => {}
                }
            }
            walk.locate(s, grid.resolution);
            grid.look(&mut walk);
            if walk.judge(s) {
                for i in 0..LANES {
                    steps.k[walk.next.0[i] as usize] = walk.k.0[i];
                    walk.next.0[i] += walk.here.0[i];
                }
            }
            walk.advance(s);
        }
    }
}

impl Occupancy {
    /// Walks rays, so that `steps` has their samples.
    ///
    /// # Panics
    /// Where the rays have more than 2^32 lattice points together.
    pub fn march(&self, arch: Arch, march_rays: &[MarchRay], step: f32, steps: &mut Steps) {
        steps.begin(march_rays, step);
        arch.dispatch(March { grid: self, march_rays, step, steps });
    }

    /// Reads the bits where the rays are.
    #[inline(always)]
    fn look(&self, walk: &mut Walk) {
        for i in 0..LANES {
            let bits = walk.bits.0[i];
            let bricks = self.blocks[walk.block.0[i] as usize];
            let any = (bricks >> (bits >> 8)) as u32 & 1;
            // Word 0 for lanes without a ray.
            let [first, second] = self.words[(any * walk.brick.0[i]) as usize];
            let (occupied, opaque) =
                (any & (first >> (bits & 63)) as u32, any & (second >> (bits & 63)) as u32);
            let edge = if bricks == 0 { BLOCK as u32 } else { [BRICK as u32, 1][any as usize] };
            walk.state.0[i] = edge << 2 | opaque << 1 | occupied;
        }
    }
}
