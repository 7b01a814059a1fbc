//! The NeRF paper's network as a trainable model, on the f32 path or in the f64 reference; optionally the paper's pair of a coarse
//! and a fine network.

pub mod forward;
pub(crate) mod grid;
pub(crate) mod path;
pub(crate) mod samples;
pub(crate) mod skipping;

#[cfg(test)]
mod tests;

use glam::DVec3;
use serde_json::{Map, Value, json};

use self::grid::Grid;
use self::path::Path;
use self::samples::Drawn;
pub use self::skipping::Skip;
use self::skipping::skipping;
use super::model::{Model, Pixel, StepReport};
use super::probe::{Cells, Probe};
use super::rate;
use crate::convention::CS180;
use crate::error::{Error, Input, Result};
use crate::field::NerfMlp;
use crate::field::fast::{Rays, Skipping};
use crate::field::nerf_mlp::Shape;
use crate::files::npz::{Array, Arrays};
use crate::ndc::cube::Cube;
use crate::optimizer::Adam;
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::ray::Ray;
use crate::sample::{rest_u, sample_along_ray};
use crate::scene::Scene;

/// Prefix of the names of the fine network's arrays.
const FINE: &str = "fine.";

/// Name of a number in a checkpoint: 1 where a density head's sign was turned.
const TURNED: &str = "density_head_turned";

/// Rays that are rendered together, which bounds the memory of a picture.
const RENDER_CHUNK: usize = 1024;

/// The settings of a [`NerfModel`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NerfSettings {
    /// Where samples start.
    pub near: f64,
    /// Where they end.
    pub far: f64,
    /// The color behind everything.
    pub background: [f64; 3],
    /// Rays per step.
    pub rays: usize,
    /// Samples per ray.
    pub samples: usize,
    /// Additional samples of a second network, drawn from the first one's weights (NeRF, section 5.2); 0: no second network.
    pub fine: usize,
    /// Learning rate of Adam at the start; it falls by 1 / sqrt(1 + step / 1500).
    pub lr: f64,
    /// Seed of parameters, rays and jitter.
    pub seed: u64,
    /// Sizes of the network.
    pub shape: Shape,
    /// L of positions and of directions.
    pub levels: (usize, usize),
    /// The f64 reference instead of the f32 path.
    pub reference: bool,
    /// Whether, and from when on, an occupancy grid and early stop leave samples out (of one network alone).
    pub skip: Option<Skip>,
    /// The normalized device coordinates that positions are in; without them, those of the scene.
    pub cube: Option<Cube>,
    /// Why.
    pub space_reason: &'static str,
}

impl NerfSettings {
    /// The paper's network, 1,024 rays of 64 samples, a learning rate that begins at 1e-3, twice the paper's, and falls.
    pub fn new(near: f64, far: f64, background: [f64; 3]) -> Self {
        #[rustfmt::skip]
        let settings = NerfSettings {
            near, far, background, rays: 1024, samples: 64, fine: 0, lr: 1e-3, seed: 0, shape: Shape::PAPER, levels: (10, 4), reference: false, skip: None, cube: None, space_reason: "the paper's own, for objects",
        };
        settings
    }

    /// The places on a ray where samples begin and end: distances, or s in normalized device coordinates.
    fn range(&self) -> (f64, f64) {
        self.cube.map_or((self.near, self.far), |_| (0.0, 1.0))
    }

    /// The positions of these.
    pub(crate) fn ends(&self, ray: &Ray) -> [[f64; 3]; 2] {
        match &self.cube {
            Some(cube) => cube.ends(ray),
            None => [self.near, self.far].map(|t| ray.at(t).to_array()),
        }
    }

    /// Another trunk width; the color layer has half of it, as in the paper.
    pub fn set_width(&mut self, width: usize) {
        (self.shape.width, self.shape.color) = (width, (width / 2).max(1));
    }
}

/// One network, or two.
pub struct NerfModel {
    pub(crate) settings: NerfSettings,
    pub(crate) coarse: Path,
    pub(crate) fine: Option<Path>,
    /// The occupancy grid, once it is filled.
    pub(crate) grid: Option<Grid>,
    /// Whether the last step moved no parameter of one of them: every density was 0 (TR1).
    dead: bool,
    /// Whether a density head's sign was turned at the start.
    turned: bool,
    /// Whether the parameters have learned already: a step numbered 1 of another loop doesn't wake them.
    learned: bool,
}

impl std::fmt::Debug for NerfModel {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("NerfModel").finish_non_exhaustive()
    }
}

impl NerfModel {
    /// Initial parameters from the seed; those of the fine network from its complement.
    pub fn new(settings: NerfSettings) -> Self {
        let of = |seed: u64| Path::new(&settings, &Key::new(seed, Purpose::Parameters));
        let fine = (settings.fine > 0).then(|| of(!settings.seed));
        let coarse = of(settings.seed);
        NerfModel { coarse, fine, settings, grid: None, dead: false, turned: false, learned: false }
    }

