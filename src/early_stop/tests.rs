//! The stated error of the early stop, in colour and in gradient.

use super::live_samples;
use crate::convention::ProductEps;
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

/// The colour moves by at most eps, whatever the background; some ray comes within a tenth of it, so the bound isn't idle.
#[test]
fn colour_error_is_at_most_eps() {
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
}
