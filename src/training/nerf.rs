//! The NeRF paper's network as a trainable model, on the f32 path or in the f64 reference.

use ndarray::Array1;
use serde_json::{Map, Value, json};

use super::model::{Model, Pixel, StepReport};
use super::reference::{Field, Target};
use crate::convention::CS180;
use crate::encoding::Encoding;
use crate::error::{Error, Result};
use crate::field::fast::{Batch, Gradient, Network, Rays};
use crate::field::nerf_mlp::Shape;
use crate::field::{Layer, NerfMlp};
use crate::files::npz::{Array, Arrays};
use crate::optimiser::{self, Adam, adam_step};
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::ray::{Ray, camera_ray, pixel_position};
use crate::sample::{rest_u, sample_along_ray};
use crate::scene::Scene;
use crate::verify::bench::system::System;
use crate::volume_rendering;

mod variants;

/// Rays that are rendered together: bounds the memory of a picture.
const RENDER_CHUNK: usize = 1024;

/// What a [`NerfModel`] depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Where samples start.
    pub near: f64,
    /// Where they end.
    pub far: f64,
    /// The colour behind everything.
    pub background: [f64; 3],
    /// Rays a step.
    pub rays: usize,
    /// Samples a ray.
    pub samples: usize,
    /// Learning rate of Adam.
    pub lr: f64,
    /// Seed of parameters, rays and jitter.
    pub seed: u64,
    /// Sizes of the network.
    pub shape: Shape,
    /// L of positions and of directions.
    pub levels: (usize, usize),
    /// The f64 reference instead of the f32 path.
    pub reference: bool,
}

impl Settings {
    /// The paper's network, 1,024 rays of 64 samples, learning rate 5e-4.
    pub fn new(near: f64, far: f64, background: [f64; 3]) -> Self {
        #[rustfmt::skip]
        let settings = Settings {
            near, far, background, rays: 1024, samples: 64, lr: 5e-4, seed: 0, shape: Shape::PAPER, levels: (10, 4), reference: false,
        };
        settings
    }

    /// Another trunk width; the colour layer has half of it, as in the paper.
    pub fn set_width(&mut self, width: usize) {
        (self.shape.width, self.shape.color) = (width, (width / 2).max(1));
    }
}

/// Parameters, their running means, and the path that computes.
pub struct NerfModel {
    settings: Settings,
    path: Path,
    /// Whether the last step moved nothing: every density was 0 (TR1).
    dead: bool,
}

#[allow(clippy::large_enum_variant, reason = "one a model")]
enum Path {
    Fast { net: Box<Network>, moments: optimiser::fast::Moments, gradient: Gradient },
    Reference { field: Box<Field>, m: NerfMlp, v: NerfMlp, steps: u64 },
}

/// One step's rays as flat arrays.
struct Drawn {
    origins: Vec<f64>,
    directions: Vec<f64>,
    t: Vec<f64>,
    targets: Vec<f32>,
}

impl NerfModel {
    /// Initial parameters from the seed.
    pub fn new(settings: Settings) -> Self {
        let net = NerfMlp::initial(&settings.shape, &Key::new(settings.seed, Purpose::Parameters));
        let path = if settings.reference {
            let mut zero = net.clone();
            zero.layers_mut().into_iter().for_each(|l| *l = Layer::zeros(l.w.ncols(), l.w.nrows()));
            let (position, direction) =
                (Encoding::new(settings.levels.0, &CS180), Encoding::new(settings.levels.1, &CS180));
            let field = Box::new(Field { net, position, direction, conventions: CS180 });
            Path::Reference { field, m: zero.clone(), v: zero, steps: 0 }
        } else {
            let net = Box::new(Network::new(&net, &settings.shape, CS180.density));
            let moments = optimiser::fast::Moments::new(net.params.len());
            Path::Fast { net, moments, gradient: Gradient::default() }
        };
        NerfModel { settings, path, dead: false }
    }

    fn adam(&self) -> Adam {
        Adam { lr: self.settings.lr, ..Adam::default() }
    }

    /// The rays of a step: pixels from one stream, jitter from another, each ray its own counter.
    fn draw(&self, scene: &Scene, step: u64) -> Result<Drawn> {
        let Settings { near, far, rays, samples, seed, .. } = self.settings;
        let (pixels, jitter) = (Key::new(seed, Purpose::Rays), Key::new(seed, Purpose::Samples));
        let mut drawn = Drawn { origins: vec![], directions: vec![], t: vec![], targets: vec![] };
        for r in 0..rays as u64 {
            let index = |range: usize, n| pixels.below(range as u64, step, r, n) as usize;
            let frame = &scene.train[index(scene.train.len(), 0)];
            let (j, i) = (index(frame.camera.height, 1), index(frame.camera.width, 2));
            let ray = camera_ray(&frame.camera, pixel_position(i, j, CS180.pixel_centre))?;
            let image = frame.image.as_ref().expect("training frames have pictures");
            drawn.origins.extend(ray.o.to_array());
            drawn.directions.extend(ray.d.to_array());
            drawn.t.extend(sample_along_ray(near, far, &jitter.uniforms(step, r, samples), CS180.grid));
            drawn.targets.extend((0..3).map(|k| image[[j, i, k]]));
        }
        Ok(drawn)
    }

