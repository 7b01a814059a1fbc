//! The trained 8x256 network as `bench` sees it: 16 to 256 samples per ray.

use crate::bench::system::{Choice, System, TrueRay};
use crate::convention::CS180;
use crate::early_stop::live_samples;
use crate::encoding::Encoding;
use crate::ray::Ray;
use crate::sample::{rest_u, sample_along_ray};
use crate::training::nerf::NerfModel;
use crate::training::nerf::path::Path;
use crate::training::reference::Field;
use crate::training::{Model, Pixel};

/// Samples per ray; the first are those of the training.
const SAMPLES: [(&str, usize); 6] = [
    ("as_trained", 0),
    ("samples_16", 16),
    ("samples_32", 32),
    ("samples_64", 64),
    ("samples_128", 128),
    ("samples_256", 256),
];

/// A model with another number of samples; its own again when dropped.
pub(super) struct Trained<'a> {
    model: &'a mut NerfModel,
    samples: usize,
    field: Field,
}

impl<'a> Trained<'a> {
    /// The model as it is.
    pub(super) fn new(model: &'a mut NerfModel) -> Self {
        let net = match &model.coarse {
            Path::Fast { net, .. } => net.to_oracle(&net.params),
            Path::Reference { field, .. } => field.net.clone(),
        };
        let (position, direction) = model.settings.levels;
        let field = Field {
            net,
            position: Encoding::new(position, &CS180),
            direction: Encoding::new(direction, &CS180),
            cube: None,
            conventions: CS180,
        };
        Trained { samples: model.settings.samples, model, field }
    }
}

impl Drop for Trained<'_> {
    fn drop(&mut self) {
        self.choose(0);
    }
}

impl System for Trained<'_> {
    fn choices(&self) -> Vec<Choice> {
        SAMPLES
            .iter()
            .map(|&(name, _)| Choice { name, about: "samples a ray, evenly spaced; all computed, or those that the run's own grid and early stop leave" })
            .collect()
    }

    fn choose(&mut self, n: usize) {
        self.model.settings.samples = if n == 0 { self.samples } else { SAMPLES[n].1 };
    }

    fn render(&self, rays: &[Ray]) -> Vec<Pixel> {
        self.model.render(rays)
    }

    fn truth(&self, ray: &Ray, samples: usize) -> TrueRay {
        self.seen(ray, samples, 0.0)
    }

    fn same_samples(&self, rays: &[Ray]) -> Vec<TrueRay> {
        let stop = self.model.skipping_stop();
        crate::parallel::map(rays.len(), |n| self.seen(&rays[n], self.model.settings.samples, stop))
    }

    fn true_pixels(&self) -> usize {
        16
    }

    fn timed_pixels(&self) -> usize {
        1024
    }
}

impl Trained<'_> {
    /// A ray rendered in f64 with this many samples, to its end or until T < `stop`.
    fn seen(&self, ray: &Ray, samples: usize, stop: f64) -> TrueRay {
        let (near, far) = (self.model.settings.near, self.model.settings.far);
        let t = sample_along_ray(near, far, &vec![rest_u(CS180.rest); samples], CS180.grid);
        let delta = (far - near) / samples as f64;
        // A run's own grid is part of its model: density 0 in empty cells.
        let live = |t: &f64| self.model.grid.as_ref().is_none_or(|grid| grid.live(ray.at(*t).to_array()));
        let mut t: Vec<f64> = t.into_iter().filter(live).collect();
        if stop > 0.0 {
            let sigmas: Vec<f64> = t.iter().map(|&t| self.field.at(ray, t).sigma).collect();
            t.truncate(live_samples(&sigmas, &vec![delta; t.len()], stop));
        }
        let (seen, _) = self.field.render(ray, &t, &vec![delta; t.len()]);
        TrueRay { color: seen.color, opacity: seen.opacity, samples, live: t.len() }
    }
}
