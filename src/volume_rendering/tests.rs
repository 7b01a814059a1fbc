use std::f64::consts::LN_2;

use proptest::prelude::*;

use super::backward::Cotangent;
use super::*;
use crate::contract::testing::{properties, slope};

const EPS: f64 = f64::EPSILON;
const ONE_HOT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn render(sigmas: &[f64], deltas: &[f64]) -> Rendering {
    volume_render(sigmas, &vec![[1.0, 0.5, 0.25]; sigmas.len()], deltas, ProductEps::None)
}

fn gradient(
    sigmas: &[f64],
    rgbs: &[[f64; 3]],
    deltas: &[f64],
    g: &Cotangent,
) -> (Vec<f64>, Vec<[f64; 3]>, Vec<f64>) {
    let forward = volume_render(sigmas, rgbs, deltas, ProductEps::None);
    backward::volume_render(sigmas, rgbs, deltas, ProductEps::None, &forward, g)
}

fn only_transmittance(n: usize) -> Cotangent {
    Cotangent { color: [0.0; 3], weights: vec![0.0; n], opacity: 0.0, transmittance: 1.0 }
}

fn finite(gradient: &(Vec<f64>, Vec<[f64; 3]>, Vec<f64>)) -> bool {
    gradient.0.iter().chain(gradient.1.as_flattened()).chain(&gradient.2).all(|g| g.is_finite())
}

#[test]
fn light_from_behind_by_hand() {
    // C + (1 - A) b.
    let (color, background) = ([0.5, 0.25, 0.125], [0.25, 0.5, 2.0]);
    assert_eq!(composite_background(color, 0.25, background), [0.6875, 0.625, 1.625]);
    let g = [0.75, -0.25, 1.25];
    let (g_color, g_opacity, g_background) = backward::composite_background(0.25, background, g);
    assert_eq!((g_color, g_background), (g, [0.5625, -0.1875, 0.9375]));
    assert_eq!(g_opacity, -(0.75 * 0.25 - 0.25 * 0.5 + 1.25 * 2.0));
}

#[test]
fn gradients_of_rendering() {
    let (sigmas, deltas) = ([0.5, 1.25, 0.0, 2.0], [0.75, 0.5, 0.25, 1.5]);
    let rgbs = [[0.25, 0.5, 0.75], [1.0, 0.125, 0.5], [0.5, 0.75, 0.25], [0.0, 1.0, 0.625]];
    let g = Cotangent {
        color: [1.0, -0.5, 0.75],
        weights: vec![0.25, -1.0, 0.5, 0.75],
        opacity: 0.5,
        transmittance: -1.5,
    };
    let pulled = |r: &Rendering| {
        let colors: f64 = (0..3).map(|k| g.color[k] * r.color[k]).sum();
        let weights: f64 = (0..4).map(|i| g.weights[i] * r.weights[i]).sum();
        colors + weights + g.opacity * r.opacity + g.transmittance * r.transmittance[4]
    };
    // 1e-7 is the largest eps in use: its effect on the slope is far above the noise of differences.
    for eps in [ProductEps::None, ProductEps::TenToMinusSeven] {
        let run = |s: &[f64], c: &[[f64; 3]], d: &[f64]| pulled(&volume_render(s, c, d, eps));
        let forward = volume_render(&sigmas, &rgbs, &deltas, eps);
        let (g_sigmas, g_rgbs, g_deltas) =
            backward::volume_render(&sigmas, &rgbs, &deltas, eps, &forward, &g);
        let alphas = [0.25, 0.5, 0.0, 1.0];
        let forward = volume_render_alpha(&alphas, &rgbs, eps);
        let (g_alphas, g_rgbs_alpha) = backward::volume_render_alpha(&alphas, &rgbs, eps, &forward, &g);
        for i in 0..4 {
            let moved = |x: [f64; 4], h: f64| {
                std::array::from_fn::<f64, 4, _>(|j| if i == j { x[j] + h } else { x[j] })
            };
            assert!(
                (g_sigmas[i] - slope(|h| run(&moved(sigmas, h), &rgbs, &deltas))).abs() < 1e-11,
                "sigma {i}"
            );
            assert!(
                (g_deltas[i] - slope(|h| run(&sigmas, &rgbs, &moved(deltas, h)))).abs() < 1e-11,
                "delta {i}"
            );
            let by_alpha = slope(|h| pulled(&volume_render_alpha(&moved(alphas, h), &rgbs, eps)));
            assert!((g_alphas[i] - by_alpha).abs() < 1e-11, "alpha {i}");
            for k in 0..3 {
                let tinted = |h: f64| {
                    let mut rgbs = rgbs;
                    rgbs[i][k] += h;
                    rgbs
                };
                assert!(
                    (g_rgbs[i][k] - slope(|h| run(&sigmas, &tinted(h), &deltas))).abs() < 1e-11,
                    "rgb {i} {k}"
                );
                let by_alpha = slope(|h| pulled(&volume_render_alpha(&alphas, &tinted(h), eps)));
                assert!((g_rgbs_alpha[i][k] - by_alpha).abs() < 1e-11, "rgb {i} {k} behind alphas");
            }
        }
    }
    // The eps of the factors passes gradient on: behind an opaque sample 1e-7 of the light's, T (g_w - eps g_T).
    let one = |eps| {
        let forward = volume_render_alpha(&[1.0, 0.0], &[[0.0; 3]; 2], eps);
        backward::volume_render_alpha(&[1.0, 0.0], &[[0.0; 3]; 2], eps, &forward, &only_transmittance(2)).0
    };
    assert_eq!(one(ProductEps::None), [-1.0, 0.0]);
    assert!((one(ProductEps::TenToMinusSeven)[1] + 1e-7).abs() < 1e-20);
    // From densities, e^-x + eps: behind x = 40, where e^-x is below 1e-17, the second sample still sees 1e-7.
    let forward = volume_render(&[40.0, 0.0], &[[0.0; 3]; 2], &[1.0; 2], ProductEps::TenToMinusSeven);
    let dense = |eps| {
        backward::volume_render(
            &[40.0, 0.0],
            &[[0.0; 3]; 2],
            &[1.0; 2],
            eps,
            &forward,
            &only_transmittance(2),
        )
        .0
    };
    assert!((dense(ProductEps::TenToMinusSeven)[0] / (-exp(-40.0) * (1.0 + 1e-7)) - 1.0).abs() < 1e-12);
}