    /// D = (far - near) / N.
    fn width(&self) -> f64 {
        (self.settings.far - self.settings.near) / self.settings.samples as f64
    }

    fn render_chunk(&self, rays: &[Ray]) -> Vec<Pixel> {
        let Settings { near, far, samples, .. } = self.settings;
        let t = sample_along_ray(near, far, &vec![rest_u(CS180.rest); samples], CS180.grid);
        let deltas = vec![self.width(); samples];
        let pixel = |rgb: [f32; 3], opacity: f32, weighted: f32| {
            let depth = if opacity > 0.0 { weighted / opacity } else { far as f32 };
            Pixel { rgb, opacity, depth }
        };
        match &self.path {
            Path::Reference { field, .. } => parallel::map(rays.len(), |r| {
                let (rendering, _) = field.render(&rays[r], &t, &deltas);
                let weighted =
                    volume_rendering::depth(&rendering.weights, &t, far, crate::convention::Depth::Plain);
                pixel(rendering.color.map(|c| c as f32), rendering.opacity as f32, weighted as f32)
            }),
            Path::Fast { net, .. } => {
                let origins: Vec<f64> = rays.iter().flat_map(|r| r.o.to_array()).collect();
                let directions: Vec<f64> = rays.iter().flat_map(|r| r.d.to_array()).collect();
                let (t, deltas) = (t.repeat(rays.len()), deltas.repeat(rays.len()));
                let rays =
                    Rays { origins: &origins, directions: &directions, t: &t, deltas: &deltas, samples };
                let seen = net.render(&rays, [0.0; 3]);
                let one = |r: usize| {
                    let rgb = [seen.colors[3 * r], seen.colors[3 * r + 1], seen.colors[3 * r + 2]];
                    pixel(rgb, seen.opacity[r], seen.depth[r])
                };
                (0..seen.opacity.len()).map(one).collect()
            }
        }
    }

