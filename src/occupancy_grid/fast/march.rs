//! The traversal in f32: sixteen rays march side by side, a lane each, over bits, past empty cells, bricks and blocks.
//!
//! A single ray is latency-bound: each step needs the bit that the step before led to. Sixteen rays share that latency, in vector
//! registers; a lane whose ray has ended takes the next.

use pulp::{Arch, Simd, WithSimd};

use super::steps::{MarchRay, Steps};
use super::walk::{LANES, Walk};
use super::{BLOCK, BRICK, Occupancy};

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
                    Some(march_ray) => {
                        walk.enter(lane, march_ray, step, grid.resolution as f32, steps.capacity)
                    }
                    None if walk.busy == 0 => return,
                    None => {}
                }
            }
            walk.locate(s, grid.resolution);
            grid.read_bits(&mut walk);
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
    fn read_bits(&self, walk: &mut Walk) {
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
