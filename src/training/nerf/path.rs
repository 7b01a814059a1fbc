//! One network of the NeRF model with its optimizer's state: on the f32 path, or in the f64 reference.

use super::{NerfSettings, find, flat, ray_of};
use crate::convention::{CS180, Depth, EmptyDepth};
use crate::early_stop::live_samples;
use crate::encoding::Encoding;
use crate::error::Result;
use crate::field::fast::{Batch, Gradient, Network, Rays, Skipping};
use crate::field::{Layer, NerfMlp};
use crate::files::npz::{Array, Arrays};
use crate::optimizer::{self, Adam};
use crate::parallel;
use crate::random::Key;
use crate::training::reference::{Field, Target, adam_layer};
use crate::volume_rendering;

/// Parameters and their running means, on either path.
#[allow(clippy::large_enum_variant, reason = "one or two a model")]
pub(crate) enum Path {
    Fast { net: Box<Network>, moments: optimizer::fast::Moments, gradient: Gradient },
    Reference { field: Box<Field>, m: NerfMlp, v: NerfMlp, steps: u64 },
}

/// The result of one optimizer step.
pub(crate) struct Stepped {
    /// Mean squared error before it.
    pub loss: f64,
    /// Whether it moved nothing.
    pub dead: bool,
    /// Samples that were evaluated.
    pub points: usize,
}

impl Path {
    /// Initial parameters.
    pub(crate) fn new(settings: &NerfSettings, key: &Key) -> Self {
        let net = NerfMlp::initial(&settings.shape, &CS180, key);
        if settings.reference {
            let mut zero = net.clone();
            zero.layers_mut().into_iter().for_each(|l| *l = Layer::zeros(l.w.ncols(), l.w.nrows()));
            let (position, direction) =
                (Encoding::new(settings.levels.0, &CS180), Encoding::new(settings.levels.1, &CS180));
            let field = Box::new(Field { net, position, direction, cube: settings.cube, conventions: CS180 });
            Path::Reference { field, m: zero.clone(), v: zero, steps: 0 }
        } else {
            let net = Box::new(Network::new(&net, &settings.shape, &CS180));
            let moments = optimizer::fast::Moments::new(net.params.len());
            Path::Fast { net, moments, gradient: Gradient::default() }
        }
    }

    /// The field in plain f64.
    pub(crate) fn to_oracle(&self, settings: &NerfSettings) -> Field {
        match self {
            Path::Reference { field, .. } => (**field).clone(),
            Path::Fast { net, .. } => Field {
                net: net.to_oracle(&net.params),
                position: Encoding::new(settings.levels.0, &CS180),
                direction: Encoding::new(settings.levels.1, &CS180),
                cube: settings.cube,
                conventions: CS180,
            },
        }
    }

    /// The density head with the other sign: as likely a draw as the one it has.
    pub(crate) fn turn_density_head(&mut self) {
        let turn = |net: &mut NerfMlp| {
            net.sigma.w.mapv_inplace(|w| -w);
            net.sigma.b.mapv_inplace(|b| -b);
        };
        match self {
            Path::Reference { field, .. } => turn(&mut field.net),
            Path::Fast { net, .. } => {
                let mut oracle = net.to_oracle(&net.params);
                turn(&mut oracle);
                net.params = flat(&oracle);
            }
        }
    }

    /// One step of Adam on a batch.
    pub(crate) fn step(
        &mut self,
        rays: Rays,
        skipping: Skipping,
        targets: &[f32],
        background: [f64; 3],
        adam: &Adam,
    ) -> Stepped {
        match self {
            Path::Fast { net, moments, gradient } => {
                let batch = Batch { rays, targets, background: background.map(|b| b as f32) };
                let loss = net.step_skipping(&batch, skipping, gradient);
                moments.update(net.arch, adam, &mut net.params, &gradient.values);
                Stepped { loss, dead: gradient.backward_points == 0, points: gradient.forward_points }
            }
            Path::Reference { field, m, v, steps } => {
                let (loss, gradient) = reference_gradient(field, rays, skipping, targets, background);
                *steps += 1;
                update(&mut field.net, m, v, &gradient, adam, *steps);
                let dead = gradient.layers().iter().all(|(_, l)| l.w.iter().all(|&g| g == 0.0));
                Stepped { loss, dead, points: skipping.points(rays.t.len()) }
            }
        }
    }

