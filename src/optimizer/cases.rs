//! Cases of Adam's and AdamW's steps: early and late steps, gradients of every size, weights that decay.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats, signed};

fn case(id: &str, comment: &'static str, step: f64, settings: [f64; 3], arrays: [Vec<f64>; 4]) -> Case {
    let [lr, eps, weight_decay] = settings;
    let [params, grad, m, v] = arrays.map(|values| array(&[values.len()], values));
    let scalars = [step, lr, 0.9, 0.999, eps, weight_decay].map(scalar);
    let [step, lr, beta1, beta2, eps, weight_decay] = scalars;
    #[rustfmt::skip]
    let inputs = vec![
        ("params", params), ("grad", grad), ("m", m), ("v", v), ("step", step), ("lr", lr),
        ("beta1", beta1), ("beta2", beta2), ("eps", eps), ("weight_decay", weight_decay),
    ];
    Case::new(id, comment, inputs)
}

/// The same with other betas.
fn with_betas(mut case: Case, beta1: f64, beta2: f64) -> Case {
    case.inputs.insert("beta1".into(), scalar(beta1));
    case.inputs.insert("beta2".into(), scalar(beta2));
    case
}

/// Parameters, gradients and moments of an optimization that runs.
fn drawn(row: &str, stream: u64) -> [Vec<f64>; 4] {
    let mut draw = Draw::new(row, stream);
    let n = 8;
    let params = (0..n).map(|_| draw.between(-1.0, 1.0)).collect();
    let grad = (0..n).map(|_| draw.between(0.5, 4.0) * if draw.below(2) == 0 { 1.0 } else { -1.0 });
    let grad: Vec<f64> = grad.collect();
    let m = (0..n).map(|_| draw.between(-0.5, 0.5)).collect();
    let v = (0..n).map(|_| draw.between(0.25, 2.0)).collect();
    [params, grad, m, v]
}

/// The same before its first step.
fn unmoved([params, grad, m, v]: [Vec<f64>; 4]) -> [Vec<f64>; 4] {
    [params, grad, vec![0.0; m.len()], vec![0.0; v.len()]]
}

/// One step of Adam.
pub(crate) fn adam_step() -> Vec<Case> {
    let running = |stream: u64| drawn("adam_step", stream);
    let fresh = |stream: u64| unmoved(running(stream));
    let usual = [5e-4, 1e-8, 0.0];
    let sizes = vec![1e-300, 1e-150, 1e-30, 1e-12, 1e-8, 1.0, -1e12, 1e150, 0.0];
    let n = sizes.len();
    let cases = vec![
        case("first", "from zero moments: lr sign(g) but for eps", 1.0, usual, fresh(0)),
        case("first_long", "a first step of 1/8", 1.0, [0.125, 1e-8, 0.0], fresh(1)),
        case("second", "the second step", 2.0, [0.125, 1e-8, 0.0], running(2)),
        case("tenth", "moments of a running optimization", 10.0, [0.125, 1e-8, 0.0], running(3)),
        case("thousandth", "the corrections have nearly vanished", 1000.0, [0.0625, 1e-8, 0.0], running(4)),
        case("late", "beta1^step has vanished", 100_000.0, usual, running(5)),
        case("five_thousandth", "beta2^step is still 0.7%", 5_000.0, [0.0625, 1e-8, 0.0], running(8)),
        with_betas(
            case("other_betas", "betas of 1/2 and 0.9", 7.0, [0.125, 1e-8, 0.0], running(9)),
            0.5,
            0.9,
        ),
        with_betas(
            case(
                "long_memory",
                "beta2^step is still 0.37 after 100,000 steps",
                100_000.0,
                [0.0625, 1e-8, 0.0],
                running(10),
            ),
            0.95,
            0.99999,
        ),
        case(
            "weight_decay",
            "coupled: the penalty enters the moments",
            3.0,
            [0.125, 1e-8, 0.0625],
            running(6),
        ),
        case("TR3_eps", "an eps of 1 stands outside the root", 2.0, [0.5, 1.0, 0.0], running(7)),
        case(
            "TR3_beside_eps",
            "squared gradients about the square of eps",
            3.0,
            [0.125, 0.0009765625, 0.0],
            [
                vec![0.5, -0.25, 0.75],
                vec![0.0009765625, -0.001953125, 0.00048828125],
                vec![0.000244140625, 0.0, -0.0001220703125],
                vec![0.00000095367431640625, 0.000000476837158203125, 0.000003814697265625],
            ],
        ),
        case(
            "zero_gradient",
            "the moments still move the parameter",
            5.0,
            [0.125, 1e-8, 0.0],
            [vec![1.0, -0.5], vec![0.0, 0.0], vec![0.25, 0.0], vec![0.5, 0.25]],
        ),
        case(
            "nothing_yet",
            "no gradient, no moments: nothing moves, 0 / eps is 0",
            1.0,
            usual,
            [vec![1.0, -0.5], vec![0.0; 2], vec![0.0; 2], vec![0.0; 2]],
        ),
        case(
            "TR3_every_size",
            "a first step of lr whatever the gradient's size, until eps outweighs it",
            1.0,
            usual,
            [vec![1.0; n], sizes, vec![0.0; n], vec![0.0; n]],
        ),
        case(
            "TR3_tiny",
            "gradients of 2^-12: their squares are subnormal in f16",
            1.0,
            [0.125, 1e-8, 0.0],
            [vec![0.5; 2], vec![0.000244140625, -0.000244140625], vec![0.0; 2], vec![0.0; 2]],
        ),
    ];
    let mut cases = in_full(cases, "second");
    let odd = running(11).map(|values| values[..7].to_vec());
    cases.push(case(
        "odd_count",
        "seven parameters: the last one stands alone",
        2.0,
        [0.125, 1e-8, 0.0],
        odd,
    ));
    cases
}

