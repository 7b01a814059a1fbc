//! The stated error of the early stop, in color and in gradient.

use super::{live_samples, made_opaque, render_packed, used_samples};
use crate::convention::{ProductEps, Stop};
use crate::random::{Key, Purpose};
use crate::volume_rendering::{backward, composite_background, volume_render};

/// Rays of every thickness: (sigmas, rgbs, deltas).
fn ray(i: u64) -> (Vec<f64>, Vec<[f64; 3]>, Vec<f64>) {
    let u = Key::new(5, Purpose::Cases).uniforms(0, i, 64 * 4 + 1);
    let thickness = 0.01 * (1000f64).powf(u[0]);
    let sigmas = (0..64).map(|n| thickness * u[1 + n] * u[1 + n]).collect();
    let rgbs = (0..64).map(|n| [u[65 + n], u[129 + n], u[193 + n]]).collect();
    (sigmas, rgbs, vec![0.5; 64])
}

/// The color moves by at most eps, whatever the background; some ray comes within a tenth of it, so the bound is sharp.
#[test]
fn color_error_is_at_most_eps() {
    for eps in [1e-2, 1e-4] {
        let (mut worst, mut stopped) = (0f64, 0);
        for i in 0..2000 {
            let (sigmas, rgbs, deltas) = ray(i);
            let n = live_samples(&sigmas, &deltas, eps);
            stopped += usize::from(n < 64);
            let render = |n| {
                let r = volume_render(&sigmas[..n], &rgbs[..n], &deltas[..n], ProductEps::None);
                composite_background(r.color, r.opacity, [0.0, 0.5, 1.0])
            };
            let (full, short) = (render(64), render(n));
            worst = (0..3).map(|k| (full[k] - short[k]).abs()).fold(worst, f64::max);
        }
        assert!(worst <= eps && worst > 0.1 * eps, "{worst} for {eps}");
        assert!((200..1900).contains(&stopped), "{stopped} of 2000 rays stopped");
    }
}

/// Gradients of the samples that are used are those of the full ray up to eps times the cotangent's length and the step.
#[test]
fn gradient_error_is_bounded_too() {
    let eps = 1e-3;
    for i in 0..300 {
        let (sigmas, rgbs, deltas) = ray(i);
        let n = live_samples(&sigmas, &deltas, eps);
        let gradient = |n: usize| {
            let (s, c, d) = (&sigmas[..n], &rgbs[..n], &deltas[..n]);
            let forward = volume_render(s, c, d, ProductEps::None);
            let g = backward::Cotangent {
                color: [1.0, -1.0, 0.5],
                weights: vec![0.0; n],
                opacity: 0.0,
                transmittance: 0.0,
            };
            backward::volume_render(s, c, d, ProductEps::None, &forward, &g).0
        };
        for (full, short) in gradient(64).iter().zip(gradient(n)) {
            assert!((full - short).abs() <= 2.5 * 0.5 * eps, "{full} {short}");
        }
    }
}

#[test]
fn no_samples_and_opaque_ones() {
    assert_eq!(live_samples(&[], &[], 1e-4), 0);
    assert_eq!(live_samples(&[f64::INFINITY, 1.0], &[1.0, 1.0], 1e-4), 1);
    assert_eq!(live_samples(&[0.0; 5], &[1.0; 5], 1e-4), 5);
    // T = 1 = eps isn't below eps.
    assert_eq!(live_samples(&[0.0; 5], &[1.0; 5], 1.0), 5);
}

/// VR2: a sample without density in a step without end absorbs nothing, as in `volume_render`. The plain product is NaN, with which no
/// transmittance is below eps: the wall behind would not stop the ray.
#[test]
fn vr2_an_endless_step_of_nothing() {
    let (sigmas, deltas) = ([0.0, 128.0, 1.0], [f64::INFINITY, 1.0, 1.0]);
    assert_eq!(live_samples(&sigmas, &deltas, 0.01), 2);
    assert_eq!(live_samples(&deltas, &sigmas, 0.01), 2);
    let rays = render_packed(&sigmas, &[[1.0; 3]; 3], &deltas, &[0, 3], 0.01);
    assert_eq!((rays[0].weights.as_slice(), rays[0].color), ([0.0, 1.0].as_slice(), [1.0; 3]));
}