    /// Adam of a training step.
    pub(crate) fn adam(&self, step: u64) -> Adam {
        Adam { lr: self.settings.lr * rate::falling(step), ..Adam::default() }
    }

    /// Before the first step: a density head that gives less than half of the samples a density gets the other sign (TR1).
    ///
    /// ReLU passes no gradient where z <= 0, and at the start z has nearly the same sign everywhere: as drawn, the network stays dead
    /// for ever with about one seed in two (bmild/nerf#29). Both signs of the head are equally likely draws; the one with more density
    /// is taken.
    fn wake(&mut self, rays: Rays) {
        for network in [Some(&mut self.coarse), self.fine.as_mut()].into_iter().flatten() {
            let weights = network.weights(rays);
            if 2 * weights.iter().filter(|&&w| w > 0.0).count() < weights.len() {
                network.turn_density_head();
                self.turned = true;
            }
        }
    }

    fn render_chunk(&self, rays: &[Ray]) -> Vec<Pixel> {
        let NerfSettings { samples, fine, .. } = self.settings;
        let (near, far) = self.settings.range();
        let places = sample_along_ray(near, far, &vec![rest_u(CS180.rest); samples], CS180.grid);
        let origins: Vec<f64> = rays.iter().flat_map(|r| r.o.to_array()).collect();
        let directions: Vec<f64> = rays.iter().flat_map(|r| r.d.to_array()).collect();
        let coarse = self.coarse_samples(places.repeat(rays.len()), &origins, &directions);
        let seen = match &self.fine {
            None => {
                let rays = coarse.rays(&origins, &directions);
                self.coarse.render(rays, skipping(self.mask(&rays).as_deref()))
            }
            Some(network) => {
                // At evaluation, u is in the middle of equal parts, as the samples of the first network are.
                let u = sample_along_ray(0.0, 1.0, &vec![rest_u(CS180.rest); fine], CS180.grid);
                let samples = self.fine_samples(&coarse, &origins, &directions, &u.repeat(rays.len()));
                network.render(samples.rays(&origins, &directions), Skipping::default())
            }
        };
        let pixel = |(rgb, opacity, weighted): ([f32; 3], f32, f32)| {
            let depth = if opacity > 0.0 { weighted / opacity } else { self.settings.far as f32 };
            Pixel { rgb, opacity, depth }
        };
        seen.into_iter().map(pixel).collect()
    }

    /// Whether there is anything to be seen along a ray: normalized device coordinates have no place for those across or backward.
    fn sees(&self, ray: &Ray) -> bool {
        self.settings.cube.is_none_or(|cube| cube.faces(ray))
    }
}

impl Model for NerfModel {
    fn step(&mut self, scene: &Scene, step: u64) -> Result<StepReport> {
        let Drawn { origins, directions, places, u, targets } = self.draw(scene, step)?;
        let (background, adam) = (self.settings.background, self.adam(step));
        let coarse = self.coarse_samples(places, &origins, &directions);
        if step == 1 && !self.learned {
            self.wake(coarse.rays(&origins, &directions));
        }
        // Before the step: both networks use the same parameters of the first, whose weights are constants to the second.
        let fine = self.fine.is_some().then(|| self.fine_samples(&coarse, &origins, &directions, &u));
        self.update_grid(scene, step)?;
        let rays = coarse.rays(&origins, &directions);
        let live = self.mask(&rays);
        let first = self.coarse.step(rays, skipping(live.as_deref()), &targets, background, &adam);
        self.dead = first.dead;
        let mut report =
            StepReport { loss: first.loss, mse: first.loss, samples: first.points as u64, still: first.dead };
        if let (Some(network), Some(fine)) = (&mut self.fine, fine) {
            let rays = fine.rays(&origins, &directions);
            let second = network.step(rays, Skipping::default(), &targets, background, &adam);
            self.dead |= second.dead;
            report.still = self.dead;
            report.samples += second.points as u64;
            (report.loss, report.mse) = (first.loss + second.loss, second.loss);
        }
        Ok(report)
    }

    fn render(&self, rays: &[Ray]) -> Vec<Pixel> {
        let seen: Vec<Ray> = rays.iter().filter(|ray| self.sees(ray)).copied().collect();
        let mut pixels = seen.chunks(RENDER_CHUNK).flat_map(|chunk| self.render_chunk(chunk));
        let empty = Pixel { depth: self.settings.far as f32, ..Pixel::default() };
        let pixel = |ray| if self.sees(ray) { pixels.next().expect("one a ray") } else { empty };
        rays.iter().map(pixel).collect()
    }

