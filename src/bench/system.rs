//! The whole system: pictures of a trained run, time per view against the error from the oracle's rendering.
//!
//! The truth is the trained field in f64 with 4,096 samples across the scene's box, at seeded pixels of the validation views.

use serde_json::{Value, json};

use super::Options;
use super::frontier::on_frontier;
use super::rounds::{quantile, seconds};
use super::scaling::exponent;
use crate::camera::Camera;
use crate::error::{Error, Input, Result};
use crate::evaluation::{over, seen_rays};
use crate::loss::psnr;
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::ray::Ray;
use crate::scene::Scene;
use crate::training::Pixel;

/// Samples across the box that count as exact.
const TRUE_SAMPLES: usize = 4096;

/// One variant of rendering.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Its name.
    pub name: &'static str,
    /// What it changes, in a line.
    pub about: &'static str,
}

/// The oracle's rendering of a ray.
#[derive(Clone, Copy, Debug)]
pub struct TrueRay {
    /// Premultiplied color.
    pub color: [f64; 3],
    /// A.
    pub opacity: f64,
    /// Samples that were evaluated.
    pub samples: usize,
    /// Those before the early stop.
    pub live: usize,
}

impl TrueRay {
    fn over(&self, background: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.color[k] + (1.0 - self.opacity) * background[k])
    }
}

/// A trained model with several variants of rendering.
pub trait System: Send + Sync {
    /// All of them; the first is as `render` and `evaluate` do.
    fn choices(&self) -> Vec<Choice>;
    /// Renders like choice `n` from now on.
    fn choose(&mut self, n: usize);
    /// The f32 path.
    fn render(&self, rays: &[Ray]) -> Vec<Pixel>;
    /// The field as trained, in f64, with this many samples across the box.
    fn truth(&self, ray: &Ray, samples: usize) -> TrueRay;
    /// The current choice in f64, at the same samples: the error of f32 and of the early stop.
    fn same_samples(&self, rays: &[Ray]) -> Vec<TrueRay>;
    /// Number of pixels whose truth is computed.
    fn true_pixels(&self) -> usize;
    /// Pixels of a view that are rendered for time; all of them where it has fewer.
    fn timed_pixels(&self) -> usize;
}

/// The rows of a run.
///
/// # Errors
/// Where a validation pixel has no ray, or there are no validation views.
pub fn rows(
    system: &mut dyn System,
    scene: &Scene,
    options: &Options,
    tell: impl Fn(&str),
) -> Result<(Vec<Value>, Vec<Value>)> {
    let frames = if scene.val.is_empty() { &scene.train } else { &scene.val };
    let frame = frames.first().ok_or_else(|| {
        Error::input(Input {
            file: &scene.name,
            field: "views",
            found: "none",
            expected: "at least one",
            remedy: "Choose a scene with views.",
        })
    })?;
    let views = frames.iter().map(|f| seen_rays(&f.camera)).collect::<Result<Vec<_>>>()?;
    let key = Key::new(0, Purpose::Probe);
    let pick = |n: usize| {
        let view = &views[key.below(views.len() as u64, 1, n as u64, 0) as usize];
        view[key.below(view.len() as u64, 1, n as u64, 1) as usize]
    };
    let pixels: Vec<Ray> = (0..system.true_pixels()).map(pick).collect();
    system.choose(0);
    tell(&format!("oracle: {} pixels with {TRUE_SAMPLES} samples", pixels.len()));
    let mut truth = vec![];
    let oracle = seconds(|| {
        truth =
            parallel::map(pixels.len(), |n| system.truth(&pixels[n], TRUE_SAMPLES).over(scene.background));
    });
    let whole = (frame.camera.width * frame.camera.height) as f64;
    // The first view's rays: all, or seeded ones.
    let all = &views[0];
    let timed: Vec<Ray> = if all.len() <= system.timed_pixels() {
        all.clone()
    } else {
        let draw = |n: usize| all[key.below(all.len() as u64, 2, n as u64, 0) as usize];
        (0..system.timed_pixels()).map(draw).collect()
    };
    let sides: Vec<(f64, Vec<Ray>)> = [8, 4, 2, 1].map(|step| coarser(&frame.camera, all, step)).into();
    let choices = system.choices();
    let mut times = vec![vec![]; choices.len()];
    let mut by_side = vec![vec![]; sides.len()];
    for round in 0..options.rounds {
        tell(&format!("pictures, round {} of {}", round + 1, options.rounds));
        system.choose(0);
        if all.len() <= system.timed_pixels() {
            for ((_, rays), times) in sides.iter().zip(&mut by_side) {
                times.push(seconds(|| drop(std::hint::black_box(system.render(rays)))));
            }
        }
        for (n, times) in times.iter_mut().enumerate() {
            system.choose(n);
            let view = seconds(|| drop(std::hint::black_box(system.render(&timed))));
            times.push(view * whole / timed.len() as f64);
        }
    }
    let mut rows = vec![oracle_row(oracle * whole / pixels.len() as f64, pixels.len())];
    for (n, choice) in choices.iter().enumerate() {
        system.choose(n);
        rows.push(row(&*system, *choice, &pixels, &truth, &times[n], scene.background));
    }
    system.choose(0);
    let points: Vec<(f64, f64)> = rows
        .iter()
        .map(|r| (r["seconds"].as_f64().unwrap_or(f64::NAN), r["max_error"].as_f64().unwrap_or(f64::NAN)))
        .collect();
    for (row, on) in rows.iter_mut().zip(on_frontier(&points)) {
        row["on_frontier"] = on.into();
    }
    let values: Vec<f64> = sides.iter().map(|(side, _)| *side).collect();
    let middle: Vec<f64> = by_side.iter().map(|times| quantile(times, 0.5)).collect();
    let scaling = json!({
        "component": "system", "parameter": "picture resolution", "about": "a view of the trained model, pixels along an edge",
        "values": values, "seconds": middle, "exponent": exponent(&values, &middle), "memory_exponent": null,
    });
    let scaling = if by_side[0].is_empty() { vec![] } else { vec![scaling] };
    Ok((rows, scaling))
}