/// One step of AdamW.
pub(crate) fn adamw_step() -> Vec<Case> {
    let running = |stream: u64| drawn("adamw_step", stream);
    let cases = vec![
        case("first", "from zero moments", 1.0, [0.125, 1e-8, 0.0625], unmoved(running(0))),
        case(
            "second",
            "the second step, and a decay of a quarter of lr",
            2.0,
            [0.125, 1e-8, 0.25],
            running(1),
        ),
        case("tenth", "moments of a running optimization", 10.0, [0.0625, 1e-8, 1.0], running(2)),
        case("no_decay", "a decay of 0: Adam's step", 3.0, [0.125, 1e-8, 0.0], running(3)),
        case("usual", "torch's decay of 0.01", 1000.0, [0.001, 1e-8, 0.01], running(4)),
        case("strong", "a decay that takes a quarter of every parameter", 5.0, [0.5, 1e-8, 0.5], running(5)),
        with_betas(
            case("other_betas", "betas of 1/2 and 0.9", 7.0, [0.125, 1e-8, 0.125], running(6)),
            0.5,
            0.9,
        ),
        case("TR3_eps", "an eps of 1 stands outside the root", 2.0, [0.5, 1.0, 0.125], running(7)),
        case(
            "TR3_beside_eps",
            "squared gradients about the square of eps",
            3.0,
            [0.125, 0.0009765625, 0.25],
            [
                vec![0.5, -0.25, 0.75],
                vec![0.0009765625, -0.001953125, 0.00048828125],
                vec![0.000244140625, 0.0, -0.0001220703125],
                vec![0.00000095367431640625, 0.000000476837158203125, 0.000003814697265625],
            ],
        ),
        case(
            "decay_alone",
            "no gradient and no moments: the decay alone moves",
            1.0,
            [0.125, 1e-8, 0.5],
            [vec![1.0, -0.5, 4.0], vec![0.0; 3], vec![0.0; 3], vec![0.0; 3]],
        ),
        case(
            "nothing_to_decay",
            "parameters of 0 beside others",
            4.0,
            [0.125, 1e-8, 0.25],
            [vec![0.0, 0.0, 0.5], vec![1.0, -2.0, 0.5], vec![0.25, 0.0, -0.125], vec![0.5, 0.25, 1.0]],
        ),
    ];
    in_full(cases, "second")
}

/// Parameters late in a training.
fn late(large: Large, weight_decay: f64) -> Large {
    let n = large.items;
    let large = large.with("params", &[n], signed(-6, 6)).with("grad", &[n], signed(-10, 8));
    let large = large.with("m", &[n], signed(-10, 8)).with("v", &[n], floats(-12, 10));
    let scalars = [
        ("step", 1000.0),
        ("lr", 1e-3),
        ("beta1", 0.9),
        ("beta2", 0.999),
        ("eps", 1e-8),
        ("weight_decay", weight_decay),
    ];
    scalars.into_iter().fold(large, |large, (name, x)| large.with(name, &[], Recipe::Constant(x)))
}

/// More parameters than a million.
pub(crate) fn large() -> Vec<Large> {
    let n = 1_000_003;
    vec![late(Large::new("parameters_1000003", "10^6 + 3 parameters, step 1,000", n, 1 << 15), 0.0)]
}

/// More parameters than 16 bits count, which decay.
pub(crate) fn large_decayed() -> Vec<Large> {
    let n = 100_003;
    vec![late(Large::new("parameters_100003", "100,003 parameters, step 1,000", n, 1 << 13), 0.01)]
}
