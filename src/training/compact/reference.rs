//! The compact model in plain f64, put together from the oracle's parts: hash grid, layers, harmonics, occupancy grid, early stop and
//! volume rendering around the trained parameters. What the f32 path is measured against; nothing here is fast.

use ndarray::{Array1, Array2};

use super::CompactModel;
use super::networks::{GEOMETRY, HIDDEN};
use super::settings::EXPONENT;
use super::space::{OPTICAL_SIZE, Space, optical_step};
use crate::contraction::contract;
use crate::convention::{
    ContractionNorm, ContractionRange, ExponentShift, HarmonicForm, HarmonicSign, ProductEps,
};
use crate::early_stop::live_samples;
use crate::field::mlp::Output;
use crate::field::{Layer, Mlp};
use crate::hash_grid;
use crate::occupancy_grid::OccupancyGrid;
use crate::ray::Ray;
use crate::ray_aabb::intersect;
use crate::spherical_harmonics::harmonics;
use crate::training::probe::Probe;
use crate::trunc_exp;
use crate::volume_rendering::volume_render;

/// Parameters and grid of a model, in f64.
pub(crate) struct Reference {
    levels: Vec<hash_grid::Level>,
    /// From the encoding to 16 numbers, of which the first says the density.
    density: Mlp,
    /// From these and the harmonics to the color.
    color: Mlp,
    /// Density 1 in occupied cells.
    occupied: OccupancyGrid,
    space: Space,
    low: [f64; 3],
    size: f64,
    near: f64,
    far: f64,
    view_dependent: bool,
}

/// What a ray sees, and how many samples of it count.
pub(crate) struct ReferenceRay {
    /// Premultiplied color.
    pub color: [f64; 3],
    /// A.
    pub opacity: f64,
    /// Samples in occupied cells.
    pub samples: usize,
    /// Those before T falls below the early stop's eps.
    pub live: usize,
}

/// A layer without biases from the rows of its inputs; the first `outputs` columns are used.
fn layer<'a, const N: usize>(rows: impl Iterator<Item = &'a [f32; N]>, outputs: usize) -> Layer {
    let rows: Vec<&[f32; N]> = rows.collect();
    let w = Array2::from_shape_fn((outputs, rows.len()), |(o, i)| f64::from(rows[i][o]));
    Layer { w, b: Array1::zeros(outputs) }
}

/// By how much the density of a point is less than what the network says: outside of the inner cube, by the square of its largest coordinate.
fn thinner(v: [f64; 3]) -> f64 {
    v.into_iter().fold(1.0, |most: f64, v| most.max(v * v))
}

impl Reference {
    /// The parameters that the model's pictures are made of.
    pub(crate) fn new(model: &CompactModel) -> Self {
        let (settings, w) = (&model.settings, model.weights_at_rest());
        let active = settings.levels_at(model.step);
        let level = |l: &hash_grid::fast::Level| {
            // Tables are padded to whole cache lines.
            let side = l.resolution() as usize + 1;
            let table = model.table_at_rest(l);
            let entries = if l.dense() { side * side * side } else { table.len() };
            let table: Vec<_> = table[..entries].iter().map(|e| e.map(f64::from)).collect();
            hash_grid::Level::new(l.resolution(), table.into())
        };
        // Levels that aren't in use yet say 0: the density network doesn't read them.
        let read = w.density0.iter().take(active * hash_grid::fast::FEATURES);
        let density = vec![layer(read, HIDDEN), layer(w.density1.iter(), GEOMETRY)];
        let color = vec![layer(w.color0.iter().chain(w.view.iter()), HIDDEN), layer(w.color1.iter(), 3)];
        let resolution = model.occupancy.resolution;
        let cell = |cell| f64::from(u8::from(model.occupancy.occupied(cell)));
        Reference {
            levels: model.levels[..active].iter().map(level).collect(),
            density: Mlp { layers: density, output: Output::Linear },
            color: Mlp { layers: color, output: Output::Sigmoid },
            occupied: OccupancyGrid {
                resolution,
                density: (0..resolution.pow(3)).map(cell).collect(),
                threshold: 0.5,
            },
            space: settings.space,
            low: settings.low.to_array(),
            size: settings.size,
            near: settings.near,
            far: settings.far,
            view_dependent: settings.view_dependent,
        }
    }

    /// Density in the unit of [`optical_step`], and color, at a point of the unit box.
    fn field(&self, p: [f64; 3], view: &[f64]) -> (f64, [f64; 3]) {
        let geometry = self.density.forward(&hash_grid::encode(&self.levels, p)).y;
        let color = self.color.forward(&[&geometry, view].concat()).y;
        (trunc_exp::density(geometry[0], EXPONENT, ExponentShift::None), [color[0], color[1], color[2]])
    }

