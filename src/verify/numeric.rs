//! Numeric gradients of wrong code: what automatic differentiation makes of a mistake in the forward function.

use ndarray::ArrayD;

use super::component::{Arrays, Component};
use crate::convention::Conventions;

/// Elements of each array that are differentiated: enough to tell two mistakes apart, few enough for a network's weights.
const SAMPLED: usize = 32;

/// The vector-Jacobian product of the component's forward function with `mistakes`, and an estimate of its error: central
/// differences at h and h / 2, combined so that the error falls with h^4 (Richardson). Of arrays longer than `SAMPLED` every n-th
/// element alone; the others' error is infinite.
pub fn vjp(component: &Component, inputs: &Arrays, c: &Conventions, mistakes: &[&str]) -> (Arrays, Arrays) {
    let cotangent = |outputs: &Arrays| -> f64 {
        let inner = |(name, out): (&String, &ArrayD<f64>)| -> f64 {
            let Some(g) = inputs.get(&format!("grad_{name}")) else { return 0.0 };
            out.iter().zip(g).map(|(out, g)| out * g).sum()
        };
        outputs.iter().map(inner).sum()
    };
    let mut inputs_now = inputs.clone();
    let (mut gradients, mut errors) = (Arrays::new(), Arrays::new());
    for port in component.differentiable_arrays(inputs) {
        let x = inputs[&port].clone();
        let (mut gradient, mut error) = (x.mapv(|_| 0.0), x.mapv(|_| f64::INFINITY));
        // An odd stride, so that every column of a matrix has its turn.
        for (i, &at) in x.iter().enumerate().step_by((x.len() / SAMPLED) | 1) {
            let mut moved = |step: f64| {
                *entry(&mut inputs_now, &port, i) = at + step;
                cotangent(&(component.forward.wrong)(&inputs_now, c, mistakes))
            };
            let mut slope = |h: f64| (moved(h) - moved(-h)) / (2.0 * h);
            let h = libm::ldexp(1.0, -13) * at.abs().max(0.0625);
            let (coarse, fine) = (slope(h), slope(0.5 * h));
            *entry(&mut inputs_now, &port, i) = at;
            let best = (4.0 * fine - coarse) / 3.0;
            *gradient.iter_mut().nth(i).expect("same shape") = best;
            *error.iter_mut().nth(i).expect("same shape") = (fine - coarse).abs();
        }
        let scale = gradient.iter().fold(0.0, |max: f64, g| max.max(g.abs()));
        error.mapv_inplace(|e| e + 1e-9 * scale);
        gradients.insert(format!("grad_{port}"), gradient);
        errors.insert(format!("grad_{port}"), error);
    }
    (gradients, errors)
}

fn entry<'a>(arrays: &'a mut Arrays, name: &str, i: usize) -> &'a mut f64 {
    let array = arrays.get_mut(name).expect("the component's own inputs");
    array.iter_mut().nth(i).expect("an index of the array")
}
