//! The 2D experiment: a network from pixel position to color, fitted to one picture.

use std::time::Instant;

use ndarray::{Array1, Array3};
use serde::{Deserialize, Serialize};

use super::reference::{adam_layer, image_loss_and_gradient};
use crate::convention::CS180;
use crate::encoding::{Encoding, positional_encoding};
use crate::error::{Error, Input, Result};
use crate::field::fast::{Gradient, ImageNetwork};
use crate::field::{Layer, Mlp};
use crate::files::npz::{Array, Arrays};
use crate::loss::{mse, psnr};
use crate::optimizer::{self, Adam};
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::ray::draw_index;

/// The settings of a fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitSettings {
    /// Steps.
    pub steps: u64,
    /// Pixels per step.
    pub batch: usize,
    /// L, bands of the encoding.
    pub levels: usize,
    /// Width of the hidden layers.
    pub width: usize,
    /// Number of hidden layers.
    pub layers: usize,
    /// Learning rate of Adam.
    pub lr: f64,
    /// Seed of parameters and pixels.
    pub seed: u64,
    /// The f64 reference instead of the f32 path.
    pub reference: bool,
}

impl Default for FitSettings {
    /// 1,000 steps of 10,000 pixels, three hidden layers of 256, L = 10, learning rate 5e-3.
    fn default() -> Self {
        #[rustfmt::skip]
        let settings = FitSettings { steps: 1000, batch: 10_000, levels: 10, width: 256, layers: 3, lr: 5e-3, seed: 0, reference: false };
        settings
    }
}

/// One line of the log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogPoint {
    /// Updates done.
    pub step: u64,
    /// Seconds of training so far, without pictures.
    pub seconds: f64,
    /// Loss of this step's batch, before the step.
    pub loss: f64,
    /// PSNR of the whole picture after the step, not quantized; infinite (null in the file) if it was reproduced exactly.
    #[serde(deserialize_with = "super::log::decibels")]
    pub psnr: f64,
}

enum Path {
    Fast { net: Box<ImageNetwork>, moments: optimizer::fast::Moments, gradient: Gradient },
    Reference { net: Mlp, encoding: Encoding, m: Vec<Layer>, v: Vec<Layer> },
}

/// Whether the picture is kept after `step` of `steps`: 1, 101, 201, ..., and the last.
pub fn kept(step: u64, steps: u64) -> bool {
    step % 100 == 1 || step == steps
}

/// Fits `picture` (H, W, 3); `seen` gets each log point with its picture.
///
/// # Errors
/// Those of `seen`.
pub fn fit<E>(
    picture: &Array3<f32>,
    settings: &FitSettings,
    mut seen: impl FnMut(&LogPoint, &Array3<f32>) -> Result<(), E>,
    mut progress: impl FnMut(u64, f64),
) -> Result<Vec<LogPoint>, E> {
    let (mut fit, mut log) = (Fit::new(settings), vec![]);
    while fit.step < settings.steps {
        let loss = fit.step(picture);
        if kept(fit.step, settings.steps) {
            let (point, fitted) = fit.measure(picture, loss);
            seen(&point, &fitted)?;
            log.push(point);
        }
        progress(fit.step, loss);
    }
    Ok(log)
}

/// A network that is being fitted to a picture.
///
/// Pixel (i, j) is the point ((i + 0.5) / W, (j + 0.5) / H), in training and in the pictures alike.
pub(super) struct Fit {
    settings: FitSettings,
    path: Path,
    /// Updates done.
    pub step: u64,
    /// Of training so far, without pictures.
    pub seconds: f64,
}

impl Fit {
    /// Before its first step.
    pub(super) fn new(settings: &FitSettings) -> Self {
        Fit { settings: settings.clone(), path: start(settings), step: 0, seconds: 0.0 }
    }

    /// The next step; returns the loss before it.
    pub(super) fn step(&mut self, picture: &Array3<f32>) -> f64 {
        let clock = Instant::now();
        let (h, w, _) = picture.dim();
        let adam = Adam { lr: self.settings.lr, ..Adam::default() };
        let pixels = Key::new(self.settings.seed, Purpose::Pixels);
        self.step += 1;
        let (mut x, mut targets) = (vec![], vec![]);
        for ray in 0..self.settings.batch as u64 {
            let [u, v, ..] = pixels.four(self.step, ray);
            let n = draw_index(u, h) * w + draw_index(v, w);
            x.extend(position(n, h, w));
            targets.extend((0..3).map(|k| picture[[n / w, n % w, k]]));
        }
        let loss = self.path.step(&x, &targets, &adam, self.step);
        self.seconds += clock.elapsed().as_secs_f64();
        loss
    }

    /// What the log says after a step, and the whole picture.
    pub(super) fn measure(&self, picture: &Array3<f32>, loss: f64) -> (LogPoint, Array3<f32>) {
        let (h, w, _) = picture.dim();
        let fitted = self.path.picture(h, w);
        let psnr = picture_psnr(&fitted, picture);
        (LogPoint { step: self.step, seconds: self.seconds, loss, psnr }, fitted)
    }

    /// Parameters and their running means by name, as a checkpoint stores them.
    pub(super) fn state(&self) -> Arrays {
        NAMES.into_iter().map(String::from).zip(self.path.state()).collect()
    }

