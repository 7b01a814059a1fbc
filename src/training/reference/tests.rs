//! The step as a whole: its loss by hand, its gradient by differences, on networks small enough for both.

use glam::DVec3;

use super::*;
use crate::convention::{CS180, Density};
use crate::field::nerf_mlp::Shape;
use crate::random::{Key, Purpose};

const BACKGROUND: [f64; 3] = [0.9, 0.5, 0.1];

fn field() -> Field {
    let (position, direction) = (Encoding::new(1, &CS180), Encoding::new(1, &CS180));
    let shape = Shape { position: 9, direction: 9, width: 4, depth: 8, color: 3 };
    let net = NerfMlp::initial(&shape, &CS180, &Key::new(4, Purpose::Parameters));
    Field {
        net,
        position,
        direction,
        cube: None,
        conventions: crate::convention::Conventions { density: Density::Softplus, ..CS180 },
    }
}

fn batch() -> Vec<Target> {
    let ray = |o: [f64; 3], d: [f64; 3]| Ray { o: DVec3::from(o), d: DVec3::from(d) };
    vec![
        Target {
            ray: ray([0.1, 0.2, -1.0], [0.3, -0.4, 1.2]),
            t: vec![0.25, 0.5, 1.0],
            deltas: vec![0.5, 0.75, 1.0],
            rgb: [0.75, 0.25, 0.5],
        },
        Target {
            ray: ray([0.5, 0.0, 0.0], [0.0, 0.6, 0.8]),
            t: vec![0.5],
            deltas: vec![2.0],
            rgb: [0.0, 1.0, 0.125],
        },
    ]
}

/// sum over rays and channels of (C + (1 - A) b - target)^2 / (3 R).
fn loss(field: &Field) -> f64 {
    let mut sum = 0.0;
    for target in batch() {
        let (seen, _) = field.render(&target.ray, &target.t, &target.deltas);
        for k in 0..3 {
            sum += (seen.color[k] + (1.0 - seen.opacity) * BACKGROUND[k] - target.rgb[k]).powi(2);
        }
    }
    sum / 6.0
}

#[test]
fn a_point_is_encoded_where_it_lies_and_seen_along_a_unit_direction() {
    let (field, batch) = (field(), batch());
    let ray = &batch[0].ray;
    let tape = field.at(ray, 0.5);
    // o + d / 2, and d / 1.3.
    let position = positional_encoding(&[0.1 + 0.15, 0.2 - 0.2, -1.0 + 0.6], &field.position);
    let view = positional_encoding(&[0.3 / 1.3, -0.4 / 1.3, 1.2 / 1.3], &field.direction);
    for (got, expected) in tape.inputs[0].iter().zip(position).chain(tape.color_input[4..].iter().zip(view)) {
        assert!((got - expected).abs() < 1e-14, "{got} {expected}");
    }
    let (rendering, tapes) = field.render(ray, &batch[0].t, &batch[0].deltas);
    assert_eq!((tapes.len(), &tapes[1]), (3, &tape));
    let alpha = 1.0 - (-tapes[0].sigma * 0.5).exp();
    assert!((rendering.weights[0] - alpha).abs() < 1e-15 && rendering.weights.len() == 3);
}

