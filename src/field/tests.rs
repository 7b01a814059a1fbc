use ndarray::{arr1, arr2};
use proptest::prelude::*;

use super::mlp::Output;
use super::nerf_mlp::Shape;
use super::*;
use crate::contract::testing::{properties, slope};
use crate::convention::{Activation, CS180, ColorOrder, Conventions, SkipOrder};
use crate::random::Purpose;

const SHAPE: Shape = Shape { position: 5, direction: 3, width: 4, depth: 8, color: 3 };

fn net(seed: u64) -> NerfMlp {
    NerfMlp::initial(&SHAPE, &CS180, &Key::new(seed, Purpose::Parameters))
}

#[test]
fn a_layer_by_hand() {
    let layer = Layer { w: arr2(&[[1.0, 2.0, -1.0], [0.5, 0.0, 4.0]]), b: arr1(&[0.25, -1.0]) };
    assert_eq!(layer.forward(&[1.0, 2.0, 3.0]), [2.25, 11.5]);
    let mut gradient = Layer::zeros(3, 2);
    for repeat in [1.0, 2.0] {
        let g_x = backward::layer(&layer, &[1.0, 2.0, 3.0], &[1.0, -2.0], &mut gradient);
        assert_eq!(g_x, [0.0, 2.0, -9.0]);
        // Gradients add up over points.
        assert_eq!(gradient.w, repeat * arr2(&[[1.0, 2.0, 3.0], [-2.0, -4.0, -6.0]]));
        assert_eq!(gradient.b, repeat * arr1(&[1.0, -2.0]));
    }
}

