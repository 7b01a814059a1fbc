//! Numeric gradients of wrong code: what automatic differentiation returns for a mistake in the forward function.

use ndarray::ArrayD;

use crate::contract::arrays::Arrays;
use crate::contract::component::Component;

/// Elements of each array that are differentiated: enough to tell two mistakes apart, few enough for a network's weights.
pub(super) const SAMPLED: usize = 32;

/// The vector-Jacobian product of a component's wrong `forward` function, and an estimate of its error: central
/// differences at h and h / 2, combined so that the error falls with h^4 (Richardson), plus their rounding, and at a kink the
/// difference between the slopes of its sides, either of which is a gradient. Arrays longer than `SAMPLED` are differentiated at every
/// n-th element, of which one in `each` is asked for; the error of the others is infinite.
pub(crate) fn vjp(
    component: &Component,
    inputs: &Arrays,
    each: usize,
    forward: impl Fn(&Arrays) -> Arrays,
) -> (Arrays, Arrays) {
    // The sum that is differentiated, and the same without signs.
    let cotangent = |outputs: &Arrays| -> [f64; 2] {
        let inner = |(name, out): (&String, &ArrayD<f64>)| -> [f64; 2] {
            let Some(g) = inputs.get(&format!("grad_{name}")) else { return [0.0; 2] };
            // What nobody asks for may be no number.
            let terms = out.iter().zip(g).map(|(out, g)| if *g == 0.0 { 0.0 } else { out * g });
            terms.fold([0.0; 2], |[sum, size], term| [sum + term, size + term.abs()])
        };
        outputs.iter().map(inner).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
    };
    let [here, size] = cotangent(&forward(inputs));
    let mut inputs_now = inputs.clone();
    let (mut gradients, mut errors) = (Arrays::new(), Arrays::new());
    for port in component.differentiable_arrays(inputs) {
        let x = inputs[&port].clone();
        let (mut gradient, mut error) = (x.mapv(|_| 0.0), x.mapv(|_| f64::INFINITY));
        // An odd stride, so that every column of a matrix is sampled.
        for (i, &at) in x.iter().enumerate().step_by((x.len() / SAMPLED) | 1).step_by(each) {
            let mut moved = |to: f64| {
                *entry(&mut inputs_now, &port, i) = to;
                cotangent(&forward(&inputs_now))[0]
            };
            // The slope, and by how much it is steeper ahead than back: as h where the function is smooth.
            let mut slopes = |h: f64| {
                let (ahead, back) = (moved(at + h), moved(at - h));
                ((ahead - back) / ((at + h) - (at - h)), (ahead - 2.0 * here + back) / h)
            };
            // A wavelength doesn't grow with x, but h must not vanish next to x.
            let h = libm::ldexp(at.abs().clamp(0.0625, 1.0).max(libm::ldexp(at.abs(), -20)), -13);
            let ((coarse, bend), (fine, half_bend)) = (slopes(h), slopes(0.5 * h));
            *entry(&mut inputs_now, &port, i) = at;
            let best = (4.0 * fine - coarse) / 3.0;
            let rounding = 64.0 * f64::EPSILON * size / h;
            // A kink smaller than rounding is none.
            let kink = Some((2.0 * half_bend - bend).abs()).filter(|kink| *kink > rounding).unwrap_or(0.0);
            let off = (fine - coarse).abs() + kink + rounding;
            // Where the function isn't finite, jumps, or bends within h, differences say nothing.
            let bent = (fine - coarse).abs() > 0.5 * fine.abs().max(coarse.abs()).max(rounding);
            // Half the step: half the bend where it is smooth, the same at a kink, twice that where the function jumps.
            let jumps = half_bend.abs() > rounding.max(1.5 * bend.abs());
            let known = best.is_finite() && off.is_finite() && !bent && !jumps;
            *gradient.iter_mut().nth(i).expect("same shape") = if known { best } else { 0.0 };
            *error.iter_mut().nth(i).expect("same shape") = if known { off } else { f64::INFINITY };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::COMPONENTS;
    use crate::contract::check::Kind;
    use crate::convention::CS180;

    /// Far cameras, waves at 65536, faces of cells, steps of 1e10: the stated error of the differences covers what they miss. Waves
    /// shorter than h are beyond them.
    #[test]
    fn hand_written_gradients_lie_within_the_estimated_error() {
        let rows = [
            "transform",
            "pixel_to_ray",
            "positional_encoding",
            "hash_grid",
            "volume_render",
            "volume_render_alpha",
        ];
        for component in COMPONENTS.iter().filter(|component| rows.contains(&component.name)) {
            let (mut known, mut all) = (0, 0);
            for case in component.cases_of(Kind::Vjp, &CS180) {
                let short = case.inputs.get("L").is_some_and(|levels| levels.iter().any(|l| *l > 8.0));
                if short || case.size() > 2_000 {
                    continue;
                }
                let right = (component.vjp.expect("it has one").oracle)(&case.inputs, &CS180);
                let forward = |inputs: &Arrays| (component.forward.oracle)(inputs, &CS180);
                let (gradient, error) = vjp(component, &case.inputs, 1, forward);
                for (name, gradient) in &gradient {
                    for ((g, e), right) in gradient.iter().zip(&error[name]).zip(&right[name]) {
                        let off = (g - right).abs();
                        assert!(
                            off <= 4.0 * e,
                            "{} {} {name}: {g} for {right}, error {e}",
                            component.name,
                            case.id
                        );
                        all += 1;
                        known += usize::from(*e <= 1e-3 * right.abs().max(1e-3));
                    }
                }
            }
            // Not vacuous: where a cell is narrower than h, as in fine hash grids, differences know little.
            assert!(4 * known > all, "{}: {known} of {all} known", component.name);
        }
    }
}
