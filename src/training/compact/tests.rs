//! The f32 model against the oracle's formulas in f64, equal bits on any number of threads, and checkpoints.

mod checkpoints;
mod pictures;
mod unbounded;

use glam::{DMat3, DMat4, DVec3};
use ndarray::Array3;
use pulp::Arch;

use super::chunk::{Chunk, Pass};
use super::forward::run;
use super::kernels::{Plain, outer, product};
use super::networks::{Networks, Weights};
use super::pace::Pace;
use super::views::{Behind, BoxRay, Target};
use super::{CompactModel, Overrides};
use crate::camera::{Camera, Intrinsics};
use crate::convention::{ExponentShift, HarmonicForm, HarmonicSign, ProductEps};
use crate::hash_grid::fast::FEATURES;
use crate::loss::psnr;
use crate::occupancy_grid::fast::MarchRay;
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::scene::{Frame, Scene};
use crate::training::Model;
use crate::volume_rendering::{composite_background, volume_render};
use crate::{spherical_harmonics, trunc_exp};

/// A red and green ball of radius 1/2, unlit, in front of black; 12 cameras at distance 2 around it.
fn ball() -> Scene {
    let size = 24;
    let k = Intrinsics { fx: 30.0, fy: 30.0, cx: 12.0, cy: 12.0 };
    let frame = |n: usize| {
        let angle = n as f64 * std::f64::consts::TAU / 12.0;
        let o = 2.0 * DVec3::new(angle.cos(), angle.sin(), 0.5 * (n % 3) as f64 - 0.5).normalize();
        let z = -o.normalize();
        let x = z.cross(DVec3::Z).normalize();
        let mut c2w = DMat4::from_mat3(DMat3::from_cols(x, z.cross(x), z));
        c2w.w_axis = o.extend(1.0);
        let camera = Camera { width: size, height: size, k, c2w, distortion: None };
        let rays = crate::evaluation::camera_rays(&camera).unwrap();
        let color = |j: usize, i: usize, c: usize| {
            let ray = &rays[j * size + i];
            let b = ray.o.dot(ray.d);
            let root = b * b - ray.o.length_squared() + 0.25;
            let hit = ray.at(-b - root.max(0.0).sqrt());
            if root < 0.0 { 0.0 } else { [0.5 + hit.x, 0.5 + hit.y, 0.1][c] as f32 }
        };
        let image = Array3::from_shape_fn((size, size, 3), |(j, i, c)| color(j, i, c));
        Frame { name: n.to_string(), camera, image: Some(image.into()) }
    };
    let (val, train) = (0..12).map(frame).partition(|f: &Frame| f.name == "5");
    Scene {
        name: "ball".into(),
        train,
        val,
        test: vec![],
        near: 1.0,
        far: 3.0,
        far_given: false,
        background: [0.0; 3],
        bounds: None,
        cloud: None,
        focus: DVec3::ZERO,
        warnings: vec![],
        reasons: serde_json::Map::new(),
    }
}

fn trained(steps: u64) -> CompactModel {
    let scene = ball();
    let mut model = CompactModel::new(&scene, &Overrides::default()).unwrap();
    for step in 1..=steps {
        model.step(&scene, step).unwrap();
    }
    model
}

fn numbers(n: u64, len: usize) -> Vec<f32> {
    let key = Key::new(n, Purpose::Cases);
    key.uniforms(0, 0, len).into_iter().map(|u| 2.0 * u as f32 - 1.0).collect()
}

fn rows<const N: usize>(n: u64, len: usize) -> Vec<[f32; N]> {
    numbers(n, N * len).as_chunks::<N>().0.to_vec()
}

struct Kernels<'a> {
    x: &'a [[f32; 32]],
    w: &'a [[f32; 64]],
    y: &'a mut [[f32; 64]],
    dw: &'a mut [[f32; 64]],
}

impl pulp::WithSimd for Kernels<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, s: S) {
        product(s, self.x, 32, self.w, self.y, true, true);
        outer(s, self.x, 32, self.y, self.dw);
    }
}

