//! The networks, wrong on purpose. Without a mistake every function equals the oracle.
//!
//! What changes the number of layers or columns (7 or 9 trunk layers, the skip in another layer, the position's bands for the
//! direction) shows in the shapes and has no row here; a ReLU on the feature is a convention.

use super::arrays::{self, Nerf, cotangents, field, mlp_gradients, network, zeros};
use super::trunk::Plan;
use super::{Layer, backward, sigmoid, sigmoid_slope, softplus};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::component::Mistake;
use crate::convention::{Activation, Conventions};
use crate::encoding::{
    backward::positional_encoding as encoding_vjp, mistakes as encoding, positional_encoding,
};
use crate::math::{erf, expm1, sin};

mod catalogue;
mod heads;
pub(crate) mod laws;
mod units;

use catalogue::{LAYER_TWICE, NEVER_APPLIED};
pub(crate) use catalogue::{MLP, NERF_MLP};
use heads::{color, color_unit, feature, head, tanh, wrong_density};
use units::LEAKY_UNITS;

/// Mistakes inside the layers: missing biases, transposed weights, the identity in place of a layer.
fn spoil(mut layers: Vec<&mut Layer>, wrong: &[&str]) {
    let which = |mistake: &Mistake| mistake.among(wrong).map(|layer| layer.round() as usize);
    let alike = |n: &usize| (1..layers.len()).contains(n) && layers[*n].w.dim() == layers[n - 1].w.dim();
    if let Some(n) = which(&LAYER_TWICE).filter(alike) {
        *layers[n - 1] = layers[n].clone();
    }
    let unused = which(&NEVER_APPLIED);
    for (n, layer) in layers.into_iter().enumerate() {
        let square = layer.w.nrows() == layer.w.ncols();
        if wrong.contains(&"bias_forgotten") {
            layer.b.fill(0.0);
        }
        if wrong.contains(&"weights_transposed") && square {
            layer.w = layer.w.t().to_owned();
        }
        // h is not negative, so leaving a layer out equals an identity before the ReLU.
        if square && unused == Some(n) {
            layer.w = ndarray::Array2::eye(layer.w.nrows());
            layer.b.fill(0.0);
        }
    }
}

/// What stands in the place of the ReLU.
fn other_units(wrong: &[&str]) -> Option<impl Fn(f64) -> f64> {
    let slope = LEAKY_UNITS.among(wrong);
    let named = [
        "smooth_units",
        "exponential_units",
        "error_function_units",
        "softplus_units",
        "sine_units",
        "tanh_units",
        "linear_units",
    ];
    let law = named.into_iter().find(|name| wrong.contains(name));
    (law.is_some() || slope.is_some()).then_some(move |z: f64| match slope {
        Some(slope) => {
            if z > 0.0 {
                z
            } else {
                slope * z
            }
        }
        None => match law {
            Some("exponential_units") if z <= 0.0 => expm1(z),
            Some("exponential_units") => z,
            Some("error_function_units") => 0.5 * z * (1.0 + erf(z / std::f64::consts::SQRT_2)),
            Some("softplus_units") => softplus(z),
            Some("sine_units") => sin(z),
            Some("tanh_units") => tanh(z),
            Some("linear_units") => z,
            _ => z * sigmoid(z),
        },
    })
}

/// The plain network.
pub(crate) fn mlp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::mlp(a, c);
    }
    let mut net = network(a);
    spoil(net.layers.iter_mut().collect(), wrong);
    let point = |x: &Vec<f64>| -> Vec<f64> {
        let tape = net.forward(x);
        if let Some(units) = other_units(wrong) {
            let last = net.layers.len() - 1;
            let hidden = net.layers[..last]
                .iter()
                .fold(x.clone(), |h, layer| layer.forward(&h).into_iter().map(&units).collect());
            let z = net.layers[last].forward(&hidden);
            return z.iter().map(|&z| head(z, wrong)).collect();
        }
        tape.z.last().expect("a layer").iter().map(|&z| head(z, wrong)).collect()
    };
    let y: Vec<Vec<f64>> = rows(a, "x").iter().map(point).collect();
    arrays([("y", from_rows(&y, net.layers.last().expect("a layer").b.len()))])
}

/// z for a mask that lets everything through.
fn open(z: &mut [Vec<f64>]) {
    z.iter_mut().for_each(|z| z.fill(1.0));
}

/// Gradient of the plain network.
pub(crate) fn mlp_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let net = network(a);
    let mut gradient = zeros(&net.layers);
    let point = |(x, g): (&Vec<f64>, &Vec<f64>)| {
        let (mut tape, mut g) = (net.forward(x), g.clone());
        let last = tape.z.len() - 1;
        if wrong.contains(&"sigmoid_gradient_missing") {
            g.iter_mut().zip(&tape.z[last]).for_each(|(g, &z)| *g /= sigmoid_slope(z));
        }
        if wrong.contains(&"relu_mask_on_output") {
            open(&mut tape.z[..last]);
        }
        backward::mlp(&net, &tape, &g, &mut gradient)
    };
    let g_x: Vec<Vec<f64>> = rows(a, "x").iter().zip(&rows(a, "grad_y")).map(point).collect();
    mlp_gradients(&gradient, &g_x, net.layers[0].w.ncols())
}

