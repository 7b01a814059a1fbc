//! The two small networks: density 32 -> 64 -> 16, color (16 + 16 harmonics) -> 64 -> 3. No biases, as in Instant-NGP.

use crate::hash_grid::fast::WIDTH;
use crate::optimizer::fast::Rates;
use crate::random::Key;
use crate::simd::{Aligned, copied, repeated};
use crate::spherical_harmonics::fast as harmonics;

/// Hidden units.
pub(crate) const HIDDEN: usize = 64;
/// Outputs of the density network; the first is the logarithm of the density.
pub(crate) const GEOMETRY: usize = 16;
/// Names of the weight matrices in a checkpoint.
pub(super) const NAMES: [&str; 5] = ["density0", "density1", "color0", "view", "color1"];

/// The weights, one row per input.
#[derive(Clone)]
pub(crate) struct Weights {
    pub density0: Aligned<[f32; HIDDEN]>,
    pub density1: Aligned<[f32; GEOMETRY]>,
    pub color0: Aligned<[f32; HIDDEN]>,
    /// From the direction's harmonics to the color network's hidden layer.
    pub view: Aligned<[f32; HIDDEN]>,
    /// 3 of 16 columns are used, so that a row is a vector; the others stay 0.
    pub color1: Aligned<[f32; 16]>,
}

impl Weights {
    pub(crate) fn zeros() -> Self {
        Weights {
            density0: repeated([0.0; HIDDEN], WIDTH),
            density1: repeated([0.0; GEOMETRY], HIDDEN),
            color0: repeated([0.0; HIDDEN], GEOMETRY),
            view: repeated([0.0; HIDDEN], harmonics::WIDTH),
            color1: repeated([0.0; 16], HIDDEN),
        }
    }

    /// Uniform, hidden layers with He's bound sqrt(6 / inputs); 0.4 of it for output layers, so that densities start near 1.
    pub(crate) fn random(key: &Key) -> Self {
        let mut weights = Self::zeros();
        let inputs = [WIDTH, HIDDEN, 2 * GEOMETRY, 2 * GEOMETRY, HIDDEN];
        let gains = [1.0, 0.4, 1.0, 1.0, 0.4];
        for (n, part) in weights.parts_mut().into_iter().enumerate() {
            let bound = gains[n] * (6.0 / inputs[n] as f64).sqrt();
            let draws = key.uniforms(0, n as u64, part.len());
            part.iter_mut().zip(draws).for_each(|(w, u)| *w = (bound * (2.0 * u - 1.0)) as f32);
        }
        weights.color1.iter_mut().for_each(|row| row[3..].fill(0.0));
        weights
    }

    pub(crate) fn parts(&self) -> [&[f32]; 5] {
        let Weights { density0, density1, color0, view, color1 } = self;
        let [a, c, d] = [density0, color0, view].map(|w| w.as_flattened());
        [a, density1.as_flattened(), c, d, color1.as_flattened()]
    }

    pub(crate) fn parts_mut(&mut self) -> [&mut [f32]; 5] {
        let Weights { density0, density1, color0, view, color1 } = self;
        let [a, c, d] = [density0, color0, view].map(|w| w.as_flattened_mut());
        [a, density1.as_flattened_mut(), c, d, color1.as_flattened_mut()]
    }

    pub(crate) fn clear(&mut self) {
        self.parts_mut().into_iter().for_each(|part| part.fill(0.0));
    }

    /// Goes by a share `rate` to where another one is.
    pub(crate) fn approach(&mut self, other: &Self, rate: f32) {
        for (a, b) in self.parts_mut().into_iter().zip(other.parts()) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += rate * (b - *a));
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        for (a, b) in self.parts_mut().into_iter().zip(other.parts()) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        }
    }
}

/// Weights, Adam's running means, the weights' own, of which pictures are made, and the transposes that the backward pass reads.
pub(super) struct Networks {
    pub weights: Weights,
    pub m: Weights,
    pub v: Weights,
    pub mean: Weights,
    pub density0_t: Aligned<[f32; WIDTH]>,
    pub density1_t: Aligned<[f32; HIDDEN]>,
    pub color0_t: Aligned<[f32; GEOMETRY]>,
    pub color1_t: Aligned<[f32; HIDDEN]>,
}

/// B rows of A columns from A rows of B columns.
fn transpose<const A: usize, const B: usize>(x: &[[f32; B]]) -> Aligned<[f32; A]> {
    copied(&std::array::from_fn::<[f32; A], B, _>(|b| std::array::from_fn(|a| x[a][b])))
}

impl Networks {
    pub(super) fn new(weights: Weights) -> Self {
        let (m, v) = (Weights::zeros(), Weights::zeros());
        let density0_t = transpose(&weights.density0);
        let density1_t = transpose(&weights.density1);
        let color0_t = transpose(&weights.color0);
        let color1_t = transpose(&weights.color1);
        let mean = weights.clone();
        Networks { weights, m, v, mean, density0_t, density1_t, color0_t, color1_t }
    }

    /// To be called whenever the weights have changed.
    pub(super) fn transpose(&mut self) {
        self.density0_t = transpose(&self.weights.density0);
        self.density1_t = transpose(&self.weights.density1);
        self.color0_t = transpose(&self.weights.color0);
        self.color1_t = transpose(&self.weights.color1);
    }

    /// One step of Adam.
    pub(super) fn update(&mut self, gradient: &Weights, rates: Rates) {
        let moments = self.m.parts_mut().into_iter().zip(self.v.parts_mut());
        for ((p, g), (m, v)) in self.weights.parts_mut().into_iter().zip(gradient.parts()).zip(moments) {
            rates.apply(p, g, m, v);
        }
        self.transpose();
    }
}
