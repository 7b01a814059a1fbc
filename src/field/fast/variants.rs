//! Variants of the networks for `bench`: the 2D network (42 - 256 - 256 - 256 - 3) and the NeRF paper's (8 x 256).

use half::f16;
use half::slice::HalfFloatSliceExt;
use pulp::Arch;

use super::activation::sigmoid;
use super::passes::{BiasRelu, Heads};
use super::product::{Matrix, product, transposed};
use super::{ImageNetwork, Network};
use crate::approximate::{from_bf16, to_bf16};
use crate::convention::{CS180, Density};
use crate::encoding::{Encoding, positional_encoding};
use crate::field::component::{Nerf, network};
use crate::field::nerf_mlp::{NerfMlp, Shape};
use crate::field::{Layer, Mlp};
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::verify::Dtype;
use crate::verify::bench::{
    BF16, F16, Kernel, Promise, Scaling, Suite, Variant, kernel, rows, singles, uniform,
};
use crate::verify::component::{Arrays, array, arrays, values};

const INPUTS: usize = 42;
const WIDTH: usize = 256;
/// Points that share a direction.
const SAMPLES: usize = 64;

/// Initial parameters, rounded to f32.
fn rounded(layers: Vec<&mut Layer>) {
    for layer in layers {
        layer.w.mapv_inplace(|x| f64::from(x as f32));
        layer.b.mapv_inplace(|x| f64::from(x as f32));
    }
}

fn mlp_workload(items: usize) -> Arrays {
    let mut net = Mlp::initial(INPUTS, WIDTH, 3, 3, &Key::new(0, Purpose::Parameters));
    rounded(net.layers.iter_mut().collect());
    let mut out = arrays([("x", array(&[items, INPUTS], uniform(9, items * INPUTS, -1.0, 1.0)))]);
    for (n, layer) in net.layers.into_iter().enumerate() {
        out.insert(format!("w{n}"), layer.w.into_dyn());
        out.insert(format!("b{n}"), layer.b.into_dyn());
    }
    out
}

fn mlp_oracle(a: &Arrays) -> Box<dyn Kernel> {
    let net = network(a);
    let run = move |x: &[f64], y: &mut [f64]| {
        for (x, y) in x.chunks_exact(INPUTS).zip(y.chunks_exact_mut(3)) {
            y.copy_from_slice(&net.forward(x).y);
        }
    };
    rows("y", (values(a, "x"), INPUTS, 3), run, |&y| y)
}

/// A layer as one writes it down: (weights row by row, biases).
type Plain = (Vec<f32>, Vec<f32>);

fn plain_layer(layer: &Layer) -> Plain {
    let single = |x: &f64| *x as f32;
    (layer.w.iter().map(single).collect(), layer.b.iter().map(single).collect())
}

fn plain_forward((w, b): &Plain, x: &[f32], relu: bool) -> Vec<f32> {
    let output = |(w, b): (&[f32], &f32)| {
        let mut sum = *b;
        for i in 0..x.len() {
            sum += w[i] * x[i];
        }
        if relu { sum.max(0.0) } else { sum }
    };
    w.chunks_exact(x.len()).zip(b).map(output).collect()
}

fn mlp_plain(a: &Arrays) -> Box<dyn Kernel> {
    let layers: Vec<Plain> = network(a).layers.iter().map(plain_layer).collect();
    let run = move |x: &[f32], y: &mut [f32]| {
        for (x, y) in x.chunks_exact(INPUTS).zip(y.chunks_exact_mut(3)) {
            let mut h = x.to_vec();
            for (n, layer) in layers.iter().enumerate() {
                h = plain_forward(layer, &h, n + 1 < layers.len());
            }
            y.iter_mut().zip(h).for_each(|(y, z)| *y = 1.0 / (1.0 + (-z).exp()));
        }
    };
    rows("y", (singles(a, "x"), INPUTS, 3), run, |&y| y.into())
}

