//! The trained model as `bench` sees it: samples per ray, early stop at several eps, occupancy thresholds.

use crate::bench::system::{Choice, System, TrueRay};
use crate::occupancy_grid::fast::Occupancy;
use crate::ray::Ray;
use crate::training::compact::CompactModel;
use crate::training::compact::reference::Reference;
use crate::training::compact::settings::AT_REST;
use crate::training::compact::space::optical_step;
use crate::training::{Model, Pixel};

/// What a variant changes.
#[derive(Clone, Copy)]
enum Knob {
    Nothing,
    /// Samples along a ray, over those of training.
    Samples(f64),
    Stop(f64),
    /// Samples and eps of training.
    Training,
    /// Opacity of one step above which a cell counts as occupied.
    Opacity(f32),
}

const KNOBS: [(&str, &str, Knob); 14] = [
    (
        "at_rest",
        "as render and evaluate do: 1.5 times the training's samples, eps 1e-6, cells of an opacity above 0.01",
        Knob::Nothing,
    ),
    ("samples_x1/8", "an eighth of the training's samples", Knob::Samples(0.125)),
    ("samples_x1/4", "a quarter of the training's samples", Knob::Samples(0.25)),
    ("samples_x1/2", "half of the training's samples", Knob::Samples(0.5)),
    ("as_trained", "the training's own samples, eps 1e-4", Knob::Training),
    ("samples_x4", "four times the training's samples", Knob::Samples(4.0)),
    ("stop_0", "no early stop", Knob::Stop(0.0)),
    ("stop_1e-4", "a ray ends where T < 1e-4, as in training", Knob::Stop(1e-4)),
    ("stop_1e-3", "a ray ends where T < 1e-3", Knob::Stop(1e-3)),
    ("stop_1e-2", "a ray ends where T < 1e-2", Knob::Stop(1e-2)),
    ("stop_1e-1", "a ray ends where T < 1e-1", Knob::Stop(1e-1)),
    ("opacity_0.001", "cells count from an opacity of 0.001 a step", Knob::Opacity(0.001)),
    ("opacity_0.05", "cells count from an opacity of 0.05 a step", Knob::Opacity(0.05)),
    ("opacity_0.2", "cells count from an opacity of 0.2 a step", Knob::Opacity(0.2)),
];

/// A model with one of its knobs turned; turned back when dropped.
pub(super) struct Trained<'a> {
    model: &'a mut CompactModel,
    /// As trained: at first and in the end.
    samples: [f64; 2],
    stop: f64,
    occupancy: Occupancy,
    reference: Reference,
}

impl<'a> Trained<'a> {
    /// The model as it is.
    pub(super) fn new(model: &'a mut CompactModel) -> Self {
        let settings = &model.settings;
        let (samples, stop) = ([settings.samples_first, settings.samples], settings.stop_at_rest);
        let (occupancy, reference) = (model.occupancy.clone(), Reference::new(model));
        Trained { model, samples, stop, occupancy, reference }
    }
}

impl Drop for Trained<'_> {
    fn drop(&mut self) {
        self.choose(0);
    }
}

