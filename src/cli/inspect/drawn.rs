//! The rays that are shown, with every stage's values along them.

use crate::convention::{CS180, Grid, PixelCenter};
use crate::error::Result;
use crate::math::expm1;
use crate::random::{Key, Purpose};
use crate::ray::{PixelDraw, Ray, camera_ray, pixel_position};
use crate::ray_aabb;
use crate::sample::{sample_along_ray, step_sizes};
use crate::scene::{Medium, Scene, random_pixel};
use crate::training::Model;
use crate::training::probe::Probe;
use crate::volume_rendering::{Rendering, composite_background, volume_render};

/// A share of rays that may miss the scene's box: those through the corners of pictures do.
const MISSED: f64 = 0.5;

/// How many rays, of how many samples, by which seed.
pub(super) struct Asked {
    pub rays: usize,
    pub samples: usize,
    pub seed: u64,
}

/// A ray that was drawn: its pixel, the ray, its samples, and what is there.
pub(super) struct Drawn {
    pub pixel: PixelDraw,
    pub ray: Ray,
    pub t: Vec<f64>,
    pub deltas: Vec<f64>,
    /// Whether it meets the scene's box between near and far.
    pub hit: bool,
    pub seen: Option<Seen>,
}

/// What the field holds along a ray, and how it is rendered.
pub(super) struct Seen {
    pub probes: Vec<Probe>,
    pub alphas: Vec<f64>,
    pub rendering: Rendering,
    /// Over the scene's background.
    pub color: [f64; 3],
}

/// Rays through random pixels of training frames, with jittered samples: exactly those of a first training step. The field is the
/// model's; that of a scene by formula otherwise; of photographs alone nothing is known.
pub(super) fn draw(scene: &Scene, model: Option<&dyn Model>, asked: &Asked) -> Result<Vec<Drawn>> {
    let (pixels, jitter) = (Key::new(asked.seed, Purpose::Rays), Key::new(asked.seed, Purpose::Samples));
    let mut drawn = Vec::with_capacity(asked.rays);
    for n in 0..asked.rays as u64 {
        let [image, j, i] = random_pixel(&scene.train, &pixels, 0, n);
        let frame = &scene.train[image];
        let uv = pixel_position(i, j, PixelCenter::Half);
        let rgb = frame.image.as_ref().map_or([0.0; 3], |image| image.at(j, i).map(f64::from));
        let t =
            sample_along_ray(scene.near, scene.far, &jitter.uniforms(0, n, asked.samples), Grid::Intervals);
        let deltas = step_sizes(&t, scene.near, scene.far, CS180.delta, CS180.last_delta);
        let ray = camera_ray(&frame.camera, uv)?;
        let hit = meets(scene, &ray);
        drawn.push(Drawn { pixel: PixelDraw { image, uv, rgb }, ray, t, deltas, hit, seen: None });
    }
    if let Some(probes) = probes(scene, model, &drawn) {
        for (drawn, probes) in drawn.iter_mut().zip(probes) {
            drawn.seen = Some(seen(probes, &drawn.deltas, scene.background));
        }
    }
    Ok(drawn)
}

fn meets(scene: &Scene, ray: &Ray) -> bool {
    let box_ = scene.bounds.map(|(low, high)| [low.to_array(), high.to_array()]);
    box_.is_none_or(|[low, high]| {
        ray_aabb::between(ray.o.to_array(), ray.d.to_array(), low, high, scene.near, scene.far).is_some()
    })
}

/// A sentence where most rays miss the scene's box.
pub(super) fn missing(scene: &Scene, drawn: &[Drawn]) -> Option<String> {
    let (low, high) = scene.bounds?;
    let missed = drawn.iter().filter(|drawn| !drawn.hit).count();
    (missed as f64 > MISSED * drawn.len() as f64).then(|| {
        let count = drawn.len();
        format!(
            "{missed} of {count} rays miss the scene's box, {low:.3} to {high:.3}, between near and far: are box, near, far and poses in \
             the same unit?"
        )
    })
}

fn probes(scene: &Scene, model: Option<&dyn Model>, drawn: &[Drawn]) -> Option<Vec<Vec<Probe>>> {
    if let Some(model) = model {
        let rays: Vec<(Ray, Vec<f64>)> = drawn.iter().map(|drawn| (drawn.ray, drawn.t.clone())).collect();
        return Some(model.probe(&rays));
    }
    let (name, _) =
        scene.name.strip_prefix("builtin:").map(|name| name.split_once(',').unwrap_or((name, "")))?;
    let medium = Medium::named(name).ok()?;
    let at =
        |ray: &Ray, t: f64| Probe { density: medium.density(ray.at(t)), rgb: medium.color(ray.at(t), ray.d) };
    Some(drawn.iter().map(|Drawn { ray, t, .. }| t.iter().map(|&t| at(ray, t)).collect()).collect())
}

fn seen(probes: Vec<Probe>, deltas: &[f64], background: [f64; 3]) -> Seen {
    let sigmas: Vec<f64> = probes.iter().map(|probe| probe.density).collect();
    let rgbs: Vec<[f64; 3]> = probes.iter().map(|probe| probe.rgb).collect();
    let alphas = sigmas.iter().zip(deltas).map(|(sigma, delta)| -expm1(-sigma * delta)).collect();
    let rendering = volume_render(&sigmas, &rgbs, deltas, CS180.product_eps);
    let color = composite_background(rendering.color, rendering.opacity, background);
    Seen { probes, alphas, rendering, color }
}