#[test]
fn kernels_agree_with_plain_loops() {
    let (x, w, before) = (rows::<32>(1, 48), rows::<64>(2, 32), rows::<64>(3, 48));
    for arch in [crate::simd::arch(), Arch::Scalar] {
        let (mut y, mut dw) = (before.clone(), vec![[1.0; 64]; 32]);
        arch.dispatch(Kernels { x: &x, w: &w, y: &mut y, dw: &mut dw });
        for (p, row) in y.iter().enumerate() {
            for (o, &y) in row.iter().enumerate() {
                let sum: f64 = (0..32).map(|i| f64::from(x[p][i]) * f64::from(w[i][o])).sum();
                let expected = (sum + f64::from(before[p][o])).max(0.0);
                assert!((f64::from(y) - expected).abs() < 33.0 * 33.0 * 6e-8, "{y} {expected}");
            }
        }
        for (i, row) in dw.iter().enumerate() {
            for (o, &d) in row.iter().enumerate() {
                let sum: f64 = (0..48).map(|p| f64::from(x[p][i]) * f64::from(y[p][o])).sum();
                assert!((f64::from(d) - 1.0 - sum).abs() < 49.0 * 300.0 * 6e-8);
            }
        }
    }
}

/// `x W`, in f64.
fn layer<const N: usize>(x: &[f64], w: &[[f32; N]]) -> Vec<f64> {
    (0..N).map(|o| x.iter().zip(w).map(|(x, w)| x * f64::from(w[o])).sum()).collect()
}

fn relu(mut x: Vec<f64>) -> Vec<f64> {
    x.iter_mut().for_each(|x| *x = x.max(0.0));
    x
}

/// sigma and color of an encoded sample, from the formulas.
fn field(w: &Weights, encoding: &[f64], direction: [f64; 3]) -> (f64, [f64; 3]) {
    let geometry = layer(&relu(layer(encoding, &w.density0)), &w.density1);
    let seen = layer(
        &spherical_harmonics::harmonics(direction, 3, HarmonicForm::Sphere, HarmonicSign::Alternating),
        &w.view,
    );
    let hidden = layer(&geometry, &w.color0).into_iter().zip(seen).map(|(a, b)| a + b).collect();
    let raw = layer(&relu(hidden), &w.color1);
    (trunc_exp::trunc_exp(geometry[0]), [0, 1, 2].map(|k| 1.0 / (1.0 + (-raw[k]).exp())))
}

const BACKGROUND: [f64; 3] = [0.25, 0.5, 1.0];
const COUNTS: [usize; 5] = [7, 0, 1, 30, 64];
/// The light that the rays' pixels let through, where they count over all backgrounds.
const CLEAR: [Option<f64>; 5] = [None, Some(0.5), Some(1.0), None, Some(0.25)];

fn direction(r: usize) -> [f64; 3] {
    DVec3::new(0.3 + r as f64, -0.5, 0.2).normalize().to_array()
}

/// The chunk's loss from the oracle's formulas.
fn oracle_loss(w: &Weights, encodings: &[[f32; 32]], delta: f64) -> f64 {
    let (mut first, mut loss) = (0, 0.0);
    for (r, count) in COUNTS.into_iter().enumerate() {
        let samples = encodings[first..first + count].iter();
        let unit = direction(r).map(|x| f64::from(x as f32));
        let (sigmas, rgbs): (Vec<f64>, Vec<[f64; 3]>) =
            samples.map(|e| field(w, &e.map(f64::from), unit)).unzip();
        first += count;
        let seen = volume_render(&sigmas, &rgbs, &vec![delta; count], ProductEps::None);
        let over = |background: [f64; 3], target: f64| {
            let color = composite_background(seen.color, seen.opacity, background);
            color.iter().map(|c| (c - target) * (c - target)).sum::<f64>()
        };
        loss += match CLEAR[r] {
            // Simpson's rule over all backgrounds, exact for squares.
            Some(clear) => {
                [(1.0, 0.0), (4.0, 0.5), (1.0, 1.0)]
                    .map(|(w, b)| w * over([b; 3], 0.3 + b * clear))
                    .iter()
                    .sum::<f64>()
                    / 6.0
            }
            None => over(BACKGROUND, 0.3),
        };
    }
    loss / (3 * COUNTS.len()) as f64
}

