//! The networks, wrong on purpose. Without a mistake every function equals the oracle.
//!
//! What changes the number of layers or columns (7 or 9 trunk layers, the skip in another layer, the position's bands for the
//! direction) shows in the shapes and has no row here; a ReLU on the feature is a convention.

use super::arrays::{self, Nerf, cotangents, field, mlp_gradients, network, zeros};
use super::trunk::Plan;
use super::{Layer, backward, sigmoid, sigmoid_slope};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::encoding::{
    backward::positional_encoding as encoding_vjp, mistakes as encoding, positional_encoding,
};

const SIGMOID_MISSING: Mistake = Mistake::new(
    "sigmoid_missing",
    "the color head's output is handed over as it is",
    "colors below 0 and above 1",
    "1 / (1 + e^-z)",
    "never; cheap to keep",
    0,
);
const RELU_BEFORE_SIGMOID: Mistake = Mistake::new(
    "relu_before_sigmoid",
    "the last layer has a ReLU too: sigmoid(max(z, 0))",
    "no color is darker than 1/2",
    "no ReLU after the last layer",
    "never; cheap to keep",
    0,
);
const BIAS_FORGOTTEN: Mistake = Mistake::new(
    "bias_forgotten",
    "z = w x",
    "black can't be learned",
    "z = w x + b",
    "never; cheap to keep",
    0,
);
const TRANSPOSED: Mistake = Mistake::new(
    "weights_transposed",
    "x w for w x in square layers",
    "parameters of another framework give noise",
    "transpose when loading (JAX and Keras keep (in, out))",
    "weight conversions",
    0,
);
const NEVER_APPLIED: Mistake = Mistake::new(
    "layer_never_applied",
    "a square layer is built but left out of forward",
    "a smaller network; the layer has no gradient",
    "call every layer",
    "2 public implementations",
    2,
);
const SIGMOID_GRADIENT: Mistake = Mistake::new(
    "sigmoid_gradient_missing",
    "the gradient passes the sigmoid unchanged",
    "dark and bright colors overshoot",
    "multiply by y (1 - y)",
    "hand-written backward passes",
    0,
)
.of_gradient();
const RELU_MASK: Mistake = Mistake::new(
    "relu_mask_on_output",
    "the mask asks max(z, 0) >= 0, which always holds",
    "dead units are trained as if they were alive",
    "mask by z > 0",
    "hand-written backward passes",
    0,
)
.of_gradient();

const LEAKY_UNITS: Mistake = Mistake::new(
    "leaky_units",
    "LeakyReLU in the hidden layers: k z below 0",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "3 public implementations",
    3,
)
.with("k", 0.01, [1e-6, 1.0]);
const SMOOTH_UNITS: Mistake = Mistake::new(
    "smooth_units",
    "SiLU in the hidden layers: z / (1 + e^-z)",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "2 public implementations",
    2,
);

/// Mistakes of the plain network.
pub(crate) const MLP: &[Mistake] = &[
    SIGMOID_MISSING,
    RELU_BEFORE_SIGMOID,
    BIAS_FORGOTTEN,
    TRANSPOSED,
    NEVER_APPLIED,
    LEAKY_UNITS,
    SMOOTH_UNITS,
    SIGMOID_GRADIENT,
    RELU_MASK,
];

