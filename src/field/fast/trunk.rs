//! Hidden layers with ReLU on a chunk of points, forward and backward, shared by the 2D network and the NeRF network.

use pulp::Arch;

use super::passes::{BiasRelu, ReluBackward};
use super::product::{Matrix, Multiply, transposed};
use crate::convention::SkipOrder;
use crate::field::trunk::Plan;

/// Where an affine layer lies in the flat parameter vector: weights (out, in), then biases (out).
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine {
    pub inputs: usize,
    pub outputs: usize,
    at: usize,
}

impl Affine {
    /// The layer that starts at `*at`, which is moved past it.
    pub(super) fn next(at: &mut usize, inputs: usize, outputs: usize) -> Self {
        let layer = Affine { inputs, outputs, at: *at };
        *at += outputs * (inputs + 1);
        layer
    }

    /// (weights, biases).
    pub(super) fn of(self, params: &[f32]) -> (&[f32], &[f32]) {
        params[self.at..self.at + self.outputs * (self.inputs + 1)].split_at(self.outputs * self.inputs)
    }

    /// (weights, biases), to write to.
    pub(super) fn of_mut(self, params: &mut [f32]) -> (&mut [f32], &mut [f32]) {
        params[self.at..self.at + self.outputs * (self.inputs + 1)].split_at_mut(self.outputs * self.inputs)
    }
}

/// The hidden layers.
#[derive(Clone, Debug)]
pub(super) struct Trunk {
    /// Columns of the encoded input.
    pub encoding: usize,
    /// Width of every layer.
    pub width: usize,
    pub layers: Vec<Affine>,
}

/// Activations of a chunk, and two buffers for gradients.
#[derive(Debug, Default)]
pub(super) struct Tape {
    /// Encoded input (P, encoding).
    pub encoding: Vec<f32>,
    /// Activations of each layer; rows end with the encoding where the next layer is the skip.
    pub h: Vec<Vec<f32>>,
    /// Gradient before the ReLU of the layer at hand (P, width).
    pub g: Vec<f32>,
    pub g_next: Vec<f32>,
}

impl Trunk {
    /// `depth` layers that start at `*at` in the parameters, which is moved past them.
    pub(super) fn next(at: &mut usize, encoding: usize, width: usize, depth: usize, plan: Plan) -> Self {
        assert_eq!(plan.order, SkipOrder::HiddenFirst, "rows of h hold the encoding after it");
        let layer = |n| Affine::next(at, plan.columns(n, width, encoding), width);
        let layers = (0..depth).map(layer).collect();
        Trunk { encoding, width, layers }
    }

    /// Transposed weights of every layer, for [`Self::forward`].
    pub(super) fn transposed(&self, params: &[f32]) -> Vec<Vec<f32>> {
        self.layers.iter().map(|l| transposed(l.of(params).0, l.outputs, l.inputs)).collect()
    }

    /// Entries between two rows of h after layer n.
    pub(super) fn stride(&self, n: usize) -> usize {
        self.layers.get(n + 1).map_or(self.width, |next| next.inputs)
    }

    /// Resizes the buffers to `points`.
    pub(super) fn reserve(&self, tape: &mut Tape, points: usize) {
        tape.encoding.resize(points * self.encoding, 0.0);
        tape.h.resize(self.layers.len(), vec![]);
        for (n, h) in tape.h.iter_mut().enumerate() {
            h.resize(points * self.stride(n), 0.0);
        }
        tape.g.resize(points * self.width, 0.0);
        tape.g_next.resize(points * self.width, 0.0);
    }

    /// The last hidden layer (points, width).
    pub(super) fn last<'a>(&self, tape: &'a Tape) -> &'a [f32] {
        &tape.h[self.layers.len() - 1]
    }

    /// h_n = relu(w_n [h_{n-1}, encoding at the skip] + b_n) for the first `points` rows of the encoding.
    pub(super) fn forward(
        &self,
        arch: Arch,
        params: &[f32],
        transposed: &[Vec<f32>],
        tape: &mut Tape,
        points: usize,
        on: &impl Multiply,
    ) {
        for (n, layer) in self.layers.iter().enumerate() {
            let stride = self.stride(n);
            let (before, after) = tape.h.split_at_mut(n);
            let h = &mut after[0][..points * stride];
            let (x, x_stride) = match n {
                0 => (&tape.encoding, self.encoding),
                n => (&before[n - 1], self.stride(n - 1)),
            };
            let x = Matrix::new(x, points, layer.inputs, x_stride);
            let w = Matrix::new(&transposed[n], layer.inputs, self.width, self.width);
            on.product(h, stride, x, w, false);
            arch.dispatch(BiasRelu { x: &mut *h, stride, bias: layer.of(params).1 });
            if stride > self.width {
                for (h, e) in h.chunks_exact_mut(stride).zip(tape.encoding.chunks_exact(self.encoding)) {
                    h[self.width..].copy_from_slice(e);
                }
            }
        }
    }

    /// Moves the rows named in `rows` (ascending) of all activations to the front.
    pub(super) fn compact(&self, tape: &mut Tape, rows: &[usize]) {
        let strides = (0..self.layers.len()).map(|n| self.stride(n));
        for (buffer, stride) in tape.h.iter_mut().zip(strides).chain([(&mut tape.encoding, self.encoding)]) {
            for (to, &from) in rows.iter().enumerate() {
                buffer.copy_within(from * stride..(from + 1) * stride, to * stride);
            }
        }
    }

    /// Adds the gradients of all layers to `gradient`. `tape.g` holds the gradient before the last layer's ReLU, whose
    /// bias gradient has been added already. The encoding gets none: nothing after it is trained.
    pub(super) fn backward(
        &self,
        arch: Arch,
        params: &[f32],
        tape: &mut Tape,
        points: usize,
        gradient: &mut [f32],
        on: &impl Multiply,
    ) {
        for (n, layer) in self.layers.iter().enumerate().rev() {
            let g = Matrix::new(&tape.g, points, self.width, self.width);
            let (x, x_stride) = match n {
                0 => (&tape.encoding, self.encoding),
                n => (&tape.h[n - 1], self.stride(n - 1)),
            };
            let inputs = Matrix::new(x, points, layer.inputs, x_stride);
            on.product(layer.of_mut(gradient).0, layer.inputs, g.t(), inputs, true);
            if n > 0 {
                // Of the skip's input [h, encoding], only h.
                let w = Matrix::new(layer.of(params).0, self.width, self.width, layer.inputs);
                let g_next = &mut tape.g_next[..points * self.width];
                on.product(g_next, self.width, g, w, false);
                let g_bias = self.layers[n - 1].of_mut(gradient).1;
                arch.dispatch(ReluBackward { g: g_next, h: x, stride: x_stride, g_bias });
                std::mem::swap(&mut tape.g, &mut tape.g_next);
            }
        }
    }
}