/// Rays of different lengths, packed, are the rays one by one, bit for bit, and the rays of one length whose ends are empty.
#[test]
fn packed_rays_are_single_rays_and_padded_ones() {
    let lengths = [7, 0, 64, 1, 33];
    let rays: Vec<_> = (0..5).map(|i| ray(40 * i)).collect();
    let (mut sigmas, mut rgbs, mut deltas, mut offsets) = (vec![], vec![], vec![], vec![0]);
    for (n, (s, c, d)) in lengths.into_iter().zip(&rays) {
        sigmas.extend(&s[..n]);
        rgbs.extend(&c[..n]);
        deltas.extend(&d[..n]);
        offsets.push(sigmas.len());
    }
    let packed = render_packed(&sigmas, &rgbs, &deltas, &offsets, 0.0);
    for ((n, (s, c, d)), packed) in lengths.into_iter().zip(&rays).zip(packed) {
        assert_eq!(packed, volume_render(&s[..n], &c[..n], &d[..n], ProductEps::None));
        let mut empty_end = s.clone();
        empty_end[n..].fill(0.0);
        let padded = volume_render(&empty_end, c, d, ProductEps::None);
        assert_eq!((packed.color, packed.opacity), (padded.color, padded.opacity));
        assert_eq!(packed.transmittance[n], padded.transmittance[64]);
    }
}

/// Packed gradients are those of each ray's live samples; samples behind a stop have none.
#[test]
fn packed_gradients_are_those_of_single_rays() {
    let (mut s, c, d) = ray(1000);
    s.iter_mut().zip(1..).for_each(|(s, i)| *s += 0.01 * f64::from(i));
    let offsets = [0, 30, 30, 64];
    let stops = live_samples(&s[30..], &d[30..], 0.05);
    let rays = render_packed(&s, &c, &d, &offsets, 0.05);
    assert!(stops > 1 && stops < 34, "{stops}");
    let cotangent = |r: usize| backward::Cotangent {
        color: [1.0, -0.5, 0.25 + r as f64],
        weights: (0..rays[r].weights.len()).map(|i| i as f64 - 3.0).collect(),
        opacity: 0.5,
        transmittance: -0.75,
    };
    let g: Vec<_> = (0..3).map(cotangent).collect();
    let packed = super::backward::render_packed(&s, &c, &d, &offsets, &rays, &g);
    let (mut g_sigmas, mut g_rgbs, mut g_deltas) = (vec![0.0; 64], vec![[0.0; 3]; 64], vec![0.0; 64]);
    for (r, first) in [(0, 0), (2, 30)] {
        let live = first..first + rays[r].weights.len();
        let (s, c, d) = (&s[live.clone()], &c[live.clone()], &d[live.clone()]);
        let single = backward::volume_render(s, c, d, ProductEps::None, &rays[r], &g[r]);
        g_sigmas[live.clone()].copy_from_slice(&single.0);
        g_rgbs[live.clone()].copy_from_slice(&single.1);
        g_deltas[live].copy_from_slice(&single.2);
    }
    assert_eq!(packed, (g_sigmas, g_rgbs, g_deltas));
    assert!(packed.0[..30].iter().any(|g| *g != 0.0) && packed.0[30] != 0.0);
}

/// VR5: a stopped ray keeps the light that is left; divided by its opacity it would be off by up to eps.
#[test]
fn nothing_is_renormalized() {
    let rays = render_packed(&[1.375; 6], &[[1.0; 3]; 6], &[0.5; 6], &[0, 6], 0.35);
    assert_eq!(rays[0].weights.len(), 2);
    assert!((rays[0].color[0] - (1.0 - (-1.375f64).exp())).abs() < 1e-15);
    assert!((rays[0].opacity + rays[0].transmittance[2] - 1.0).abs() < 1e-15);
}

