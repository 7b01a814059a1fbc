//! Honest implementations of the networks in emulated arithmetic.

use super::arrays::{Nerf, cotangents, field, mlp_gradients, network, zeros};
use super::trunk::Plan;
use super::{Layer, density_slope};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::machine::Machine;
use crate::convention::{Activation, Conventions, Cosine, Density};
use crate::encoding::honest::{encode, gradient as encoding_gradient};
use crate::math::{exp, ln_1p};

/// w x, then + b; in f32 and f64 the bias is one more term of the sum.
fn affine(layer: &Layer, x: &[f64], m: &Machine) -> Vec<f64> {
    let row = |o: usize| layer.w.row(o).to_vec();
    (0..layer.b.len()).map(|o| m.add(m.dot(&row(o), x), layer.b[o])).collect()
}

/// w^T g.
fn transposed(layer: &Layer, g: &[f64], m: &Machine) -> Vec<f64> {
    (0..layer.w.ncols()).map(|i| m.dot(&layer.w.column(i).to_vec(), g)).collect()
}

fn relu(z: &[f64]) -> Vec<f64> {
    z.iter().map(|&z| z.max(0.0)).collect()
}

fn masked(g: &[f64], z: &[f64]) -> Vec<f64> {
    g.iter().zip(z).map(|(&g, &z)| if z > 0.0 { g } else { 0.0 }).collect()
}

/// 1 / (1 + e^-z), or e^z / (1 + e^z) on the negative side.
fn sigmoid(z: f64, m: &Machine) -> f64 {
    if m.form % 2 == 0 || z >= 0.0 {
        return m.div(1.0, m.add(1.0, m.exp(-z)));
    }
    let e = m.exp(z);
    m.div(e, m.add(1.0, e))
}

/// s (1 - s), or sigmoid(z) sigmoid(-z).
fn sigmoid_slope(z: f64, m: &Machine) -> f64 {
    let s = sigmoid(z, m);
    if m.form % 3 == 0 { m.mul(s, sigmoid(-z, m)) } else { m.mul(s, m.sub(1.0, s)) }
}

fn density(z: f64, activation: Density, m: &Machine) -> f64 {
    match activation {
        Density::Relu => z.max(0.0),
        Density::Exp => m.exp(z),
        Density::Softplus if m.stable => m.add(z.max(0.0), m.elementary(ln_1p(exp(-z.abs())))),
        Density::Softplus => m.elementary(crate::math::ln(m.add(1.0, m.exp(z)))),
    }
}

/// Sums over the points of g_z x^T and g_z.
#[derive(Default)]
struct Outer {
    g_z: Vec<Vec<f64>>,
    x: Vec<Vec<f64>>,
}

impl Outer {
    fn add(&mut self, g_z: &[f64], x: &[f64]) {
        self.g_z.push(g_z.to_vec());
        self.x.push(x.to_vec());
    }

    fn sums(&self, into: &mut Layer, m: &Machine) {
        for o in 0..into.b.len() {
            let g: Vec<f64> = self.g_z.iter().map(|g| g[o]).collect();
            into.b[o] = m.sum(&g);
            for i in 0..into.w.ncols() {
                into.w[[o, i]] = m.dot(&g, &self.x.iter().map(|x| x[i]).collect::<Vec<_>>());
            }
        }
    }
}

/// Inputs and z of every layer.
fn forward(layers: &[Layer], x: &[f64], m: &Machine) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let (mut inputs, mut zs) = (vec![x.to_vec()], vec![]);
    for (n, layer) in layers.iter().enumerate() {
        let z = affine(layer, &inputs[n], m);
        inputs.push(relu(&z));
        zs.push(z);
    }
    (inputs, zs)
}

/// The plain network.
pub(crate) fn mlp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let net = network(a);
    let point = |x: &Vec<f64>| {
        let (_, z) = forward(&net.layers, x, m);
        z.last().expect("a layer").iter().map(|&z| sigmoid(z, m)).collect()
    };
    let y: Vec<Vec<f64>> = rows(a, "x").iter().map(point).collect();
    arrays([("y", from_rows(&y, net.layers.last().expect("a layer").b.len()))])
}

/// Its gradients.
pub(crate) fn mlp_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let net = network(a);
    let count = net.layers.len();
    let mut outer: Vec<Outer> = (0..count).map(|_| Outer::default()).collect();
    let mut g_x = vec![];
    for (x, g) in rows(a, "x").iter().zip(&rows(a, "grad_y")) {
        let (inputs, z) = forward(&net.layers, x, m);
        let mut g: Vec<f64> =
            z[count - 1].iter().zip(g).map(|(&z, &g)| m.mul(sigmoid_slope(z, m), g)).collect();
        for n in (0..count).rev() {
            let g_z = if n + 1 < count { masked(&g, &z[n]) } else { g };
            outer[n].add(&g_z, &inputs[n]);
            g = transposed(&net.layers[n], &g_z, m);
        }
        g_x.push(g);
    }
    let mut gradient = zeros(&net.layers);
    outer.iter().zip(&mut gradient).for_each(|(outer, into)| outer.sums(into, m));
    mlp_gradients(&gradient, &g_x, net.layers[0].w.ncols())
}

/// One point through the NeRF network.
struct Tape {
    inputs: Vec<Vec<f64>>,
    z: Vec<Vec<f64>>,
    hidden: Vec<f64>,
    z_sigma: f64,
    z_feature: Vec<f64>,
    color_input: Vec<f64>,
    z_color0: Vec<f64>,
    color_hidden: Vec<f64>,
    z_color1: Vec<f64>,
}

