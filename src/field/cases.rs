//! Cases of the networks: widths of 16 to 32 with parameters that every number type holds, and one of full size.

use ndarray::{ArrayD, Axis};

use super::nerf_mlp::{NerfMlp, Shape};
use super::trunk::Plan;
use crate::contract::arrays::{Arrays, array};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::signed;
use crate::convention::{Bands, CS180, Conventions};
use crate::random::{Key, Purpose};

/// Weights as large as PyTorch's initial values, biases away from 0 so that every unit is clearly on or off.
pub(crate) fn layer(draw: &mut Draw, inputs: usize, outputs: usize, bias: f64) -> [ArrayD<f64>; 2] {
    let reach = 1.0 / (inputs as f64).sqrt();
    let w = draw.array(&[outputs, inputs], -reach, reach);
    let b = (0..outputs).map(|_| {
        let b = draw.between(bias, 1.5 * bias);
        if draw.below(4) == 0 { -b } else { b }
    });
    [w, array(&[outputs], b.collect())]
}

fn plain(id: &str, comment: &'static str, stream: u64, sizes: &[usize], points: usize, bias: f64) -> Case {
    let mut draw = Draw::new("mlp", stream);
    let mut case = Case::new(id, comment, vec![("x", draw.array(&[points, sizes[0]], -1.0, 1.0))]);
    for (n, size) in sizes.windows(2).enumerate() {
        let last = n + 2 == sizes.len();
        let [w, b] = layer(&mut draw, size[0], size[1], if last { 0.25 } else { bias });
        case.inputs.insert(format!("w{n}"), w);
        case.inputs.insert(format!("b{n}"), b);
    }
    case
}

/// Weights that pass on one input each, the `n` from `first` on by turns: sums of one product keep most digits even in bf16.
pub(crate) fn passing_on([outputs, inputs]: [usize; 2], first: usize, n: usize, gain: f64) -> ArrayD<f64> {
    let weight = |k: usize| if k % inputs == first + (k / inputs) % n { gain } else { 0.0 };
    array(&[outputs, inputs], (0..outputs * inputs).map(weight).collect())
}

/// Weights and biases that keep hidden units near 3/4, and small logits, where the sigmoid's slope is sharpest.
pub(crate) const GAIN: f64 = 0.875;
pub(crate) const BIAS: f64 = 0.09375;
pub(crate) const LAST_GAIN: f64 = 0.25;

/// A plain network of such weights, with small biases.
fn passing_mlp(sizes: &[usize]) -> Case {
    let comment = "every unit passes on one of the layer below: the gradient keeps its digits in every type";
    let mut case = plain("passing_on", comment, 10, sizes, 1, 1.0);
    case.inputs.insert("x".into(), Draw::new("mlp", 11).array(&[1, sizes[0]], 0.5, 1.0));
    for (n, size) in sizes.windows(2).enumerate() {
        let gain = if n + 2 == sizes.len() { LAST_GAIN } else { GAIN };
        case.inputs.insert(format!("w{n}"), passing_on([size[1], size[0]], 0, size[0], gain));
        case.inputs.insert(format!("b{n}"), array(&[size[1]], vec![BIAS; size[1]]));
    }
    case
}

/// The plain network.
pub(crate) fn mlp() -> Vec<Case> {
    let mut dead =
        plain("TR1_dead", "every hidden unit is off: y is sigmoid(b), no gradient", 9, &[3, 8, 3], 2, 1.0);
    dead.inputs.insert("b0".into(), array(&[8], vec![-64.0; 8]));
    let mut saturated =
        plain("saturated", "logits near -88 and 8: small y keeps its digits", 8, &[1, 2], 1, 1.0);
    saturated.inputs.insert("w0".into(), array(&[2, 1], vec![-88.0, 8.0]));
    saturated.inputs.insert("b0".into(), array(&[2], vec![0.0, 0.0]));
    saturated.inputs.insert("x".into(), array(&[1, 1], vec![1.0]));
    let cases = vec![
        plain("one_layer", "no hidden layer", 0, &[3, 2], 3, 0.25),
        plain("two_hidden", "two hidden layers of 16", 1, &[6, 16, 16, 3], 4, 2.0),
        plain("wide", "three hidden layers of 32", 2, &[10, 32, 32, 32, 3], 2, 3.0),
        dead,
        saturated,
        passing_mlp(&[4, 8, 8, 8, 3]),
    ];
    in_full(in_full(cases, "two_hidden"), "passing_on")
}

