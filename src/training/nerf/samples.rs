//! The rays of a step, and where on them the networks are evaluated.

use super::{NerfModel, NerfSettings, ray_of};
use crate::convention::CS180;
use crate::error::Result;
use crate::field::fast::Rays;
use crate::ndc::cube::Cube;
use crate::random::{Key, Purpose};
use crate::ray::{camera_ray, pixel_position};
use crate::sample::sample_along_ray;
use crate::scene::{Scene, random_pixel};
use crate::training::reference::{fine_samples, interval_edges};

/// One step's rays as flat arrays.
pub(crate) struct Drawn {
    pub origins: Vec<f64>,
    pub directions: Vec<f64>,
    /// Where samples lie in the range of [`NerfSettings::range`].
    pub places: Vec<f64>,
    /// The u of the second network's samples.
    pub(super) u: Vec<f64>,
    pub targets: Vec<f32>,
}

/// Samples of rays (R, N): places in the range of [`NerfSettings::range`], distances, and step lengths.
pub(crate) struct Samples {
    places: Vec<f64>,
    t: Vec<f64>,
    deltas: Vec<f64>,
    count: usize,
    cube: Option<Cube>,
}

impl Samples {
    pub(crate) fn rays<'a>(&'a self, origins: &'a [f64], directions: &'a [f64]) -> Rays<'a> {
        let (t, deltas, cube) = (&self.t, &self.deltas, self.cube.as_ref());
        Rays { origins, directions, t, deltas, samples: self.count, cube }
    }
}

impl NerfModel {
    /// The rays of a step: pixels from one stream, jitter from another, each ray its own counter.
    pub(crate) fn draw(&self, scene: &Scene, step: u64) -> Result<Drawn> {
        let NerfSettings { rays, samples, fine, seed, .. } = self.settings;
        let (near, far) = self.settings.range();
        let (pixels, jitter) = (Key::new(seed, Purpose::Rays), Key::new(seed, Purpose::Samples));
        let mut drawn =
            Drawn { origins: vec![], directions: vec![], places: vec![], u: vec![], targets: vec![] };
        for r in 0..rays as u64 {
            let [frame, j, i] = random_pixel(&scene.train, &pixels, step, r);
            let frame = &scene.train[frame];
            let ray = camera_ray(&frame.camera, pixel_position(i, j, CS180.pixel_center))?;
            let image = frame.image.as_ref().expect("training frames have pictures");
            drawn.origins.extend(ray.o.to_array());
            drawn.directions.extend(ray.d.to_array());
            let u = jitter.uniforms(step, r, samples + fine);
            drawn.places.extend(sample_along_ray(near, far, &u[..samples], CS180.grid));
            drawn.u.extend(&u[samples..]);
            drawn.targets.extend(image.at(j, i));
        }
        Ok(drawn)
    }

    /// The first network's samples: steps D = (far - near) / N.
    pub(crate) fn coarse_samples(&self, places: Vec<f64>, origins: &[f64], directions: &[f64]) -> Samples {
        let (near, far) = self.settings.range();
        let steps = vec![(far - near) / self.settings.samples as f64; places.len()];
        self.laid(places, steps, origins, directions)
    }

    /// Samples at these places, with steps of these lengths: distances themselves, or shares of a ray's way through the cube.
    fn laid(&self, places: Vec<f64>, steps: Vec<f64>, origins: &[f64], directions: &[f64]) -> Samples {
        let (count, cube) = (places.len() / (origins.len() / 3).max(1), self.settings.cube);
        let (mut t, mut deltas) = (places.clone(), steps);
        if let Some(cube) = &cube {
            for (r, (t, deltas)) in t.chunks_mut(count).zip(deltas.chunks_mut(count)).enumerate() {
                let ray = ray_of(origins, directions, r);
                let length = cube.length(&ray);
                t.iter_mut().for_each(|t| *t = cube.distance(&ray, *t));
                deltas.iter_mut().for_each(|delta| *delta *= length);
            }
        }
        Samples { places, t, deltas, count, cube }
    }

    /// The second network's samples: those of the first, and more where its weights are large.
    pub(super) fn fine_samples(
        &self,
        coarse: &Samples,
        origins: &[f64],
        directions: &[f64],
        u: &[f64],
    ) -> Samples {
        let NerfSettings { samples, fine, .. } = self.settings;
        let (near, far) = self.settings.range();
        let weights = self.coarse.weights(coarse.rays(origins, directions));
        let edges = interval_edges(near, far, samples);
        let (mut places, mut steps) = (vec![], vec![]);
        for r in 0..origins.len() / 3 {
            let of = r * samples..(r + 1) * samples;
            let (coarse, u) = (&coarse.places[of.clone()], &u[r * fine..(r + 1) * fine]);
            let found = fine_samples(coarse, &edges, &weights[of], u, far);
            places.extend(found.0);
            steps.extend(found.1);
        }
        self.laid(places, steps, origins, directions)
    }
}
