//! The 2D experiment: a network from pixel position to color, fitted to one picture.

use std::time::Instant;

use ndarray::Array3;
use serde::Serialize;

use super::reference::{adam_layer, image_loss_and_gradient};
use crate::convention::CS180;
use crate::encoding::{Encoding, positional_encoding};
use crate::field::fast::{Gradient, ImageNetwork};
use crate::field::{Layer, Mlp};
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
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogPoint {
    /// Updates done.
    pub step: u64,
    /// Seconds of training so far, without pictures.
    pub seconds: f64,
    /// Loss of this step's batch, before the step.
    pub loss: f64,
    /// PSNR of the whole picture after the step, not quantized.
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
/// Pixel (i, j) is the point ((i + 0.5) / W, (j + 0.5) / H), in training and in the pictures alike.
///
/// # Errors
/// Those of `seen`.
pub fn fit<E>(
    picture: &Array3<f32>,
    settings: &FitSettings,
    mut seen: impl FnMut(&LogPoint, &Array3<f32>) -> Result<(), E>,
    mut progress: impl FnMut(u64, f64),
) -> Result<Vec<LogPoint>, E> {
    let (h, w, _) = picture.dim();
    let mut path = start(settings);
    let adam = Adam { lr: settings.lr, ..Adam::default() };
    let pixels = Key::new(settings.seed, Purpose::Pixels);
    let (mut log, mut seconds) = (vec![], 0.0);
    for step in 1..=settings.steps {
        let clock = Instant::now();
        let (mut x, mut targets) = (vec![], vec![]);
        for ray in 0..settings.batch as u64 {
            let [u, v, ..] = pixels.four(step, ray);
            let n = draw_index(u, h) * w + draw_index(v, w);
            x.extend(position(n, h, w));
            targets.extend((0..3).map(|k| picture[[n / w, n % w, k]]));
        }
        let loss = path.step(&x, &targets, &adam, step);
        seconds += clock.elapsed().as_secs_f64();
        if kept(step, settings.steps) {
            let fitted = path.picture(h, w);
            let point = LogPoint { step, seconds, loss, psnr: picture_psnr(&fitted, picture) };
            seen(&point, &fitted)?;
            log.push(point);
        }
        progress(step, loss);
    }
    Ok(log)
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

impl Path {
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