#[test]
fn gradients_of_depth() {
    let (weights, t, far) = ([0.25, 0.125, 0.5], [2.0, 3.5, 5.0], 6.0);
    for convention in [Depth::Divided, Depth::Plain, Depth::FarBehind] {
        let (g_weights, g_t) = backward::depth(&weights, &t, far, convention, EmptyDepth::Far, 0.75);
        for i in 0..3 {
            let moved = |x: [f64; 3], h: f64| {
                std::array::from_fn::<f64, 3, _>(|j| if i == j { x[j] + h } else { x[j] })
            };
            let by_weight = slope(|h| 0.75 * depth(&moved(weights, h), &t, far, convention, EmptyDepth::Far));
            let by_t = slope(|h| 0.75 * depth(&weights, &moved(t, h), far, convention, EmptyDepth::Far));
            assert!(
                (g_weights[i] - by_weight).abs() < 1e-10 && (g_t[i] - by_t).abs() < 1e-10,
                "{convention:?} {i}"
            );
        }
    }
}

#[test]
fn a_slab_absorbs_1_minus_exp_of_its_depth() {
    for n in [1, 7, 64, 1024] {
        for depth in [1e-9, 0.3, 4.0, 50.0] {
            let r = render(&vec![depth / 4.0; n], &vec![4.0 / n as f64; n]);
            let expected = -expm1(-depth);
            assert!((r.opacity - expected).abs() <= 16.0 * EPS * expected, "{n} samples, depth {depth}");
            assert!((r.transmittance[n] - exp(-depth)).abs() <= 4.0 * EPS * (1.0 + depth) * exp(-depth));
            assert!((r.color[2] - 0.25 * expected).abs() <= 4.0 * EPS * expected);
        }
    }
}

