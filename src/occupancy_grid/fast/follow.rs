//! The traversal along paths that aren't straight in the grid: a sample at a time, past empty bricks and blocks as far as it is safe.

use super::steps::{MarchRay, Steps};
use super::{BLOCK, BRICK, Occupancy};

/// Where a ray's samples lie in the grid, and how fast they move.
pub trait Path {
    /// The first sample's number, and the number that all are below.
    fn ends(&self, ray: &MarchRay) -> [f32; 2];
    /// Sample k, in the unit box.
    fn at(&self, ray: &MarchRay, k: f32) -> [f32; 3];
    /// After sample k, how many samples on none is farther than `distance` from it along any axis.
    fn within(&self, ray: &MarchRay, k: f32, distance: f32) -> f32;
}

impl Occupancy {
    /// Follows rays along their paths, so that `steps` has their samples in occupied cells.
    pub fn follow(&self, path: &impl Path, march_rays: &[MarchRay], steps: &mut Steps) {
        let ends: Vec<[f32; 2]> = march_rays.iter().map(|ray| path.ends(ray)).collect();
        let longest = ends.iter().map(|[first, last]| last - first).fold(0.0, f32::max);
        steps.begin_with(march_rays, longest);
        for (n, (ray, [first, last])) in march_rays.iter().zip(ends).enumerate() {
            let mut k = first;
            while k < last && steps.patience[n] > 0 {
                let p = path.at(ray, k);
                let (occupied, opaque, edge) = self.state(p);
                if occupied {
                    steps.push(n, k, opaque);
                }
                // Empty around: no sample is missed that is nearer than the brick's or block's side.
                let free = if edge > 1 { self.margin(p, edge) } else { 0.0 };
                k += if free > 0.0 { path.within(ray, k, free).floor().max(1.0) } else { 1.0 };
            }
        }
    }

    /// Whether the cell of a point is occupied, whether it is opaque, and the edge of the largest part around it that is empty, in cells.
    #[inline(always)]
    fn state(&self, p: [f32; 3]) -> (bool, bool, usize) {
        let [x, y, z] = p.map(|x| self.along(x));
        let (bricks, blocks) = (self.resolution / BRICK, self.resolution / BLOCK);
        if self.blocks[(z / BLOCK * blocks + y / BLOCK) * blocks + x / BLOCK] == 0 {
            return (false, false, BLOCK);
        }
        let [occupied, opaque] = self.words[(z / BRICK * bricks + y / BRICK) * bricks + x / BRICK];
        let bit = (z % BRICK * BRICK + y % BRICK) * BRICK + x % BRICK;
        (occupied >> bit & 1 == 1, opaque >> bit & 1 == 1, if occupied == 0 { BRICK } else { 1 })
    }

    /// How far a point is from the nearest side of the part of so many cells that it lies in; less what rounding takes.
    #[inline(always)]
    fn margin(&self, p: [f32; 3], edge: usize) -> f32 {
        let size = edge as f32 / self.resolution as f32;
        let least = p.into_iter().fold(size, |least, x| {
            let inside = x - (x / size).floor() * size;
            least.min(inside).min(size - inside)
        });
        least - 1e-6
    }
}
