//! The fast networks against the oracle, on the same parameters and rays; and against themselves on other numbers of threads.

use pulp::Arch;

use super::{Batch, Gradient, ImageNetwork, Network, Rays, Skipping};
use crate::convention::{CS180, Conventions, Density, ProductEps};
use crate::early_stop::live_samples;
use crate::encoding::{Encoding, positional_encoding};
use crate::field::nerf_mlp::Shape;
use crate::field::{Layer, Mlp, NerfMlp, backward};
use crate::parallel::with_threads;
use crate::random::{Key, Purpose};
use crate::volume_rendering as volume;

mod skipping;

const SMALL: Shape = Shape { position: 63, direction: 27, width: 24, depth: 5, color: 20 };
/// The encoding again into the third of its five layers.
const EARLY: Conventions = Conventions { skip_layer: 2, ..CS180 };
const BACKGROUND: [f32; 3] = [0.25, 0.5, 1.0];

/// Rays from a sphere of radius 4 toward the unit cube, with jittered samples between 2 and 6.
struct Scene {
    origins: Vec<f64>,
    directions: Vec<f64>,
    t: Vec<f64>,
    deltas: Vec<f64>,
    targets: Vec<f32>,
    samples: usize,
}

impl Scene {
    fn new(rays: usize, samples: usize) -> Self {
        let key = Key::new(5, Purpose::Cases);
        let unit = |v: &[f64]| {
            let norm = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            [v[0] / norm, v[1] / norm, v[2] / norm]
        };
        let width = 4.0 / samples as f64;
        let mut scene = Scene {
            origins: vec![],
            directions: vec![],
            t: vec![],
            deltas: vec![width; rays * samples],
            targets: vec![],
            samples,
        };
        for ray in 0..rays as u64 {
            let u: Vec<f64> = key.uniforms(0, ray, 9 + samples).iter().map(|u| 2.0 * u - 1.0).collect();
            let o = unit(&u[..3]).map(|x| 4.0 * x);
            scene.origins.extend(o);
            scene.directions.extend(unit(&[u[3] - o[0], u[4] - o[1], u[5] - o[2]]));
            scene.targets.extend(u[6..9].iter().map(|u| (0.5 * u + 0.5) as f32));
            scene.t.extend(u[9..].iter().enumerate().map(|(i, u)| 2.0 + (i as f64 + 0.5 * u + 0.5) * width));
        }
        scene
    }

    fn batch(&self) -> Batch<'_> {
        let Scene { origins, directions, t, deltas, targets, samples } = self;
        let rays = Rays { origins, directions, t, deltas, samples: *samples, cube: None };
        Batch { rays, targets, background: BACKGROUND }
    }
}

/// The initial network, rounded to f32, with a density head that gives about half of the samples a density.
fn network(shape: &Shape, c: &Conventions) -> NerfMlp {
    let mut net = NerfMlp::initial(shape, c, &Key::new(3, Purpose::Parameters));
    net.sigma.w *= 20.0;
    let scene = Scene::new(4, 16);
    let mut z: Vec<f64> =
        (0..64).map(|i| net.forward(&positions(&scene, i), &[0.0; 27], c).z_sigma).collect();
    z.sort_by(f64::total_cmp);
    // Between two samples, so that none of them stands on the kink of the ReLU.
    net.sigma.b[0] -= 0.5 * (z[31] + z[32]);
    for layer in net.layers_mut() {
        layer.w.mapv_inplace(|p| f64::from(p as f32));
        layer.b.mapv_inplace(|p| f64::from(p as f32));
    }
    net
}

/// Sample i of all rays, encoded.
fn positions(scene: &Scene, i: usize) -> Vec<f64> {
    let (o, d) = (&scene.origins[3 * (i / scene.samples)..], &scene.directions[3 * (i / scene.samples)..]);
    let x: [f64; 3] = std::array::from_fn(|k| o[k] + scene.t[i] * d[k]);
    positional_encoding(&x, &Encoding::new(10, &CS180))
}