#[test]
fn three_spikes_read_the_weights() {
    let rgbs = [ONE_HOT[0], ONE_HOT[1], [0.0; 3], [0.0; 3], ONE_HOT[2]];
    let expected = [0.5, 0.25, 0.125];
    assert_eq!(
        volume_render(&[LN_2, LN_2, 0.0, 0.0, LN_2], &rgbs, &[1.0; 5], ProductEps::None).color,
        expected
    );
    let r = volume_render_alpha(&[0.5, 0.5, 0.0, 0.0, 0.5], &rgbs, ProductEps::None);
    assert_eq!(
        (r.color, r.opacity, r.transmittance),
        (expected, 0.875, vec![1.0, 0.5, 0.25, 0.25, 0.25, 0.125])
    );
}

#[test]
fn a_number_in_the_product_is_added_to_each_factor() {
    let r = volume_render_alpha(&[0.5, 1.0, 0.25], &[[1.0; 3]; 3], ProductEps::TenToMinusTen);
    assert_eq!(r.transmittance[1..3], [0.5 + 1e-10, (0.5 + 1e-10) * 1e-10]);
    let from_sigmas = volume_render(&[LN_2; 3], &[[1.0; 3]; 3], &[1.0; 3], ProductEps::TenToMinusEight);
    assert!((from_sigmas.transmittance[1] - 0.5 - 1e-8).abs() < 2.0 * EPS);
    // VR3: 1,024 empty samples.
    let empty = vec![0.0; 1024];
    let end = |eps| volume_render(&empty, &vec![[0.5; 3]; 1024], &empty, eps).transmittance[1024];
    assert!((end(ProductEps::TenToMinusTen) - 1.0 - 1.024e-7).abs() < 1e-12);
    assert_eq!(end(ProductEps::None), 1.0);
}

#[test]
fn vr1_tiny_opacities_keep_their_digits() {
    for x in [1e-8, 1e-16, 1e-200, 5e-324] {
        let r = render(&[x], &[1.0]);
        // alpha = x - x^2 / 2 + ...
        assert!((r.opacity - (x - 0.5 * x * x)).abs() <= 2.0 * EPS * x);
        assert_eq!(
            gradient(
                &[x],
                &[[1.0, 0.0, 0.0]],
                &[1.0],
                &Cotangent { color: [1.0; 3], ..only_transmittance(1) }
            )
            .1[0][0],
            r.weights[0]
        );
    }
    // The textbook form keeps half of its digits at 1e-8, none at 1e-17.
    assert!(((1.0 - exp(-1e-8)) / -expm1(-1e-8) - 1.0).abs() > 1e-9 && 1.0 - exp(-1e-17) == 0.0);
}

#[test]
fn vr2_a_last_step_of_1e10() {
    let r = render(&[0.5, 1e-12], &[0.1, 1e10]);
    assert!((r.weights[1] / r.transmittance[1] - (-expm1(-0.01))).abs() < 4.0 * EPS);
    let empty = render(&[0.5, 0.0], &[0.1, f64::INFINITY]);
    assert_eq!(empty.weights[1], 0.0, "nothing absorbs nothing, over any length");
    let opaque = gradient(&[0.5, 1.0], &ONE_HOT[..2], &[0.1, f64::INFINITY], &only_transmittance(2));
    assert!(finite(&opaque), "the textbook's inf * 0 is NaN");
    assert!((f64::INFINITY * exp(-f64::INFINITY)).is_nan());
}

#[test]
fn vr4_the_gradient_at_an_opaque_sample() {
    // The cotangent [1, 2, 3, 4] falls on T_0, ..., T_3: with respect to the factors 1 - alpha it is [2, 2.9, 0, 0].
    let (alphas, cotangent) = ([0.5, 1.0, 0.3, 0.2], [1.0, 2.0, 3.0, 4.0]);
    // T_i = 1 - sum_{j<i} w_j, so g_w_j = -(sum of g_i over i > j).
    let weights = (0..4).map(|j| -cotangent[j + 1..].iter().sum::<f64>()).collect();
    let g = Cotangent { color: [0.0; 3], weights, opacity: 0.0, transmittance: 0.0 };
    let forward = volume_render_alpha(&alphas, &[[0.0; 3]; 4], ProductEps::None);
    // The textbook form divides sum_{j>1} g_j T_j by the factor, which is 0, or by a clamped one: 0 instead of 2.9.
    let t = &forward.transmittance;
    let sum = cotangent[2] * t[2] + cotangent[3] * t[3];
    assert!((sum / (1.0 - alphas[1])).is_nan() && sum / f64::max(1.0 - alphas[1], 1e-10) == 0.0);
    let (g_alphas, _) =
        backward::volume_render_alpha(&alphas, &[[0.0; 3]; 4], ProductEps::None, &forward, &g);
    for (g, expected) in g_alphas.iter().zip([2.0, 2.9, 0.0, 0.0]) {
        assert!((-g - expected).abs() < 8.0 * EPS, "{g_alphas:?}");
    }
}

