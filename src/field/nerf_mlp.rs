//! The network of the NeRF paper: density from the position alone, color from position and direction.

use super::trunk::Plan;
use super::{Layer, density, relu, sigmoid};
use crate::convention::{Activation, Conventions};
use crate::random::Key;

/// Parameters. In the paper: 8 trunk layers of 256, the encoding (63 columns) concatenated again into the input of the fifth,
/// a feature of 256, a color layer of 128.
#[derive(Clone, Debug, PartialEq)]
pub struct NerfMlp {
    /// Trunk layers, ReLU after each.
    pub trunk: Vec<Layer>,
    /// Density head, (1, width).
    pub sigma: Layer,
    /// Feature, (width, width).
    pub feature: Layer,
    /// Color layer on [feature, encoded direction].
    pub color0: Layer,
    /// Color head, (3, width of color0).
    pub color1: Layer,
}

/// The sizes of a [`NerfMlp`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Columns of the encoded position.
    pub position: usize,
    /// Columns of the encoded direction.
    pub direction: usize,
    /// Trunk width.
    pub width: usize,
    /// Trunk depth.
    pub depth: usize,
    /// Width of the color layer.
    pub color: usize,
}

impl Shape {
    /// The paper's: L = 10 and 4, 8 layers of 256, 128 for the color.
    pub const PAPER: Shape = Shape { position: 63, direction: 27, width: 256, depth: 8, color: 128 };

    /// Columns that go into trunk layer n.
    pub fn trunk_inputs(&self, n: usize, c: &Conventions) -> usize {
        Plan::of(c).columns(n, self.width, self.position)
    }
}

/// The forward pass of one point, as the backward pass needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape {
    /// Input of each trunk layer.
    pub inputs: Vec<Vec<f64>>,
    /// z of each trunk layer.
    pub z: Vec<Vec<f64>>,
    /// Output of the trunk.
    pub hidden: Vec<f64>,
    /// z of the density head.
    pub z_sigma: f64,
    /// z of the feature layer.
    pub z_feature: Vec<f64>,
    /// [feature, encoded direction].
    pub color_input: Vec<f64>,
    /// z of the color layer.
    pub z_color0: Vec<f64>,
    /// Output of the color layer.
    pub color_hidden: Vec<f64>,
    /// z of the color head.
    pub z_color1: Vec<f64>,
    /// Density.
    pub sigma: f64,
    /// Color.
    pub rgb: [f64; 3],
}

impl NerfMlp {
    /// PyTorch's initial values, for the skip of `c`. Streams in the order of the names: trunk 0, 1, ..., sigma, feature, color0, color1.
    pub fn initial(shape: &Shape, c: &Conventions, key: &Key) -> Self {
        let Shape { direction, width, depth, color, .. } = *shape;
        let layer = |n: usize, inputs, outputs| Layer::initial(inputs, outputs, key, n as u64);
        NerfMlp {
            trunk: (0..depth).map(|n| layer(n, shape.trunk_inputs(n, c), width)).collect(),
            sigma: layer(depth, width, 1),
            feature: layer(depth + 1, width, width),
            color0: layer(depth + 2, width + direction, color),
            color1: layer(depth + 3, color, 3),
        }
    }

    /// All layers with their names, in the order of the streams: `trunk0`, ..., `sigma`, `feature`, `color0`, `color1`.
    pub fn layers(&self) -> Vec<(String, &Layer)> {
        let mut layers: Vec<_> =
            self.trunk.iter().enumerate().map(|(n, layer)| (format!("trunk{n}"), layer)).collect();
        layers.push(("sigma".into(), &self.sigma));
        layers.push(("feature".into(), &self.feature));
        layers.push(("color0".into(), &self.color0));
        layers.push(("color1".into(), &self.color1));
        layers
    }

    /// The same layers to write to.
    pub fn layers_mut(&mut self) -> Vec<&mut Layer> {
        let mut layers: Vec<_> = self.trunk.iter_mut().collect();
        layers.extend([&mut self.sigma, &mut self.feature, &mut self.color0, &mut self.color1]);
        layers
    }

    /// One point, encoded, seen from an encoded direction.
    ///
    /// h = relu(trunk(...)), sigma = density(w_sigma h + b), f = w_feature h + b, rgb = sigmoid(color1 relu(color0 [f, direction])).
    ///
    /// # Panics
    /// Where `position` or `direction` isn't as long as the layers that take it are wide.
    pub fn forward(&self, position: &[f64], direction: &[f64], c: &Conventions) -> Tape {
        let (mut inputs, mut zs) = (vec![], vec![]);
        let mut h = vec![];
        for (n, layer) in self.trunk.iter().enumerate() {
            let input = Plan::of(c).join(n, &h, position);
            let z = layer.forward(&input);
            let linear = n + 1 == self.trunk.len() && c.last_trunk == Activation::None;
            h = if linear { z.clone() } else { relu(&z) };
            inputs.push(input);
            zs.push(z);
        }
        let z_sigma = self.sigma.forward(&h)[0];
        let z_feature = self.feature.forward(&h);
        let feature = if c.feature == Activation::Relu { relu(&z_feature) } else { z_feature.clone() };
        let color_input = c.color_order.join(&feature, direction);
        let z_color0 = self.color0.forward(&color_input);
        let color_hidden = relu(&z_color0);
        let z_color1 = self.color1.forward(&color_hidden);
        let rgb = [sigmoid(z_color1[0]), sigmoid(z_color1[1]), sigmoid(z_color1[2])];
        let sigma = density(z_sigma, c.density);
        #[rustfmt::skip]
        let tape = Tape { inputs, z: zs, hidden: h, z_sigma, z_feature, color_input, z_color0, color_hidden, z_color1, sigma, rgb };
        tape
    }
}
