//! Error bounds of the networks. The probabilistic model, lambda and the false-alarm probability are in `contract/propagate.rs`.

use super::arrays::{Nerf, cotangents, field, mlp_gradients, network, zeros};
use super::mlp::Mlp;
use super::trunk::{Part, Plan};
use super::{Layer, density, density_slope, sigmoid, sigmoid_slope};
use crate::contract::arithmetic::{Arithmetic, Grade};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::bounded::{Bounded, exact};
use crate::contract::propagate::Vector;
use crate::convention::{Activation, ColorOrder, Conventions, Cosine, Density};
use crate::encoding::bound::{encode, gradient as encoding_gradient};

/// One layer.
fn affine(layer: &Layer, x: &Vector, m: &Arithmetic) -> Vector {
    x.through(&layer.w, Some(&layer.b), m)
}

/// w^T g.
fn transposed(layer: &Layer, g: &Vector, m: &Arithmetic) -> Vector {
    g.through(&layer.w.t().to_owned(), None, m)
}

/// 1 / (1 + e^-z), or e^z / (1 + e^z) where z < 0.
pub(crate) fn sigmoid_of(z: Bounded, m: &Arithmetic) -> Bounded {
    let y = sigmoid(z.y);
    let of = |e: Bounded, above: Bounded| m.div(above, m.add(exact(1.0), e)).e;
    let (down, up) = (m.exp(z.neg()), m.exp(z));
    let textbook = of(down, exact(1.0));
    let other = if z.y - z.e < 0.0 { of(up, up) } else { 0.0 };
    Bounded { y, e: textbook.max(other) }.capped(0.0, 1.0)
}

/// s (1 - s), or sigmoid(z) sigmoid(-z).
pub(crate) fn sigmoid_slope_of(z: Bounded, m: &Arithmetic) -> Bounded {
    let s = sigmoid_of(z, m);
    let product = m.mul(s, m.sub(exact(1.0), s)).e.max(m.mul(s, sigmoid_of(z.neg(), m)).e);
    // Rounding aside, the slope stays within (0, 1/4].
    Bounded { y: sigmoid_slope(z.y), e: product.min(1.0) }
}

/// The density of a head's output.
pub(crate) fn density_of(z: Bounded, activation: Density, m: &Arithmetic) -> Bounded {
    let y = density(z.y, activation);
    match activation {
        Density::Relu if z.y > 0.0 => z,
        Density::Relu => Bounded { y, e: (z.e + z.y).max(0.0) },
        Density::Exp => m.exp(z),
        Density::Softplus => {
            // Slope at most sigmoid(z + e). ln(1 + e^z) rounds 1 + e^z first; the stable form rounds its result.
            let textbook = if m.grade == Grade::B { 2.0 * m.u } else { 0.0 };
            let carried = z.e * sigmoid(z.y + z.e) + textbook;
            let term = m.elementary(y, carried + 16.0 * m.u * y);
            // The textbook form's e^z overflows long before its logarithm does.
            let overflow = m.grade == Grade::B && m.exp(z).e == f64::INFINITY;
            if overflow { Bounded { y, e: f64::INFINITY } } else { m.rounded(y, term.e) }
        }
    }
}

/// Its slope.
pub(crate) fn density_slope_of(z: Bounded, activation: Density, m: &Arithmetic) -> Bounded {
    let y = density_slope(z.y, activation);
    match activation {
        Density::Relu => Bounded { y, e: f64::from(z.e >= z.y.abs() && z.e > 0.0) },
        Density::Softplus => sigmoid_of(z, m),
        Density::Exp => Bounded { y, e: m.exp(z).e },
    }
}

/// The inputs and the pre-activations of every layer, for one point.
struct Tape {
    inputs: Vec<Vector>,
    z: Vec<Vector>,
}

fn mlp_tape(net: &Mlp, x: &[f64], m: &Arithmetic) -> Tape {
    let x: Vec<Bounded> = x.iter().copied().map(exact).collect();
    let mut tape = Tape { inputs: vec![Vector::from_bounded(&x, 0, x.len())], z: vec![] };
    for (n, layer) in net.layers.iter().enumerate() {
        let z = affine(layer, &tape.inputs[n], m);
        tape.inputs.push(z.relu());
        tape.z.push(z);
    }
    tape
}