/// Every `step`-th pixel of a view along both axes, with the square root of their number.
fn coarser(camera: &Camera, rays: &[Ray], step: usize) -> (f64, Vec<Ray>) {
    let (w, h) = (camera.width, camera.height);
    let rows = (step / 2..h).step_by(step);
    let chosen: Vec<Ray> =
        rows.flat_map(|j| (step / 2..w).step_by(step).map(move |i| rays[j * w + i])).collect();
    ((chosen.len() as f64).sqrt(), chosen)
}

fn oracle_row(seconds: f64, pixels: usize) -> Value {
    json!({
        "component": "system", "variant": "oracle", "dtype": "f64", "seconds": seconds, "spread": null, "psnr": null,
        "max_error": 0.0, "mean_error": 0.0, "p99_error": 0.0, "samples_a_ray": TRUE_SAMPLES, "pixels": pixels,
        "about": "the trained field in f64, 4,096 samples across the box, all threads",
    })
}

fn row(
    system: &dyn System,
    choice: Choice,
    pixels: &[Ray],
    truth: &[[f64; 3]],
    times: &[f64],
    background: [f64; 3],
) -> Value {
    let dark = background.map(|b| b as f32);
    let seen: Vec<[f64; 3]> =
        system.render(pixels).into_iter().map(|p| over(p, dark).map(f64::from)).collect();
    let same = system.same_samples(pixels);
    let errors = |of: &dyn Fn(usize) -> [f64; 3]| -> Vec<f64> {
        (0..pixels.len())
            .flat_map(|n| (0..3).map(move |k| (n, k)))
            .map(|(n, k)| (seen[n][k] - of(n)[k]).abs())
            .collect()
    };
    let off = errors(&|n| truth[n]);
    let f32s = errors(&|n| same[n].over(background));
    let count = off.len() as f64;
    let largest = |errors: &[f64]| errors.iter().fold(0.0, |max: f64, e| if *e > max { *e } else { max });
    let mse = off.iter().map(|e| e * e).sum::<f64>() / count;
    let mean = |f: fn(&TrueRay) -> usize| same.iter().map(|s| f(s) as f64).sum::<f64>() / same.len() as f64;
    let middle = quantile(times, 0.5);
    json!({
        "component": "system", "variant": choice.name, "dtype": "f32", "seconds": middle,
        "spread": (quantile(times, 0.75) - quantile(times, 0.25)) / middle, "psnr": psnr(mse, 1.0),
        "max_error": largest(&off), "mean_error": off.iter().sum::<f64>() / count, "p99_error": quantile(&off, 0.99),
        "same_samples_max_error": largest(&f32s), "samples_a_ray": mean(|s| s.samples),
        "live_samples_a_ray": mean(|s| s.live), "pixels": pixels.len(), "rounds": times.len(), "about": choice.about,
    })
}
