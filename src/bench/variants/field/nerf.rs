//! The network of the NeRF paper (8 x 256).

use super::{Plain, Store, plain_forward, plain_layer, rounded, short};
use crate::bench::{BF16, F16, Kernel, Scaling, Suite, Tolerance, Variant, kernel, uniform};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, values};
use crate::convention::CS180;
use crate::encoding::{Encoding, positional_encoding};
use crate::field::arrays::Nerf;
use crate::field::fast::Network;
use crate::field::nerf_mlp::{NerfMlp, Shape};
use crate::field::trunk::{Part, Plan};
use crate::parallel;
use crate::random::{Key, Purpose};

/// Points that share a direction.
const SAMPLES: usize = 64;

/// Points along rays through [-1, 1]^3, 64 a direction, and a network with initial values except for a density bias that keeps densities
/// positive.
fn nerf_workload(items: usize, shape: &Shape) -> Arrays {
    let mut net = NerfMlp::initial(shape, &CS180, &Key::new(0, Purpose::Parameters));
    net.sigma.b[0] += 0.1;
    rounded(net.layers_mut());
    let rays = items.div_ceil(SAMPLES);
    let directions = uniform(10, 3 * rays, -1.0, 1.0);
    let each: Vec<f64> = (0..items).flat_map(|i| directions[i / SAMPLES * 3..][..3].to_vec()).collect();
    let mut out = arrays([
        ("positions", array(&[items, 3], uniform(11, 3 * items, -1.0, 1.0))),
        ("directions", array(&[items, 3], each)),
    ]);
    for (name, layer) in net.layers() {
        out.insert(format!("{name}_w"), layer.w.clone().into_dyn());
        out.insert(format!("{name}_b"), layer.b.clone().into_dyn());
    }
    out
}

fn field_arrays(sigmas: Vec<f64>, rgbs: Vec<f64>) -> Arrays {
    let points = sigmas.len();
    arrays([("sigmas", array(&[points], sigmas)), ("rgbs", array(&[points, 3], rgbs))])
}

/// Densities and colors, one point after the other.
fn point_by_point(
    a: &Arrays,
    point: impl Fn(&[f64], &[f64]) -> (f64, [f64; 3]) + 'static,
) -> Box<dyn Kernel> {
    let data = (values(a, "positions"), values(a, "directions"), vec![], vec![]);
    let bytes = 8 * 10 * (data.0.len() / 3);
    let run = move |(x, d, sigmas, rgbs): &mut (Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>)| {
        sigmas.clear();
        rgbs.clear();
        for (x, d) in x.chunks_exact(3).zip(d.chunks_exact(3)) {
            let (sigma, rgb) = point(x, d);
            sigmas.push(sigma);
            rgbs.extend(rgb);
        }
    };
    kernel(data, bytes, run, |(_, _, sigmas, rgbs)| field_arrays(sigmas.clone(), rgbs.clone()))
}

fn nerf_oracle(a: &Arrays) -> Box<dyn Kernel> {
    let nerf = Nerf::of(a, &CS180);
    point_by_point(a, move |x, d| {
        let (x, d) = (positional_encoding(x, &nerf.position), positional_encoding(d, &nerf.direction));
        let tape = nerf.net.forward(&x, &d, &CS180);
        (tape.sigma, tape.rgb)
    })
}

/// Bands of sin and cos in f32, the product 2^k pi x rounded.
fn plain_encoding(x: &[f64], encoding: &Encoding) -> Vec<f32> {
    let mut out: Vec<f32> = x.iter().map(|&x| x as f32).collect();
    for k in 0..encoding.levels {
        let angles: Vec<f32> =
            out[..3].iter().map(|x| std::f32::consts::PI * (1u32 << k) as f32 * x).collect();
        out.extend(angles.iter().map(|a| a.sin()));
        out.extend(angles.iter().map(|a| a.cos()));
    }
    out
}

fn nerf_plain(a: &Arrays) -> Box<dyn Kernel> {
    let nerf = Nerf::of(a, &CS180);
    let layers: Vec<Plain> = nerf.net.layers().iter().map(|(_, layer)| plain_layer(layer)).collect();
    let depth = nerf.net.trunk.len();
    point_by_point(a, move |x, d| {
        let (x, d) = (plain_encoding(x, &nerf.position), plain_encoding(d, &nerf.direction));
        let mut h: Vec<f32> = vec![];
        for (n, layer) in layers[..depth].iter().enumerate() {
            let parts = Plan::of(&CS180).parts(n).iter();
            let input: Vec<f32> =
                parts.flat_map(|part| if *part == Part::Hidden { &h } else { &x }).copied().collect();
            h = plain_forward(layer, &input, true);
        }
        let sigma = plain_forward(&layers[depth], &h, true)[0];
        let mut feature = plain_forward(&layers[depth + 1], &h, false);
        feature.extend(&d);
        let rgb =
            plain_forward(&layers[depth + 3], &plain_forward(&layers[depth + 2], &feature, true), false);
        (sigma.into(), [0, 1, 2].map(|k| f64::from(1.0 / (1.0 + (-rgb[k]).exp()))))
    })
}