#[test]
fn activations_at_their_extremes() {
    assert_eq!(relu(&[-1.0, -0.0, 0.0, 2.0]).map_bits(), [0.0, 0.0, 0.0, 2.0].map(f64::to_bits));
    assert!(
        relu(&[f64::NAN])[0].is_nan() && density(f64::NAN, Density::Relu).is_nan(),
        "a NaN stays visible"
    );
    assert_eq!([-750.0, -40.0, 40.0, 1e300].map(softplus), [0.0, exp(-40.0), 40.0, 1e300]);
    assert!((softplus(0.0) - std::f64::consts::LN_2).abs() < 1e-16 * 2.0);
    assert_eq!((sigmoid(-745.0), sigmoid_slope(800.0), sigmoid_slope(0.0)), (exp(-745.0), 0.0, 0.25));
    // s (1 - s) written so loses every digit at z = 40; sigmoid(-z) keeps them.
    assert!(
        (sigmoid_slope(40.0) / exp(-40.0) - 1.0).abs() < 1e-15 * 2.0
            && sigmoid(40.0) * (1.0 - sigmoid(40.0)) == 0.0
    );
    assert_eq!([-2.0, 3.0].map(|z| density(z, Density::Relu)), [0.0, 3.0]);
    assert_eq!([-2.0, 0.0, 3.0].map(|z| density_slope(z, Density::Relu)), [0.0, 0.0, 1.0]);
    // At its kink a ReLU passes no gradient, for the density or inside of the trunk.
    assert_eq!(backward::relu(&[-1e-300, 0.0, -0.0, 1e-300], &[1.0; 4]), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!([density(1.5, Density::Softplus), density(1.5, Density::Exp)], [softplus(1.5), exp(1.5)]);
    assert_eq!(
        [density_slope(1.5, Density::Softplus), density_slope(1.5, Density::Exp)],
        [sigmoid(1.5), exp(1.5)]
    );
}

/// The slope with steps so short that no ReLU opens or closes on the way.
fn short_slope(f: impl Fn(f64) -> f64) -> f64 {
    slope(|h| 1024.0 * f(h / 1024.0))
}

/// All parameters of layers in one row.
fn flat(layers: &[&Layer]) -> Vec<f64> {
    layers.iter().flat_map(|layer| layer.w.iter().chain(&layer.b).copied()).collect()
}

/// Adds h to parameter n.
fn nudge(layers: Vec<&mut Layer>, n: usize, h: f64) {
    *layers
        .into_iter()
        .flat_map(|layer| layer.w.iter_mut().chain(&mut layer.b))
        .nth(n)
        .expect("a parameter") += h;
}

#[test]
fn gradients_of_the_plain_network() {
    for output in [Output::Linear, Output::Sigmoid] {
        let mlp = Mlp { output, ..Mlp::initial(3, 5, 2, 2, &Key::new(11, Purpose::Parameters)) };
        let (x, g) = ([0.5, -0.25, 0.75], [0.75, -1.25]);
        let pulled = |mlp: &Mlp, x: &[f64]| mlp.forward(x).y.iter().zip(g).map(|(y, g)| y * g).sum::<f64>();
        let mut gradient: Vec<Layer> =
            mlp.layers.iter().map(|l| Layer::zeros(l.w.ncols(), l.w.nrows())).collect();
        let g_x = backward::mlp(&mlp, &mlp.forward(&x), &g, &mut gradient);
        for (n, by_hand) in flat(&gradient.iter().collect::<Vec<_>>()).into_iter().enumerate() {
            let moved = |h: f64| {
                let mut mlp = mlp.clone();
                nudge(mlp.layers.iter_mut().collect(), n, h);
                pulled(&mlp, &x)
            };
            assert!((by_hand - short_slope(moved)).abs() < 1e-9, "{output:?}: parameter {n}");
        }
        for d in 0..3 {
            let moved = |h: f64| {
                let mut x = x;
                x[d] += h;
                pulled(&mlp, &x)
            };
            assert!((g_x[d] - short_slope(moved)).abs() < 1e-9, "{output:?}: x {d}");
        }
    }
}

#[test]
fn gradients_of_the_nerf_network_in_every_convention() {
    let (x, d, g_sigma, g_rgb) = ([0.3, -0.2, 0.9, 0.5, -0.7], [0.1, 0.8, -0.6], 0.75, [1.0, -0.5, 0.25]);
    let mut net = net(5);
    net.sigma.b.fill(1.0);
    let others = [
        CS180,
        Conventions { density: Density::Softplus, skip_order: SkipOrder::EncodingFirst, ..CS180 },
        Conventions { density: Density::Exp, last_trunk: Activation::None, ..CS180 },
        Conventions { feature: Activation::Relu, ..CS180 },
        Conventions { feature: Activation::Relu, color_order: ColorOrder::DirectionFirst, ..CS180 },
    ];
    for c in others {
        let pulled = |net: &NerfMlp, x: &[f64], d: &[f64]| {
            let tape = net.forward(x, d, &c);
            g_sigma * tape.sigma + (0..3).map(|k| g_rgb[k] * tape.rgb[k]).sum::<f64>()
        };
        let mut gradient = net.clone();
        for layer in gradient.layers_mut() {
            *layer = Layer::zeros(layer.w.ncols(), layer.w.nrows());
        }
        let (g_x, g_d) =
            backward::nerf_mlp(&net, &net.forward(&x, &d, &c), &c, g_sigma, g_rgb, &mut gradient);
        let layers: Vec<&Layer> = gradient.layers().into_iter().map(|(_, layer)| layer).collect();
        for (n, by_hand) in flat(&layers).into_iter().enumerate() {
            let moved = |h: f64| {
                let mut net = net.clone();
                nudge(net.layers_mut(), n, h);
                pulled(&net, &x, &d)
            };
            assert!(
                (by_hand - short_slope(moved)).abs() < 1e-9,
                "{c:?}: parameter {n}: {by_hand} {}",
                short_slope(moved)
            );
        }
        for n in 0..8 {
            let moved = |h: f64| {
                let (mut x, mut d) = (x, d);
                *(x.iter_mut().chain(&mut d).nth(n).expect("an entry")) += h;
                pulled(&net, &x, &d)
            };
            let by_hand = if n < 5 { g_x[n] } else { g_d[n - 5] };
            assert!((by_hand - short_slope(moved)).abs() < 1e-9, "{c:?}: input {n}");
        }
    }
}

trait Bits {
    fn map_bits(&self) -> Vec<u64>;
}

impl Bits for Vec<f64> {
    fn map_bits(&self) -> Vec<u64> {
        self.iter().map(|x| x.to_bits()).collect()
    }
}

#[test]
fn initial_values_are_uniform_within_one_over_the_root_of_the_inputs() {
    let key = Key::new(3, Purpose::Parameters);
    let layer = Layer::initial(100, 50, &key, 2);
    let values: Vec<f64> = layer.w.iter().chain(&layer.b).copied().collect();
    assert!(values.iter().all(|v| v.abs() <= 0.1) && values.iter().any(|v| v.abs() > 0.099));
    // Mean 0 and variance 1 / (3 * 100), each within four standard errors of 5,050 draws.
    let n = values.len() as f64;
    assert!((values.iter().sum::<f64>() / n).abs() < 4.0 * 0.0577 / n.sqrt());
    assert!((values.iter().map(|v| v * v).sum::<f64>() / n * 300.0 - 1.0).abs() < 4.0 * 0.894 / n.sqrt());
    assert_eq!(layer.w[[0, 1]], 0.1 * (2.0 * key.uniform(0, 2, 1) - 1.0));
    assert_eq!(layer.b[3], 0.1 * (2.0 * key.uniform(0, 2, 5003) - 1.0));
    // Each layer has its own stream: no two begin alike.
    let net = NerfMlp::initial(&SHAPE, &CS180, &key);
    assert_eq!(net.trunk[7], Layer::initial(4, 4, &key, 7));
    assert_eq!([&net.sigma, &net.feature], [&Layer::initial(4, 1, &key, 8), &Layer::initial(4, 4, &key, 9)]);
    assert_eq!(
        [&net.color0, &net.color1],
        [&Layer::initial(7, 3, &key, 10), &Layer::initial(3, 3, &key, 11)]
    );
    let mlp = Mlp::initial(7, 5, 3, 2, &key);
    assert_eq!(mlp.layers.iter().map(|l| l.w.dim()).collect::<Vec<_>>(), [(5, 7), (5, 5), (5, 5), (2, 5)]);
}

#[test]
fn the_papers_network_has_its_parameters() {
    let net = NerfMlp::initial(&Shape::PAPER, &CS180, &Key::new(0, Purpose::Parameters));
    let shapes: Vec<_> = net.layers().iter().map(|(_, layer)| layer.w.dim()).collect();
    assert_eq!(shapes[..5], [(256, 63), (256, 256), (256, 256), (256, 256), (256, 319)]);
    assert_eq!(shapes[5..], [(256, 256), (256, 256), (256, 256), (1, 256), (256, 256), (128, 283), (3, 128)]);
    assert_eq!(net.layers().iter().map(|(_, l)| l.w.len() + l.b.len()).sum::<usize>(), 595_844);
    let names: Vec<_> = net.layers().into_iter().map(|(name, _)| name).collect();
    assert_eq!(
        (names[0].as_str(), &names[7..]),
        ("trunk0", ["trunk7", "sigma", "feature", "color0", "color1"].map(String::from).as_slice())
    );
}

#[test]
fn an_mlp_of_ones_adds_up() {
    let ones =
        |inputs, outputs| Layer { w: ndarray::Array2::ones((outputs, inputs)), b: arr1(&vec![1.0; outputs]) };
    let mut mlp = Mlp { layers: vec![ones(2, 3), ones(3, 2), ones(2, 1)], output: Output::Linear };
    // 2 + 3 + 1 = 6, 3 * 6 + 1 = 19, 2 * 19 + 1 = 39.
    assert_eq!(mlp.forward(&[2.0, 3.0]).y, [39.0]);
    // -9 + 1 < 0 everywhere: only the biases are left, 3 * 0 + 1 = 1, 2 * 1 + 1 = 3.
    assert_eq!(mlp.forward(&[-4.0, -5.0]).y, [3.0]);
    mlp.output = Output::Sigmoid;
    assert_eq!(mlp.forward(&[-4.0, -5.0]).y, [sigmoid(3.0)]);
    let tape = mlp.forward(&[-4.0, -5.0]);
    let mut gradient = vec![Layer::zeros(2, 3), Layer::zeros(3, 2), Layer::zeros(2, 1)];
    assert_eq!(
        backward::mlp(&mlp, &tape, &[1.0], &mut gradient),
        [0.0, 0.0],
        "closed ReLUs let nothing through"
    );
    assert_eq!(gradient[2].b[0], sigmoid_slope(3.0));
}

#[test]
fn conventions_change_what_they_name() {
    let (x, d) = ([0.3, -0.2, 0.9, 0.5, -0.7], [0.1, 0.8, -0.6]);
    let mut net = net(5);
    net.sigma.b.fill(1.0);
    let run = |net: &NerfMlp, c: Conventions| net.forward(&x, &d, &c);
    let base = run(&net, CS180);
    // The encoding comes after h in the fifth layer's input, or before it.
    assert_eq!((base.inputs[4].len(), &base.inputs[4][4..]), (9, x.as_slice()));
    let first = Conventions { skip_order: SkipOrder::EncodingFirst, ..CS180 };
    assert_eq!(run(&net, first).inputs[4][..5], x);
    // With the columns of w permuted in the same way nothing else changes.
    let mut permuted = net.clone();
    for o in 0..4 {
        for i in 0..9 {
            permuted.trunk[4].w[[o, (i + 5) % 9]] = net.trunk[4].w[[o, i]];
        }
    }
    assert!((run(&permuted, first).sigma - base.sigma).abs() < 1e-15);
    // The ReLUs of the last layers.
    let linear = run(&net, Conventions { last_trunk: Activation::None, ..CS180 });
    assert_eq!((&linear.hidden, &base.hidden), (&linear.z[7], &relu(&base.z[7])));
    let feature = run(&net, Conventions { feature: Activation::Relu, ..CS180 });
    assert_eq!(
        (&feature.color_input[..4], &base.color_input[..4]),
        (relu(&base.z_feature).as_slice(), base.z_feature.as_slice())
    );
    assert_eq!(base.color_input[4..], d);
    let direction_first = run(&net, Conventions { color_order: ColorOrder::DirectionFirst, ..CS180 });
    assert_eq!(
        (&direction_first.color_input[..3], &direction_first.color_input[3..]),
        (&d[..], &base.color_input[..4])
    );
    assert_eq!(run(&net, Conventions { density: Density::Exp, ..CS180 }).sigma, exp(base.z_sigma));
}

/// The first layer's input is the encoding already: a skip into layer 0 is no skip, forward and backward.
#[test]
fn a_skip_into_the_first_layer_is_none() {
    let none = Conventions { skip_layer: 0, ..CS180 };
    let mut plain = NerfMlp::initial(&SHAPE, &none, &Key::new(5, Purpose::Parameters));
    plain.trunk.iter_mut().for_each(|layer| layer.b.fill(0.5));
    assert!(plain.trunk[1..].iter().all(|layer| layer.w.dim() == (4, 4)));
    let (x, d) = ([0.3, -0.2, 0.9, 0.5, -0.7], [0.1, 0.8, -0.6]);
    let run = |skip_layer| {
        let c = Conventions { density: Density::Softplus, skip_layer, ..CS180 };
        let tape = plain.forward(&x, &d, &c);
        let mut gradient = plain.clone();
        let g = backward::nerf_mlp(&plain, &tape, &c, 0.75, [1.0, -0.5, 0.25], &mut gradient);
        (tape, g, gradient)
    };
    // Layer 9 doesn't exist.
    assert_eq!(run(0), run(9));
    assert!(run(0).1.0.iter().any(|g| *g != 0.0));
}

/// VR6: e^z beyond f64 is opaque; its gradient is the 0 that volume rendering hands back, not 0 times infinity.
#[test]
fn vr6_an_infinite_density_passes_no_gradient() {
    let mut net = net(3);
    net.sigma.b[0] = 800.0;
    let c = Conventions { density: Density::Exp, ..CS180 };
    let tape = net.forward(&[0.3, -0.2, 0.9, 0.5, -0.7], &[0.1, 0.8, -0.6], &c);
    assert_eq!(tape.sigma, f64::INFINITY);
    let mut gradient = net.clone();
    gradient.layers_mut().into_iter().for_each(|layer| layer.w.fill(0.0));
    let (g_x, _) = backward::nerf_mlp(&net, &tape, &c, 0.0, [1.0, -0.5, 0.25], &mut gradient);
    assert!(g_x.iter().all(|g| g.is_finite()) && gradient.sigma.w.iter().all(|g| *g == 0.0), "{g_x:?}");
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn density_does_not_see_the_direction(seed in any::<u64>(), x in prop::array::uniform5(-1.0..1.0), d in prop::array::uniform3(-1.0..1.0)) {
        let net = net(seed);
        let (a, b) = (net.forward(&x, &d, &CS180), net.forward(&x, &[0.0; 3], &CS180));
        prop_assert_eq!(a.sigma, b.sigma);
        prop_assert!(a.sigma >= 0.0 && a.rgb.iter().all(|c| (0.0..=1.0).contains(c)));
        let mut gradient = net.clone();
        let (_, g_d) = backward::nerf_mlp(&net, &a, &CS180, 1.0, [0.0; 3], &mut gradient);
        prop_assert_eq!(g_d, vec![0.0; 3]);
    }

    #[test]
    fn sigmoid_and_softplus_identities(z in -30.0..30.0f64) {
        prop_assert!((sigmoid(z) + sigmoid(-z) - 1.0).abs() <= 2.0 * f64::EPSILON);
        prop_assert!((softplus(z) - softplus(-z) - z).abs() <= 4.0 * f64::EPSILON * z.abs().max(1.0));
        prop_assert!((exp(-softplus(-z)) / sigmoid(z) - 1.0).abs() <= 64.0 * f64::EPSILON);
    }
}