/// Columns of the skip's encoding set to 0.
fn cut_skip(nerf: &mut Nerf, c: &Conventions) {
    let columns = nerf.net.trunk[0].w.ncols();
    for (n, layer) in nerf.net.trunk.iter_mut().enumerate().skip(1) {
        let Some(first) = Plan::of(c).encoding_begins(n, layer.w.ncols(), columns) else { continue };
        layer.w.slice_mut(ndarray::s![.., first..first + columns]).fill(0.0);
    }
}

/// z of both heads of a network whose units are other ones.
fn heads(nerf: &Nerf, x: &[f64], d: &[f64], c: &Conventions, wrong: &[&str]) -> (f64, Vec<f64>) {
    let (net, other) = (&nerf.net, other_units(wrong));
    let unit = |z: &f64| other.as_ref().map_or(z.max(0.0), |unit| unit(*z));
    let mut h = vec![];
    for (n, layer) in net.trunk.iter().enumerate() {
        let z = layer.forward(&Plan::of(c).join(n, &h, x));
        let skip = n > 0 && Plan::of(c).encoding_begins(n, layer.w.ncols(), x.len()).is_some();
        let linear = n + 1 == net.trunk.len() && c.last_trunk == Activation::None
            || n == 0 && wrong.contains(&"first_layer_linear")
            || skip && wrong.contains(&"skip_layer_linear");
        h = if linear { z } else { z.iter().map(unit).collect() };
    }
    let z = net.feature.forward(&h);
    let feature: Vec<f64> = match feature(wrong) {
        Some(unit) => z.into_iter().map(unit).collect(),
        None if c.feature == Activation::Relu => z.iter().map(unit).collect(),
        None => z,
    };
    let z = net.color0.forward(&c.color_order.join(&feature, d));
    let hidden: Vec<f64> = z.iter().map(|z| color_unit(*z, wrong).unwrap_or_else(|| unit(z))).collect();
    (net.sigma.forward(&h)[0], net.color1.forward(&hidden))
}

/// The NeRF network.
pub(crate) fn nerf_mlp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::nerf(a, c);
    }
    let mut nerf = Nerf::of(a, c);
    spoil(nerf.net.layers_mut(), wrong);
    if wrong.contains(&"skip_omitted") {
        cut_skip(&mut nerf, c);
    }
    let point = |(x, d): (&Vec<f64>, &Vec<f64>)| {
        let in_box = |x: &Vec<f64>| x.iter().map(|x| 0.5 * (x + 1.0)).collect::<Vec<f64>>();
        let x = match () {
            () if wrong.contains(&"positions_halved_into_the_box") => in_box(x),
            () if wrong.contains(&"positions_halved") => x.iter().map(|x| 0.5 * x).collect(),
            () => x.clone(),
        };
        let d = if wrong.contains(&"directions_halved_into_the_box") { in_box(d) } else { d.clone() };
        let x = encoding::encode(&x, &nerf.position, wrong);
        let mut d = encoding::encode(&d, &nerf.direction, wrong);
        if wrong.contains(&"no_view_direction") {
            d.fill(0.0);
        }
        let (z, z_color) = heads(&nerf, &x, &d, c, wrong);
        (wrong_density(z, c.density, wrong), color(&z_color, wrong))
    };
    let (sigmas, rgbs): (Vec<f64>, Vec<_>) =
        rows(a, "positions").iter().zip(&rows(a, "directions")).map(point).unzip();
    field(sigmas, &rgbs)
}

/// Gradient of the NeRF network.
pub(crate) fn nerf_mlp_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let nerf = Nerf::of(a, c);
    let mut without_skip = Nerf::of(a, c);
    cut_skip(&mut without_skip, c);
    let (mut gradient, mut unused) = (nerf.zeros(), nerf.zeros());
    let mut g_positions = vec![];
    let (positions, directions) = (rows(a, "positions"), rows(a, "directions"));
    for (m, (g_sigma, mut g_rgb)) in cotangents(a).into_iter().enumerate() {
        let x = positional_encoding(&positions[m], &nerf.position);
        let d = positional_encoding(&directions[m], &nerf.direction);
        let mut tape = nerf.net.forward(&x, &d, c);
        if wrong.contains(&"sigmoid_gradient_missing") {
            (0..3).for_each(|k| g_rgb[k] /= sigmoid_slope(tape.z_color1[k]));
        }
        if wrong.contains(&"relu_mask_on_output") {
            open(&mut tape.z);
            tape.z_color0.fill(1.0);
        }
        let (mut g_x, _) = backward::nerf_mlp(&nerf.net, &tape, c, g_sigma, g_rgb, &mut gradient);
        if wrong.contains(&"skip_gradient_forgotten") {
            g_x = backward::nerf_mlp(&without_skip.net, &tape, c, g_sigma, g_rgb, &mut unused).0;
        }
        g_positions.push(encoding_vjp(&positions[m], &nerf.position, &g_x));
    }
    Nerf::gradients(&gradient, &g_positions)
}