/// Colors, loss and gradient of a batch, point by point in f64: for the samples that aren't left out.
fn oracle(net: &NerfMlp, c: &Conventions, batch: &Batch, skipping: Skipping) -> (Vec<f64>, f64, NerfMlp) {
    let (positions, directions) = (Encoding::new(10, c), Encoding::new(4, c));
    let mut gradient = net.clone();
    for layer in gradient.layers_mut() {
        *layer = Layer::zeros(layer.w.ncols(), layer.w.nrows());
    }
    let (rays, background) = (&batch.rays, batch.background.map(f64::from));
    let (n, count) = (rays.samples, 3 * rays.len());
    let (mut colors, mut loss) = (vec![], 0.0);
    for ray in 0..rays.len() {
        let (o, d) = (&rays.origins[3 * ray..][..3], &rays.directions[3 * ray..][..3]);
        let live = (ray * n..(ray + 1) * n).filter(|&i| skipping.live.is_none_or(|live| live[i]));
        let (t, deltas): (Vec<f64>, Vec<f64>) = live.map(|i| (rays.t[i], rays.deltas[i])).unzip();
        let direction = positional_encoding(d, &directions);
        let point = |t: f64| [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
        let tapes: Vec<_> = t
            .iter()
            .map(|&t| net.forward(&positional_encoding(&point(t), &positions), &direction, c))
            .collect();
        let mut sigmas: Vec<f64> = tapes.iter().map(|t| t.sigma).collect();
        let end = live_samples(&sigmas, &deltas, f64::from(skipping.stop));
        sigmas.truncate(end);
        let rgbs: Vec<[f64; 3]> = tapes[..end].iter().map(|t| t.rgb).collect();
        let deltas = &deltas[..end];
        let rendering = volume::volume_render(&sigmas, &rgbs, deltas, ProductEps::None);
        let color = volume::composite_background(rendering.color, rendering.opacity, background);
        let r: [f64; 3] = std::array::from_fn(|k| color[k] - f64::from(batch.targets[3 * ray + k]));
        loss += r.iter().map(|r| r * r / count as f64).sum::<f64>();
        colors.extend(color);
        let g_color = r.map(|r| 2.0 * r / count as f64);
        let (color, opacity, _) =
            volume::backward::composite_background(rendering.opacity, background, g_color);
        let g = volume::backward::Cotangent { color, weights: vec![0.0; end], opacity, transmittance: 0.0 };
        let (g_sigmas, g_rgbs, _) =
            volume::backward::volume_render(&sigmas, &rgbs, deltas, ProductEps::None, &rendering, &g);
        for i in 0..end {
            backward::nerf_mlp(net, &tapes[i], c, g_sigmas[i], g_rgbs[i], &mut gradient);
        }
    }
    (colors, loss, gradient)
}

/// Largest difference of two layers over the largest entry of the second, weights and biases apart.
fn difference(got: &Layer, want: &Layer) -> f64 {
    let largest = |values: Vec<f64>| values.into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let w = largest((&got.w - &want.w).into_iter().collect()) / largest(want.w.iter().copied().collect());
    let b = largest((&got.b - &want.b).into_iter().collect()) / largest(want.b.iter().copied().collect());
    w.max(b)
}

fn agrees(shape: &Shape, c: &Conventions, dense: bool, arch: Arch) {
    let scene = Scene::new(4, 16);
    let batch = scene.batch();
    let net = network(shape, c);
    let (colors, loss, gradient) = oracle(&net, c, &batch, Skipping::default());

    let mut fast = Network::new(&net, shape, c);
    fast.arch = arch;
    let rendered = fast.render(&batch.rays, BACKGROUND);
    for (got, want) in rendered.colors.iter().zip(&colors) {
        assert!((f64::from(*got) - want).abs() < 1e-5, "color {got}, expected {want}");
    }
    let mut got = Gradient::default();
    let got_loss = fast.step(&batch, dense, &mut got);
    assert!((got_loss - loss).abs() < 1e-5, "loss {got_loss}, expected {loss}");
    assert_eq!(got.forward_points, 64);
    if c.density == Density::Relu {
        assert!(if dense { got.backward_points == 64 } else { (8..57).contains(&got.backward_points) });
    }
    let got = fast.to_oracle(&got.values);
    for ((name, want), (_, got)) in gradient.layers().into_iter().zip(got.layers()) {
        let difference = difference(got, want);
        assert!(difference < 1e-4, "gradient of {name}: {difference:e} of its largest entry");
    }
}

#[test]
fn the_papers_network_agrees_with_the_oracle() {
    for density in [Density::Relu, Density::Softplus, Density::Exp] {
        agrees(&Shape::PAPER, &Conventions { density, ..CS180 }, false, crate::simd::arch());
    }
    agrees(&Shape::PAPER, &CS180, true, crate::simd::arch());
}

#[test]
fn other_shapes_and_the_scalar_path_agree_with_the_oracle() {
    agrees(&SMALL, &EARLY, false, crate::simd::arch());
    agrees(&SMALL, &EARLY, true, Arch::Scalar);
    let none = Conventions { density: Density::Softplus, skip_layer: 9, ..CS180 };
    agrees(&SMALL, &none, false, Arch::Scalar);
}

/// All numbers of threads, twice, with buffers left over from an earlier and larger step.
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let scene = Scene::new(150, 24);
    let net = Network::new(&network(&SMALL, &EARLY), &SMALL, &EARLY);
    let run = |threads| {
        with_threads(Some(threads), || {
            let mut gradient = Gradient::default();
            net.step(&Scene::new(400, 40).batch(), true, &mut gradient);
            let loss = net.step(&scene.batch(), false, &mut gradient);
            (loss.to_bits(), gradient.values.iter().map(|g| g.to_bits()).collect::<Vec<_>>())
        })
    };
    let one = run(1);
    assert!(one.1.iter().any(|&g| g != 0));
    for threads in [2, 3, 8, 8] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

/// Leaving out samples without effect changes nothing: the compacted step is the dense one except for the order of sums.
#[test]
fn idle_samples_contribute_nothing() {
    let scene = Scene::new(40, 32);
    let net = Network::new(&network(&SMALL, &EARLY), &SMALL, &EARLY);
    let (mut dense, mut compact) = (Gradient::default(), Gradient::default());
    let losses = [net.step(&scene.batch(), true, &mut dense), net.step(&scene.batch(), false, &mut compact)];
    assert!((losses[0] - losses[1]).abs() < 1e-7);
    assert!(compact.backward_points < dense.backward_points);
    let largest = dense.values.iter().fold(0.0f32, |m, g| m.max(g.abs()));
    for (a, b) in dense.values.iter().zip(&compact.values) {
        assert!((a - b).abs() < 1e-5 * largest);
    }
}

/// A batch in which nothing has any density has a loss, and no gradient.
#[test]
fn an_empty_scene_has_no_gradient() {
    let mut net = network(&SMALL, &EARLY);
    net.sigma.w.fill(0.0);
    net.sigma.b.fill(-1.0);
    let net = Network::new(&net, &SMALL, &EARLY);
    let scene = Scene::new(4, 16);
    let mut gradient = Gradient::default();
    assert!(net.step(&scene.batch(), false, &mut gradient) > 0.0);
    assert!(gradient.values.iter().all(|&g| g == 0.0));
    assert_eq!(gradient.backward_points, 0);
    assert_eq!(net.render(&scene.batch().rays, BACKGROUND).colors[..3], BACKGROUND);
}

/// A NaN in a parameter reaches the loss instead of being clipped by a ReLU or left out as idle.
#[test]
fn nan_is_not_hidden() {
    let mut net = Network::new(&network(&SMALL, &EARLY), &SMALL, &EARLY);
    net.params[5] = f32::NAN;
    assert!(net.step(&Scene::new(4, 16).batch(), false, &mut Gradient::default()).is_nan());
}

#[test]
fn forward_agrees_with_the_oracle() {
    let c = Conventions { density: Density::Softplus, ..CS180 };
    let oracle = network(&Shape::PAPER, &c);
    let net = Network::new(&oracle, &Shape::PAPER, &c);
    let key = Key::new(8, Purpose::Cases);
    let positions: Vec<f64> =
        key.uniforms(0, 0, 3 * 1200).iter().map(|u| f64::from((4.0 * u - 2.0) as f32)).collect();
    let directions: Vec<f64> = key.uniforms(0, 1, 3 * 400).iter().map(|u| 2.0 * u - 1.0).collect();
    let (sigmas, rgbs) = net.forward(&positions, &directions, 3);
    assert_eq!((sigmas.len(), rgbs.len()), (1200, 3600));
    for i in (0..1200).step_by(37) {
        let x = positional_encoding(&positions[3 * i..][..3], &Encoding::new(10, &c));
        let d = positional_encoding(&directions[i / 3 * 3..][..3], &Encoding::new(4, &c));
        let want = oracle.forward(&x, &d, &c);
        assert!((f64::from(sigmas[i]) - want.sigma).abs() < 1e-5 * want.sigma.max(1.0));
        for k in 0..3 {
            assert!((f64::from(rgbs[3 * i + k]) - want.rgb[k]).abs() < 1e-5);
        }
    }
}

/// The 2D network: colors, loss, gradients, threads, scalar path.
#[test]
fn the_image_network_agrees_with_the_oracle() {
    let encoding = Encoding::new(10, &CS180);
    let mut oracle = Mlp::initial(42, 256, 3, 3, &Key::new(1, Purpose::Parameters));
    let points = 700;
    let key = Key::new(2, Purpose::Pixels);
    let x = key.uniforms(0, 0, 2 * points);
    let targets: Vec<f32> = key.uniforms(0, 1, 3 * points).iter().map(|&u| u as f32).collect();
    let mut net = ImageNetwork::new(&oracle, 2);
    net.write_to(&net.params, &mut oracle);

    let mut want: Vec<Layer> = oracle.layers.iter().map(|l| Layer::zeros(l.w.ncols(), l.w.nrows())).collect();
    let (mut loss, scale) = (0.0, 1.0 / (3 * points) as f64);
    let colors = net.forward(&x);
    for (n, x) in x.chunks(2).enumerate() {
        let tape = oracle.forward(&positional_encoding(x, &encoding));
        let r: Vec<f64> = (0..3).map(|k| tape.y[k] - f64::from(targets[3 * n + k])).collect();
        loss += r.iter().map(|r| r * r * scale).sum::<f64>();
        let g: Vec<f64> = r.iter().map(|r| 2.0 * r * scale).collect();
        backward::mlp(&oracle, &tape, &g, &mut want);
        for k in 0..3 {
            assert!((f64::from(colors[3 * n + k]) - tape.y[k]).abs() < 1e-5);
        }
    }
    let mut first = None;
    for (threads, arch) in [
        (1, crate::simd::arch()),
        (2, crate::simd::arch()),
        (3, crate::simd::arch()),
        (8, crate::simd::arch()),
        (2, Arch::Scalar),
    ] {
        net.arch = arch;
        let mut gradient = Gradient::default();
        let got_loss = with_threads(Some(threads), || net.step(&x, &targets, &mut gradient));
        assert!((got_loss - loss).abs() < 1e-5);
        let mut got = oracle.clone();
        net.write_to(&gradient.values, &mut got);
        for (got, want) in got.layers.iter().zip(&want) {
            assert!(difference(got, want) < 1e-4);
        }
        if !matches!(arch, Arch::Scalar) {
            assert!(*first.get_or_insert(gradient.values.clone()) == gradient.values, "{threads} threads");
        }
    }
}
