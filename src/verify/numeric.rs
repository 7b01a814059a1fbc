//! Numeric gradients of wrong code: what automatic differentiation makes of a mistake in the forward function.

use ndarray::ArrayD;

use super::component::{Arrays, Component};
use crate::convention::Conventions;

/// Elements of each array that are differentiated: enough to tell two mistakes apart, few enough for a network's weights.
const SAMPLED: usize = 32;

/// The vector-Jacobian product of the component's forward function with `mistakes`, and an estimate of its error: central
/// differences at h and h / 2, combined so that the error falls with h^4 (Richardson), what rounding makes of them, and at a kink
/// the difference between the slopes of its sides, either of which is a gradient. Of arrays longer than `SAMPLED` every n-th
/// element alone; the others' error is infinite.
pub fn vjp(component: &Component, inputs: &Arrays, c: &Conventions, mistakes: &[&str]) -> (Arrays, Arrays) {
    // The sum that is differentiated, and the same without signs.
    let cotangent = |outputs: &Arrays| -> [f64; 2] {
        let inner = |(name, out): (&String, &ArrayD<f64>)| -> [f64; 2] {
            let Some(g) = inputs.get(&format!("grad_{name}")) else { return [0.0; 2] };
            let terms = out.iter().zip(g).map(|(out, g)| out * g);
            terms.fold([0.0; 2], |[sum, size], term| [sum + term, size + term.abs()])
        };
        outputs.iter().map(inner).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
    };
    let [here, size] = cotangent(&(component.forward.wrong)(inputs, c, mistakes));
    let mut inputs_now = inputs.clone();
    let (mut gradients, mut errors) = (Arrays::new(), Arrays::new());
    for port in component.differentiable_arrays(inputs) {
        let x = inputs[&port].clone();
        let (mut gradient, mut error) = (x.mapv(|_| 0.0), x.mapv(|_| f64::INFINITY));
        // An odd stride, so that every column of a matrix has its turn.
        for (i, &at) in x.iter().enumerate().step_by((x.len() / SAMPLED) | 1) {
            let mut moved = |step: f64| {
                *entry(&mut inputs_now, &port, i) = at + step;
                cotangent(&(component.forward.wrong)(&inputs_now, c, mistakes))[0]
            };
            // The slope, and by how much it is steeper ahead than behind: as h where the function is smooth.
            let mut slopes = |h: f64| {
                let (ahead, behind) = (moved(h), moved(-h));
                ((ahead - behind) / (2.0 * h), (ahead - 2.0 * here + behind) / h)
            };
            let h = libm::ldexp(1.0, -13) * at.abs().max(0.0625);
            let ((coarse, bend), (fine, half_bend)) = (slopes(h), slopes(0.5 * h));
            *entry(&mut inputs_now, &port, i) = at;
            let best = (4.0 * fine - coarse) / 3.0;
            *gradient.iter_mut().nth(i).expect("same shape") = best;
            let kink = (2.0 * half_bend - bend).abs();
            let rounding = 16.0 * f64::EPSILON * size / h;
            // A kink below what rounding makes of it is none.
            let kink = if kink > 4.0 * rounding { kink } else { 0.0 };
            *error.iter_mut().nth(i).expect("same shape") = (fine - coarse).abs() + kink + rounding;
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