#[test]
fn the_gradient_of_every_parameter() {
    let field = field();
    let (value, gradient) = field.loss_and_gradient(&batch(), BACKGROUND);
    assert!((value - loss(&field)).abs() < 1e-15);
    let gradient: Vec<Layer> = gradient.layers().into_iter().map(|(_, layer)| layer.clone()).collect();
    let largest =
        gradient.iter().flat_map(|l| l.w.iter().chain(&l.b)).fold(0.0, |max: f64, g| max.max(g.abs()));
    assert!(largest > 1e-3, "a step that learns something");
    for (n, layer) in gradient.iter().enumerate() {
        for (i, g) in layer.w.iter().chain(&layer.b).enumerate() {
            let moved = |h: f64| {
                let mut field = field.clone();
                let layer = field.net.layers_mut().into_iter().nth(n).expect("a layer");
                *layer.w.iter_mut().chain(&mut layer.b).nth(i).expect("a parameter") += h;
                loss(&field)
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!(
                (g - slope).abs() < 1e-6 * largest,
                "layer {n}, parameter {i}: {g} by hand, {slope} by differences"
            );
        }
    }
}

#[test]
fn the_gradient_of_a_picture() {
    let encoding = Encoding::new(1, &CS180);
    let net = Mlp::initial(encoding.width(2), 5, 2, 3, &Key::new(3, Purpose::Parameters));
    let (pixels, targets) = ([[0.25, 0.75], [0.1, 0.3]], [[0.0, 1.0, 0.5], [0.25, 0.5, 0.75]]);
    let loss = |net: &Mlp| {
        let mut sum = 0.0;
        for (xy, target) in pixels.iter().zip(&targets) {
            let y = net.forward(&positional_encoding(xy, &encoding)).y;
            sum += (0..3).map(|k| (y[k] - target[k]).powi(2)).sum::<f64>();
        }
        sum / 6.0
    };
    let (value, gradient) = image_loss_and_gradient(&net, &encoding, &pixels, &targets);
    assert!((value - loss(&net)).abs() < 1e-15);
    for (n, layer) in gradient.iter().enumerate() {
        for (i, g) in layer.w.iter().chain(&layer.b).enumerate() {
            let moved = |h: f64| {
                let mut net = net.clone();
                let layer = &mut net.layers[n];
                *layer.w.iter_mut().chain(&mut layer.b).nth(i).expect("a parameter") += h;
                loss(&net)
            };
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!(
                (g - slope).abs() < 1e-9,
                "layer {n}, parameter {i}: {g} by hand, {slope} by differences"
            );
        }
    }
}

#[test]
fn adam_moves_every_parameter_of_a_layer() {
    let of = |f: fn(f64) -> f64| Layer {
        w: ndarray::Array2::from_shape_fn((2, 3), |(o, i)| f((3 * o + i) as f64)),
        b: ndarray::Array1::from_shape_fn(2, |o| f(6.0 + o as f64)),
    };
    let adam = Adam { lr: 0.1, ..Adam::default() };
    let (mut params, mut m, mut v) = (of(|n| n), of(|n| 0.1 * n), of(|n| 0.2 * n));
    adam_layer(&adam, 3, &mut params, &mut m, &mut v, &of(|n| 1.0 - n));
    let flat = |layer: &Layer| layer.w.iter().chain(&layer.b).copied().collect::<Vec<_>>();
    for (n, ((param, m), v)) in flat(&params).into_iter().zip(flat(&m)).zip(flat(&v)).enumerate() {
        let n = n as f64;
        assert_eq!(
            Moments { param, m, v },
            adam_step(&adam, Moments { param: n, m: 0.1 * n, v: 0.2 * n }, 1.0 - n, 3)
        );
    }
}

/// Four intervals of 1 on [2, 6]; all light from the third, so that u places the fine samples there. A step
/// goes to the next sample, the last one to far.
#[test]
fn fine_samples_by_hand() {
    let edges = interval_edges(2.0, 6.0, 4);
    assert_eq!(edges, [2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(interval_edges(2.0, 4.0, 4), [2.0, 2.5, 3.0, 3.5, 4.0]);
    let (t, deltas) = fine_samples(&[2.5, 3.5, 4.5, 5.5], &edges, &[0.0, 0.0, 1.0, 0.0], &[0.25, 0.75], 6.0);
    assert_eq!(t, [2.5, 3.5, 4.25, 4.5, 4.75, 5.5]);
    assert_eq!(deltas, [1.0, 0.75, 0.25, 0.25, 0.75, 0.5]);
}
