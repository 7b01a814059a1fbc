//! A dense step of the 8x256 network against one that leaves samples out: time, work and loss on the same rays.

use serde_json::{Value, json};

use super::rounds::{quantile, seconds};
use crate::error::Result;
use crate::field::fast::{Batch, Gradient, Network, Skipping};
use crate::loss::psnr;
use crate::optimizer::{Adam, fast::Moments};
use crate::random::{Key, Purpose};
use crate::scene::Scene;
use crate::training::Model;
use crate::training::nerf::grid::Grid;
use crate::training::nerf::path::Path;
use crate::training::nerf::samples::{Drawn, Samples};
use crate::training::nerf::skipping::skipping;
use crate::training::nerf::{NerfModel, Skip};

/// The step whose rays are drawn: beyond any training. Batches that follow it are only rendered.
const STEP: u64 = 1 << 40;
/// Other batches than the timed one, on which the losses are compared.
const OTHERS: u64 = 8;

/// One variant of a step, with its buffers.
#[derive(Default)]
struct StepVariant {
    gradient: Gradient,
    loss: f64,
    seconds: Vec<f64>,
}

impl StepVariant {
    /// Loss, gradient and Adam, timed; the parameters are restored.
    fn round(
        &mut self,
        (net, moments, adam): (&mut Network, &Moments, &Adam),
        step: impl Fn(&Network, &mut Gradient) -> f64,
    ) {
        let (before, mut moments) = (net.params.clone(), moments.clone());
        let took = seconds(|| {
            self.loss = step(net, &mut self.gradient);
            moments.update(net.arch, adam, &mut net.params, &self.gradient.values);
        });
        net.params = before;
        self.seconds.push(took);
    }

    fn points(&self) -> [usize; 2] {
        [self.gradient.forward_points, self.gradient.backward_points]
    }
}

/// Mean squared error of a rendered batch.
fn error(net: &Network, batch: &Batch, skipping: Skipping) -> f64 {
    let seen = net.render_skipping(&batch.rays, skipping, batch.background);
    let squares = seen.colors.iter().zip(batch.targets).map(|(c, t)| f64::from(c - t).powi(2));
    squares.sum::<f64>() / batch.targets.len() as f64
}

/// A dense training step against one that leaves samples out; none for the compact model, a pair of networks, and the reference.
///
/// # Errors
/// Where a training pixel has no ray.
pub fn compare(model: &mut dyn Model, scene: &Scene, rounds: usize) -> Result<Option<Value>> {
    let any: &mut dyn std::any::Any = model;
    let model = any.downcast_mut::<NerfModel>();
    let alone = model.filter(|model| model.fine.is_none() && matches!(model.coarse, Path::Fast { .. }));
    alone.map(|model| compared(model, scene, rounds)).transpose()
}

fn drawn(model: &NerfModel, scene: &Scene, step: u64) -> Result<(Drawn, Samples)> {
    let mut drawn = model.draw(scene, step)?;
    let samples = model.coarse_samples(std::mem::take(&mut drawn.places), &drawn.origins, &drawn.directions);
    Ok((drawn, samples))
}

fn compared(model: &mut NerfModel, scene: &Scene, rounds: usize) -> Result<Value> {
    let Skip { every, resolution, .. } = model.settings.skip.unwrap_or_default();
    let (key, length) = (Key::new(model.settings.seed, Purpose::Occupancy), model.step_length());
    let density_at = |points: &[f64]| model.coarse.densities(points);
    let mut fill_seconds = None;
    let grid = match &model.grid {
        Some(grid) => grid.clone(),
        None => {
            let mut grid = Grid::new(scene, &|ray| model.settings.ends(ray), resolution)?;
            fill_seconds = Some(seconds(|| grid.fill(&key, STEP, length, &density_at)));
            grid
        }
    };
    let mut later = grid.clone();
    let update_seconds = seconds(|| later.update(&key, (STEP, 1), length, &density_at));
    let background = model.settings.background.map(|b| b as f32);
    let mut others = vec![];
    for n in 1..=OTHERS {
        let (drawn, samples) = drawn(model, scene, STEP + n)?;
        let rays = samples.rays(&drawn.origins, &drawn.directions);
        let batch = Batch { rays, targets: &drawn.targets, background };
        let Path::Fast { net, .. } = &model.coarse else { unreachable!("a fast path") };
        let whole = error(net, &batch, Skipping::default());
        others.push(psnr(whole, 1.0) - psnr(error(net, &batch, skipping(Some(&grid.mask(&rays)))), 1.0));
    }
    let (drawn, samples) = drawn(model, scene, STEP)?;
    let rays = samples.rays(&drawn.origins, &drawn.directions);
    let batch = Batch { rays, targets: &drawn.targets, background };
    let adam = model.adam(1);
    let Path::Fast { net, moments, .. } = &mut model.coarse else { unreachable!("a fast path") };
    let [mut dense, mut usual, mut skip] = [(); 3].map(|()| StepVariant::default());
    // The first round warms up and doesn't count.
    for round in 0..=rounds {
        let mut of = |variant: &mut StepVariant, step: &dyn Fn(&Network, &mut Gradient) -> f64| {
            variant.round((&mut *net, &*moments, &adam), step);
        };
        of(&mut dense, &|net, gradient| net.step(&batch, true, gradient));
        of(&mut usual, &|net, gradient| net.step(&batch, false, gradient));
        of(&mut skip, &|net, gradient| {
            net.step_skipping(&batch, skipping(Some(&grid.mask(&rays))), gradient)
        });
        if round == 0 {
            for variant in [&mut dense, &mut usual, &mut skip] {
                variant.seconds.clear();
            }
        }
    }
    let all = rays.t.len() as f64;
    let figures = Figures { dense, usual, skip, all, update: update_seconds / every as f64 };
    let mut object = figures.json();
    object["rays"] = rays.len().into();
    object["samples"] = rays.samples.into();
    object["occupied_cells"] = grid.fraction().into();
    object["grid_fill_seconds"] = fill_seconds.into();
    object["grid_update_seconds"] = update_seconds.into();
    object["grid_update_every"] = every.into();
    object["other_rays"] = (OTHERS as usize * rays.len()).into();
    object["other_loss_db"] = (others.iter().sum::<f64>() / others.len() as f64).into();
    object["other_loss_db_worst"] = others.iter().copied().fold(f64::NEG_INFINITY, f64::max).into();
    object["text"] = text(&object).into();
    Ok(object)
}

