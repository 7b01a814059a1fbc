//! Variants of the networks for `bench`, and what they share: straightforward layers, parameters stored in short types.

use half::f16;
use half::slice::HalfFloatSliceExt;

use crate::approximate::{from_bf16, to_bf16};
use crate::bench::Tolerance;
use crate::field::Layer;

mod mlp;
mod nerf;

pub(crate) use mlp::MLP;
pub(crate) use nerf::{NERF_MLP, SCALING};

/// Initial parameters, rounded to f32.
pub(super) fn rounded(layers: Vec<&mut Layer>) {
    for layer in layers {
        layer.w.mapv_inplace(|x| f64::from(x as f32));
        layer.b.mapv_inplace(|x| f64::from(x as f32));
    }
}

/// A straightforward layer: (weights row by row, biases).
pub(super) type Plain = (Vec<f32>, Vec<f32>);

pub(super) fn plain_layer(layer: &Layer) -> Plain {
    let single = |x: &f64| *x as f32;
    (layer.w.iter().map(single).collect(), layer.b.iter().map(single).collect())
}

pub(super) fn plain_forward((w, b): &Plain, x: &[f32], relu: bool) -> Vec<f32> {
    let output = |(w, b): (&[f32], &f32)| {
        let mut sum = *b;
        for i in 0..x.len() {
            sum += w[i] * x[i];
        }
        if relu { sum.max(0.0) } else { sum }
    };
    w.chunks_exact(x.len()).zip(b).map(output).collect()
}

/// How the parameters are stored between two calls.
#[derive(Clone)]
pub(super) enum Store {
    F32,
    Bf16(Vec<u16>),
    F16(Vec<f16>),
}

impl Store {
    pub(super) fn bf16(params: &[f32]) -> Store {
        Store::Bf16(params.iter().map(|&p| to_bf16(p)).collect())
    }

    pub(super) fn f16(params: &[f32]) -> Store {
        Store::F16(params.iter().map(|&p| f16::from_f32(p)).collect())
    }

    /// Writes the parameters in f32, for the products.
    pub(super) fn unpack(&self, params: &mut [f32]) {
        match self {
            Store::F32 => {}
            Store::Bf16(short) => params.iter_mut().zip(short).for_each(|(p, &s)| *p = from_bf16(s)),
            Store::F16(short) => short.convert_to_f32_slice(params),
        }
    }
}

/// The error of weights in a short type: each layer changes its outputs by at most half a unit of the last place, relative to the
/// largest.
pub(super) const fn short(layers: f64, half_unit: f64) -> Tolerance {
    Tolerance::f32().of_largest(layers * half_unit)
}