fn nerf(id: &str, comment: &'static str, stream: u64, width: usize, levels: [usize; 2], bias: f64) -> Case {
    let mut draw = Draw::new("nerf_mlp", stream);
    let [position, direction] = levels.map(|levels| 3 + 6 * levels);
    let inputs =
        vec![("positions", draw.array(&[2, 3], -1.0, 1.0)), ("directions", draw.array(&[2, 3], -1.0, 1.0))];
    let mut case = Case::new(id, comment, inputs);
    let shape = Shape { position, direction, width, depth: 8, color: width / 2 };
    let mut sizes: Vec<(String, usize, usize, f64)> =
        (0..8).map(|n| (format!("trunk{n}"), shape.trunk_inputs(n, &CS180), width, bias)).collect();
    sizes.push(("sigma".into(), width, 1, 0.5));
    sizes.push(("feature".into(), width, width, 0.25));
    sizes.push(("color0".into(), width + direction, width / 2, bias));
    sizes.push(("color1".into(), width / 2, 3, 0.25));
    for (name, inputs, outputs, bias) in sizes {
        let [w, b] = layer(&mut draw, inputs, outputs, bias);
        case.inputs.insert(format!("{name}_w"), w);
        case.inputs.insert(format!("{name}_b"), b);
    }
    // A density head whose ReLU is on.
    case.inputs.insert("sigma_b".into(), array(&[1], vec![16.0]));
    case
}

/// A NeRF network of weights that pass on one input each. The first layer reads the position itself, and has larger biases for networks
/// without it; where the encoding enters again, columns 9 to 15 are hidden units in either order; red is a feature, green and blue
/// are directions.
fn passing_nerf() -> Case {
    let comment = "every unit passes on one of the layer below: the gradient keeps its digits in every type";
    let mut case = nerf("passing_on", comment, 4, 16, [1, 1], 1.0);
    let mut draw = Draw::new("nerf_mlp", 5);
    for (name, array) in case.inputs.iter_mut() {
        *array = match name.as_str() {
            "positions" | "directions" => draw.array(&[1, 3], 0.5, 1.0),
            "trunk0_b" => array.mapv(|_| 0.5),
            _ if name.ends_with("_b") => array.mapv(|_| BIAS),
            _ => {
                let [outputs, inputs] = [array.shape()[0], array.shape()[1]];
                let (first, n) = match name.as_str() {
                    "trunk0_w" => (0, 3),
                    "trunk4_w" => (9, 7),
                    "color0_w" => (12, 8),
                    "color1_w" => (3, 3),
                    _ => (0, inputs.min(16)),
                };
                passing_on([outputs, inputs], first, n, if name == "color1_w" { LAST_GAIN } else { GAIN })
            }
        };
    }
    case
}

/// The NeRF network.
pub(crate) fn nerf_mlp() -> Vec<Case> {
    let mut dead = nerf("TR1_dead", "sigma is 0 everywhere and its head has no gradient", 2, 16, [1, 1], 2.0);
    dead.inputs.insert("sigma_b".into(), array(&[1], vec![-64.0]));
    let cases = vec![
        nerf("short", "one band each: accurate in every type", 0, 16, [1, 1], 2.0),
        nerf("width_16", "63 and 27 columns, as in the paper", 1, 16, [10, 4], 4.0),
        nerf("width_32", "width 32, short encodings", 3, 32, [2, 1], 4.0),
        dead,
        full_size(),
        passing_nerf(),
    ];
    let mut cases = in_full(cases, "passing_on");
    cases.iter_mut().for_each(with_unit_directions);
    cases
}

/// Directions of length 1, so that a network which normalizes them itself is asked the same: along the axes, which every type has, and
/// in full precision as they are drawn.
fn with_unit_directions(case: &mut Case) {
    let directions = case.inputs.get_mut("directions").expect("a network's arrays");
    for mut d in directions.rows_mut() {
        let length = d.dot(&d).sqrt();
        let nearest = (0..3).max_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs())).expect("three axes");
        let sign = d[nearest].signum();
        match case.full {
            Some(dtype) => d.mapv_inplace(|x| dtype.round(x / length)),
            None => (0..3).for_each(|axis| d[axis] = if axis == nearest { sign } else { 0.0 }),
        }
    }
}