    /// The samples of a ray at rest, `samples` step lengths across the box: positions in the unit box, in occupied cells alone, and
    /// their deltas in the unit of [`optical_step`].
    fn march(&self, ray: &Ray, samples: f64) -> (Vec<[f64; 3]>, Vec<f64>) {
        // In f64: the f32 step length's rounding is the f32 path's own.
        let delta = f64::from(optical_step(1.0)) / samples;
        match self.space {
            Space::Box => {
                let points = self.straight(ray, samples);
                let deltas = vec![delta; points.len()];
                (points, deltas)
            }
            Space::Contracted { even } => self.contracted(ray, self.size / samples, even, delta),
        }
    }

    /// In contracted space: the middles of steps that are even as far as `even`, and even in 1 / distance from there on.
    fn contracted(&self, ray: &Ray, step: f64, even: f64, delta: f64) -> (Vec<[f64; 3]>, Vec<f64>) {
        let (mut points, mut deltas) = (vec![], vec![]);
        let distance = |x: f64| if x <= even { x } else { even / (2.0 - x / even) };
        let last = if self.far <= even { self.far } else { even * (2.0 - even / self.far) };
        let middles = (0..).map(|k| (f64::from(k) + 0.5) * step).take_while(|x| *x < last);
        for t in middles.map(distance).skip_while(|t| *t < self.near) {
            let v = self.middled(ray, t);
            let p = contract(v, ContractionNorm::Linf, ContractionRange::Unit);
            if self.occupied.occupied(p) {
                points.push(p);
                deltas.push(delta * (t / even).max(1.0).powi(2) / thinner(v));
            }
        }
        (points, deltas)
    }

    /// A ray's point in units in which the inner cube is [-1, 1]^3.
    fn middled(&self, ray: &Ray, t: f64) -> [f64; 3] {
        let x = ray.at(t);
        [0, 1, 2].map(|a| 2.0 * (x[a] - self.low[a]) / self.size - 1.0)
    }

    fn straight(&self, ray: &Ray, samples: f64) -> Vec<[f64; 3]> {
        let o = [0, 1, 2].map(|a| (ray.o[a] - self.low[a]) / self.size);
        let d = [0, 1, 2].map(|a| ray.d[a] / self.size);
        let Some(hit) = intersect(o, d, [0.0; 3], [1.0; 3]) else { return vec![] };
        let (near, far) = (hit.enter.max(self.near), hit.leave.min(self.far));
        let t = self.occupied.samples(o, d, near, far, self.size / samples, 0.5);
        t.into_iter().map(|t| [0, 1, 2].map(|a| (o[a] + t * d[a]).clamp(0.0, 1.0))).collect()
    }

    /// Density in 1 / length of the scene, and color, along a ray; nothing in empty cells and outside of the box.
    pub(crate) fn probe(&self, ray: &Ray, t: &[f64]) -> Vec<Probe> {
        let view = self.view(ray);
        let at = |&t: &f64| {
            let v = self.middled(ray, t);
            let (p, thinner) = match self.space {
                Space::Box => (v.map(|v| 0.5 * v + 0.5), 1.0),
                Space::Contracted { .. } => {
                    (contract(v, ContractionNorm::Linf, ContractionRange::Unit), thinner(v))
                }
            };
            let inside = p.iter().all(|x| (0.0..=1.0).contains(x));
            if !inside || !self.occupied.occupied(p) {
                return Probe::default();
            }
            let (sigma, rgb) = self.field(p, &view);
            Probe { density: sigma * OPTICAL_SIZE / (self.size * thinner), rgb }
        };
        t.iter().map(at).collect()
    }

    /// The direction as the color network sees it.
    fn view(&self, ray: &Ray) -> Vec<f64> {
        let mut view =
            harmonics(ray.d.normalize().to_array(), 3, HarmonicForm::Sphere, HarmonicSign::Alternating);
        if !self.view_dependent {
            view.fill(0.0);
        }
        view
    }

    /// What a ray sees with `samples` step lengths across the box, all of its samples; `stop` is used to count alone.
    pub(crate) fn render(&self, ray: &Ray, samples: f64, stop: f64) -> ReferenceRay {
        let view = self.view(ray);
        let (mut sigmas, mut rgbs) = (vec![], vec![]);
        let (points, deltas) = self.march(ray, samples);
        for p in points {
            let (sigma, rgb) = self.field(p, &view);
            sigmas.push(sigma);
            rgbs.push(rgb);
        }
        let seen = volume_render(&sigmas, &rgbs, &deltas, ProductEps::None);
        let live = live_samples(&sigmas, &deltas, stop);
        ReferenceRay { color: seen.color, opacity: seen.opacity, samples: sigmas.len(), live }
    }
}
