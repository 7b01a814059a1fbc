//! A training step by hand: a proof without the registry, for the mutation tests.

use glam::DVec3;

use super::{Batch, Field, State, filled, flat, pass, train, update};
use crate::convention::{AdamEps, CS180, Conventions, Delta, LastDelta};
use crate::encoding::Encoding;
use crate::field::{NerfMlp, nerf_mlp::Shape};
use crate::optimizer::Adam;
use crate::random::{Key, Purpose};
use crate::ray::Ray;

const BOUNDS: (f64, f64) = (0.5, 2.0);
const SHAPE: Shape = Shape { position: 9, direction: 9, width: 4, depth: 5, color: 4 };

/// A field whose density is on.
fn field() -> Field {
    let mut net = NerfMlp::initial(&SHAPE, &CS180, &Key::new(5, Purpose::Parameters));
    net.sigma.b[0] = 1.0;
    Field { net, position: Encoding::new(1, &CS180), direction: Encoding::new(1, &CS180) }
}

/// Two rays of three samples.
fn batch(step: u64) -> Batch {
    let key = Key::new(6, Purpose::Rays);
    let three = |ray: u64| -> [f64; 3] { std::array::from_fn(|n| key.uniform(step, ray, n as u64)) };
    Batch {
        rays: (0..2).map(|r| Ray { o: DVec3::from(three(r)), d: 2.0 * DVec3::from(three(10 + r)) }).collect(),
        directions: (0..2).map(|r| three(20 + r)).collect(),
        u: (0..2).map(|r| three(30 + r).to_vec()).collect(),
        target: (0..2).map(|r| three(40 + r)).collect(),
    }
}

#[test]
fn parameters_go_into_a_row_and_back() {
    let net = field().net;
    let params = flat(&net);
    assert_eq!(params.len(), 40 + 3 * 20 + (4 * 13 + 4) + 5 + 20 + (4 * 13 + 4) + 15);
    let doubled: Vec<f64> = params.iter().map(|x| 2.0 * x).collect();
    let other = filled(&net, &doubled);
    assert_eq!((flat(&other), filled(&other, &params)), (doubled, net));
}

/// The gradient is that of the loss: central differences in every parameter, in both kinds of steps that read the ray.
#[test]
fn the_gradient_is_the_slope_of_the_loss() {
    let stretched =
        Conventions { delta: Delta::DifferencesTimesNorm, last_delta: LastDelta::Repeated, ..CS180 };
    for c in [CS180, stretched] {
        let (field, batch) = (field(), batch(0));
        let passed = pass(&field, &batch, BOUNDS, &c);
        let params = flat(&field.net);
        let loss = |i: usize, h: f64| {
            let mut params = params.clone();
            params[i] += h;
            pass(&Field { net: filled(&field.net, &params), ..field.clone() }, &batch, BOUNDS, &c).loss
        };
        let mut some = 0;
        for (i, g) in flat(&passed.gradient).into_iter().enumerate() {
            let slope = (loss(i, 1e-6) - loss(i, -1e-6)) / 2e-6;
            assert!((slope - g).abs() < 1e-8, "{i}: {slope} {g}");
            some += usize::from(g.abs() > 1e-4);
        }
        assert!(some > params.len() / 4, "{some} of {}", params.len());
    }
}

/// Colors between 0 and 1, the mean over rays and channels, and steps along t or in space.
#[test]
fn what_comes_on_the_way_is_by_its_formula() {
    let (field, batch) = (field(), batch(1));
    let passed = pass(&field, &batch, BOUNDS, &CS180);
    assert_eq!(passed.deltas, vec![vec![0.5; 3]; 2]);
    let differences: Vec<f64> =
        passed.colors.concat().iter().zip(batch.target.concat()).map(|(p, t)| (p - t) * (p - t)).collect();
    assert!((passed.loss - differences.iter().sum::<f64>() / 6.0).abs() < 1e-15);
    let c = Conventions { delta: Delta::DifferencesTimesNorm, last_delta: LastDelta::ToFar, ..CS180 };
    let stretched = pass(&field, &batch, BOUNDS, &c);
    for r in 0..2 {
        let (t, length) = (&stretched.t[r], batch.rays[r].d.length());
        assert_eq!(stretched.deltas[r][0], (t[1] - t[0]) * length);
        assert_eq!(stretched.deltas[r][2], (2.0 - t[2]) * length);
    }
}

/// The first step is lr sign(g) where eps is next to nothing; the second one by the formula, from the gradient at the new parameters.
#[test]
fn two_steps_of_adam() {
    let (field, batches) = (field(), [batch(2), batch(3)]);
    let adam = Adam { lr: 9.0, beta1: 0.5, beta2: 0.75, eps: 1e-300, weight_decay: 0.0 };
    let rates = [0.015625, 0.0078125];
    let out = train(&field, &batches, BOUNDS, &rates, &adam, &CS180);
    let before = flat(&field.net);
    let g = flat(&out.pass.gradient);
    let moved = Field { net: filled(&field.net, &out.first.params), ..field.clone() };
    let second = pass(&moved, &batches[1], BOUNDS, &CS180);
    let g2 = flat(&second.gradient);
    assert_eq!(out.losses, [out.pass.loss, second.loss]);
    for i in (0..g.len()).filter(|&i| g[i].abs() > 1e-6) {
        assert!((before[i] - rates[0] * g[i].signum() - out.first.params[i]).abs() < 1e-12);
        assert_eq!((out.first.m[i], out.first.v[i]), (0.5 * g[i], 0.25 * g[i] * g[i]));
        let (m, v) = (0.25 * g[i] + 0.5 * g2[i], 0.1875 * g[i] * g[i] + 0.25 * g2[i] * g2[i]);
        assert!((out.last.m[i] - m).abs() < 1e-15 && (out.last.v[i] - v).abs() < 1e-15);
        let expected = out.first.params[i] - rates[1] * (m / 0.75) / (v / 0.4375).sqrt();
        assert!((out.last.params[i] - expected).abs() < 1e-13, "{i}");
    }
}

/// Where eps stands beside the uncorrected root, it weighs more: sqrt(1 - beta2) = 1/2 of a first step.
#[test]
fn eps_stands_where_the_convention_has_it() {
    let before = State { params: vec![1.0], m: vec![0.0], v: vec![0.0] };
    let adam = Adam { lr: 1.0, beta1: 0.5, beta2: 0.75, eps: 0.5, weight_decay: 0.0 };
    let after = |c: &Conventions| update(&before, &[0.5], &adam, 1, c).params[0];
    assert!((after(&CS180) - 0.5).abs() < 1e-15);
    let other = Conventions { adam_eps: AdamEps::Uncorrected, ..CS180 };
    assert!((after(&other) - (1.0 - 0.5 / 1.5)).abs() < 1e-15);
}