/// Bound of the plain network.
pub(crate) fn mlp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let net = network(a);
    let point = |x: &Vec<f64>| {
        let tape = mlp_tape(&net, x, m);
        tape.z[net.layers.len() - 1].entries().iter().map(|&z| sigmoid_of(z, m).e).collect()
    };
    let y: Vec<Vec<f64>> = rows(a, "x").iter().map(point).collect();
    arrays([("y", from_rows(&y, net.layers.last().expect("a layer").b.len()))])
}

/// The error of a hidden unit's pre-activation over its distance from the kink: the largest over all units and points. Below 1,
/// honest implementations agree on which units are on, and the gradient is the same function for all of them.
pub fn mlp_kink(a: &Arrays, m: &Arithmetic) -> f64 {
    let net = network(a);
    let hidden = net.layers.len() - 1;
    let point = |x: &Vec<f64>| mlp_tape(&net, x, m).z[..hidden].iter().map(kink).fold(0.0, f64::max);
    rows(a, "x").iter().map(point).fold(0.0, f64::max)
}

/// The same of the NeRF network, whose density may be a ReLU too.
pub fn nerf_mlp_kink(a: &Arrays, c: &Conventions, m: &Arithmetic) -> f64 {
    let nerf = Nerf::of(a, c);
    let point = |(x, d): (&Vec<f64>, &Vec<f64>)| {
        let mut tape = nerf_tape(&nerf, x, d, c, m);
        if c.last_trunk == Activation::None {
            tape.trunk.z.pop();
        }
        let mut units = tape.trunk.z;
        units.push(tape.z_color0);
        units.extend((c.feature == Activation::Relu).then_some(tape.z_feature));
        units.extend((c.density == Density::Relu).then_some(tape.z_sigma));
        units.iter().map(kink).fold(0.0, f64::max)
    };
    rows(a, "positions").iter().zip(&rows(a, "directions")).map(point).fold(0.0, f64::max)
}

/// Error over distance from 0, of a vector's worst entry; infinite at 0 itself.
fn kink(z: &Vector) -> f64 {
    let ratio = |z: Bounded| if z.y == 0.0 { f64::INFINITY } else { z.e / z.y.abs() };
    z.entries().into_iter().map(ratio).fold(0.0, f64::max)
}

/// Sums g_z x^T and g_z over the points, each with its error.
#[derive(Default)]
struct Outer {
    g_z: Vec<Vec<Bounded>>,
    x: Vec<Vec<Bounded>>,
}

impl Outer {
    fn add(&mut self, g_z: &Vector, x: &Vector) {
        self.g_z.push(g_z.entries());
        self.x.push(x.entries());
    }

    fn errors(&self, into: &mut Layer, m: &Arithmetic) {
        let rounded = |b: Bounded| m.rounded(b.y, b.e).e;
        for o in 0..into.b.len() {
            let g: Vec<Bounded> = self.g_z.iter().map(|g| g[o]).collect();
            into.b[o] = rounded(m.sum(&g));
            for i in 0..into.w.ncols() {
                let x: Vec<Bounded> = self.x.iter().map(|x| x[i]).collect();
                into.w[[o, i]] = rounded(m.dot(&g, &x));
            }
        }
    }
}

/// Bound of [`super::backward::mlp`].
pub(crate) fn mlp_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let net = network(a);
    let count = net.layers.len();
    let mut outer: Vec<Outer> = (0..count).map(|_| Outer::default()).collect();
    let mut g_x = vec![];
    for (x, g) in rows(a, "x").iter().zip(&rows(a, "grad_y")) {
        let tape = mlp_tape(&net, x, m);
        let head = tape.z[count - 1].entries();
        let slopes: Vec<Bounded> =
            head.iter().zip(g).map(|(&z, &g)| m.mul(sigmoid_slope_of(z, m), exact(g))).collect();
        let mut g = Vector::from_bounded(&slopes, 0, slopes.len());
        for n in (0..count).rev() {
            let g_z = if n + 1 < count { g.masked(&tape.z[n]) } else { g };
            outer[n].add(&g_z, &tape.inputs[n]);
            g = transposed(&net.layers[n], &g_z, m);
        }
        g_x.push(g.entries().iter().map(|g| g.e).collect());
    }
    let mut errors = zeros(&net.layers);
    outer.iter().zip(&mut errors).for_each(|(outer, into)| outer.errors(into, m));
    mlp_gradients(&errors, &g_x, net.layers[0].w.ncols())
}

