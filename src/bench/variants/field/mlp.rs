//! The 2D network (42 - 256 - 256 - 256 - 3).

use super::{Plain, Store, plain_forward, plain_layer, rounded, short};
use crate::bench::{BF16, F16, Kernel, Suite, Tolerance, Variant, kernel, rows, singles, uniform};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, values};
use crate::field::Mlp;
use crate::field::arrays::network;
use crate::field::fast::ImageNetwork;
use crate::field::fast::activation::sigmoid;
use crate::field::fast::passes::{BiasRelu, Heads};
use crate::field::fast::product::{Matrix, product, transposed};
use crate::parallel;
use crate::random::{Key, Purpose};

const INPUTS: usize = 42;
const WIDTH: usize = 256;

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

/// Layer by layer over half of all points per thread: activations go through memory instead of staying in the cache.
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
        let arch = crate::simd::arch();
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

/// The suite of the 2D network.
pub(crate) const MLP: Suite = Suite {
    component: "mlp",
    judged: true,
    item: "point",
    workload: mlp_workload,
    items: 1 << 13,
    checked: 64,
    oracle: mlp_oracle,
    variants: &[
        Variant::new(
            "plain_f32",
            "one thread, a point and an output at a time",
            Dtype::F32,
            Tolerance::f32(),
            mlp_plain,
        ),
        Variant::new(
            "batched",
            "one thread, matrix products over 512 points, all layers of a chunk in the cache",
            Dtype::F32,
            Tolerance::f32(),
            |a| mlp_batched(a, 1, |_| Store::F32),
        ),
        Variant::new("threaded", "the same on all threads", Dtype::F32, Tolerance::f32(), |a| {
            mlp_batched(a, 0, |_| Store::F32)
        }),
        Variant::new(
            "layer_by_layer",
            "all threads, without that fusion: each layer over the whole batch",
            Dtype::F32,
            Tolerance::f32(),
            mlp_unfused,
        ),
        Variant::new(
            "bf16_weights",
            "threaded, parameters stored as bf16 and unpacked in every call",
            Dtype::Bf16,
            short(4.0, BF16),
            |a| mlp_batched(a, 0, Store::bf16),
        ),
        Variant::new(
            "f16_weights",
            "threaded, parameters stored as f16 and unpacked in every call",
            Dtype::F16,
            short(4.0, F16),
            |a| mlp_batched(a, 0, Store::f16),
        ),
    ],
};
