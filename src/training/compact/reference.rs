//! The compact model in plain f64: the oracle's hash grid, harmonics and volume rendering around the trained parameters. The f32
//! path is compared with this; nothing here is fast.

use super::CompactModel;
use super::step::optical_step;
use crate::convention::ProductEps;
use crate::hash_grid;
use crate::math::{Sum, exp};
use crate::ray::Ray;
use crate::ray_aabb::intersect;
use crate::spherical_harmonics::harmonics;
use crate::trunc_exp;
use crate::volume_rendering::volume_render;

/// Rows of a weight matrix, one per input.
type Matrix = Vec<Vec<f64>>;

/// Parameters and grid of a model, in f64.
pub(crate) struct Reference {
    levels: Vec<hash_grid::Level>,
    density0: Matrix,
    density1: Matrix,
    color0: Matrix,
    view: Matrix,
    color1: Matrix,
    low: [f64; 3],
    size: f64,
    near: f64,
    far: f64,
    view_dependent: bool,
    /// Cells along an edge of the occupancy grid, and which of them are occupied.
    resolution: usize,
    occupied: Vec<bool>,
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

fn matrix<const N: usize>(rows: &[[f32; N]]) -> Matrix {
    rows.iter().map(|row| row.map(f64::from).to_vec()).collect()
}

/// x W, terms in order.
fn layer(x: &[f64], w: &Matrix) -> Vec<f64> {
    let mut y = vec![0.0; w[0].len()];
    for i in 0..x.len() {
        for o in 0..y.len() {
            y[o] += x[i] * w[i][o];
        }
    }
    y
}

fn relu(x: Vec<f64>) -> Vec<f64> {
    x.into_iter().map(|x| if x > 0.0 { x } else { 0.0 }).collect()
}

impl Reference {
    /// The model's current parameters.
    pub fn new(model: &CompactModel) -> Self {
        let (settings, w) = (&model.settings, &model.nets.weights);
        let active = settings.levels_at(model.step);
        let level = |l: &hash_grid::fast::Level| {
            // Tables are padded to whole cache lines.
            let side = l.resolution() as usize + 1;
            let entries = if l.dense() { side * side * side } else { l.table().len() };
            let table = l.table()[..entries].iter().map(|e| e.map(f64::from).to_vec()).collect();
            hash_grid::Level { resolution: l.resolution(), table }
        };
        let r = model.occupancy.resolution;
        Reference {
            levels: model.levels[..active].iter().map(level).collect(),
            density0: matrix(&w.density0),
            density1: matrix(&w.density1),
            color0: matrix(&w.color0),
            view: matrix(&w.view),
            color1: matrix(&w.color1),
            low: settings.low.to_array(),
            size: settings.size,
            near: settings.near,
            far: settings.far,
            view_dependent: settings.view_dependent,
            resolution: r,
            occupied: (0..r * r * r).map(|cell| model.occupancy.occupied(cell)).collect(),
        }
    }

    /// Density in the unit of [`optical_step`], and color, at a point of the unit box.
    fn field(&self, p: [f64; 3], view: &[f64]) -> (f64, [f64; 3]) {
        // Levels that aren't in use yet are columns of zeros: their rows of the weights are never reached.
        let encoding = hash_grid::encode(&self.levels, p);
        let geometry = layer(&relu(layer(&encoding, &self.density0)), &self.density1);
        let mut hidden = layer(&geometry, &self.color0);
        for h in 0..hidden.len() {
            hidden[h] += view[h];
        }
        let raw = layer(&relu(hidden), &self.color1);
        let limit = trunc_exp::LIMIT;
        let sigma = trunc_exp::trunc_exp(geometry[0].clamp(-limit, limit));
        (sigma, [0, 1, 2].map(|k| 1.0 / (1.0 + exp(-raw[k]))))
    }

    /// The samples of a ray at rest, `samples` step lengths across the box: positions in the unit box, in occupied cells alone.
    fn march(&self, ray: &Ray, samples: f64) -> Vec<[f64; 3]> {
        let o = [0, 1, 2].map(|a| (ray.o[a] - self.low[a]) / self.size);
        let d = [0, 1, 2].map(|a| ray.d[a] / self.size);
        let Some(hit) = intersect(o, d, [0.0; 3], [1.0; 3]) else { return vec![] };
        let (near, far) = (hit.enter.max(self.near), hit.leave.min(self.far));
        let length = self.size / samples;
        let mut points = vec![];
        let mut k = (near / length - 0.5).ceil();
        while (k + 0.5) * length < far {
            let p = [0, 1, 2].map(|a| (o[a] + (k + 0.5) * length * d[a]).clamp(0.0, 1.0));
            let r = self.resolution;
            let [x, y, z] = p.map(|x| ((x * r as f64) as usize).min(r - 1));
            if self.occupied[x + r * (y + r * z)] {
                points.push(p);
            }
            k += 1.0;
        }
        points
    }

    /// What a ray sees with `samples` step lengths across the box, all of its samples; `stop` is used to count alone.
    pub fn render(&self, ray: &Ray, samples: f64, stop: f64) -> ReferenceRay {
        let unit = ray.d.normalize().to_array();
        let mut view = vec![0.0; self.view[0].len()];
        if self.view_dependent {
            view = layer(&harmonics(unit, 3), &self.view);
        }
        let (mut sigmas, mut rgbs) = (vec![], vec![]);
        for p in self.march(ray, samples) {
            let (sigma, rgb) = self.field(p, &view);
            sigmas.push(sigma);
            rgbs.push(rgb);
        }
        // In f64: the f32 step length's rounding is the f32 path's own.
        let delta = f64::from(optical_step(1.0)) / samples;
        let (mut depth, mut live) = (Sum::default(), 0);
        while live < sigmas.len() && exp(-depth.value()) >= stop {
            depth.add(sigmas[live] * delta);
            live += 1;
        }
        let seen = volume_render(&sigmas, &rgbs, &vec![delta; sigmas.len()], ProductEps::None);
        ReferenceRay { color: seen.color, opacity: seen.opacity, samples: sigmas.len(), live }
    }
}