fn chunk_of(encodings: &[[f32; 32]], delta: f32) -> Chunk {
    let mut chunk = Chunk::default();
    for (r, count) in COUNTS.into_iter().enumerate() {
        let unit = direction(r).map(|x| x as f32);
        chunk.push_ray(
            &BoxRay { o: [0.0; 3], d: [1.0; 3], unit },
            Target {
                color: [0.3; 3],
                behind: match CLEAR[r] {
                    Some(clear) => Behind::Anything { clear: clear as f32 },
                    None => Behind::Color(BACKGROUND.map(|b| b as f32)),
                },
            },
            0,
            false,
        );
        let march_ray =
            MarchRay { o: [0.5; 3], d: [0.0; 3], near: 0.0, far: 1.0, u: 0.5, patience: u32::MAX };
        chunk.push_samples(&march_ray, &vec![0.5; count], &Pace::even(1.0, delta));
    }
    chunk.reserve();
    chunk.spread(0, encodings);
    chunk
}

/// Loss and gradients of a chunk against the oracle's loss and its central differences, vectorized and scalar.
#[test]
fn gradients_agree_with_the_oracle() {
    let nets = Networks::new(Weights::random(&Key::new(4, Purpose::Parameters)));
    let encodings = rows::<32>(5, COUNTS.iter().sum());
    let pass = Pass {
        nets: &nets,
        weights: &nets.weights,
        stop: 0.0,
        view_dependent: true,
        gradient: Some(2.0 / (3 * COUNTS.len()) as f32),
        scatter: None,
    };
    for arch in [crate::simd::arch(), Arch::Scalar] {
        let mut chunk = chunk_of(&encodings, 0.05);
        let delta = f64::from(0.05f32);
        run(arch, &pass, &mut chunk, &Plain);
        let loss = chunk.error / (3 * COUNTS.len()) as f64;
        assert!((loss - oracle_loss(&nets.weights, &encodings, delta)).abs() < 1e-6);
        let h = 1e-3;
        for (part, gradient) in chunk.gradient.parts().into_iter().enumerate() {
            let largest = gradient.iter().fold(0f32, |a, b| a.max(b.abs()));
            assert!(largest > 1e-4, "part {part} has a gradient");
            for i in (0..gradient.len()).step_by(37).filter(|i| part != 4 || i % 16 < 3) {
                let at = |h: f32| {
                    let mut moved = nets.weights.clone();
                    moved.parts_mut()[part][i] += h;
                    let h = f64::from(moved.parts()[part][i]) - f64::from(nets.weights.parts()[part][i]);
                    (oracle_loss(&moved, &encodings, delta), h)
                };
                let ((up, a), (down, b)) = (at(h), at(-h));
                let slope = (up - down) / (a - b);
                // Central differences across a ReLU's kink are off by the kink's share of h.
                assert!(
                    (slope - f64::from(gradient[i])).abs() < 2e-2 * f64::from(largest),
                    "part {part}, {i}: {slope} {}",
                    gradient[i]
                );
            }
        }
        for (p, f) in [(0, 0), (3, 17), (8, 31), (40, 5), (101, 9)] {
            let at = |h: f32| {
                let mut moved = encodings.clone();
                moved[p][f] += h;
                oracle_loss(&nets.weights, &moved, delta)
            };
            let slope = (at(1e-3) - at(-1e-3)) / 2e-3;
            let got = f64::from(chunk.encoding[f / FEATURES][p][f % FEATURES]);
            assert!((slope - got).abs() < 1e-6 + 2e-2 * got.abs(), "{p} {f}: {slope} {got}");
        }
    }
}

/// The early stop moves no color by more than its eps.
#[test]
fn early_stop_keeps_its_word() {
    let nets = Networks::new(Weights::random(&Key::new(4, Purpose::Parameters)));
    let encodings = rows::<32>(5, COUNTS.iter().sum());
    let colors = |stop| {
        let mut chunk = chunk_of(&encodings, 0.5);
        let pass = Pass {
            nets: &nets,
            weights: &nets.weights,
            stop,
            view_dependent: true,
            gradient: None,
            scatter: None,
        };
        run(crate::simd::arch(), &pass, &mut chunk, &Plain);
        (chunk.rays.iter().map(|r| r.color).collect::<Vec<_>>(), chunk.points.len())
    };
    let ((full, all), (short, live)) = (colors(0.0), colors(1e-2));
    assert!(live < all, "{live} of {all}: something must have been left out");
    let moved = full.iter().zip(&short).flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).abs()));
    let worst = moved.fold(0.0, f32::max);
    assert!(worst <= 1e-2 && worst > 0.0, "{worst}");
}

