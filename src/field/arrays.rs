//! The oracle of this folder on named arrays, and what turns these into its types and back.

use ndarray::{Array1, Array2, ArrayD, Ix1, Ix2};

use super::mlp::{Mlp, Output};
use super::nerf_mlp::NerfMlp;
use super::{Layer, backward};
use crate::contract::arrays::{Arrays, arrays, from_rows, input, rows, values};
use crate::convention::Conventions;
use crate::encoding::{Encoding, backward::positional_encoding as encoding_vjp, positional_encoding};

/// A layer from its two arrays.
pub(super) fn layer(a: &Arrays, w: &str, b: &str) -> Layer {
    let w: Array2<f64> = input(a, w).clone().into_dimensionality::<Ix2>().expect("weights are (out, in)");
    let b: Array1<f64> = input(a, b).clone().into_dimensionality::<Ix1>().expect("biases are (out)");
    Layer { w, b }
}

/// The plain network of the arrays w0, b0, w1, ...
pub(crate) fn network(a: &Arrays) -> Mlp {
    let count = (0..).take_while(|n| a.contains_key(&format!("w{n}"))).count();
    let layers = (0..count).map(|n| layer(a, &format!("w{n}"), &format!("b{n}"))).collect();
    Mlp { layers, output: Output::Sigmoid }
}

/// The same network with zeros in the place of its parameters.
pub(crate) fn zeros(layers: &[Layer]) -> Vec<Layer> {
    layers.iter().map(|layer| Layer::zeros(layer.w.ncols(), layer.w.nrows())).collect()
}

/// Gradients of the plain network as arrays.
pub(crate) fn mlp_gradients(gradient: &[Layer], g_x: &[Vec<f64>], columns: usize) -> Arrays {
    let mut out = arrays([("grad_x", from_rows(g_x, columns))]);
    for (n, layer) in gradient.iter().enumerate() {
        out.insert(format!("grad_w{n}"), layer.w.clone().into_dyn());
        out.insert(format!("grad_b{n}"), layer.b.clone().into_dyn());
    }
    out
}

pub(super) fn mlp(a: &Arrays, _: &Conventions) -> Arrays {
    let net = network(a);
    let y: Vec<Vec<f64>> = rows(a, "x").iter().map(|x| net.forward(x).y).collect();
    arrays([("y", from_rows(&y, net.layers.last().expect("a layer").b.len()))])
}

pub(super) fn mlp_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let net = network(a);
    let mut gradient = zeros(&net.layers);
    let point = |(x, g): (&Vec<f64>, &Vec<f64>)| backward::mlp(&net, &net.forward(x), g, &mut gradient);
    let g_x: Vec<Vec<f64>> = rows(a, "x").iter().zip(&rows(a, "grad_y")).map(point).collect();
    mlp_gradients(&gradient, &g_x, net.layers[0].w.ncols())
}

/// The NeRF network with its two encodings.
pub(crate) struct Nerf {
    pub net: NerfMlp,
    pub position: Encoding,
    pub direction: Encoding,
}

impl Nerf {
    /// L of both encodings follows from the widths: D + 2 L D columns (2 L D without the identity).
    pub(crate) fn of(a: &Arrays, c: &Conventions) -> Nerf {
        let count = (0..).take_while(|n| a.contains_key(&format!("trunk{n}_w"))).count();
        let named = |name: &str| layer(a, &format!("{name}_w"), &format!("{name}_b"));
        let net = NerfMlp {
            trunk: (0..count).map(|n| named(&format!("trunk{n}"))).collect(),
            sigma: named("sigma"),
            feature: named("feature"),
            color0: named("color0"),
            color1: named("color1"),
        };
        let levels = |columns: usize| (columns - if c.identity { 3 } else { 0 }) / 6;
        let direction = net.color0.w.ncols() - net.feature.w.nrows();
        let c = &Conventions { identity_place: c.network_identity, ..*c };
        let position = Encoding::new(levels(net.trunk[0].w.ncols()), c);
        Nerf { position, direction: Encoding::new(levels(direction), c), net }
    }

    /// A network of zeros.
    pub(crate) fn zeros(&self) -> NerfMlp {
        let mut net = self.net.clone();
        for layer in net.layers_mut() {
            layer.w.fill(0.0);
            layer.b.fill(0.0);
        }
        net
    }

    /// Gradients as arrays.
    pub(crate) fn gradients(gradient: &NerfMlp, g_positions: &[Vec<f64>]) -> Arrays {
        let mut out = arrays([("grad_positions", from_rows(g_positions, 3))]);
        for (name, layer) in gradient.layers() {
            out.insert(format!("grad_{name}_w"), layer.w.clone().into_dyn());
            out.insert(format!("grad_{name}_b"), layer.b.clone().into_dyn());
        }
        out
    }
}

/// Densities and colors as arrays.
pub(crate) fn field(sigmas: Vec<f64>, rgbs: &[[f64; 3]]) -> Arrays {
    let rows: Vec<Vec<f64>> = rgbs.iter().map(|rgb| rgb.to_vec()).collect();
    let sigmas = ArrayD::from(Array1::from(sigmas).into_dyn());
    arrays([("sigmas", sigmas), ("rgbs", from_rows(&rows, 3))])
}

/// The cotangents of point m.
pub(crate) fn cotangents(a: &Arrays) -> Vec<(f64, [f64; 3])> {
    let rgbs = rows(a, "grad_rgbs");
    values(a, "grad_sigmas").into_iter().zip(rgbs).map(|(g, rgb)| (g, [rgb[0], rgb[1], rgb[2]])).collect()
}

pub(super) fn nerf(a: &Arrays, c: &Conventions) -> Arrays {
    let nerf = Nerf::of(a, c);
    let point = |(x, d): (&Vec<f64>, &Vec<f64>)| {
        let (x, d) = (positional_encoding(x, &nerf.position), positional_encoding(d, &nerf.direction));
        let tape = nerf.net.forward(&x, &d, c);
        (tape.sigma, tape.rgb)
    };
    let (sigmas, rgbs): (Vec<f64>, Vec<_>) =
        rows(a, "positions").iter().zip(&rows(a, "directions")).map(point).unzip();
    field(sigmas, &rgbs)
}

pub(super) fn nerf_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let nerf = Nerf::of(a, c);
    let mut gradient = nerf.zeros();
    let (positions, directions) = (rows(a, "positions"), rows(a, "directions"));
    let mut g_positions = vec![];
    for (m, (g_sigma, g_rgb)) in cotangents(a).into_iter().enumerate() {
        let x = positional_encoding(&positions[m], &nerf.position);
        let d = positional_encoding(&directions[m], &nerf.direction);
        let tape = nerf.net.forward(&x, &d, c);
        let (g_x, _) = backward::nerf_mlp(&nerf.net, &tape, c, g_sigma, g_rgb, &mut gradient);
        g_positions.push(encoding_vjp(&positions[m], &nerf.position, &g_x));
    }
    Nerf::gradients(&gradient, &g_positions)
}
