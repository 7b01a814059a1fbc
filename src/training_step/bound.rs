//! Error bound of training steps, in running error analysis: each row's bound once more, with the errors of what goes into it.
//!
//! A step's errors go into the next step's parameters: after S steps the bound is that of S networks in a row. No honest step of Adam is
//! longer than [`longest`] says, however uncertain its gradient is, which is all that is known of parameters whose gradient has no digits
//! left.

mod network;

use ndarray::ArrayD;

use self::network::{Network, encoded};
use super::arrays::{adam, batches, field, of_step, steps, usual};
use super::{Batch, Field, flat};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, array, arrays, groups, input, values};
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Conventions, Delta};
use crate::loss::bound::{mean_square_of, slope_of};
use crate::optimizer::bound::{Scalars, moved};
use crate::optimizer::{Adam, bias_correction};
use crate::sample::component::{SAMPLE_ALONG_RAYS, STEP_SIZES};
use crate::trace::bound::carry;
use crate::volume_rendering::bound::{Arriving, Ray};

/// What is known of a pass over a batch.
struct Pass {
    t: Vec<Bounded>,
    deltas: Vec<Bounded>,
    colors: Vec<Bounded>,
    loss: Bounded,
    gradient: Vec<Bounded>,
}

/// A row's outputs with their errors, entry by entry.
fn both(truth: &Arrays, error: &Arrays, name: &str) -> Vec<Bounded> {
    truth[name].iter().zip(&error[name]).map(|(&y, &e)| Bounded { y, e }).collect()
}

/// Positions, points and steps of a batch's samples.
fn sampled(a: &Arrays, k: usize, c: &Conventions, m: &Arithmetic) -> [Vec<Bounded>; 3] {
    let mut rays = of_step(a, k);
    rays.extend(["near", "far"].map(|name| (name.to_string(), input(a, name).clone())));
    let row = &SAMPLE_ALONG_RAYS.forward;
    let (truth, error) = ((row.oracle)(&rays, c), (row.bound)(&rays, c, m));
    let (t, points) = (both(&truth, &error, "t"), both(&truth, &error, "points"));
    rays.insert("t".into(), truth["t"].clone());
    let row = &STEP_SIZES.forward;
    let (steps, mut own) = ((row.oracle)(&rays, c), (row.bound)(&rays, c, m));
    let (n, t_errors) = (rays["u"].shape()[1], values(&error, "t"));
    let own_errors = own.get_mut("deltas").expect("an output").as_slice_mut().expect("row by row");
    if n > 1 {
        t_errors
            .chunks_exact(n)
            .zip(own_errors.chunks_exact_mut(n))
            .for_each(|(t, own)| carry(t, own, c.delta));
    }
    let mut deltas = both(&steps, &own, "deltas");
    if c.delta == Delta::DifferencesTimesNorm {
        let norms: Vec<Bounded> = groups::<3>(&rays, "rays_d")
            .into_iter()
            .map(|d| m.sqrt(m.dot(&d.map(exact), &d.map(exact))))
            .collect();
        deltas.iter_mut().enumerate().for_each(|(i, delta)| *delta = m.mul(*delta, norms[i / n]));
    }
    [t, points, deltas]
}

