//! Cases of the training step: networks of eight layers of four units and short encodings, one step and ten.

use ndarray::ArrayD;

use super::arrays::usual;
use crate::contract::arrays::{Arrays, array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::convention::{CS180, Conventions};
use crate::field::cases as network;
use crate::field::cases::{BIAS, GAIN, LAST_GAIN, layer, passing_on};
use crate::field::nerf_mlp::Shape;

/// Sizes of the network: one band each, so that the skip's layer has 13 columns.
const SHAPE: Shape = Shape { position: 9, direction: 9, width: 4, depth: 8, color: 4 };

/// Rays and samples.
const SIZE: [usize; 2] = [2, 3];

/// Adam's hyper-parameters and the learning rate of the first step.
struct Rates {
    lr: f64,
    /// Each step's over that of the step before.
    decay: f64,
    betas: [f64; 2],
    eps: f64,
    weight_decay: f64,
}

const USUAL: Rates = Rates { lr: 0.0078125, decay: 1.0, betas: [0.9, 0.999], eps: 1e-8, weight_decay: 0.0 };

fn case(
    id: &str,
    comment: &'static str,
    stream: u64,
    steps: usize,
    [rays, samples]: [usize; 2],
    rates: &Rates,
) -> Case {
    let mut draw = Draw::new("training_step", stream);
    let per_ray = [steps, rays, 3];
    let lr = (0..steps).map(|k| crate::contract::case::short(rates.lr * rates.decay.powi(k as i32)));
    let inputs = vec![
        ("rays_o", draw.array(&per_ray, -0.5, 0.5)),
        ("rays_d", draw.array(&per_ray, 0.25, 0.75)),
        ("directions", draw.array(&per_ray, -0.75, 0.75)),
        ("u", draw.array(&[steps, rays, samples], 0.02, 0.95)),
        ("target", draw.array(&per_ray, 0.05, 1.0)),
        ("near", scalar(0.5)),
        ("far", scalar(2.0)),
        ("lr", array(&[steps], lr.collect())),
        ("beta1", scalar(rates.betas[0])),
        ("beta2", scalar(rates.betas[1])),
        ("eps", scalar(rates.eps)),
        ("weight_decay", scalar(rates.weight_decay)),
    ];
    let mut case = Case::new(id, comment, inputs);
    for (name, inputs, outputs, bias) in layers() {
        let [w, b] = layer(&mut draw, inputs, outputs, bias);
        case.inputs.insert(format!("{name}_w"), w);
        case.inputs.insert(format!("{name}_b"), b);
    }
    // A density head that is on.
    case.inputs.insert("sigma_b".into(), array(&[1], vec![1.5]));
    case
}

/// Name, columns, rows and size of the biases of each layer.
fn layers() -> Vec<(String, usize, usize, f64)> {
    let Shape { direction, width, depth, color, .. } = SHAPE;
    let mut layers: Vec<_> =
        (0..depth).map(|n| (format!("trunk{n}"), SHAPE.trunk_inputs(n, &CS180), width, 1.0)).collect();
    layers.push(("sigma".into(), width, 1, 0.5));
    layers.push(("feature".into(), width, width, 0.25));
    layers.push(("color0".into(), width + direction, color, 1.0));
    layers.push(("color1".into(), color, 3, 0.25));
    layers
}

/// A step in which sums are of one product each, gradients are large, and moments remember half: what short types tell.
fn passing() -> Case {
    let comment = "every unit passes on one of the layer below: a step keeps its digits in every type";
    let rates = Rates { betas: [0.5, 0.5], lr: 0.0625, eps: 0.0009765625, ..USUAL };
    let mut case = case("passing_on", comment, 5, 1, [1, 2], &rates);
    let mut draw = Draw::new("training_step", 6);
    for (name, array) in case.inputs.iter_mut() {
        let first = match name.as_str() {
            "trunk0_w" => (0, 3),
            "color0_w" => (2, 5),
            _ => (0, 4),
        };
        if name.ends_with("_w") {
            let gain = if name == "color1_w" || name == "sigma_w" { LAST_GAIN } else { GAIN };
            *array = passing_on([array.shape()[0], array.shape()[1]], first.0, first.1, gain);
        } else if name.ends_with("_b") {
            array.fill(match name.as_str() {
                "trunk0_b" => 0.5,
                "sigma_b" => 2.0,
                _ => BIAS,
            });
        }
    }
    let shape = case.inputs["target"].shape().to_vec();
    // Colors far from those of any field: the difference keeps its digits.
    case.inputs.insert("target".into(), ArrayD::from_elem(shape, -4.0));
    for name in ["rays_o", "directions"] {
        let positive = draw.array(&[1, 1, 3], 0.25, 0.5);
        case.inputs.insert(name.into(), positive);
    }
    // Points next to the origins, whatever the digits of t.
    case.inputs.insert("rays_d".into(), ArrayD::from_elem(vec![1, 1, 3], 0.0625));
    case
}

/// One step and more.
pub(crate) fn training_step() -> Vec<Case> {
    // With an eps of 1e-8 a step is little more than the sign of the gradient, and ten of them multiply errors by 10^13 in the worst
    // case: bounds would be vacuous. An eps of the gradient's size keeps them sharp in f64. In f32 most of what is left after ten
    // steps goes untold even so: there, the four steps of `schedule` tell.
    let smooth = Rates { lr: 0.015625, eps: 0.0625, ..USUAL };
    let schedule = Rates { lr: 0.03125, decay: 0.75, betas: [0.75, 0.9], eps: 0.0625, weight_decay: 0.0625 };
    let cases = vec![
        case("one_step", "from moments of 0: lr sign(g) but for eps", 0, 1, SIZE, &USUAL),
        case(
            "ten_steps",
            "ten steps, each with its rays and draws, and an eps that weighs",
            1,
            10,
            SIZE,
            &smooth,
        ),
        case("usual_eps", "three steps with an eps of 1e-8", 3, 3, SIZE, &USUAL),
        case(
            "schedule",
            "rates that fall, an eps that weighs, other betas, coupled weight decay",
            2,
            4,
            SIZE,
            &schedule,
        ),
        passing(),
    ];
    in_full(in_full(cases, "one_step"), "ten_steps")
}

/// As the network's own cases: the layers that read the encoding again change places.
pub(crate) fn reshape(inputs: &mut Arrays, c: &Conventions) {
    network::reshape(inputs, &usual(c));
}

/// Whether the network's widths are those of these conventions.
pub(crate) fn admits(inputs: &Arrays, c: &Conventions) -> bool {
    network::fits(inputs, &usual(c))
}