/// Where the parameters stay between two calls.
#[derive(Clone)]
enum Store {
    F32,
    Bf16(Vec<u16>),
    F16(Vec<f16>),
}

impl Store {
    fn bf16(params: &[f32]) -> Store {
        Store::Bf16(params.iter().map(|&p| to_bf16(p)).collect())
    }

    fn f16(params: &[f32]) -> Store {
        Store::F16(params.iter().map(|&p| f16::from_f32(p)).collect())
    }

    /// Writes the parameters in f32, for the products.
    fn unpack(&self, params: &mut [f32]) {
        match self {
            Store::F32 => {}
            Store::Bf16(short) => params.iter_mut().zip(short).for_each(|(p, &s)| *p = from_bf16(s)),
            Store::F16(short) => short.convert_to_f32_slice(params),
        }
    }
}

/// The batched network; `threads` 0 for all.
fn mlp_batched(a: &Arrays, threads: usize, store: fn(&[f32]) -> Store) -> Box<dyn Kernel> {
    let net = ImageNetwork::new(&network(a), INPUTS);
    let (x, store) = (values(a, "x"), store(&net.params));
    let points = x.len() / INPUTS;
    let bytes = 8 * x.len() + 4 * net.params.len() + 12 * points;
    let threads = (threads > 0).then_some(threads);
    let run = move |(net, x, y): &mut (ImageNetwork, Vec<f64>, Vec<f32>)| {
        store.unpack(&mut net.params);
        *y = parallel::with_threads(threads, || net.forward(x));
    };
    kernel((net, x, vec![0f32; 0]), bytes, run, move |(_, _, y)| {
        arrays([("y", array(&[points, 3], y.iter().map(|&y| y.into()).collect()))])
    })
}

/// Layer by layer over half of all points a thread: activations go through memory instead of staying in the cache.
fn mlp_unfused(a: &Arrays) -> Box<dyn Kernel> {
    let layers: Vec<Plain> = network(a).layers.iter().map(plain_layer).collect();
    let turned: Vec<Vec<f32>> =
        layers.iter().map(|(w, b)| transposed(w, b.len(), w.len() / b.len())).collect();
    let x = singles(a, "x");
    let points = x.len() / INPUTS;
    let share = points.div_ceil(parallel::threads());
    let bytes = 4 * (x.len() + 2 * points * WIDTH + 3 * points);
    let data = (x, vec![vec![0f32; points * WIDTH]; 2], vec![0f32; 3 * points]);
    let run = move |(x, h, y): &mut (Vec<f32>, Vec<Vec<f32>>, Vec<f32>)| {
        let arch = Arch::new();
        let [even, odd] = &mut h[..] else { unreachable!("two buffers") };
        for n in 0..layers.len() - 1 {
            let (from, to) = if n % 2 == 0 { (&*odd, &mut *even) } else { (&*even, &mut *odd) };
            let (from, inputs) = if n == 0 { (&*x, INPUTS) } else { (from, WIDTH) };
            parallel::for_chunks(to, share * WIDTH, |part, to| {
                let count = to.len() / WIDTH;
                let from = &from[part * share * inputs..][..count * inputs];
                let w = Matrix::new(&turned[n], inputs, WIDTH, WIDTH);
                product(to, WIDTH, Matrix::new(from, count, inputs, inputs), w, false);
                arch.dispatch(BiasRelu { x: to, stride: WIDTH, bias: &layers[n].1 });
            });
        }
        let (w, b) = layers.last().expect("a layer");
        let h = if layers.len() % 2 == 0 { &*even } else { &*odd };
        parallel::for_chunks(y, share * 3, |part, y| {
            let x = &h[part * share * WIDTH..][..y.len() / 3 * WIDTH];
            arch.dispatch(Heads::<3> { x, w, bias: b, z: y });
            y.iter_mut().for_each(|z| *z = sigmoid(*z));
        });
    };
    kernel(data, bytes, run, move |(_, _, y)| {
        arrays([("y", array(&[points, 3], y.iter().map(|&y| y.into()).collect()))])
    })
}

