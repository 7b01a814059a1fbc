//! Variants of a training step of the 8x256 network for `bench`: rays of 64 samples, loss, gradient, Adam.

use glam::DVec3;

use crate::bench::{Kernel, Suite, Tolerance, Variant, kernel, singles, uniform};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, scalar, values};
use crate::convention::CS180;
use crate::encoding::Encoding;
use crate::field::NerfMlp;
use crate::field::fast::{Batch, Gradient, Network, Rays};
use crate::field::nerf_mlp::Shape;
use crate::optimizer::{Adam, fast::Moments};
use crate::random::{Key, Purpose};
use crate::ray::Ray;
use crate::training::reference::{Field, Target};

const SAMPLES: usize = 64;
const WIDTH: f64 = 4.0 / SAMPLES as f64;

/// Rays with jittered samples and random targets, as `tools/bench_torch.py` draws them; items are points.
fn workload(items: usize) -> Arrays {
    let rays = items / SAMPLES;
    let unit = |d: &[f64; 3]| {
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt().max(1e-6);
        d.map(|x| x / length)
    };
    let directions = uniform(21, 3 * rays, -0.58, 0.58).as_chunks::<3>().0.iter().flat_map(unit).collect();
    let jitter = uniform(22, rays * SAMPLES, 0.0, 1.0);
    let t = (0..rays * SAMPLES).map(|i| 2.0 + ((i % SAMPLES) as f64 + jitter[i]) * WIDTH).collect();
    arrays([
        ("origins", array(&[rays, 3], uniform(20, 3 * rays, -2.0, 2.0))),
        ("directions", array(&[rays, 3], directions)),
        ("t", array(&[rays, SAMPLES], t)),
        ("targets", array(&[rays, 3], uniform(23, 3 * rays, 0.0, 1.0))),
    ])
}

/// Initial values except for a density bias that keeps every density positive, rounded to f32.
fn network() -> NerfMlp {
    let mut net = NerfMlp::initial(&Shape::PAPER, &CS180, &Key::new(0, Purpose::Parameters));
    net.sigma.b[0] += 0.1;
    for layer in net.layers_mut() {
        layer.w.mapv_inplace(|x| f64::from(x as f32));
        layer.b.mapv_inplace(|x| f64::from(x as f32));
    }
    net
}

fn results(loss: f64, gradient: &NerfMlp) -> Arrays {
    let mut out = arrays([("loss", scalar(loss))]);
    for (name, layer) in gradient.layers() {
        out.insert(format!("grad_{name}_w"), layer.w.clone().into_dyn());
        out.insert(format!("grad_{name}_b"), layer.b.clone().into_dyn());
    }
    out
}

fn oracle(a: &Arrays) -> Box<dyn Kernel> {
    let field = Field {
        net: network(),
        position: Encoding::new(10, &CS180),
        direction: Encoding::new(4, &CS180),
        cube: None,
        conventions: CS180,
    };
    let [o, d, t, targets] = ["origins", "directions", "t", "targets"].map(|name| values(a, name));
    let vector = |x: &[f64], r: usize| DVec3::new(x[3 * r], x[3 * r + 1], x[3 * r + 2]);
    let target = |r: usize| {
        let ray = Ray { o: vector(&o, r), d: vector(&d, r) };
        let t = t[r * SAMPLES..(r + 1) * SAMPLES].to_vec();
        Target { ray, t, deltas: vec![WIDTH; SAMPLES], rgb: vector(&targets, r).to_array() }
    };
    let batch: Vec<Target> = (0..o.len() / 3).map(target).collect();
    let bytes = 16 * t.len();
    let data = (batch, None);
    let run = move |(batch, out): &mut (Vec<Target>, Option<(f64, NerfMlp)>)| {
        *out = Some(field.loss_and_gradient(batch, [0.0; 3]));
    };
    kernel(data, bytes, run, |(_, out)| {
        let (loss, gradient) = out.as_ref().expect("has run");
        results(*loss, gradient)
    })
}

/// A step of the f32 path and Adam; `dense` computes samples without any effect too.
fn step(a: &Arrays, dense: bool) -> Box<dyn Kernel> {
    let net = Network::new(&network(), &Shape::PAPER, &CS180);
    let moments = Moments::new(net.params.len());
    let inputs = ["origins", "directions", "t"].map(|name| values(a, name));
    let targets = singles(a, "targets");
    let deltas = vec![WIDTH; inputs[2].len()];
    let bytes = 16 * deltas.len() + 20 * net.params.len();
    type Data = (Network, Moments, Gradient, f64);
    let run = move |(net, moments, gradient, loss): &mut Data| {
        let [origins, directions, t] = &inputs;
        let rays = Rays { origins, directions, t, deltas: &deltas, samples: SAMPLES, cube: None };
        *loss = net.step(&Batch { rays, targets: &targets, background: [0.0; 3] }, dense, gradient);
        moments.update(net.arch, &Adam::default(), &mut net.params, &gradient.values);
    };
    kernel((net, moments, Gradient::default(), 0.0), bytes, run, |(net, _, gradient, loss)| {
        results(*loss, &net.to_oracle(&gradient.values))
    })
}

/// The suite of the training step.
pub(crate) const SUITE: Suite = Suite {
    component: "training_step",
    judged: false,
    item: "point",
    workload,
    items: 256 * SAMPLES,
    checked: 2 * SAMPLES,
    oracle,
    variants: &[
        Variant {
            name: "dense",
            about: "all threads, every sample computed, Adam included",
            dtype: Dtype::F32,
            tolerance: Tolerance::exact().of_largest(1e-4),
            prepare: |a| step(a, true),
        },
        Variant {
            name: "nothing_for_nothing",
            about: "the same without samples that can't have a gradient",
            dtype: Dtype::F32,
            tolerance: Tolerance::exact().of_largest(1e-4),
            prepare: |a| step(a, false),
        },
    ],
};
