//! Vector-Jacobian products of the networks, by hand, accumulated point by point.
//!
//! For z = w x + b: g_w += g_z x^T, g_b += g_z, g_x = w^T g_z. A ReLU passes g where z > 0.

use super::mlp::{self, Mlp, Output};
use super::nerf_mlp::{self, NerfMlp};
use super::trunk::Plan;
use super::{Layer, density_slope, sigmoid_slope};
use crate::convention::{Activation, Conventions};

/// Adds one point's g_w and g_b to `gradient` and returns g_x.
///
/// # Panics
/// Where `x` doesn't have w's columns, `g_z` w's rows, or `gradient` the layer's shapes.
pub fn layer(layer: &Layer, x: &[f64], g_z: &[f64], gradient: &mut Layer) -> Vec<f64> {
    let (outputs, inputs) = layer.w.dim();
    assert_eq!(x.len(), inputs, "x and the columns of w: one each an input");
    assert_eq!(g_z.len(), outputs, "g_z and the rows of w: one each an output");
    assert_eq!(gradient.w.dim(), layer.w.dim(), "gradient.w and w: the same shape");
    assert_eq!(gradient.b.len(), outputs, "gradient.b and the rows of w: one each an output");
    let mut g_x = vec![0.0; inputs];
    for o in 0..outputs {
        gradient.b[o] += g_z[o];
        for i in 0..inputs {
            gradient.w[[o, i]] += g_z[o] * x[i];
            g_x[i] += layer.w[[o, i]] * g_z[o];
        }
    }
    g_x
}

/// g where z > 0, else 0.
///
/// # Panics
/// Where the lengths differ.
pub fn relu(z: &[f64], g: &[f64]) -> Vec<f64> {
    assert_eq!(z.len(), g.len(), "z and g: one entry for one entry");
    z.iter().zip(g).map(|(&z, &g)| if z > 0.0 { g } else { 0.0 }).collect()
}

/// Gradients of [`Mlp::forward`]: adds to `gradient` (one entry a layer) and returns g_x.
///
/// # Panics
/// Where `tape` or `gradient` isn't that of such a network, or `g_y` isn't as long as its output.
pub fn mlp(net: &Mlp, tape: &mlp::Tape, g_y: &[f64], gradient: &mut [Layer]) -> Vec<f64> {
    assert_eq!(gradient.len(), net.layers.len(), "gradient and net: one each a layer");
    assert_eq!(tape.z.len(), net.layers.len(), "tape and net: one each a layer");
    assert_eq!(g_y.len(), tape.y.len(), "g_y and y: one each an output");
    let last = net.layers.len() - 1;
    let mut g = g_y.to_vec();
    for n in (0..=last).rev() {
        let z = &tape.z[n];
        let g_z = if n < last {
            relu(z, &g)
        } else if net.output == Output::Sigmoid {
            z.iter().zip(&g).map(|(&z, g)| sigmoid_slope(z) * g).collect()
        } else {
            g
        };
        g = layer(&net.layers[n], &tape.inputs[n], &g_z, &mut gradient[n]);
    }
    g
}

/// Gradients of [`NerfMlp::forward`]: adds to `gradient` and returns those of the encoded position and direction.
///
/// # Panics
/// Where `tape` or `gradient` isn't that of such a network.
pub fn nerf_mlp(
    net: &NerfMlp,
    tape: &nerf_mlp::Tape,
    c: &Conventions,
    g_sigma: f64,
    g_rgb: [f64; 3],
    gradient: &mut NerfMlp,
) -> (Vec<f64>, Vec<f64>) {
    assert_eq!(gradient.trunk.len(), net.trunk.len(), "gradient.trunk and net.trunk: one each a layer");
    assert_eq!(tape.z.len(), net.trunk.len(), "tape and net.trunk: one each a layer");
    // Color head, color layer, feature.
    let g_z1: Vec<f64> = (0..3).map(|k| sigmoid_slope(tape.z_color1[k]) * g_rgb[k]).collect();
    let g = layer(&net.color1, &tape.color_hidden, &g_z1, &mut gradient.color1);
    let g = relu(&tape.z_color0, &g);
    let g = layer(&net.color0, &tape.color_input, &g, &mut gradient.color0);
    let (mut g_feature, g_direction) = c.color_order.split(&g, tape.z_feature.len());
    if c.feature == Activation::Relu {
        g_feature = relu(&tape.z_feature, &g_feature);
    }
    // At the end of the trunk, the gradients of feature and density add up.
    let mut g_h = layer(&net.feature, &tape.hidden, &g_feature, &mut gradient.feature);
    // An opaque sample's e^z may be infinite, and its gradient 0: no product of these, which would be NaN.
    let g_z_sigma = if g_sigma == 0.0 { g_sigma } else { density_slope(tape.z_sigma, c.density) * g_sigma };
    let g_from_sigma = layer(&net.sigma, &tape.hidden, &[g_z_sigma], &mut gradient.sigma);
    for (g, from_sigma) in g_h.iter_mut().zip(g_from_sigma) {
        *g += from_sigma;
    }
    // Back through the trunk. The encoding gets a gradient from every layer whose input it is part of.
    let mut g_position = vec![0.0; tape.inputs[0].len()];
    for n in (0..net.trunk.len()).rev() {
        let linear = n + 1 == net.trunk.len() && c.last_trunk == Activation::None;
        let g_z = if linear { g_h } else { relu(&tape.z[n], &g_h) };
        let g_input = layer(&net.trunk[n], &tape.inputs[n], &g_z, &mut gradient.trunk[n]);
        let (g_hidden, g_encoding) = Plan::of(c).split(n, &g_input, g_position.len());
        for (g, more) in g_position.iter_mut().zip(g_encoding) {
            *g += more;
        }
        g_h = g_hidden;
    }
    (g_position, g_direction)
}