/// One pass, forth and back.
fn pass(
    a: &Arrays,
    field: &Field,
    batch: &Batch,
    (k, params): (usize, &[Bounded]),
    c: &Conventions,
    m: &Arithmetic,
) -> Pass {
    let [t, points, deltas] = sampled(a, k, c, m);
    let mut network = Network::new(&field.net, params, c);
    let n = batch.u[0].len();
    let (mut colors, mut seen) = (vec![], vec![]);
    for r in 0..batch.rays.len() {
        let direction = encoded(&batch.directions[r].map(exact), &field.direction, m);
        let tapes: Vec<_> = (r * n..(r + 1) * n)
            .map(|i| {
                let x = encoded(&points[3 * i..3 * i + 3], &field.position, m);
                network.forward(&x, &direction, m)
            })
            .collect();
        let sigmas: Vec<Bounded> = tapes.iter().map(|tape| tape.sigma).collect();
        let rgbs = tapes.iter().map(|tape| tape.rgb).collect();
        let ray = Ray::from_densities(&sigmas, &deltas[r * n..(r + 1) * n], rgbs, c.product_eps, m);
        colors.extend(ray.outputs(c.product_eps, m).0);
        seen.push((ray, tapes));
    }
    let target = batch.target.concat();
    let loss = mean_square_of(&colors, &target, m);
    let slope = |i: usize| slope_of(colors[i], target[i], 1.0, colors.len(), m);
    for (r, (ray, tapes)) in seen.iter().enumerate() {
        let color = [slope(3 * r), slope(3 * r + 1), slope(3 * r + 2)];
        let zero = exact(0.0);
        let g = Arriving { color, weights: vec![zero; n], opacity: zero, transmittance: zero };
        let (g_x, g_rgbs) = ray.gradients_from(&g, c.product_eps, m);
        for (i, tape) in tapes.iter().enumerate() {
            network.backward(tape, m.mul(deltas[r * n + i], g_x[i]), g_rgbs[i], m);
        }
    }
    Pass { t, deltas, colors, loss, gradient: network.gradient(m) }
}

/// The longest step that Adam may take at step t, from moments of 0: by Cauchy and Schwarz, |m| <= sqrt(v) (1 - b1) / sqrt(1 - b2)
/// sqrt(sum (b1^2 / b2)^i). Rounding moves it by a few of its digits. Where v may underflow before eps outweighs it, nothing is known.
fn longest(adam: &Adam, step: u64, m: &Arithmetic) -> f64 {
    let ratio = adam.beta1 * adam.beta1 / adam.beta2;
    let root = (m.tiny / (1.0 - adam.beta2)).sqrt();
    if root > adam.eps || step as f64 * m.u > 0.05 {
        return f64::INFINITY;
    }
    let sum: f64 = (0..step).map(|i| crate::math::pow(ratio, i as f64)).sum();
    let quotient = (1.0 - adam.beta1) * (sum / (1.0 - adam.beta2)).sqrt();
    let corrected = quotient * bias_correction(adam.beta2, step).sqrt() / bias_correction(adam.beta1, step);
    adam.lr * corrected * (1.0 + 16.0 * (step as f64 + 4.0) * m.u)
}

/// The errors in a row.
fn errors(x: &[Bounded]) -> ArrayD<f64> {
    array(&[x.len()], x.iter().map(|x| x.e).collect())
}

/// Bound of [`super::train`].
pub(crate) fn training_step(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let c = &usual(c);
    let (field, batches, rates) = (field(a, c), batches(a), values(a, "lr"));
    let mut state: Vec<[Bounded; 3]> =
        flat(&field.net).into_iter().map(|x| [exact(x), exact(0.0), exact(0.0)]).collect();
    let (mut losses, mut out) = (vec![], Arrays::new());
    for k in 0..steps(a) {
        let params: Vec<Bounded> = state.iter().map(|[param, ..]| *param).collect();
        let passed = pass(a, &field, &batches[k], (k, &params), c, m);
        let step = k as u64 + 1;
        let adam = Adam { lr: rates[k], ..adam(a) };
        let limit = longest(&adam, step, m);
        let scalars = Scalars::new(&adam, step, m);
        for (state, g) in state.iter_mut().zip(&passed.gradient) {
            *state = moved(*state, *g, &adam, &scalars, (c.adam_eps, limit), m);
        }
        losses.push(passed.loss);
        let each = |n: usize| errors(&state.iter().map(|x| x[n]).collect::<Vec<_>>());
        if k == 0 {
            let (rays, samples) = (batches[0].rays.len(), batches[0].u[0].len());
            let shaped =
                |x: &[Bounded], columns: usize| array(&[rays, columns], x.iter().map(|x| x.e).collect());
            out.extend(arrays([
                ("t", shaped(&passed.t, samples)),
                ("deltas", shaped(&passed.deltas, samples)),
                ("colors", shaped(&passed.colors, 3)),
                ("grad", errors(&passed.gradient)),
                ("params_1", each(0)),
                ("m_1", each(1)),
                ("v_1", each(2)),
            ]));
        }
        out.extend(arrays([("params_last", each(0)), ("m_last", each(1)), ("v_last", each(2))]));
    }
    out.insert("losses".into(), errors(&losses));
    out
}
