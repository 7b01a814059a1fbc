//! The oracle's bits: the same on every machine, in every build.

use nerf_oracle::contract::{Arrays, Component, Kind, arrays::array};
use nerf_oracle::convention::{CS180, Conventions, Density, Grid, RateEnd};
use nerf_oracle::encoding::{Encoding, positional_encoding};
use nerf_oracle::field::nerf_mlp::{NerfMlp, Shape};
use nerf_oracle::optimizer::{Adam, Moments, adam_step};
use nerf_oracle::random::{Key, Purpose};
use nerf_oracle::sample::sample_along_ray;
use nerf_oracle::{COMPONENTS, field, learning_rate, loss, volume_rendering as render};

/// Of [`training_step`].
const PINNED: u64 = 0x4b77_4521_1873_d685;

/// FNV-1a over names, shapes and bits.
fn digest(digest: u64, arrays: &Arrays) -> u64 {
    let mut bytes = vec![];
    for (name, array) in arrays {
        bytes.extend(name.as_bytes());
        array.shape().iter().for_each(|n| bytes.extend((*n as u64).to_le_bytes()));
        // A NaN's payload is not specified; that it is NaN is.
        array
            .iter()
            .for_each(|x| bytes.extend(if x.is_nan() { f64::NAN } else { *x }.to_bits().to_le_bytes()));
    }
    bytes.iter().fold(digest, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
}

/// One number for all cases of a component, forward and backward.
fn bits(component: &Component) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325;
    for kind in [Kind::Forward, Kind::Vjp] {
        let Some(direction) = component.direction(kind) else { continue };
        for case in component.cases_of(kind, &CS180) {
            hash = digest(hash, &(direction.oracle)(&case.inputs, &CS180));
        }
    }
    hash
}

#[test]
fn a_second_run_and_other_threads_give_the_same_bits() {
    let alone: Vec<u64> = COMPONENTS.iter().map(bits).collect();
    let beside: Vec<u64> = std::thread::scope(|scope| {
        let threads: Vec<_> = COMPONENTS.iter().map(|c| scope.spawn(move || bits(c))).collect();
        threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
    });
    assert_eq!(alone, beside);
}

/// The numbers of one fixed training step: network, encoding, rendering, gradient and Adam, through every function of `math`.
fn training_step() -> Vec<f64> {
    let c = Conventions { density: Density::Softplus, ..CS180 };
    let (position, direction) = (Encoding::new(6, &c), Encoding::new(2, &c));
    let shape = Shape { position: 39, direction: 15, width: 16, depth: 8, color: 8 };
    let net = NerfMlp::initial(&shape, &c, &Key::new(1, Purpose::Parameters));
    let u = Key::new(1, Purpose::Samples).uniforms(0, 0, 8);
    let t = sample_along_ray(2.0, 6.0, &u, Grid::Intervals);
    let d = positional_encoding(&[0.48, -0.6, 0.64], &direction);
    let tapes: Vec<_> = t
        .iter()
        .map(|t| {
            net.forward(&positional_encoding(&[0.1 + 0.12 * t, 0.2 - 0.15 * t, 0.16 * t], &position), &d, &c)
        })
        .collect();
    let (sigmas, rgbs): (Vec<f64>, Vec<_>) = tapes.iter().map(|tape| (tape.sigma, tape.rgb)).unzip();
    let deltas = [0.5; 8];
    let ray = render::volume_render(&sigmas, &rgbs, &deltas, c.product_eps);
    let g = loss::backward::mse(&ray.color, &[0.25, 0.5, 0.75], 1.0);
    let g = render::backward::Cotangent {
        color: [g[0], g[1], g[2]],
        weights: vec![0.0; 8],
        opacity: 0.0,
        transmittance: 0.0,
    };
    let (g_sigmas, g_rgbs, _) =
        render::backward::volume_render(&sigmas, &rgbs, &deltas, c.product_eps, &ray, &g);
    let mut gradient = net.clone();
    for (i, tape) in tapes.iter().enumerate() {
        field::backward::nerf_mlp(&net, tape, &c, g_sigmas[i], g_rgbs[i], &mut gradient);
    }
    let mut numbers = [sigmas, ray.weights, ray.transmittance, ray.color.to_vec()].concat();
    for ((_, layer), (_, g)) in net.layers().iter().zip(gradient.layers()) {
        for (&param, &g) in layer.w.iter().zip(&g.w) {
            let state = adam_step(&Adam::default(), Moments { param, m: 0.0, v: 0.0 }, g, 1);
            numbers.extend([g, state.param, state.v]);
        }
    }
    let rate = learning_rate::exponential(5e-4, 0.1, 37, 100, RateEnd::GoesOn);
    numbers.extend([loss::psnr(0.037, 1.0), rate]);
    numbers
}

#[test]
fn a_training_step_has_these_bits_everywhere() {
    // x86-64, release. A formula that is changed on purpose changes this number.
    let numbers =
        Arrays::from([("training step".to_string(), array(&[training_step().len()], training_step()))]);
    let found = digest(0xcbf2_9ce4_8422_2325, &numbers);
    assert_eq!(found, PINNED, "{found:#018x}");
}
