//! Kinks: where a function has two derivatives, which one the reference takes; and that no case of a gradient sits on one.

use ndarray::{arr1, arr2};
use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::{Arithmetic, Component, Dtype, Grade, Kind};
use nerf_oracle::convention::{CHOICES, CS180, Conventions, Density, Depth, EmptyDepth, ProductEps};
use nerf_oracle::field::mlp::Output;
use nerf_oracle::field::{Layer, Mlp, backward as field_backward, density, density_slope, sigmoid_slope};
use nerf_oracle::field::{mlp_kink, nerf_mlp_kink};
use nerf_oracle::proof::gradient::one_sided;
use nerf_oracle::volume_rendering::backward::Cotangent;
use nerf_oracle::volume_rendering::{self as render, Rendering};

fn find(name: &str) -> &'static Component {
    COMPONENTS.iter().find(|component| component.name == name).unwrap()
}

/// CS180, and each other value of each convention that the network's gradient depends on.
fn conventions() -> Vec<Conventions> {
    let mut all = vec![CS180];
    for key in find("nerf_mlp").conventions {
        let values = CHOICES.iter().find(|(name, _)| name == key).unwrap().1;
        all.extend(values.iter().map(|value| CS180.with(key, value).unwrap()).filter(|c| *c != CS180));
    }
    all
}

/// In f64 and f32 every honest implementation sees the same units switched on, so that there is one right gradient.
#[test]
fn every_pre_activation_is_further_from_0_than_its_own_bound() {
    let mut seen = 0;
    for dtype in [Dtype::F64, Dtype::F32] {
        // Grade B: the wider encoding.
        let m = Arithmetic::new(dtype, Grade::B);
        let mut check = |label: String, kink: f64| {
            seen += 1;
            assert!(
                kink < 1.0,
                "{label} {dtype}: a pre-activation lies within {kink:.2} of its distance from 0"
            );
        };
        for case in find("mlp").cases_of(Kind::Vjp, &CS180).iter().filter(|case| case.exists_in(dtype)) {
            check(format!("mlp {}", case.id), mlp_kink(&case.inputs, &m));
        }
        let nerf = find("nerf_mlp");
        for c in conventions() {
            for case in nerf.cases_of(Kind::Vjp, &c).iter().filter(|case| case.exists_in(dtype)) {
                if (nerf.special.admits)(&case.inputs, &c) {
                    check(format!("nerf_mlp {} {c:?}", case.id), nerf_mlp_kink(&case.inputs, &c, &m));
                }
            }
        }
    }
    assert!(seen > 40, "{seen} cases are too few");
}

#[test]
fn a_relu_at_its_kink_takes_the_left_derivative() {
    assert_eq!(field_backward::relu(&[-1e-300, 0.0, -0.0, 1e-300], &[1.0; 4]), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(density_slope(0.0, Density::Relu), 0.0);
    // Two derivatives at z = 0, from the left 0, from the right 1; the reference takes the left one, as PyTorch does.
    let relu = |z: f64| density(z, Density::Relu);
    assert_eq!([one_sided(relu, -0.5).value, one_sided(relu, 0.5).value], [0.0, 1.0]);
    // And inside a network: y = sigmoid(2 max(x, 0) + 1/2) at x = 0.
    let layer = |w: f64, b: f64| Layer { w: arr2(&[[w]]), b: arr1(&[b]) };
    let net = Mlp { layers: vec![layer(1.0, 0.0), layer(2.0, 0.5)], output: Output::Sigmoid };
    let mut gradient = vec![Layer::zeros(1, 1), Layer::zeros(1, 1)];
    let g_x = field_backward::mlp(&net, &net.forward(&[0.0]), &[1.0], &mut gradient);
    let side = |step: f64| one_sided(|s| net.forward(&[s]).y[0], step);
    assert_eq!((g_x[0], gradient[0].b[0]), (side(-0.25).value, 0.0));
    assert!((side(0.25).value - 2.0 * sigmoid_slope(0.5)).abs() < 1e-10);
}

/// Densities and steps end at 0, opacities at 0 and 1: there the gradient is the derivative from inside.
#[test]
fn at_the_edge_of_its_domain_rendering_has_the_derivative_from_inside() {
    let rgbs = [[1.0, 0.5, 0.25], [0.0, 0.75, 0.5], [0.25, 0.25, 1.0]];
    let g = Cotangent {
        color: [1.0, -0.5, 0.75],
        weights: vec![0.25, -1.0, 0.5],
        opacity: 0.5,
        transmittance: -0.75,
    };
    let pulled = |r: &Rendering| {
        let colors: f64 = (0..3).map(|k| g.color[k] * r.color[k]).sum();
        let weights: f64 = (0..3).map(|i| g.weights[i] * r.weights[i]).sum();
        colors + weights + g.opacity * r.opacity + g.transmittance * r.transmittance[3]
    };
    let (sigmas, deltas) = ([1.5, 0.0, 0.75], [0.5, 0.25, 0.0]);
    let forward = render::volume_render(&sigmas, &rgbs, &deltas, ProductEps::None);
    let (g_sigmas, _, g_deltas) =
        render::backward::volume_render(&sigmas, &rgbs, &deltas, ProductEps::None, &forward, &g);
    let with = |sigma: f64, delta: f64| {
        pulled(&render::volume_render(&[1.5, sigma, 0.75], &rgbs, &[0.5, 0.25, delta], ProductEps::None))
    };
    let (by_sigma, by_delta) =
        (one_sided(|s| with(s, 0.0), 0.25).value, one_sided(|s| with(0.0, s), 0.25).value);
    assert!((g_sigmas[1] - by_sigma).abs() < 1e-10 && by_sigma != 0.0, "{} {by_sigma}", g_sigmas[1]);
    assert!((g_deltas[2] - by_delta).abs() < 1e-10 && by_delta != 0.0, "{} {by_delta}", g_deltas[2]);
    for (at, inward) in [(0.0, 0.25), (1.0, -0.25)] {
        let alphas = |alpha: f64| [0.5, alpha, 0.25];
        let forward = render::volume_render_alpha(&alphas(at), &rgbs, ProductEps::None);
        let by_hand =
            render::backward::volume_render_alpha(&alphas(at), &rgbs, ProductEps::None, &forward, &g).0[1];
        let moved = |s: f64| pulled(&render::volume_render_alpha(&alphas(at + s), &rgbs, ProductEps::None));
        let inside = one_sided(moved, inward).value;
        assert!((by_hand - inside).abs() < 1e-10 && inside != 0.0, "alpha = {at}: {by_hand} {inside}");
    }
}

/// On an empty ray the depth jumps to `far`, a constant: by definition all of its gradients are 0.
#[test]
fn depth_of_an_empty_ray_has_no_gradient() {
    let depth = |w: f64, t: f64| render::depth(&[w, 0.0], &[t, 3.0], 6.0, Depth::Divided, EmptyDepth::Far);
    assert_eq!((depth(0.0, 1.0), depth(1e-300, 1.0)), (6.0, 1.0), "a jump");
    assert_eq!(one_sided(|s| depth(0.0, 1.0 + s), 0.25).value, 0.0);
    let gradients =
        render::backward::depth(&[0.0; 2], &[1.0, 3.0], 6.0, Depth::Divided, EmptyDepth::Far, 1.0);
    assert_eq!(gradients, (vec![0.0; 2], vec![0.0; 2]));
}
