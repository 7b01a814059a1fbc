//! Laws of the NeRF network: what the heads read, what their units are, and what becomes of positions and directions before.

use super::super::arrays::{Nerf, field, nerf};
use super::super::trunk::Plan;
use super::super::{density, sigmoid, softplus};
use super::heads::tanh;
use crate::contract::arrays::{Arrays, rows};
use crate::contract::laws::Laws;
use crate::convention::{Activation, Conventions};
use crate::encoding::positional_encoding;
use crate::math::{exp, expm1};

/// What the density is read from.
const DENSITY_OF: [&str; 5] = [
    "the trunk",
    "the feature layer",
    "the first unit of the trunk, without a layer of its own",
    "the first unit of the feature layer",
    "the trunk in front of its last layer",
];

/// What the color is read from.
const COLOR_OF: [&str; 4] = [
    "the feature layer",
    "the trunk, the feature layer left out",
    "the feature layer through a ReLU",
    "the feature layer without direction",
];

/// The density's unit.
const DENSITY: [&str; 14] = [
    "as it is by convention",
    "z",
    "max(0, z)",
    "softplus(z)",
    "softplus(z - 1)",
    "exp(z)",
    "sigmoid(z)",
    "|z|",
    "z^2",
    "max(0, z) + 0.1",
    "z + 0.1",
    "elu(z)",
    "max(z, z / 100)",
    "1 - exp(-max(0, z))",
];

/// The color's unit.
const COLOR: [&str; 9] = [
    "sigmoid(z)",
    "z",
    "max(0, z)",
    "z held between 0 and 1",
    "tanh(z)",
    "(tanh(z) + 1) / 2",
    "softmax(z)",
    "1.002 sigmoid(z) - 0.001",
    "1.2 (sigmoid(z) - 1/2) + 1/2",
];

/// What positions are.
const POSITIONS: [&str; 5] = ["as they are", "(x + 1) / 2", "2 x - 1", "x / 2", "x over its length"];

/// What directions are.
const DIRECTIONS: [&str; 5] = ["as they are", "d over its length", "-d", "(d + 1) / 2", "0"];

/// The unit between layers.
const UNIT: [&str; 6] = [
    "max(0, z)",
    "softplus(z)",
    "max(z, z / 100)",
    "z sigmoid(z)",
    "elu(z)",
    "max(0, z), but for the layer in front of the color's last",
];

/// Those of the network.
pub(crate) const OF_NETWORKS: Laws = Laws {
    choices: &[
        DENSITY_OF.len(),
        COLOR_OF.len(),
        DENSITY.len(),
        COLOR.len(),
        POSITIONS.len(),
        DIRECTIONS.len(),
        UNIT.len(),
    ],
    says: |part, choice| match part {
        0 => format!("the density of {}", DENSITY_OF[choice]),
        1 => format!("the color of {}", COLOR_OF[choice]),
        2 => format!("sigma = {}", DENSITY[choice]),
        3 => format!("c = {}", COLOR[choice]),
        4 => format!("positions {}", POSITIONS[choice]),
        5 => format!("directions {}", DIRECTIONS[choice]),
        _ => format!("{} between layers", UNIT[choice]),
    },
    of,
    rounding: &[],
};

fn over_its_length(x: &[f64]) -> Vec<f64> {
    let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    x.iter().map(|x| x / length).collect()
}

fn position(x: &[f64], choice: usize) -> Vec<f64> {
    match choice {
        0 => x.to_vec(),
        1 => x.iter().map(|x| 0.5 * (x + 1.0)).collect(),
        2 => x.iter().map(|x| 2.0 * x - 1.0).collect(),
        3 => x.iter().map(|x| 0.5 * x).collect(),
        _ => over_its_length(x),
    }
}

fn direction(d: &[f64], choice: usize) -> Vec<f64> {
    match choice {
        0 => d.to_vec(),
        1 => over_its_length(d),
        2 => d.iter().map(|d| -d).collect(),
        3 => d.iter().map(|d| 0.5 * (d + 1.0)).collect(),
        _ => vec![0.0; d.len()],
    }
}

fn unit(z: f64, choice: usize) -> f64 {
    match choice {
        1 => softplus(z),
        2 => z.max(0.01 * z),
        3 => z * sigmoid(z),
        4 => z.max(expm1(z.min(0.0))),
        _ => z.max(0.0),
    }
}

fn sigma(z: f64, c: &Conventions, choice: usize) -> f64 {
    match choice {
        0 => density(z, c.density),
        1 => z,
        2 => z.max(0.0),
        3 => softplus(z),
        4 => softplus(z - 1.0),
        5 => exp(z),
        6 => sigmoid(z),
        7 => z.abs(),
        8 => z * z,
        9 => z.max(0.0) + 0.1,
        10 => z + 0.1,
        11 => z.max(expm1(z.min(0.0))),
        12 => z.max(0.01 * z),
        _ => -expm1(-z.max(0.0)),
    }
}

fn color(z: &[f64], choice: usize) -> [f64; 3] {
    let all: f64 = z.iter().map(|z| exp(*z)).sum();
    std::array::from_fn(|k| match choice {
        0 => sigmoid(z[k]),
        1 => z[k],
        2 => z[k].max(0.0),
        3 => z[k].clamp(0.0, 1.0),
        4 => tanh(z[k]),
        5 => 0.5 * (tanh(z[k]) + 1.0),
        6 => exp(z[k]) / all,
        7 => 1.002 * sigmoid(z[k]) - 0.001,
        _ => 1.2 * (sigmoid(z[k]) - 0.5) + 0.5,
    })
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law.iter().all(|choice| *choice == 0) {
        return nerf(a, c);
    }
    let nerf = Nerf::of(a, c);
    let between = |z: Vec<f64>| -> Vec<f64> { z.into_iter().map(|z| unit(z, law[6])).collect() };
    let point = |(x, d): (&Vec<f64>, &Vec<f64>)| {
        let x = positional_encoding(&position(x, law[4]), &nerf.position);
        let mut d = positional_encoding(&direction(d, law[5]), &nerf.direction);
        let (mut h, mut before) = (vec![], vec![]);
        for (n, layer) in nerf.net.trunk.iter().enumerate() {
            let z = layer.forward(&Plan::of(c).join(n, &h, &x));
            let linear = n + 1 == nerf.net.trunk.len() && c.last_trunk == Activation::None;
            before = std::mem::replace(&mut h, if linear { z } else { between(z) });
        }
        let z = nerf.net.feature.forward(&h);
        let feature = if c.feature == Activation::Relu { between(z) } else { z };
        let read = match law[1] {
            1 => h.clone(),
            2 => feature.iter().map(|z| z.max(0.0)).collect(),
            _ => feature.clone(),
        };
        if law[1] == 3 {
            d.fill(0.0);
        }
        let hidden = nerf.net.color0.forward(&c.color_order.join(&read, &d));
        let hidden = if law[6] == 5 { hidden } else { between(hidden) };
        let z = match law[0] {
            0 => nerf.net.sigma.forward(&h)[0],
            1 => nerf.net.sigma.forward(&feature)[0],
            2 => h[0],
            3 => feature[0],
            _ => nerf.net.sigma.forward(&before)[0],
        };
        (sigma(z, c, law[2]), color(&nerf.net.color1.forward(&hidden), law[3]))
    };
    let (sigmas, rgbs): (Vec<f64>, Vec<_>) =
        rows(a, "positions").iter().zip(&rows(a, "directions")).map(point).unzip();
    field(sigmas, &rgbs)
}
