//! Draws rays and marches them through the occupancy grid, into a chunk.

use pulp::{Simd, WithSimd};

use super::CompactModel;
use super::chunk::Chunk;
use super::views::BoxRay;
use crate::occupancy_grid::fast::MarchRay;
use crate::random::Key;
use crate::ray::Ray;

/// Pixels that are looked up together.
const TOGETHER: usize = 16;

/// Rays of a march: enough that lanes are seldom idle, few enough that their samples stay in the cache.
const WALKING: usize = 128;

/// A ray, the training pixel that it comes from and its color, jitter and patience.
struct Drawn {
    ray: BoxRay,
    pixel: u32,
    target: [f32; 3],
    u: f32,
    patience: u32,
}

/// Rays and their samples, into the chunk.
#[inline(always)]
fn push(model: &CompactModel, length: f32, rays: &[Drawn], chunk: &mut Chunk) {
    let settings = &model.settings;
    let march_ray = |Drawn { ray, u, patience, .. }: &Drawn| {
        let (enter, leave) = model.occupancy.span(ray.o, ray.d);
        let (near, far) = (enter.max(settings.near as f32), leave.min(settings.far as f32));
        MarchRay { o: ray.o, d: ray.d, near, far, u: *u, patience: *patience }
    };
    let mut steps = std::mem::take(&mut chunk.steps);
    for rays in rays.chunks(WALKING) {
        let march_rays: Vec<MarchRay> = rays.iter().map(march_ray).collect();
        model.occupancy.march(model.arch, &march_rays, length, &mut steps);
        for (n, (march_ray, drawn)) in march_rays.iter().zip(rays).enumerate() {
            chunk.push_ray(&drawn.ray, drawn.target, drawn.pixel, steps.cut(n));
            chunk.push_samples(march_ray, steps.of(n), length);
        }
    }
    chunk.steps = steps;
}

/// Draws rays of training pixels and marches them.
pub(super) struct March<'a> {
    pub model: &'a CompactModel,
    /// The keys of pixels and of jitter.
    pub keys: [Key; 2],
    pub step: u64,
    pub length: f32,
    pub rays: std::ops::Range<usize>,
    pub chunk: &'a mut Chunk,
}

impl WithSimd for March<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let March { model, keys: [pixels, jitter], step, length, rays, chunk } = self;
        chunk.clear();
        let mut drawn = Vec::with_capacity(rays.len());
        let (again, patience) = (&model.again[..], model.settings.patience());
        for first in rays.clone().step_by(TOGETHER) {
            let last = (first + TOGETHER).min(rays.end);
            // All random numbers first: reads from the pictures miss the cache, and several can be in flight at once.
            let mut numbers = [(0, 0.0, 0); TOGETHER];
            for (number, r) in numbers.iter_mut().zip(first..last) {
                let u = jitter.uniform(step, r as u64, 0) as f32;
                *number = match again.get(r) {
                    Some(&pixel) => (pixel, u, u32::MAX),
                    None => (model.views.draw(&pixels, step, r as u64) as u32, u, patience),
                };
            }
            for &(pixel, u, patience) in &numbers[..last - first] {
                let (ray, target) = model.views.pixel(pixel as usize);
                drawn.push(Drawn { ray, pixel, target, u, patience });
            }
        }
        push(model, length, &drawn, chunk);
        chunk.reserve();
    }
}

/// Marches given rays without jitter (u = 1/2), to the end.
pub(super) struct MarchAtRest<'a> {
    pub model: &'a CompactModel,
    pub length: f32,
    pub rays: &'a [Ray],
    pub chunk: &'a mut Chunk,
}

impl WithSimd for MarchAtRest<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let MarchAtRest { model, length, rays, chunk } = self;
        chunk.clear();
        let at_rest = |ray| Drawn {
            ray: BoxRay::new(ray, &model.settings),
            pixel: 0,
            target: [0.0; 3],
            u: 0.5,
            patience: u32::MAX,
        };
        let rays: Vec<Drawn> = rays.iter().map(at_rest).collect();
        push(model, length, &rays, chunk);
        chunk.reserve();
    }
}