    fn probe(&self, rays: &[(Ray, Vec<f64>)]) -> Vec<Vec<Probe>> {
        let field = self.fine.as_ref().unwrap_or(&self.coarse).to_oracle(&self.settings);
        parallel::map(rays.len(), |r| {
            let (ray, t) = &rays[r];
            t.iter().map(|&t| self.probed(&field, ray, t)).collect()
        })
    }

    fn cells(&self) -> Option<Cells> {
        // Cells of the cube are none of the world's.
        self.grid.as_ref().filter(|_| self.settings.cube.is_none()).map(Grid::to_cells)
    }

    fn arrays(&self) -> Box<dyn Iterator<Item = (String, Array)> + '_> {
        let mut state = self.coarse.state("");
        if let Some(fine) = &self.fine {
            state.extend(fine.state(FINE));
        }
        state.extend(self.grid_state());
        state.insert(TURNED.into(), ndarray::arr0(i64::from(self.turned)).into());
        Box::new(state.into_iter())
    }

    fn restore(&mut self, state: &Arrays, file: &str) -> Result<()> {
        self.coarse.restore(state, "", file)?;
        // The checkpoint of a run's beginning holds parameters as they were drawn: its first step wakes them.
        self.learned = self.coarse.steps() > 0;
        self.turned = state.get(TURNED).is_some_and(|turned| turned.to_f64().iter().any(|&x| x == 1.0));
        self.restore_grid(state, file)?;
        match &mut self.fine {
            Some(fine) => fine.restore(state, FINE, file),
            None => match state.keys().find(|name| name.starts_with(FINE)) {
                Some(name) => {
                    let remedy = "The run has two networks: go on with the `fine` it was trained with.";
                    Err(Error::input(Input {
                        file,
                        field: name,
                        found: "an array of a fine network",
                        expected: "none without `fine`",
                        remedy,
                    }))
                }
                None => Ok(()),
            },
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let NerfSettings { near, far, rays, samples, fine, lr, shape, levels, .. } = self.settings;
        let value = json!({
            "near": near, "far": far, "rays": rays, "samples": samples, "fine": fine, "lr": lr, "lr_half_life": rate::HALF_LIFE,
            "width": shape.width, "depth": shape.depth, "color_width": shape.color, "skip": CS180.skip_layer,
            "levels_position": levels.0, "levels_direction": levels.1, "profile": "cs180",
            "density_head": "at step 1 the sign that gives at least half of the samples a density",
        });
        let mut value = value.as_object().expect("an object literal").clone();
        value.extend(self.skipping_settings());
        value.extend(self.space_settings());
        value["reasons"]["lr_half_life"] = "rates fall by 1 / sqrt(1 + step / 1500)".into();
        value["reasons"]["space"] = self.settings.space_reason.into();
        value
    }

    fn warning(&self) -> Option<String> {
        if self.dead {
            return Some(
                "every density is 0, so no gradient flows and pictures stay empty (a dead density head). Try another `seed`, or a \
                 smaller `lr`."
                    .into(),
            );
        }
        self.turned.then(|| {
            "the density head was drawn with hardly a density above 0; its other sign, as likely a draw, was taken.".into()
        })
    }
}

/// Ray r of flat arrays (R, 3).
pub(crate) fn ray_of(origins: &[f64], directions: &[f64], r: usize) -> Ray {
    let vector = |values: &[f64]| DVec3::new(values[3 * r], values[3 * r + 1], values[3 * r + 2]);
    Ray { o: vector(origins), d: vector(directions) }
}

fn flat(net: &NerfMlp) -> Vec<f32> {
    net.layers().iter().flat_map(|(_, l)| l.w.iter().chain(&l.b)).map(|&x| x as f32).collect()
}

/// The parameters of a checkpoint's state, without what the optimizer and the grid keep.
pub fn parameters(state: &Arrays) -> Arrays {
    let layer = |name: &&String| {
        let name = name.strip_prefix(FINE).unwrap_or(name);
        !name.contains('.') && (name.ends_with("_w") || name.ends_with("_b"))
    };
    state.iter().filter(|(name, _)| layer(name)).map(|(name, array)| (name.clone(), array.clone())).collect()
}

/// An array of a checkpoint, by name and shape.
fn find(state: &Arrays, name: &str, shape: &[usize], file: &str) -> Result<ndarray::ArrayD<f64>> {
    let remedy = "Use the options that the run was trained with, or train it again.";
    let array = state.get(name).ok_or_else(|| {
        Error::input(Input {
            file,
            field: name,
            found: "no such array",
            expected: format!("{shape:?}"),
            remedy,
        })
    })?;
    if array.shape() != shape {
        return Err(Error::input(Input {
            file,
            field: name,
            found: format!("{:?}", array.shape()),
            expected: format!("{shape:?}"),
            remedy,
        }));
    }
    Ok(array.to_f64())
}