    /// Weights of all samples (R, N).
    pub(crate) fn weights(&self, rays: Rays) -> Vec<f64> {
        match self {
            Path::Fast { net, .. } => net.weights(&rays).into_iter().map(f64::from).collect(),
            Path::Reference { field, .. } => {
                let one = |r: usize| {
                    let (t, deltas) = samples_of(rays, r);
                    field.render(&ray_of(rays.origins, rays.directions, r), t, deltas).0.weights
                };
                parallel::map(rays.len(), one).concat()
            }
        }
    }

    /// Densities of points (M, 3), in the field's own coordinates.
    pub(crate) fn densities(&self, points: &[f64]) -> Vec<f32> {
        match self {
            Path::Fast { net, .. } => net.densities(points),
            Path::Reference { field, .. } => parallel::map(points.len() / 3, |n| {
                // The density doesn't depend on the direction.
                let x = [points[3 * n], points[3 * n + 1], points[3 * n + 2]];
                field.seen(x, [0.0, 0.0, 1.0]).sigma as f32
            }),
        }
    }

    /// Color without background, opacity and sum w t of each ray.
    pub(crate) fn render(&self, rays: Rays, skipping: Skipping) -> Vec<([f32; 3], f32, f32)> {
        match self {
            Path::Reference { field, .. } => parallel::map(rays.len(), |r| {
                let (t, deltas) = followed(field, rays, skipping, r);
                let (rendering, _) = field.render(&ray_of(rays.origins, rays.directions, r), &t, &deltas);
                let weighted =
                    volume_rendering::depth(&rendering.weights, &t, 0.0, Depth::Plain, EmptyDepth::Far);
                (rendering.color.map(|c| c as f32), rendering.opacity as f32, weighted as f32)
            }),
            Path::Fast { net, .. } => {
                let seen = net.render_skipping(&rays, skipping, [0.0; 3]);
                let one = |r: usize| {
                    let rgb = [seen.colors[3 * r], seen.colors[3 * r + 1], seen.colors[3 * r + 2]];
                    (rgb, seen.opacity[r], seen.depth[r])
                };
                (0..seen.opacity.len()).map(one).collect()
            }
        }
    }

    /// Parameters, m and v as networks, each with the prefix of its names.
    fn parts(&self) -> [(&'static str, NerfMlp); 3] {
        match self {
            Path::Fast { net, moments, .. } => [
                ("", net.to_oracle(&net.params)),
                ("m.", net.to_oracle(&moments.m)),
                ("v.", net.to_oracle(&moments.v)),
            ],
            Path::Reference { field, m, v, .. } => {
                [("", field.net.clone()), ("m.", m.clone()), ("v.", v.clone())]
            }
        }
    }

    /// All of it by name, each name after `owner`.
    pub(crate) fn state(&self, owner: &str) -> Arrays {
        let mut state = Arrays::new();
        for (prefix, net) in self.parts() {
            for (name, layer) in net.layers() {
                let (w, b) = (layer.w.clone().into_dyn(), layer.b.clone().into_dyn());
                let (w, b) = match self {
                    Path::Reference { .. } => (Array::F64(w), Array::F64(b)),
                    Path::Fast { .. } => (Array::F32(w.mapv(|x| x as f32)), Array::F32(b.mapv(|x| x as f32))),
                };
                state.insert(format!("{owner}{prefix}{name}_w"), w);
                state.insert(format!("{owner}{prefix}{name}_b"), b);
            }
        }
        let steps = ndarray::Array1::from_elem(1, self.steps() as i64).into_dyn();
        state.insert(format!("{owner}adam_step"), Array::I64(steps));
        state
    }

    /// Steps of its optimizer so far.
    pub(crate) fn steps(&self) -> u64 {
        match self {
            Path::Fast { moments, .. } => moments.step,
            Path::Reference { steps, .. } => *steps,
        }
    }

    /// Loads what [`Self::state`] returned.
    pub(crate) fn restore(&mut self, state: &Arrays, owner: &str, file: &str) -> Result<()> {
        let mut parts = self.parts();
        for (prefix, net) in &mut parts {
            let names: Vec<String> = net.layers().into_iter().map(|(name, _)| name).collect();
            for (name, layer) in names.iter().zip(net.layers_mut()) {
                let w = find(state, &format!("{owner}{prefix}{name}_w"), layer.w.shape(), file)?;
                let b = find(state, &format!("{owner}{prefix}{name}_b"), layer.b.shape(), file)?;
                layer.w = w.into_dimensionality().expect("the shape was checked");
                layer.b = b.into_dimensionality().expect("the shape was checked");
            }
        }
        let step = find(state, &format!("{owner}adam_step"), &[1], file)?[[0]] as u64;
        let [(_, params), (_, means), (_, squares)] = parts;
        match self {
            Path::Fast { net, moments, .. } => {
                net.params = flat(&params);
                *moments = optimizer::fast::Moments { step, m: flat(&means), v: flat(&squares) };
            }
            Path::Reference { field, m, v, steps } => {
                (field.net, *m, *v, *steps) = (params, means, squares, step);
            }
        }
        Ok(())
    }
}

/// t and deltas of ray r.
fn samples_of<'a>(rays: Rays<'a>, r: usize) -> (&'a [f64], &'a [f64]) {
    let range = r * rays.samples..(r + 1) * rays.samples;
    (&rays.t[range.clone()], &rays.deltas[range])
}