fn tape(nerf: &Nerf, x: &[f64], d: &[f64], c: &Conventions, m: &Machine) -> Tape {
    let (encoding, direction) =
        (encode(x, &nerf.position, Cosine::Own, m), encode(d, &nerf.direction, Cosine::Own, m));
    let (mut inputs, mut zs, mut h) = (vec![], vec![], vec![]);
    for (n, layer) in nerf.net.trunk.iter().enumerate() {
        let input = Plan::of(c).join(n, &h, &encoding);
        let z = affine(layer, &input, m);
        let linear = n + 1 == nerf.net.trunk.len() && c.last_trunk == Activation::None;
        h = if linear { z.clone() } else { relu(&z) };
        inputs.push(input);
        zs.push(z);
    }
    let z_sigma = affine(&nerf.net.sigma, &h, m)[0];
    let z_feature = affine(&nerf.net.feature, &h, m);
    let feature = if c.feature == Activation::Relu { relu(&z_feature) } else { z_feature.clone() };
    let color_input = c.color_order.join(&feature, &direction);
    let z_color0 = affine(&nerf.net.color0, &color_input, m);
    let color_hidden = relu(&z_color0);
    let z_color1 = affine(&nerf.net.color1, &color_hidden, m);
    Tape { inputs, z: zs, hidden: h, z_sigma, z_feature, color_input, z_color0, color_hidden, z_color1 }
}

/// The NeRF network.
pub(crate) fn nerf_mlp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let nerf = Nerf::of(a, c);
    let point = |(x, d): (&Vec<f64>, &Vec<f64>)| {
        let tape = tape(&nerf, x, d, c, m);
        (density(tape.z_sigma, c.density, m), std::array::from_fn(|k| sigmoid(tape.z_color1[k], m)))
    };
    let (sigmas, rgbs): (Vec<f64>, Vec<_>) =
        rows(a, "positions").iter().zip(&rows(a, "directions")).map(point).unzip();
    field(sigmas, &rgbs)
}

/// Its gradients.
pub(crate) fn nerf_mlp_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let nerf = Nerf::of(a, c);
    let (positions, directions) = (rows(a, "positions"), rows(a, "directions"));
    let mut outer: Vec<Outer> = (0..nerf.net.trunk.len() + 4).map(|_| Outer::default()).collect();
    let mut g_positions = vec![];
    for (i, (g_sigma, g_rgb)) in cotangents(a).into_iter().enumerate() {
        let tape = tape(&nerf, &positions[i], &directions[i], c, m);
        let g_x = point_gradient(&nerf, &tape, c, g_sigma, g_rgb, &mut outer, m);
        g_positions.push(encoding_gradient(&positions[i], &nerf.position, Cosine::Own, &g_x, m));
    }
    let mut gradient = nerf.zeros();
    outer.iter().zip(gradient.layers_mut()).for_each(|(outer, into)| outer.sums(into, m));
    Nerf::gradients(&gradient, &g_positions)
}

fn point_gradient(
    nerf: &Nerf,
    tape: &Tape,
    c: &Conventions,
    g_sigma: f64,
    g_rgb: [f64; 3],
    outer: &mut [Outer],
    m: &Machine,
) -> Vec<f64> {
    let (net, depth) = (&nerf.net, nerf.net.trunk.len());
    let g: Vec<f64> = (0..3).map(|k| m.mul(sigmoid_slope(tape.z_color1[k], m), g_rgb[k])).collect();
    outer[depth + 3].add(&g, &tape.color_hidden);
    let g = masked(&transposed(&net.color1, &g, m), &tape.z_color0);
    outer[depth + 2].add(&g, &tape.color_input);
    let (mut g, _) = c.color_order.split(&transposed(&net.color0, &g, m), net.feature.b.len());
    if c.feature == Activation::Relu {
        g = masked(&g, &tape.z_feature);
    }
    outer[depth + 1].add(&g, &tape.hidden);
    let from_color = transposed(&net.feature, &g, m);
    let slope = match c.density {
        Density::Softplus => sigmoid(tape.z_sigma, m),
        Density::Relu | Density::Exp => m.elementary(density_slope(tape.z_sigma, c.density)),
    };
    let g = vec![m.mul(
        if c.density == Density::Relu { m.round(density_slope(tape.z_sigma, c.density)) } else { slope },
        g_sigma,
    )];
    outer[depth].add(&g, &tape.hidden);
    let from_sigma = transposed(&net.sigma, &g, m);
    let mut g: Vec<f64> = from_color.iter().zip(from_sigma).map(|(&a, b)| m.add(a, b)).collect();
    let mut g_position = vec![0.0; net.trunk[0].w.ncols()];
    for n in (0..depth).rev() {
        let linear = n + 1 == depth && c.last_trunk == Activation::None;
        let g_z = if linear { g } else { masked(&g, &tape.z[n]) };
        outer[n].add(&g_z, &tape.inputs[n]);
        let (g_hidden, g_encoding) =
            Plan::of(c).split(n, &transposed(&net.trunk[n], &g_z, m), g_position.len());
        g_position.iter_mut().zip(g_encoding).for_each(|(g, more)| *g = m.add(more, *g));
        g = g_hidden;
    }
    g_position
}
