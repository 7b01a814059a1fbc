//! Seconds a training step, points per second forward, seconds to fit a picture: the measurements that `tools/bench_torch.py`
//! makes of PyTorch, in the same sizes. One JSON object a round, so that rounds of both can be interleaved:
//!
//! `cargo bench --bench step -- --rounds 1 --threads 2 --fit-steps 100`

use std::time::Instant;

use nerf_oracle::convention::CS180;
use nerf_oracle::encoding::fast::positional_encoding;
use nerf_oracle::field::fast::{Batch, Gradient, ImageNetwork, Network, Rays};
use nerf_oracle::field::nerf_mlp::Shape;
use nerf_oracle::field::{Mlp, NerfMlp};
use nerf_oracle::optimizer::{Adam, fast::Moments};
use nerf_oracle::parallel::with_threads;
use nerf_oracle::random::{Key, Purpose};

const RAYS: usize = 1024;
const SAMPLES: usize = 64;
const PIXELS: usize = 10_000;
/// Steps timed in one round; the fastest counts, as it does for the peer.
const REPEATS: usize = 3;

/// The value after `--name`, or the default.
fn argument(name: &str, default: usize) -> usize {
    let mut arguments = std::env::args().skip_while(|a| a != name);
    arguments.nth(1).map_or(default, |value| value.parse().expect("a whole number"))
}

/// The shortest of [`REPEATS`] runs, in seconds.
fn fastest(mut work: impl FnMut()) -> f64 {
    let run = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..REPEATS).map(run).fold(f64::INFINITY, f64::min)
}

fn main() {
    let threads = argument("--threads", 2);
    let fit_steps = argument("--fit-steps", 100);
    for round in 0..argument("--rounds", 3) {
        let (dense, compact, share) = with_threads(Some(threads), training_step);
        let report = serde_json::json!({
            "program": "nerf-oracle",
            "round": round,
            "threads": threads,
            "step_seconds": dense,
            "step_compact_seconds": compact,
            "step_compact_share": share,
            "forward_points_per_second": with_threads(Some(threads), forward),
            "encoding_points_per_second": encoding(),
            "fit_image_seconds_per_1000_steps": with_threads(Some(threads), || fit_image(fit_steps)),
        });
        println!("{report}");
    }
}

/// Dense and compacted steps of 1024 rays x 64 samples with Adam, and the share of samples that the latter keeps.
fn training_step() -> (f64, f64, f64) {
    let key = Key::new(0, Purpose::Cases);
    let uniform = |stream, count| key.uniforms(0, stream, count);
    let origins: Vec<f64> = uniform(0, 3 * RAYS).iter().map(|u| 4.0 * u - 2.0).collect();
    let directions: Vec<f64> = uniform(1, 3 * RAYS).iter().map(|u| 1.16 * u - 0.58).collect();
    let width = 4.0 / SAMPLES as f64;
    let jitter = uniform(2, RAYS * SAMPLES);
    let t: Vec<f64> = (0..RAYS * SAMPLES).map(|i| 2.0 + ((i % SAMPLES) as f64 + jitter[i]) * width).collect();
    let targets: Vec<f32> = uniform(3, 3 * RAYS).iter().map(|&u| u as f32).collect();
    let deltas = vec![width; RAYS * SAMPLES];
    let rays = Rays {
        origins: &origins,
        directions: &directions,
        t: &t,
        deltas: &deltas,
        samples: SAMPLES,
        cube: None,
    };
    let batch = Batch { rays, targets: &targets, background: [0.0; 3] };
    let mut net = network();
    let mut moments = Moments::new(net.params.len());
    let mut gradient = Gradient::default();
    let mut run = |dense| {
        fastest(|| {
            net.step(&batch, dense, &mut gradient);
            moments.update(net.arch, &Adam::default(), &mut net.params, &gradient.values);
        })
    };
    let seconds = (run(true), run(false));
    (seconds.0, seconds.1, gradient.backward_points as f64 / gradient.forward_points as f64)
}

/// The paper's network, initial but for a density bias that keeps every density alive.
fn network() -> Network {
    let mut oracle = NerfMlp::initial(&Shape::PAPER, &CS180, &Key::new(0, Purpose::Parameters));
    oracle.sigma.b[0] += 0.1;
    Network::new(&oracle, &Shape::PAPER, &CS180)
}

/// Points per second, densities and colors, one direction for 64 points.
fn forward() -> f64 {
    let points = RAYS * SAMPLES;
    let key = Key::new(1, Purpose::Cases);
    let positions = key.uniforms(0, 0, 3 * points);
    let directions = key.uniforms(0, 1, 3 * RAYS);
    let net = network();
    points as f64 / fastest(|| drop(net.forward(&positions, &directions, SAMPLES)))
}

/// Points per second on one thread, L = 10.
fn encoding() -> f64 {
    let points = 1 << 16;
    let positions = Key::new(1, Purpose::Cases).uniforms(0, 0, 3 * points);
    let mut out = vec![0.0; points * 63];
    points as f64
        / fastest(|| positional_encoding(nerf_oracle::simd::arch(), &positions, 3, 10, &mut out, 63))
}

/// Seconds for 1000 steps of 10,000 pixels, 3 hidden layers of 256, L = 10, from `steps` of them.
fn fit_image(steps: usize) -> f64 {
    let mut net = ImageNetwork::new(&Mlp::initial(42, 256, 3, 3, &Key::new(0, Purpose::Parameters)), 2);
    let mut moments = Moments::new(net.params.len());
    let mut gradient = Gradient::default();
    let adam = Adam { lr: 5e-3, ..Adam::default() };
    let key = Key::new(0, Purpose::Pixels);
    let start = Instant::now();
    for step in 0..steps {
        let x = key.uniforms(step as u64, 0, 2 * PIXELS);
        let targets: Vec<f32> = x.iter().flat_map(|&u| [u as f32, 0.5]).take(3 * PIXELS).collect();
        net.step(&x, &targets, &mut gradient);
        moments.update(net.arch, &adam, &mut net.params, &gradient.values);
    }
    start.elapsed().as_secs_f64() * 1000.0 / steps as f64
}
