//! Draws rays and marches them through the occupancy grid, into a chunk.

use pulp::{Simd, WithSimd};

use super::CompactModel;
use super::chunk::Chunk;
use super::pace::Pace;
use super::space::Space;
use super::views::{BoxRay, Target};
use crate::occupancy_grid::fast::MarchRay;
use crate::random::Key;

/// Pixels that are looked up together.
const TOGETHER: usize = 16;

/// Rays of a march: enough that lanes are seldom idle, few enough that their samples stay in the cache.
const WALKING: usize = 128;

/// A training pixel's ray with its jitter and patience, and what it shows.
struct Drawn {
    ray: BoxRay,
    pixel: u32,
    target: Target,
    u: f32,
    patience: u32,
}

/// Rays and their samples, into the chunk.
#[inline(always)]
fn push(model: &CompactModel, pace: &Pace, rays: &[Drawn], chunk: &mut Chunk) {
    let march_ray = |drawn: &Drawn| model.march_ray(&drawn.ray, drawn.u, drawn.patience);
    let mut steps = std::mem::take(&mut chunk.steps);
    for rays in rays.chunks(WALKING) {
        let march_rays: Vec<MarchRay> = rays.iter().map(march_ray).collect();
        pace.march(&model.occupancy, model.arch, &march_rays, &mut steps);
        for (n, (march_ray, drawn)) in march_rays.iter().zip(rays).enumerate() {
            chunk.push_ray(&drawn.ray, drawn.target, drawn.pixel, steps.cut(n));
            chunk.push_samples(march_ray, steps.of(n), pace);
        }
    }
    chunk.steps = steps;
}

impl CompactModel {
    /// A ray between the planes near and far, where it can meet occupied cells.
    #[inline(always)]
    pub(super) fn march_ray(&self, ray: &BoxRay, u: f32, patience: u32) -> MarchRay {
        // Contracted space has no end that a ray could miss.
        let (enter, leave) = match self.settings.space {
            Space::Box => self.occupancy.span(ray.o, ray.d),
            Space::Contracted { .. } => (0.0, f32::INFINITY),
        };
        let (near, far) = (enter.max(self.settings.near as f32), leave.min(self.settings.far as f32));
        MarchRay { o: ray.o, d: ray.d, near, far, u, patience }
    }
}

/// Draws rays of training pixels and marches them.
pub(super) struct March<'a> {
    pub model: &'a CompactModel,
    /// The keys of pixels and of jitter.
    pub keys: [Key; 2],
    pub step: u64,
    pub pace: Pace,
    pub rays: std::ops::Range<usize>,
    pub chunk: &'a mut Chunk,
}

impl WithSimd for March<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let March { model, keys: [pixels, jitter], step, pace, rays, chunk } = self;
        chunk.clear();
        let mut drawn = Vec::with_capacity(rays.len());
        let (again, patience) = (&model.again[..], model.settings.patience_at(step));
        for first in rays.clone().step_by(TOGETHER) {
            let last = (first + TOGETHER).min(rays.end);
            // All random numbers first: reads from the pictures miss the cache, and several can be in flight at once.
            let mut numbers = [(0, 0.0, 0); TOGETHER];
            for (number, r) in numbers.iter_mut().zip(first..last) {
                let u = jitter.four(step, r as u64)[0] as f32;
                *number = match again.get(r) {
                    Some(&pixel) => (pixel, u, u32::MAX),
                    None => (model.views.draw(&pixels, step, r as u64) as u32, u, patience),
                };
            }
            for &(pixel, u, patience) in &numbers[..last - first] {
                let n = pixel as usize;
                let (ray, target) = (model.views.ray(n), model.views.target(n));
                drawn.push(Drawn { ray, pixel, target, u, patience });
            }
        }
        push(model, &pace, &drawn, chunk);
        chunk.reserve();
    }
}
