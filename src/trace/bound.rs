//! Error bound of the trace: each row's bound, with the error of the step lengths carried into the weights.

use super::arrays::size;
use super::chain::{chain, plainly, without_backdrop};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, array, rgb, threes, values};
use crate::contract::bounded::{Bounded, exact};
use crate::contract::component::Component;
use crate::convention::{Conventions, Delta};
use crate::volume_rendering::bound::Ray;

/// Bound of [`super::trace_pixel`].
pub(crate) fn render_trace(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let c = &without_backdrop(c);
    let [h, w, n] = size(a);
    let truth = chain(a, c, |component, a| (component.forward.oracle)(a, c), plainly);
    // Component by component, at the true arrays; the bounds of rays_o, rays_d, uv and t are final.
    let mut bound = chain_bounds(a, c, m);
    let (t, deltas) = (values(&bound, "t"), values(&truth, "deltas"));
    let mut step_errors = values(&bound, "deltas");
    if n > 1 {
        t.chunks_exact(n)
            .zip(step_errors.chunks_exact_mut(n))
            .for_each(|(t, steps)| carry(t, steps, c.delta));
    }
    if c.delta == Delta::DifferencesTimesNorm {
        let (d, d_error) = (threes(&truth, "rays_d"), threes(&bound, "rays_d"));
        for (p, error) in step_errors.iter_mut().enumerate() {
            let d: [Bounded; 3] = std::array::from_fn(|k| Bounded { y: d[p / n][k], e: d_error[p / n][k] });
            let norm = m.sqrt(m.dot(&d, &d));
            *error = m.mul(Bounded { y: deltas[p] / norm.y, e: *error }, norm).e;
        }
    }
    let sigmas: Vec<Bounded> = values(a, "sigmas").into_iter().map(exact).collect();
    let (rgbs, b) = (values(a, "rgbs"), rgb(&values(a, "background")));
    let (mut weights, mut colors) = (vec![], vec![]);
    for ray in (0..h * w).map(|p| p * n..(p + 1) * n) {
        let steps: Vec<Bounded> = ray.clone().map(|i| Bounded { y: deltas[i], e: step_errors[i] }).collect();
        let rgbs = rgbs[3 * ray.start..3 * ray.end].chunks_exact(3).map(|c| rgb(c).map(exact)).collect();
        let ray = Ray::from_densities(&sigmas[ray], &steps, rgbs, c.product_eps, m);
        let (color, opacity, _) = ray.outputs(c.product_eps, m);
        for k in 0..3 {
            let factored = m.add(color[k], m.mul(m.sub(exact(1.0), opacity), exact(b[k])));
            let expanded = m.sub(m.add(color[k], exact(b[k])), m.mul(opacity, exact(b[k])));
            colors.push(factored.or(expanded).e);
        }
        weights.extend(ray.weights.iter().map(|w| w.e));
    }
    bound.insert("deltas".into(), array(&[h, w, n], step_errors));
    bound.insert("weights".into(), array(&[h, w, n], weights));
    bound.insert("colors".into(), array(&[h, w, 3], colors));
    bound
}

/// Adds what the errors of a ray's positions `t` do to its steps.
pub(crate) fn carry(t: &[f64], steps: &mut [f64], delta: Delta) {
    let last = t.len() - 1;
    // The middle between two positions.
    let edge = |i: usize| 0.5 * (t[i - 1] + t[i]);
    for (i, step) in steps.iter_mut().enumerate() {
        *step += match delta {
            Delta::Width => 0.0,
            // t_{i+1} - t_i; the last step may be computed from the two positions before it.
            Delta::Differences | Delta::DifferencesTimesNorm => t[i.min(last - 1)] + t[i.min(last - 1) + 1],
            Delta::Central if last == 0 => 0.0,
            Delta::Central => {
                0.5 * (t[i.saturating_sub(1)] + t[(i + 1).min(last)]) * if i % last == 0 { 2.0 } else { 1.0 }
            }
            Delta::Midpoints if i == 0 => edge(1),
            Delta::Midpoints if i == last => edge(last),
            Delta::Midpoints => edge(i) + edge(i + 1),
        };
    }
}

/// Each row's bound at the true values of the arrays before it.
fn chain_bounds(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let bounds = std::cell::RefCell::new(Arrays::new());
    let run = |component: &Component, a: &Arrays| {
        bounds.borrow_mut().extend((component.forward.bound)(a, c, m));
        (component.forward.oracle)(a, c)
    };
    let truth = chain(a, c, run, plainly);
    let bounds = bounds.into_inner();
    let shaped = |(name, truth): (&String, &ndarray::ArrayD<f64>)| {
        let bound = if name == "colors" { &bounds["colors_out"] } else { &bounds[name] };
        (name.clone(), bound.to_shape(truth.shape()).expect("the same number of entries").into_owned())
    };
    truth.iter().map(shaped).collect()
}