    /// Loads what [`Self::state`] returned after `step`.
    ///
    /// # Errors
    /// Where an array is missing or has another length or type; `file` is named in the message.
    pub(super) fn restore(&mut self, state: &Arrays, step: u64, seconds: f64, file: &str) -> Result<()> {
        let own = self.path.state();
        let wanted = NAMES.into_iter().zip(&own).map(|(name, own)| match state.get(name) {
            Some(array) if (array.dtype(), array.shape()) == (own.dtype(), own.shape()) => Ok(array),
            other => Err(Error::input(Input {
                file,
                field: name,
                found: other.map_or("no such array".into(), |a| format!("{} {:?}", a.dtype(), a.shape())),
                expected: format!("{} {:?}", own.dtype(), own.shape()),
                remedy: "Use the options that the picture was fitted with, or fit it again.",
            })),
        });
        let wanted: Vec<&Array> = wanted.collect::<Result<_>>()?;
        self.path.restore([0, 1, 2].map(|n| wanted[n]), step);
        (self.step, self.seconds) = (step, seconds);
        Ok(())
    }
}

/// The center of pixel n, counted row by row, in [0, 1]^2.
fn position(n: usize, h: usize, w: usize) -> [f64; 2] {
    [((n % w) as f64 + 0.5) / w as f64, ((n / w) as f64 + 0.5) / h as f64]
}

fn start(settings: &FitSettings) -> Path {
    let encoding = Encoding::new(settings.levels, &CS180);
    let key = Key::new(settings.seed, Purpose::Parameters);
    let net = Mlp::initial(encoding.width(2), settings.width, settings.layers, 3, &key);
    if settings.reference {
        let zero: Vec<Layer> = net.layers.iter().map(|l| Layer::zeros(l.w.ncols(), l.w.nrows())).collect();
        return Path::Reference { net, encoding, m: zero.clone(), v: zero };
    }
    let net = Box::new(ImageNetwork::new(&net, 2));
    let moments = optimizer::fast::Moments::new(net.params.len());
    Path::Fast { net, moments, gradient: Gradient::default() }
}

/// The arrays of a checkpoint: parameters, their means, their means of squares; each layer's weights (out, in) row by row, then its
/// biases.
const NAMES: [&str; 3] = ["params", "m", "v"];

fn flat(layers: &[Layer]) -> Array {
    layers.iter().flat_map(|layer| layer.w.iter().chain(&layer.b)).copied().collect::<Array1<f64>>().into()
}

fn unflatten(values: &Array, layers: &mut [Layer]) {
    let values = values.to_f64();
    let all = layers.iter_mut().flat_map(|layer| layer.w.iter_mut().chain(&mut layer.b));
    all.zip(values).for_each(|(to, from)| *to = from);
}

impl Path {
    /// In the order of [`NAMES`].
    fn state(&self) -> [Array; 3] {
        match self {
            Path::Fast { net, moments, .. } => {
                [&net.params, &moments.m, &moments.v].map(|values| Array1::from(values.clone()).into())
            }
            Path::Reference { net, m, v, .. } => [flat(&net.layers), flat(m), flat(v)],
        }
    }

    /// Loads arrays of the types and lengths that [`Self::state`] returns.
    fn restore(&mut self, state: [&Array; 3], step: u64) {
        match self {
            Path::Fast { net, moments, .. } => {
                let [params, m, v] = state.map(|array| array.to_f64().iter().map(|&x| x as f32).collect());
                net.params = params;
                *moments = optimizer::fast::Moments { step, m, v };
            }
            Path::Reference { net, m, v, .. } => {
                let layers = [&mut net.layers, m, v];
                state.into_iter().zip(layers).for_each(|(values, layers)| unflatten(values, layers));
            }
        }
    }

    fn step(&mut self, x: &[f64], targets: &[f32], adam: &Adam, step: u64) -> f64 {
        match self {
            Path::Fast { net, moments, gradient } => {
                let loss = net.step(x, targets, gradient);
                moments.update(net.arch, adam, &mut net.params, &gradient.values);
                loss
            }
            Path::Reference { net, encoding, m, v } => {
                let pixels: Vec<[f64; 2]> = x.chunks_exact(2).map(|x| [x[0], x[1]]).collect();
                let targets: Vec<[f64; 3]> =
                    targets.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(f64::from)).collect();
                let (loss, gradient) = image_loss_and_gradient(net, encoding, &pixels, &targets);
                for (((p, m), v), g) in net.layers.iter_mut().zip(m).zip(v).zip(&gradient) {
                    adam_layer(adam, step, p, m, v, g);
                }
                loss
            }
        }
    }

    fn picture(&self, h: usize, w: usize) -> Array3<f32> {
        let colors = match self {
            Path::Fast { net, .. } => {
                let x: Vec<f64> = (0..h * w).flat_map(|n| position(n, h, w)).collect();
                net.forward(&x)
            }
            Path::Reference { net, encoding, .. } => {
                let color = |n: usize| net.forward(&positional_encoding(&position(n, h, w), encoding)).y;
                parallel::map(h * w, color).concat().into_iter().map(|c| c as f32).collect()
            }
        };
        Array3::from_shape_vec((h, w, 3), colors).expect("three channels a pixel")
    }
}

fn picture_psnr(a: &Array3<f32>, b: &Array3<f32>) -> f64 {
    let flat = |picture: &Array3<f32>| picture.iter().map(|&x| f64::from(x)).collect::<Vec<_>>();
    psnr(mse(&flat(a), &flat(b)), 1.0)
}