/// Mistakes of the NeRF network.
pub(crate) const NERF_MLP: &[Mistake] = &[
    encoding::POSITIONAL_ENCODING[0],
    SIGMOID_MISSING,
    RELU_BEFORE_SIGMOID,
    BIAS_FORGOTTEN,
    TRANSPOSED,
    NEVER_APPLIED,
    Mistake::new(
        "skip_omitted",
        "the encoding isn't concatenated again (zeros stand in its place)",
        "blurred detail",
        "[h, encoding] into the fifth layer",
        "2 public implementations",
        2,
    ),
    Mistake::new(
        "no_view_direction",
        "the direction never reaches the color layer",
        "no highlights: a point looks the same from everywhere",
        "[feature, encoded direction] into the color layer",
        "3 public implementations",
        3,
    ),
    Mistake::new(
        "density_without_relu",
        "the density head's output is handed over as it is: it may be negative",
        "opacities below 0 where nobody takes a ReLU later",
        "max(z, 0)",
        "3 public implementations",
        3,
    ),
    SIGMOID_GRADIENT,
    RELU_MASK,
    Mistake::new(
        "skip_gradient_forgotten",
        "the gradient of the encoding comes through the first layer alone",
        "poses are refined with half of the gradient",
        "add the skip's part",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
];

/// Mistakes inside the layers: missing biases, transposed weights, the identity in place of a layer.
fn spoil(layers: Vec<&mut Layer>, unused: usize, wrong: &[&str]) {
    for (n, layer) in layers.into_iter().enumerate() {
        let square = layer.w.nrows() == layer.w.ncols();
        if wrong.contains(&"bias_forgotten") {
            layer.b.fill(0.0);
        }
        if wrong.contains(&"weights_transposed") && square {
            layer.w = layer.w.t().to_owned();
        }
        // h is not negative, so leaving a layer out equals an identity before the ReLU.
        if wrong.contains(&"layer_never_applied") && square && n == unused {
            layer.w = ndarray::Array2::eye(layer.w.nrows());
            layer.b.fill(0.0);
        }
    }
}

/// y, or what is returned instead.
fn head(y: f64, z: f64, wrong: &[&str]) -> f64 {
    let relu = wrong.contains(&"relu_before_sigmoid");
    match (wrong.contains(&"sigmoid_missing"), relu && z < 0.0) {
        (true, true) => 0.0,
        (true, false) => z,
        (false, true) => 0.5,
        (false, false) => y,
    }
}

/// What stands in the place of the ReLU.
fn units(wrong: &[&str]) -> Option<impl Fn(f64) -> f64> {
    let slope = LEAKY_UNITS.among(wrong);
    let smooth = wrong.contains(&"smooth_units");
    (smooth || slope.is_some()).then_some(move |z: f64| match slope {
        Some(slope) => {
            if z > 0.0 {
                z
            } else {
                slope * z
            }
        }
        None => z * sigmoid(z),
    })
}

/// The plain network.
pub(crate) fn mlp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::mlp(a, c);
    }
    let mut net = network(a);
    spoil(net.layers.iter_mut().collect(), 1, wrong);
    let point = |x: &Vec<f64>| {
        let tape = net.forward(x);
        if let Some(units) = units(wrong) {
            let last = net.layers.len() - 1;
            let hidden = net.layers[..last]
                .iter()
                .fold(x.clone(), |h, layer| layer.forward(&h).into_iter().map(&units).collect());
            let z = net.layers[last].forward(&hidden);
            return z.iter().map(|&z| head(sigmoid(z), z, wrong)).collect();
        }
        let z = tape.z.last().expect("a layer");
        tape.y.iter().zip(z).map(|(&y, &z)| head(y, z, wrong)).collect()
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

/// The NeRF network.
pub(crate) fn nerf_mlp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::nerf(a, c);
    }
    let mut nerf = Nerf::of(a, c);
    spoil(nerf.net.layers_mut(), 1, wrong);
    if wrong.contains(&"skip_omitted") {
        cut_skip(&mut nerf, c);
    }
    let point = |(x, d): (&Vec<f64>, &Vec<f64>)| {
        let x = encoding::encode(x, &nerf.position, wrong);
        let mut d = encoding::encode(d, &nerf.direction, wrong);
        if wrong.contains(&"no_view_direction") {
            d.fill(0.0);
        }
        let tape = nerf.net.forward(&x, &d, c);
        let sigma = if wrong.contains(&"density_without_relu") { tape.z_sigma } else { tape.sigma };
        (sigma, std::array::from_fn(|k| head(tape.rgb[k], tape.z_color1[k], wrong)))
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