    /// Parameters, m and v as networks, each with the prefix of its names.
    fn parts(&self) -> [(&'static str, NerfMlp); 3] {
        match &self.path {
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
}

impl Model for NerfModel {
    fn system(&mut self) -> Option<Box<dyn System + '_>> {
        Some(Box::new(self.trained()))
    }

    fn step(&mut self, scene: &Scene, step: u64) -> Result<StepReport> {
        let drawn = self.draw(scene, step)?;
        let Settings { rays, samples, background, .. } = self.settings;
        let (deltas, adam) = (vec![self.width(); drawn.t.len()], self.adam());
        let loss = match &mut self.path {
            Path::Fast { net, moments, gradient } => {
                let rays = Rays {
                    origins: &drawn.origins,
                    directions: &drawn.directions,
                    t: &drawn.t,
                    deltas: &deltas,
                    samples,
                };
                let batch = Batch { rays, targets: &drawn.targets, background: background.map(|b| b as f32) };
                let loss = net.step(&batch, false, gradient);
                self.dead = gradient.backward_points == 0;
                moments.update(net.arch, &adam, &mut net.params, &gradient.values);
                loss
            }
            Path::Reference { field, m, v, steps } => {
                let (loss, gradient) = reference_gradient(field, &drawn, &deltas, samples, background);
                *steps += 1;
                self.dead = gradient.layers().iter().all(|(_, l)| l.w.iter().all(|&g| g == 0.0));
                update(&mut field.net, m, v, &gradient, &adam, *steps);
                loss
            }
        };
        Ok(StepReport { loss, samples: (rays * samples) as u64 })
    }

    fn render(&self, rays: &[Ray]) -> Vec<Pixel> {
        rays.chunks(RENDER_CHUNK).flat_map(|chunk| self.render_chunk(chunk)).collect()
    }

    fn state(&self) -> Arrays {
        let mut state = Arrays::new();
        for (prefix, net) in self.parts() {
            for (name, layer) in net.layers() {
                let (w, b) = (layer.w.clone().into_dyn(), layer.b.clone().into_dyn());
                let (w, b) = if self.settings.reference {
                    (Array::F64(w), Array::F64(b))
                } else {
                    (Array::F32(w.mapv(|x| x as f32)), Array::F32(b.mapv(|x| x as f32)))
                };
                state.insert(format!("{prefix}{name}_w"), w);
                state.insert(format!("{prefix}{name}_b"), b);
            }
        }
        let steps = match &self.path {
            Path::Fast { moments, .. } => moments.step,
            Path::Reference { steps, .. } => *steps,
        };
        state.insert("adam_step".into(), Array::I64(Array1::from_elem(1, steps as i64).into_dyn()));
        state
    }

    fn restore(&mut self, state: &Arrays, file: &str) -> Result<()> {
        let mut parts = self.parts();
        for (prefix, net) in &mut parts {
            let names: Vec<String> = net.layers().into_iter().map(|(name, _)| name).collect();
            for (name, layer) in names.iter().zip(net.layers_mut()) {
                let w = find(state, &format!("{prefix}{name}_w"), layer.w.shape(), file)?;
                let b = find(state, &format!("{prefix}{name}_b"), layer.b.shape(), file)?;
                layer.w = w.into_dimensionality().expect("the shape was checked");
                layer.b = b.into_dimensionality().expect("the shape was checked");
            }
        }
        let step = find(state, "adam_step", &[1], file)?[[0]] as u64;
        let [(_, params), (_, means), (_, squares)] = parts;
        match &mut self.path {
            Path::Fast { net, moments, .. } => {
                net.params = flat(&params);
                *moments = optimiser::fast::Moments { step, m: flat(&means), v: flat(&squares) };
            }
            Path::Reference { field, m, v, steps } => {
                (field.net, *m, *v, *steps) = (params, means, squares, step);
            }
        }
        Ok(())
    }

    fn settings(&self) -> Map<String, Value> {
        let Settings { near, far, rays, samples, lr, shape, levels, .. } = self.settings;
        let value = json!({
            "near": near, "far": far, "rays": rays, "samples": samples, "lr": lr,
            "width": shape.width, "depth": shape.depth, "color_width": shape.color, "skip": shape.skip,
            "levels_position": levels.0, "levels_direction": levels.1, "profile": "cs180",
        });
        value.as_object().expect("an object literal").clone()
    }

    fn warning(&self) -> Option<String> {
        self.dead.then(|| {
            "every density is 0, so no gradient flows and pictures stay empty (a dead density head). Try another --seed.".into()
        })
    }
}

fn flat(net: &NerfMlp) -> Vec<f32> {
    net.layers().iter().flat_map(|(_, l)| l.w.iter().chain(&l.b)).map(|&x| x as f32).collect()
}

/// An array of a checkpoint, by name and shape.
fn find(state: &Arrays, name: &str, shape: &[usize], file: &str) -> Result<ndarray::ArrayD<f64>> {
    let advice = "Use the options that the run was trained with, or train it again.";
    let array = state
        .get(name)
        .ok_or_else(|| Error::input(file, name, "no such array", format!("{shape:?}"), advice))?;
    if array.shape() != shape {
        return Err(Error::input(file, name, format!("{:?}", array.shape()), format!("{shape:?}"), advice));
    }
    Ok(array.to_f64())
}

/// Loss and gradient of a step in f64: rays in fixed chunks on all threads, folded in order.
fn reference_gradient(
    field: &Field,
    drawn: &Drawn,
    deltas: &[f64],
    samples: usize,
    background: [f64; 3],
) -> (f64, NerfMlp) {
    const CHUNK: usize = 16;
    let rays = drawn.origins.len() / 3;
    let vector =
        |values: &[f64], r: usize| glam::DVec3::new(values[3 * r], values[3 * r + 1], values[3 * r + 2]);
    let target = |r: usize| Target {
        ray: Ray { o: vector(&drawn.origins, r), d: vector(&drawn.directions, r) },
        t: drawn.t[r * samples..(r + 1) * samples].to_vec(),
        deltas: deltas[r * samples..(r + 1) * samples].to_vec(),
        rgb: std::array::from_fn(|k| f64::from(drawn.targets[3 * r + k])),
    };
    let parts = parallel::map(rays.div_ceil(CHUNK), |n| {
        let batch: Vec<Target> = (n * CHUNK..rays.min((n + 1) * CHUNK)).map(target).collect();
        let (loss, gradient) = field.loss_and_gradient(&batch, background);
        (batch.len() as f64 / rays as f64, loss, gradient)
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
        let entries = p.w.iter_mut().chain(p.b.iter_mut());
        let means = m.w.iter_mut().chain(m.b.iter_mut()).zip(v.w.iter_mut().chain(v.b.iter_mut()));
        for ((param, (m, v)), g) in entries.zip(means).zip(g.w.iter().chain(&g.b)) {
            let after = adam_step(adam, optimiser::Moments { param: *param, m: *m, v: *v }, *g, step);
            (*param, *m, *v) = (after.param, after.m, after.v);
        }
    }
}