/// By convention a stopped ray is divided by its opacity: white stays white, weights sum to 1, nothing of it changes with the density of
/// what all its samples share. A ray that goes through keeps its light.
#[test]
fn a_stopped_ray_is_made_opaque_by_convention() {
    let rays = render_packed(&[1.375; 8], &[[1.0, 0.5, 0.0]; 8], &[0.5; 8], &[0, 6, 8], 0.35);
    let opaque = made_opaque(&rays[0]);
    assert!((opaque.color[0] - 1.0).abs() < 1e-15 && (opaque.color[1] - 0.5).abs() < 1e-15);
    assert!((opaque.weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    assert_eq!((opaque.opacity, opaque.transmittance[2]), (1.0, 0.0));
    assert_eq!(opaque.transmittance[..2], rays[0].transmittance[..2]);
    let g = backward::Cotangent {
        color: [1.0, -2.0, 3.0],
        weights: vec![0.5; 2],
        opacity: 4.0,
        transmittance: 5.0,
    };
    let (g_sigmas, g_rgbs, _) = super::backward::render_packed(
        &[1.375; 2],
        &[[1.0, 0.5, 0.0]; 2],
        &[0.5; 2],
        &[0, 2],
        &rays[..1],
        &[super::backward::made_opaque(&rays[0], &g)],
    );
    assert!(g_sigmas.iter().all(|g| g.abs() < 1e-15), "{g_sigmas:?}");
    assert!((g_rgbs.iter().map(|g| g[2]).sum::<f64>() - 3.0).abs() < 1e-15);
}

/// Its gradient against differences, where samples, colors and cotangents all differ.
#[test]
fn the_gradient_of_a_ray_made_opaque() {
    let (c, d) = ([[0.2, 0.9, 0.4], [0.8, 0.1, 0.5], [0.3, 0.6, 1.2]], [0.5, 0.7, 0.9]);
    let g = backward::Cotangent {
        color: [1.5, -2.0, 3.0],
        weights: vec![0.5, -1.25, 2.0],
        opacity: 4.0,
        transmittance: 5.0,
    };
    let sigmas = [1.0, 2.0, 1.5];
    let render = |sigmas: &[f64; 3]| render_packed(sigmas, &c, &d, &[0, 3], 0.0);
    let loss = |sigmas: &[f64; 3]| -> f64 {
        let ray = made_opaque(&render(sigmas)[0]);
        let values = ray.color.iter().chain(&ray.weights);
        values.zip(g.color.iter().chain(&g.weights)).map(|(x, g)| x * g).sum()
    };
    let rays = render(&sigmas);
    let before = super::backward::made_opaque(&rays[0], &g);
    let (g_sigmas, g_rgbs, _) = super::backward::render_packed(&sigmas, &c, &d, &[0, 3], &rays, &[before]);
    for i in 0..3 {
        let at = |h: f64| loss(&std::array::from_fn(|j| sigmas[j] + if i == j { h } else { 0.0 }));
        let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
        assert!((g_sigmas[i] - slope).abs() < 1e-8, "{} {slope}", g_sigmas[i]);
        let share = rays[0].weights[i] / rays[0].opacity;
        (0..3).for_each(|k| assert!((g_rgbs[i][k] - g.color[k] * share).abs() < 1e-15));
    }
}

/// eps = 1 takes one sample of every ray that has some density, eps = 0 all.
#[test]
fn between_the_extremes_fewer_samples_for_larger_eps() {
    for i in 0..200 {
        let (sigmas, _, deltas) = ray(i);
        let used = [0.0, 1e-6, 1e-3, 0.1, 0.9, 1.0].map(|eps| live_samples(&sigmas, &deltas, eps));
        assert!(used.windows(2).all(|pair| pair[0] >= pair[1]), "{used:?}");
        assert_eq!((used[0], used[5]), (64, 1));
    }
}

/// Optical depths of ln 2: T is 1/2, 1/4, 1/8, ... exactly. The sample that ends a ray is the last, or isn't used at all, or one more is; a ray that
/// comes to its end with light left, be it exactly the limit, keeps all.
#[test]
fn the_sample_that_ends_a_ray_counts_by_convention() {
    let ln2 = std::f64::consts::LN_2;
    let used = |count: usize, eps: f64| {
        let (sigmas, deltas) = (vec![ln2; count], vec![1.0; count]);
        [Stop::Behind, Stop::InFront, Stop::OneMore].map(|stop| used_samples(&sigmas, &deltas, eps, stop))
    };
    assert_eq!(used(6, 0.2), [3, 2, 4]);
    assert_eq!(used(6, 0.6), [1, 0, 2]);
    assert_eq!(used(3, 0.2), [3, 2, 3]);
    assert_eq!(used(2, 0.2), [2, 2, 2]);
    let left = f64::exp(-ln2);
    assert_eq!(used(1, left), [1, 1, 1]);
    assert_eq!(used(2, left), [2, 1, 2]);
    assert_eq!(used(0, 1.5), [0, 0, 0]);
}