/// What was measured.
struct Figures {
    dense: StepVariant,
    usual: StepVariant,
    skip: StepVariant,
    /// Samples of the batch.
    all: f64,
    /// Seconds of the grid's updates, a step.
    update: f64,
}

impl Figures {
    /// Quartiles and extremes over the rounds of `of` over the skipping step, with `more` seconds in each of the latter.
    fn ratios(&self, of: &StepVariant, more: f64) -> [f64; 3] {
        let pairs = of.seconds.iter().zip(&self.skip.seconds);
        let ratios: Vec<f64> = pairs.map(|(of, skip)| of / (skip + more)).collect();
        [0.5, 0.0, 1.0].map(|q| quantile(&ratios, q))
    }

    fn json(&self) -> Value {
        let [forward, backward] = self.skip.points().map(|n| n as f64 / self.all);
        let median = |variant: &StepVariant| quantile(&variant.seconds, 0.5);
        json!({
            "rounds": self.skip.seconds.len(),
            "dense_seconds": median(&self.dense), "train_seconds": median(&self.usual), "skip_seconds": median(&self.skip),
            "ratio": self.ratios(&self.dense, 0.0), "ratio_with_updates": self.ratios(&self.dense, self.update),
            "ratio_to_train": self.ratios(&self.usual, self.update),
            "evaluated": forward, "backward": backward,
            // A backward pass is two products where a forward pass is one.
            "ceiling": 3.0 / (forward + 2.0 * backward),
            "dense_loss": self.dense.loss, "skip_loss": self.skip.loss,
            "loss_db": psnr(self.dense.loss, 1.0) - psnr(self.skip.loss, 1.0),
        })
    }
}

/// For people.
fn text(object: &Value) -> String {
    let number = |name: &str| object[name].as_f64().unwrap_or(f64::NAN);
    let ratio = |name: &str| {
        let [middle, low, high] = [0, 1, 2].map(|n| object[name][n].as_f64().unwrap_or(f64::NAN));
        format!("{middle:.2} times ({low:.2} to {high:.2})")
    };
    let seconds = |name: &str| format!("{:.4} s", number(name));
    let rows = [
        ("every sample computed", seconds("dense_seconds")),
        ("as train computes it: no backward pass where the density is 0", seconds("train_seconds")),
        ("with occupancy grid and early stop", seconds("skip_seconds")),
        ("every sample / skipping", ratio("ratio")),
        ("the same with the grid's updates", ratio("ratio_with_updates")),
        ("as train computes it / skipping with updates", ratio("ratio_to_train")),
        (
            "samples evaluated; with backward pass",
            format!("{:.2}%; {:.2}%", 100.0 * number("evaluated"), 100.0 * number("backward")),
        ),
        ("ceiling: work that is left out", format!("{:.2} times", number("ceiling"))),
        (
            "loss, the same rays; other rays, mean and worst batch",
            format!(
                "{:+.4} dB; {:+.4}, {:+.4} dB",
                number("loss_db"),
                number("other_loss_db"),
                number("other_loss_db_worst")
            ),
        ),
    ];
    let rows = rows.map(|(name, value)| vec![name.to_string(), value]);
    crate::report::table::text(&["8x256 step with Adam", ""], &rows)
}