/// One point through the NeRF network.
struct NerfTape {
    trunk: Tape,
    hidden: Vector,
    z_sigma: Vector,
    z_feature: Vector,
    color_input: Vector,
    z_color0: Vector,
    color_hidden: Vector,
    z_color1: Vector,
}

fn nerf_tape(nerf: &Nerf, x: &[f64], d: &[f64], c: &Conventions, m: &Arithmetic) -> NerfTape {
    let (x, d) = (encode(x, &nerf.position, Cosine::Own, m), encode(d, &nerf.direction, Cosine::Own, m));
    let sources = x.len() + d.len();
    let direction = Vector::from_bounded(&d, x.len(), sources);
    let encoding = Vector::from_bounded(&x, 0, sources);
    let mut trunk = Tape { inputs: vec![], z: vec![] };
    let mut h = encoding.clone();
    for (n, layer) in nerf.net.trunk.iter().enumerate() {
        let input = Plan::of(c).parts(n).iter().map(|part| match part {
            Part::Encoding => encoding.clone(),
            Part::Hidden => h.clone(),
        });
        let input = input.reduce(|a, b| a.followed_by(&b)).expect("a layer reads something");
        let z = affine(layer, &input, m);
        let linear = n + 1 == nerf.net.trunk.len() && c.last_trunk == Activation::None;
        h = if linear { z.clone() } else { z.relu() };
        trunk.inputs.push(input);
        trunk.z.push(z);
    }
    let z_sigma = affine(&nerf.net.sigma, &h, m);
    let z_feature = affine(&nerf.net.feature, &h, m);
    let feature = if c.feature == Activation::Relu { z_feature.relu() } else { z_feature.clone() };
    let color_input = match c.color_order {
        ColorOrder::FeatureFirst => feature.followed_by(&direction),
        ColorOrder::DirectionFirst => direction.followed_by(&feature),
    };
    let z_color0 = affine(&nerf.net.color0, &color_input, m);
    let color_hidden = z_color0.relu();
    let z_color1 = affine(&nerf.net.color1, &color_hidden, m);
    NerfTape { trunk, hidden: h, z_sigma, z_feature, color_input, z_color0, color_hidden, z_color1 }
}

/// Bound of the NeRF network.
pub(crate) fn nerf_mlp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let nerf = Nerf::of(a, c);
    let point = |(x, d): (&Vec<f64>, &Vec<f64>)| {
        let tape = nerf_tape(&nerf, x, d, c, m);
        let rgb = std::array::from_fn(|k| sigmoid_of(tape.z_color1.entry(k), m).e);
        (density_of(tape.z_sigma.entry(0), c.density, m).e, rgb)
    };
    let (sigmas, rgbs): (Vec<f64>, Vec<_>) =
        rows(a, "positions").iter().zip(&rows(a, "directions")).map(point).unzip();
    field(sigmas, &rgbs)
}