#[test]
fn vr7_depth_of_an_empty_ray() {
    let empty = |of| depth(&[0.0; 3], &[1.0, 2.0, 3.0], 6.0, Depth::Divided, of);
    let all = [EmptyDepth::Far, EmptyDepth::Zero, EmptyDepth::First, EmptyDepth::Last];
    assert_eq!(all.map(empty), [6.0, 0.0, 1.0, 3.0]);
    assert_eq!(all.map(|of| depth(&[], &[], 6.0, Depth::Divided, of)), [6.0, 0.0, 6.0, 6.0]);
    // Where there is any weight, the convention says nothing.
    assert_eq!(all.map(|of| depth(&[0.5; 3], &[1.0, 2.0, 3.0], 6.0, Depth::Divided, of)), [2.0; 4]);
    // Where far lies behind the samples, an empty ray ends there without a rule of its own.
    assert_eq!(all.map(|of| depth(&[0.0; 3], &[1.0, 2.0, 3.0], 6.0, Depth::FarBehind, of)), [6.0; 4]);
    // A sample at infinity that has no weight.
    for convention in [Depth::Divided, Depth::Plain, Depth::FarBehind] {
        let (weights, t) = ([0.25, 0.75, 0.0], [2.0, 4.0, f64::INFINITY]);
        assert_eq!(depth(&weights, &t, 6.0, convention, EmptyDepth::Far), 3.5);
        let (g_weights, g_t) = backward::depth(&weights, &t, 6.0, convention, EmptyDepth::Far, 0.0);
        assert_eq!((g_weights, g_t), (vec![0.0; 3], vec![0.0; 3]));
        assert_eq!(backward::depth(&weights, &t, 6.0, convention, EmptyDepth::Far, 1.0).1, weights);
    }
    // What an empty ray's depth is has a gradient of its own.
    let of = |empty| backward::depth(&[0.0; 2], &[1.0, 2.0], 6.0, Depth::Divided, empty, 3.0);
    assert_eq!(of(EmptyDepth::Zero), (vec![0.0; 2], vec![0.0; 2]));
    assert_eq!(of(EmptyDepth::First), (vec![0.0; 2], vec![3.0, 0.0]));
    assert_eq!(of(EmptyDepth::Last), (vec![0.0; 2], vec![0.0, 3.0]));
    let g = backward::depth(&[0.0; 2], &[1.0, 2.0], 6.0, Depth::Divided, EmptyDepth::Far, 1.0);
    assert_eq!(g, (vec![0.0; 2], vec![0.0; 2]));
    let opacity: f64 = [0.0; 3].iter().sum();
    assert!((opacity / opacity).is_nan(), "the textbook's quotient");
    assert!(
        (depth(&[1e-300, 3e-300], &[1.0, 5.0], 6.0, Depth::Divided, EmptyDepth::Far) - 4.0).abs()
            <= 4.0 * EPS
    );
}

#[test]
fn vr9_extremes_stay_finite() {
    let none = render(&[], &[]);
    assert_eq!((none.color, none.opacity, none.transmittance), ([0.0; 3], 0.0, vec![1.0]));
    assert_eq!(render(&[1.5], &[2.0]).opacity, -expm1(-3.0));
    // T runs through the subnormals to 0; densities from 1e-300 to 1e300.
    for sigmas in [vec![100.0; 9], vec![1e-300, 1e300, 1.0], vec![1e300; 3], vec![740.0, 4.0, 1.0]] {
        let r = render(&sigmas, &vec![1.0; sigmas.len()]);
        assert!(r.weights.iter().chain(&r.transmittance).all(|w| (0.0..=1.0).contains(w)));
        assert!((r.opacity + r.transmittance[sigmas.len()] - 1.0).abs() <= 4.0 * EPS);
        let g = Cotangent {
            color: [1.0; 3],
            weights: vec![1.0; sigmas.len()],
            opacity: -1.0,
            transmittance: 2.0,
        };
        assert!(finite(&gradient(&sigmas, &vec![[0.5; 3]; sigmas.len()], &vec![1.0; sigmas.len()], &g)));
    }
    assert_eq!(render(&[740.0], &[1.0]).transmittance[1], exp(-740.0), "a subnormal");
    // 1e5 samples on one ray.
    let n = 100_000;
    let r = render(&vec![0.5; n], &vec![4.0 / n as f64; n]);
    assert!(
        (r.opacity + expm1(-2.0)).abs() <= 8.0 * EPS && (r.transmittance[n] - exp(-2.0)).abs() <= 8.0 * EPS
    );
}