const fn variant(
    name: &'static str,
    about: &'static str,
    dtype: Dtype,
    promise: Promise,
    prepare: fn(&Arrays) -> Box<dyn Kernel>,
) -> Variant {
    Variant { name, about, dtype, promise, prepare }
}

/// What weights of a short type cost: each of the layers moves what passes by at most half a unit of its last place, as a share of the
/// largest.
const fn short(layers: f64, half_unit: f64) -> Promise {
    Promise::f32().of_largest(layers * half_unit)
}

/// The suite of the 2D network.
pub const MLP: Suite = Suite {
    component: "mlp",
    judged: true,
    item: "point",
    workload: mlp_workload,
    items: 1 << 13,
    checked: 64,
    oracle: mlp_oracle,
    variants: &[
        variant(
            "plain_f32",
            "one thread, a point and an output at a time",
            Dtype::F32,
            Promise::f32(),
            mlp_plain,
        ),
        variant(
            "batched",
            "one thread, matrix products over 512 points, all layers of a chunk in the cache",
            Dtype::F32,
            Promise::f32(),
            |a| mlp_batched(a, 1, |_| Store::F32),
        ),
        variant("threaded", "the same on all threads", Dtype::F32, Promise::f32(), |a| {
            mlp_batched(a, 0, |_| Store::F32)
        }),
        variant(
            "layer_by_layer",
            "all threads, without that fusion: each layer over the whole batch",
            Dtype::F32,
            Promise::f32(),
            mlp_unfused,
        ),
        variant(
            "bf16_weights",
            "threaded, parameters stored as bf16 and unpacked in every call",
            Dtype::Bf16,
            short(4.0, BF16),
            |a| mlp_batched(a, 0, Store::bf16),
        ),
        variant(
            "f16_weights",
            "threaded, parameters stored as f16 and unpacked in every call",
            Dtype::F16,
            short(4.0, F16),
            |a| mlp_batched(a, 0, Store::f16),
        ),
    ],
};

/// Points along rays through [-1, 1]^3, 64 a direction, and a network with initial values but for a density bias that keeps densities alive.
fn nerf_workload(items: usize, shape: &Shape) -> Arrays {
    let mut net = NerfMlp::initial(shape, &Key::new(0, Purpose::Parameters));
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

/// Densities and colours that one point after the other gives.
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
        let mut h = x.clone();
        for (n, layer) in layers[..depth].iter().enumerate() {
            if n == CS180.skip_layer {
                h.extend(&x);
            }
            h = plain_forward(layer, &h, true);
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
    let net = Network::new(&Nerf::of(a, &CS180).net, shape, Density::Relu);
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
pub const NERF_MLP: Suite = Suite {
    component: "nerf_mlp",
    judged: true,
    item: "point",
    workload: |items| nerf_workload(items, &Shape::PAPER),
    items: 1 << 13,
    checked: 64,
    oracle: nerf_oracle,
    variants: &[
        variant(
            "plain_f32",
            "one thread, a point and an output at a time",
            Dtype::F32,
            Promise::f32(),
            nerf_plain,
        ),
        variant(
            "batched",
            "one thread, matrix products over 512 points, feature and colour layer folded into one, one direction for 64 points",
            Dtype::F32,
            Promise::f32(),
            |a| nerf_batched(a, &Shape::PAPER, 1, |_| Store::F32),
        ),
        variant("threaded", "the same on all threads", Dtype::F32, Promise::f32(), |a| {
            nerf_batched(a, &Shape::PAPER, 0, |_| Store::F32)
        }),
        variant(
            "bf16_weights",
            "threaded, parameters stored as bf16 and unpacked in every call",
            Dtype::Bf16,
            short(11.0, BF16),
            |a| nerf_batched(a, &Shape::PAPER, 0, Store::bf16),
        ),
        variant(
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
pub const SCALING: &[Scaling] = &[
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