/// Bound of [`super::backward::nerf_mlp`], the encoding's gradient included.
pub(crate) fn nerf_mlp_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let nerf = Nerf::of(a, c);
    let (positions, directions) = (rows(a, "positions"), rows(a, "directions"));
    let depth = nerf.net.trunk.len();
    let mut outer: Vec<Outer> = (0..depth + 4).map(|_| Outer::default()).collect();
    let mut g_positions: Vec<Vec<f64>> = vec![];
    let mut overflow = false;
    for (i, (g_sigma, g_rgb)) in cotangents(a).into_iter().enumerate() {
        let tape = nerf_tape(&nerf, &positions[i], &directions[i], c, m);
        let g_x = nerf_point(&nerf, &tape, c, g_sigma, g_rgb, &mut outer, m);
        let g = encoding_gradient(&positions[i], &nerf.position, Cosine::Own, &g_x, m);
        g_positions.push(g.iter().map(|g| g.e).collect());
        if density_gradient(&tape, c, g_sigma, m).e == f64::INFINITY {
            overflow = true;
            g_positions[i].fill(f64::INFINITY);
        }
    }
    let mut errors = nerf.zeros();
    outer.iter().zip(errors.layers_mut()).for_each(|(outer, into)| outer.errors(into, m));
    if overflow {
        // VR6: e^z leaves f16 at z = 12. Infinity times a closed unit's 0 is NaN, so nothing before the head is bounded.
        errors.trunk.iter_mut().chain([&mut errors.sigma]).for_each(|layer| {
            layer.w.fill(f64::INFINITY);
            layer.b.fill(f64::INFINITY);
        });
    }
    Nerf::gradients(&errors, &g_positions)
}

/// The gradient of the density head's output from the cotangent of the density.
fn density_gradient(tape: &NerfTape, c: &Conventions, g_sigma: f64, m: &Arithmetic) -> Bounded {
    m.mul(density_slope_of(tape.z_sigma.entry(0), c.density, m), exact(g_sigma))
}

/// One point back through the NeRF network: fills `outer` (trunk, sigma, feature, color0, color1) and returns g of the encoding.
fn nerf_point(
    nerf: &Nerf,
    tape: &NerfTape,
    c: &Conventions,
    g_sigma: f64,
    g_rgb: [f64; 3],
    outer: &mut [Outer],
    m: &Arithmetic,
) -> Vec<Bounded> {
    let net = &nerf.net;
    let depth = net.trunk.len();
    let head = tape.z_color1.entries();
    let slopes: Vec<Bounded> =
        head.iter().zip(g_rgb).map(|(&z, g)| m.mul(sigmoid_slope_of(z, m), exact(g))).collect();
    // Four errors that aren't independent: three of the colors, one of the density.
    let g = Vector::from_bounded(&slopes, 0, 4);
    outer[depth + 3].add(&g, &tape.color_hidden);
    let g = transposed(&net.color1, &g, m).masked(&tape.z_color0);
    outer[depth + 2].add(&g, &tape.color_input);
    let features = net.feature.b.len();
    let [begins, _] = c.color_order.begins(features, net.color0.w.ncols() - features);
    let mut g = transposed(&net.color0, &g, m).part(begins, begins + features);
    if c.feature == Activation::Relu {
        g = g.masked(&tape.z_feature);
    }
    outer[depth + 1].add(&g, &tape.hidden);
    let from_color = transposed(&net.feature, &g, m);
    let g = Vector::from_bounded(&[density_gradient(tape, c, g_sigma, m)], 3, 4);
    outer[depth].add(&g, &tape.hidden);
    let mut g = from_color.plus(&transposed(&net.sigma, &g, m), m);
    let columns = net.trunk[0].w.ncols();
    let mut g_position: Option<Vec<Bounded>> = None;
    for n in (0..depth).rev() {
        let linear = n + 1 == depth && c.last_trunk == Activation::None;
        let g_z = if linear { g } else { g.masked(&tape.trunk.z[n]) };
        outer[n].add(&g_z, &tape.trunk.inputs[n]);
        g = transposed(&net.trunk[n], &g_z, m);
        let all = g.y.len();
        let Some(begins) = Plan::of(c).encoding_begins(n, all, columns) else { continue };
        let g_encoding = g.part(begins, begins + columns).entries();
        g_position = Some(match g_position {
            None => g_encoding,
            Some(before) => g_encoding.iter().zip(before).map(|(&g, before)| m.add(g, before)).collect(),
        });
        // The hidden units stand on the other side.
        g = if begins == 0 { g.part(columns, all) } else { g.part(0, begins) };
    }
    g_position.expect("layer 0 reads the encoding")
}