#[test]
fn light_from_behind_two_opaque_samples_keeps_its_gradient() {
    // T = e^-80 and dT/dx = -e^-80 for both samples; 1 - alpha rounds to 0 at x = 40.
    let (g, _, _) = gradient(&[40.0; 2], &[[0.0; 3]; 2], &[1.0; 2], &only_transmittance(2));
    assert!(g.iter().all(|g| (g / -exp(-80.0) - 1.0).abs() < 8.0 * EPS), "{g:?}");
}

#[test]
fn vr10_each_ray_has_its_own_steps() {
    let (a, b) = (render(&[1.0, 1.0], &[0.15, 0.15]), render(&[1.0, 1.0], &[0.3, 0.04]));
    assert!((a.weights[0] + expm1(-0.15)).abs() < EPS && (b.weights[0] + expm1(-0.3)).abs() < EPS);
}

/// A ray: densities, colors, steps.
fn ray() -> impl Strategy<Value = Vec<(f64, [f64; 3], f64)>> {
    prop::collection::vec(
        ((-3.0..2.0).prop_map(|x: f64| x.exp()), prop::array::uniform3(0.0..1.0), 0.01..1.0),
        1..40,
    )
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn light_is_absorbed_or_gets_through(ray in ray()) {
        let (sigmas, rgbs, deltas) = columns(&ray);
        let alphas: Vec<f64> = optical_depths(&sigmas, &deltas).iter().map(|&x| -expm1(-x)).collect();
        for r in [volume_render(&sigmas, &rgbs, &deltas, ProductEps::None), volume_render_alpha(&alphas, &rgbs, ProductEps::None)] {
            let end = *r.transmittance.last().unwrap();
            prop_assert!((r.opacity + end - 1.0).abs() <= 4.0 * EPS);
            prop_assert!(r.transmittance.windows(2).all(|t| t[1] <= t[0]) && end >= 0.0);
            prop_assert!(r.opacity >= 0.0 && r.opacity <= 1.0 + 2.0 * EPS);
            prop_assert!(r.color.iter().all(|&c| c <= r.opacity + 2.0 * EPS));
        }
    }

    #[test]
    fn an_interval_split_in_two_looks_the_same(ray in ray(), which in any::<prop::sample::Index>(), at in 0.0..1.0) {
        let (sigmas, rgbs, deltas) = columns(&ray);
        let (mut s, mut c, mut d) = (sigmas.clone(), rgbs.clone(), deltas.clone());
        let i = which.index(s.len());
        s.insert(i, s[i]);
        c.insert(i, c[i]);
        d.insert(i, at * d[i]);
        d[i + 1] -= d[i];
        let (one, two) = (volume_render(&sigmas, &rgbs, &deltas, ProductEps::None), volume_render(&s, &c, &d, ProductEps::None));
        for k in 0..3 {
            prop_assert!((one.color[k] - two.color[k]).abs() <= 16.0 * EPS);
        }
        let (a, b) = (one.transmittance.last().unwrap(), two.transmittance.last().unwrap());
        prop_assert!((a - b).abs() <= 64.0 * EPS * a, "relative: depth up to 40 loses some digits");
    }
}

/// Three columns.
fn columns(ray: &[(f64, [f64; 3], f64)]) -> (Vec<f64>, Vec<[f64; 3]>, Vec<f64>) {
    let column = |f: fn(&(f64, [f64; 3], f64)) -> f64| ray.iter().map(f).collect();
    (column(|s| s.0), ray.iter().map(|s| s.1).collect(), column(|s| s.2))
}
