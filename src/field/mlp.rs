//! The plain network: affine layers, ReLU between them, sigmoid or nothing at the end.

use super::{Layer, relu, sigmoid};
use crate::random::Key;

/// The activation after the last layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// sigmoid: colors.
    Sigmoid,
    /// Nothing.
    Linear,
}

/// A network of affine layers with ReLU between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Mlp {
    /// Layers from input to output.
    pub layers: Vec<Layer>,
    /// Activation after the last layer.
    pub output: Output,
}

/// The forward pass of one point, as the backward pass needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape {
    /// Input of each layer.
    pub inputs: Vec<Vec<f64>>,
    /// z of each layer.
    pub z: Vec<Vec<f64>>,
    /// The result.
    pub y: Vec<f64>,
}

impl Mlp {
    /// `hidden` layers of `width` between `inputs` and `outputs`, with PyTorch's initial values; layer n draws from stream n.
    pub fn initial(inputs: usize, width: usize, hidden: usize, outputs: usize, key: &Key) -> Self {
        let sizes: Vec<usize> =
            [inputs].into_iter().chain(std::iter::repeat_n(width, hidden)).chain([outputs]).collect();
        let layers = (0..=hidden).map(|n| Layer::initial(sizes[n], sizes[n + 1], key, n as u64)).collect();
        Mlp { layers, output: Output::Sigmoid }
    }

    /// One point through the network: h_0 = x, z_n = w_n h_{n-1} + b_n, h_n = max(z_n, 0), y = sigmoid(z_last).
    ///
    /// # Panics
    /// Where `x` isn't as long as the first layer is wide, or a layer's input as the output before it.
    pub fn forward(&self, x: &[f64]) -> Tape {
        let mut tape = Tape { inputs: vec![], z: vec![], y: vec![] };
        let mut h = x.to_vec();
        for layer in &self.layers {
            let z = layer.forward(&h);
            tape.inputs.push(h);
            h = relu(&z);
            tape.z.push(z);
        }
        let last = tape.z.last().expect("at least one layer");
        tape.y = match self.output {
            Output::Sigmoid => last.iter().map(|&z| sigmoid(z)).collect(),
            Output::Linear => last.clone(),
        };
        tape
    }
}