impl System for Trained<'_> {
    fn choices(&self) -> Vec<Choice> {
        KNOBS.iter().map(|&(name, about, _)| Choice { name, about }).collect()
    }

    fn choose(&mut self, n: usize) {
        let model = &mut *self.model;
        let settings = &mut model.settings;
        let mut samples = |factor: f64| {
            [settings.samples_first, settings.samples] =
                self.samples.map(|samples| factor / AT_REST * samples);
        };
        samples(AT_REST);
        settings.stop_at_rest = self.stop;
        model.occupancy.clone_from(&self.occupancy);
        match KNOBS[n].2 {
            Knob::Nothing => {}
            Knob::Samples(factor) => samples(factor),
            Knob::Training => {
                samples(1.0);
                model.settings.stop_at_rest = model.settings.stop;
            }
            Knob::Stop(eps) => model.settings.stop_at_rest = eps,
            Knob::Opacity(opacity) => {
                let threshold = opacity / optical_step(model.settings.samples_at(model.step));
                model.occupancy.apply_threshold(threshold);
            }
        }
    }

    fn render(&self, rays: &[Ray]) -> Vec<Pixel> {
        self.model.render(rays)
    }

    fn truth(&self, ray: &Ray, samples: usize) -> TrueRay {
        self.seen(ray, samples as f64, &self.reference)
    }

    fn same_samples(&self, rays: &[Ray]) -> Vec<TrueRay> {
        // With the cells of the choice, which may differ from those of the trained model.
        let reference = Reference::new(self.model);
        let samples = self.model.settings.samples_at_rest(self.model.step);
        crate::parallel::map(rays.len(), |n| self.seen(&rays[n], samples, &reference))
    }

    fn true_pixels(&self) -> usize {
        4096
    }

    fn timed_pixels(&self) -> usize {
        usize::MAX
    }
}

impl Trained<'_> {
    fn seen(&self, ray: &Ray, samples: f64, reference: &Reference) -> TrueRay {
        let seen = reference.render(ray, samples, self.model.settings.stop_at_rest);
        TrueRay { color: seen.color, opacity: seen.opacity, samples: seen.samples, live: seen.live }
    }
}

#[cfg(test)]
mod tests {
    use super::{AT_REST, Trained};
    use crate::bench::system::System;
    use crate::evaluation::camera_rays;
    use crate::ray::Ray;
    use crate::scene;
    use crate::training::Model;
    use crate::training::compact::{CompactModel, Overrides};

    fn trained() -> (CompactModel, Vec<Ray>) {
        let scene = scene::load("builtin:blob", &scene::Options::default()).unwrap();
        let mut model = CompactModel::new(&scene, &Overrides::default()).unwrap();
        for step in 1..=40 {
            model.step(&scene, step).unwrap();
        }
        let rays = camera_rays(&scene.val[0].camera).unwrap();
        let some = rays.iter().copied().step_by(rays.len() / 60).collect();
        (model, some)
    }

    /// At the same samples f32 and f64 agree to some roundings; the early stop moves a color by at most its eps; nothing sticks.
    #[test]
    fn the_f32_path_agrees_with_it_and_knobs_turn_back() {
        let (mut model, rays) = trained();
        let before = model.render(&rays);
        let mut system: Box<dyn System + '_> = Box::new(Trained::new(&mut model));
        let names: Vec<&str> = system.choices().iter().map(|c| c.name).collect();
        let at = |name: &str| names.iter().position(|n| *n == name).unwrap();
        let off = |system: &dyn System| {
            let same = system.same_samples(&rays);
            let pairs = system.render(&rays).into_iter().zip(same);
            pairs.fold(0f64, |max, (got, want)| {
                (0..3).fold(max, |max, k| max.max((f64::from(got.rgb[k]) - want.color[k]).abs()))
            })
        };
        system.choose(at("stop_0"));
        assert!(off(&*system) < 1e-4, "{}", off(&*system));
        let seen = system.same_samples(&rays);
        assert!(seen.iter().all(|s| s.live == s.samples) && seen.iter().any(|s| s.samples > 10));
        assert!(seen.iter().any(|s| s.opacity > 0.3), "something is there");
        system.choose(at("stop_1e-1"));
        assert!((1e-3..=0.1 + 1e-4).contains(&off(&*system)), "{}", off(&*system));
        let samples = |system: &dyn System| {
            system.same_samples(&rays).iter().map(|seen| seen.samples).sum::<usize>() as f64
        };
        system.choose(at("at_rest"));
        let at_rest = samples(&*system);
        system.choose(at("as_trained"));
        assert!((at_rest / samples(&*system) - AT_REST).abs() < 0.05, "pictures take more samples");
        system.choose(at("samples_x1/8"));
        assert!(off(&*system) < 1e-4, "its own samples are an eighth too");
        drop(system);
        assert!(model.render(&rays) == before);
    }
}