/// 8 layers of 256 with PyTorch's initial values, rounded to f32: `Key::new(0, Purpose::Parameters)`, streams as in
/// [`NerfMlp::initial`].
fn full_size() -> Case {
    let net = NerfMlp::initial(&Shape::PAPER, &CS180, &Key::new(0, Purpose::Parameters));
    let mut draw = Draw::new("nerf_mlp", 100);
    let inputs =
        vec![("positions", draw.array(&[1, 3], -1.0, 1.0)), ("directions", draw.array(&[1, 3], -1.0, 1.0))];
    let mut case = Case::new("full_size", "8 layers of 256, as in the paper", inputs);
    for (name, layer) in net.layers() {
        let single = |x: f64| f64::from(x as f32);
        case.inputs.insert(format!("{name}_w"), layer.w.mapv(single).into_dyn());
        case.inputs.insert(format!("{name}_b"), layer.b.mapv(single).into_dyn());
    }
    case.forward_only()
}

/// The network's cases are written for the skip of `cs180`. Where the encoding enters the trunk again in another layer, the two
/// layers' weights are exchanged, so that the shapes fit; where the encoding lacks x itself, the weights lack those columns.
pub(crate) fn reshape(inputs: &mut Arrays, c: &Conventions) {
    let name = |layer: usize| format!("trunk{layer}_w");
    let columns = |inputs: &Arrays, name: &str| inputs.get(name).map(|w| w.shape()[1]);
    if !c.identity {
        let written = Plan { skip: CS180.skip_layer, order: c.skip_order };
        let encoding = columns(inputs, &name(0)).expect("a network's arrays");
        let features = inputs["feature_w"].shape()[0];
        let directions = columns(inputs, "color0_w").expect("a network's arrays") - features;
        let [_, direction] = c.color_order.begins(features, directions);
        let mut identity = vec![("color0_w".to_string(), direction)];
        for n in 0.. {
            let Some(inputs) = columns(inputs, &name(n)) else { break };
            identity.extend(written.encoding_begins(n, inputs, encoding).map(|first| (name(n), first)));
        }
        for (name, first) in identity {
            let w = inputs.get_mut(&name).expect("a network's arrays");
            let kept: Vec<usize> = (0..w.shape()[1]).filter(|i| !(first..first + 3).contains(i)).collect();
            *w = w.select(Axis(1), &kept);
        }
    }
    let (here, there) = (name(CS180.skip_layer), name(c.skip_layer));
    if here != there && inputs.contains_key(&there) {
        let (wide, narrow) = (inputs.remove(&here), inputs.remove(&there));
        inputs.extend(wide.map(|w| (there, w)));
        inputs.extend(narrow.map(|w| (here, w)));
    }
}

/// Whether a case can be asked in these conventions: its widths are theirs, and none of its units lies within f32's bound of 0, where it
/// is switched on and off. Of the network of width 32 one does where bands reach twice as far.
pub(crate) fn admits(inputs: &Arrays, c: &Conventions) -> bool {
    let width = inputs.get("trunk0_w").map_or(0, |w| w.shape()[0]);
    fits(inputs, c) && !(width == 32 && c.bands == Bands::Widened)
}

/// A network's widths belong to conventions: which layer reads the encoding again, and whether the encoding keeps x itself.
pub(crate) fn fits(inputs: &Arrays, c: &Conventions) -> bool {
    let layers = (0..).map_while(|n| inputs.get(&format!("trunk{n}_w")));
    let shapes: Vec<&[usize]> = layers.map(|w| w.shape()).collect();
    let Some(&&[width, encoding]) = shapes.first() else { return false };
    let identity = if c.identity { 3 } else { 0 };
    let fits = |n: usize| shapes[n][1] == Plan::of(c).columns(n, width, encoding);
    encoding % 6 == identity && c.skip_layer < shapes.len() && (0..shapes.len()).all(fits)
}

/// Plain networks of real widths. Their parameters' gradients add up over all points: a case of its own kind, not asked here.
pub(crate) fn large() -> Vec<Large> {
    let network = |(id, comment, width): (&'static str, &'static str, usize)| {
        let points = 1031;
        let large =
            Large::new(id, comment, points, 32).with("x", &[points, 32], signed(-4, 4)).forward_only();
        let layer = |large: Large, (n, size): (usize, &[usize])| {
            let w = large.with(format!("w{n}"), &[size[1], size[0]], signed(-7, 4));
            w.with(format!("b{n}"), &[size[1]], signed(-4, 4))
        };
        [32, width, width, width, 3].windows(2).enumerate().fold(large, layer)
    };
    let networks = [
        ("batch_1031_width_64", "1,031 points, three layers of 64", 64),
        ("batch_1031_width_128", "1,031 points, three layers of 128", 128),
        ("batch_1031_width_256", "1,031 points, three layers of 256", 256),
    ];
    networks.into_iter().map(network).collect()
}