/// t and deltas of the samples of ray r that aren't left out: their step lengths stay what they are.
fn followed(field: &Field, rays: Rays, skipping: Skipping, r: usize) -> (Vec<f64>, Vec<f64>) {
    let samples = r * rays.samples..(r + 1) * rays.samples;
    let live = samples.filter(|&n| skipping.live.is_none_or(|live| live[n]));
    let (mut t, mut deltas): (Vec<f64>, Vec<f64>) = live.map(|n| (rays.t[n], rays.deltas[n])).unzip();
    if skipping.stop > 0.0 {
        let ray = ray_of(rays.origins, rays.directions, r);
        let sigmas: Vec<f64> = t.iter().map(|&t| field.at(&ray, t).sigma).collect();
        let end = live_samples(&sigmas, &deltas, f64::from(skipping.stop));
        t.truncate(end);
        deltas.truncate(end);
    }
    (t, deltas)
}

/// Loss and gradient of a step in f64: rays in fixed chunks on all threads, folded in order.
fn reference_gradient(
    field: &Field,
    rays: Rays,
    skipping: Skipping,
    targets: &[f32],
    background: [f64; 3],
) -> (f64, NerfMlp) {
    const CHUNK: usize = 16;
    let count = rays.len();
    let target = |r: usize| {
        let (t, deltas) = followed(field, rays, skipping, r);
        let rgb = std::array::from_fn(|k| f64::from(targets[3 * r + k]));
        Target { ray: ray_of(rays.origins, rays.directions, r), t, deltas, rgb }
    };
    let parts = parallel::map(count.div_ceil(CHUNK), |n| {
        let batch: Vec<Target> = (n * CHUNK..count.min((n + 1) * CHUNK)).map(target).collect();
        let (loss, gradient) = field.loss_and_gradient(&batch, background);
        (batch.len() as f64 / count as f64, loss, gradient)
    });
    let mut parts = parts.into_iter();
    let (share, loss, mut sum) = parts.next().expect("at least one ray");
    let mut total = share * loss;
    sum.layers_mut().into_iter().for_each(|l| add(l, None, share));
    for (share, loss, part) in parts {
        total += share * loss;
        for (to, (_, from)) in sum.layers_mut().into_iter().zip(part.layers()) {
            add(to, Some(from), share);
        }
    }
    (total, sum)
}

/// to += share from; without `from`, to *= share.
fn add(to: &mut Layer, from: Option<&Layer>, share: f64) {
    match from {
        None => {
            to.w.mapv_inplace(|g| share * g);
            to.b.mapv_inplace(|g| share * g);
        }
        Some(from) => {
            to.w.zip_mut_with(&from.w, |to, g| *to += share * g);
            to.b.zip_mut_with(&from.b, |to, g| *to += share * g);
        }
    }
}

/// One Adam step for every parameter, in f64.
fn update(net: &mut NerfMlp, m: &mut NerfMlp, v: &mut NerfMlp, gradient: &NerfMlp, adam: &Adam, step: u64) {
    let layers = net.layers_mut().into_iter().zip(m.layers_mut()).zip(v.layers_mut()).zip(gradient.layers());
    for (((p, m), v), (_, g)) in layers {
        adam_layer(adam, step, p, m, v, g);
    }
}