/// A ray that was ended while light was left has no gradient in this step, and is the first of the next one, marched to its end.
#[test]
fn a_ray_that_was_given_up_too_early_is_drawn_again() {
    let nets = Networks::new(Weights::random(&Key::new(4, Purpose::Parameters)));
    let encodings = rows::<32>(5, COUNTS.iter().sum());
    let gradient = |cut: [bool; 5]| {
        let mut chunk = chunk_of(&encodings, 0.05);
        (0..5).for_each(|r| (chunk.rays[r].cut, chunk.rays[r].pixel) = (cut[r], 70 + r as u32));
        let pass = Pass {
            nets: &nets,
            weights: &nets.weights,
            stop: 1e-4,
            view_dependent: true,
            gradient: Some(1.0),
            scatter: None,
        };
        run(crate::simd::arch(), &pass, &mut chunk, &Plain);
        let light: Vec<f32> = chunk.rays.iter().map(|ray| ray.transmittance).collect();
        (chunk, light)
    };
    let (all, light) = gradient([false; 5]);
    assert!(light[0] > 0.1 && all.again.is_empty());
    let (less, _) = gradient([true, false, false, false, false]);
    assert_eq!(less.again, [70]);
    assert!(less.error < all.error && less.gradient.density0 != all.gradient.density0);
    let first_rays = |chunk: &Chunk| {
        let mut rows = [[0.0; 32]; 7];
        chunk.gather(0, &mut rows);
        rows
    };
    assert!(first_rays(&less).as_flattened().iter().all(|&g| g == 0.0));
    assert!(first_rays(&all).as_flattened().iter().any(|&g| g != 0.0));

    let scene = ball();
    let mut model = CompactModel::new(&scene, &Overrides::default()).unwrap();
    model.again = vec![77, 5];
    model.step(&scene, 1).unwrap();
    let first = &model.chunks[0].rays[..2];
    assert!(first.iter().map(|ray| ray.pixel).eq([77, 5]) && first.iter().all(|ray| !ray.cut));
}

fn bits(model: &CompactModel) -> Vec<u32> {
    let levels = model.levels.iter().flat_map(|l| l.table().as_flattened().iter().map(|x| x.to_bits()));
    let weights = model.nets.weights.parts().into_iter().flatten().map(|x| x.to_bits());
    levels.chain(weights).collect()
}

#[test]
fn same_bits_on_any_number_of_threads() {
    let one = bits(&parallel::with_threads(Some(1), || trained(40)));
    for threads in [2, 3, 8] {
        assert!(one == bits(&parallel::with_threads(Some(threads), || trained(40))), "{threads} threads");
    }
}

/// It learns: 20 dB on a view it has never seen, and most of the box is known to be empty.
#[test]
fn learns_a_ball() {
    let scene = ball();
    let model = trained(150);
    let frame = &scene.val[0];
    let seen = model.render(&crate::evaluation::camera_rays(&frame.camera).unwrap());
    let image = frame.image.as_ref().unwrap();
    let error: f64 = seen
        .iter()
        .zip(image.colors())
        .flat_map(|(a, b)| (0..3).map(move |k| f64::from(a.rgb[k] - b[k]).powi(2)))
        .sum();
    let db = psnr(error / (3 * image.len()) as f64, 1.0);
    assert!(db > 20.0, "{db} dB");
    assert!(model.occupancy.fraction() < 0.7, "{}", model.occupancy.fraction());
    // In the middle the ball's front stands at distance 3/2 and its back at 5/2; fog in between would be at 2.
    let depth = seen[12 * 24 + 12].depth;
    assert!((1.25..1.85).contains(&depth), "{depth}");
}

/// What `run.json` says of the density's exponent is what the vector code does.
#[test]
fn the_density_is_the_declared_one() {
    for x in [-80.0f32, -15.5, -14.5, -3.0, 0.0, 8.0, 14.5, 15.5, 80.0] {
        let want = trunc_exp::density(x.into(), super::settings::EXPONENT, ExponentShift::None);
        let got = f64::from(super::forward::trunc_exp(x));
        assert!((got / want - 1.0).abs() < 2e-7, "{x}: {got}, expected {want}");
    }
}