/// The batched network of the training; `threads` 0 for all.
fn nerf_batched(a: &Arrays, shape: &Shape, threads: usize, store: fn(&[f32]) -> Store) -> Box<dyn Kernel> {
    let net = Network::new(&Nerf::of(a, &CS180).net, shape, &CS180);
    let store = store(&net.params);
    let (x, d) = (values(a, "positions"), values(a, "directions"));
    // One direction for 64 points.
    let d: Vec<f64> = d.chunks(3 * SAMPLES).flat_map(|d| d[..3].to_vec()).collect();
    let bytes = 8 * (x.len() + d.len()) + 4 * net.params.len() + 16 * (x.len() / 3);
    let threads = (threads > 0).then_some(threads);
    type Data = (Network, Vec<f64>, Vec<f64>, (Vec<f32>, Vec<f32>));
    let run = move |(net, x, d, out): &mut Data| {
        store.unpack(&mut net.params);
        *out = parallel::with_threads(threads, || net.forward(x, d, SAMPLES));
    };
    kernel((net, x, d, (vec![], vec![])), bytes, run, |(.., (sigmas, rgbs))| {
        let wide = |x: &[f32]| x.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>();
        field_arrays(wide(sigmas), wide(rgbs))
    })
}

/// The suite of the NeRF paper's network.
pub(crate) const NERF_MLP: Suite = Suite {
    component: "nerf_mlp",
    judged: true,
    item: "point",
    workload: |items| nerf_workload(items, &Shape::PAPER),
    items: 1 << 13,
    checked: 64,
    oracle: nerf_oracle,
    variants: &[
        Variant::new(
            "plain_f32",
            "one thread, a point and an output at a time",
            Dtype::F32,
            Tolerance::f32(),
            nerf_plain,
        ),
        Variant::new(
            "batched",
            "one thread, matrix products over 512 points, feature and color layer folded into one, one direction for 64 points",
            Dtype::F32,
            Tolerance::f32(),
            |a| nerf_batched(a, &Shape::PAPER, 1, |_| Store::F32),
        ),
        Variant::new("threaded", "the same on all threads", Dtype::F32, Tolerance::f32(), |a| {
            nerf_batched(a, &Shape::PAPER, 0, |_| Store::F32)
        }),
        Variant::new(
            "bf16_weights",
            "threaded, parameters stored as bf16 and unpacked in every call",
            Dtype::Bf16,
            short(11.0, BF16),
            |a| nerf_batched(a, &Shape::PAPER, 0, Store::bf16),
        ),
        Variant::new(
            "f16_weights",
            "threaded, parameters stored as f16 and unpacked in every call",
            Dtype::F16,
            short(11.0, F16),
            |a| nerf_batched(a, &Shape::PAPER, 0, Store::f16),
        ),
    ],
};

fn nerf_of_width(width: usize, points: usize, threads: usize) -> Box<dyn Kernel> {
    let shape = Shape { width, color: width / 2, ..Shape::PAPER };
    nerf_batched(&nerf_workload(points, &shape), &shape, threads, |_| Store::F32)
}

/// Time against points, width and threads.
pub(crate) const SCALING: &[Scaling] = &[
    Scaling {
        component: "nerf_mlp",
        parameter: "points",
        about: "threaded, 8 x 256",
        values: &[1024.0, 2048.0, 4096.0, 8192.0, 16384.0],
        prepare: |points| nerf_of_width(256, points as usize, 0),
        memory: true,
    },
    Scaling {
        component: "nerf_mlp",
        parameter: "width",
        about: "threaded, 8 layers, 4,096 points",
        values: &[32.0, 64.0, 128.0, 256.0, 512.0],
        prepare: |width| nerf_of_width(width as usize, 4096, 0),
        memory: true,
    },
    Scaling {
        component: "nerf_mlp",
        parameter: "threads",
        about: "8 x 256, 8,192 points; more threads than cores don't help",
        values: &[1.0, 2.0, 4.0],
        prepare: |threads| nerf_of_width(256, 8192, threads as usize),
        memory: false,
    },
];
