//! Volume rendering on named arrays: batches on one side, slices of one ray on the other.

use std::borrow::Cow;

use ndarray::{ArrayView1, Axis, s};

use super::backward::Cotangent;
use super::{Rendering, backward, composite_background, depth};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, number, rgb, row, rows3, size, values};
use crate::convention::{
    AlphaStop, Backdrop, CapGradient, Conventions, Faint, LastSample, OpacitySum, SigmaRelu,
};
use crate::math::Sum;

/// The outputs of R rays as arrays.
pub(crate) fn renderings(samples: usize, rays: &[Rendering]) -> Arrays {
    let each = |f: fn(&Rendering) -> Vec<f64>| rays.iter().flat_map(f).collect::<Vec<_>>();
    arrays([
        ("colors", array(&[rays.len(), 3], each(|r| r.color.to_vec()))),
        ("weights", array(&[rays.len(), samples], each(|r| r.weights.clone()))),
        ("opacity", array(&[rays.len()], each(|r| vec![r.opacity]))),
        ("transmittance", array(&[rays.len()], each(|r| r.transmittance[r.weights.len()..].to_vec()))),
    ])
}

/// The cotangent of ray r.
pub(crate) fn cotangent(arrays: &Arrays, r: usize) -> Cotangent {
    Cotangent {
        color: rows3(arrays, "grad_colors", r)[0],
        weights: row(arrays, "grad_weights", r),
        opacity: row(arrays, "grad_opacity", r)[0],
        transmittance: row(arrays, "grad_transmittance", r)[0],
    }
}

/// What stands for the last sample of each ray where that is opaque by convention, whatever its density.
const OPAQUE: [(&str, f64); 3] = [("sigmas", 1.0), ("deltas", 1e10), ("alphas", 1.0)];

/// Sets what is given of each ray's last sample.
fn set_last(a: &mut Arrays, name: &str, value: f64) {
    if let Some(array) = a.get_mut(name) {
        array
            .lanes_mut(Axis(1))
            .into_iter()
            .filter_map(|ray| ray.into_iter().last())
            .for_each(|x| *x = value);
    }
}

/// Samples with the last of each ray as it counts.
pub(super) fn closed<'a>(a: &'a Arrays, c: &Conventions) -> Cow<'a, Arrays> {
    if c.last_sample == LastSample::AsItIs {
        return Cow::Borrowed(a);
    }
    let mut closed = a.clone();
    OPAQUE.iter().for_each(|(name, value)| set_last(&mut closed, name, *value));
    Cow::Owned(closed)
}

/// Gradients, where an opaque last sample has none.
pub(super) fn gradients_of_closed(c: &Conventions, mut gradients: Arrays) -> Arrays {
    if c.last_sample == LastSample::Opaque {
        OPAQUE.iter().for_each(|(name, _)| set_last(&mut gradients, &format!("grad_{name}"), 0.0));
    }
    gradients
}

pub(super) fn render(a: &Arrays, c: &Conventions) -> Arrays {
    let a = &closed(a, c);
    let (rays, samples) = size(a, "sigmas");
    let ray = |r| {
        super::volume_render(&row(a, "sigmas", r), &rows3(a, "rgbs", r), &row(a, "deltas", r), c.product_eps)
    };
    over(c, renderings(samples, &(0..rays).map(ray).collect::<Vec<_>>()))
}

/// Over white, where that is the convention: C + 1 - A, where A is the sum of all weights. What is handed out for A may be without the last.
pub(super) fn over(c: &Conventions, mut out: Arrays) -> Arrays {
    if c.backdrop == Backdrop::White {
        let opacity = values(&out, "opacity");
        let colors = out.get_mut("colors").expect("an output");
        colors.indexed_iter_mut().for_each(|(i, color)| *color += 1.0 - opacity[i[0]]);
    }
    if c.opacity_sum == OpacitySum::WithoutLast {
        let (rays, samples) = size(&out, "weights");
        let opacity = |r| {
            let mut sum = Sum::default();
            row(&out, "weights", r).iter().take(samples.saturating_sub(1)).for_each(|w| sum.add(*w));
            sum.value()
        };
        let opacity = array(&[rays], (0..rays).map(opacity).collect());
        out.insert("opacity".into(), opacity);
    }
    out
}

/// The cotangent of ray r in front of its backdrop: white loses what the sum of all weights gains. Where the opacity is without the last
/// sample's weight, its cotangent goes to the weights of the others.
pub(crate) fn cotangent_over(a: &Arrays, r: usize, c: &Conventions) -> Cotangent {
    let mut g = cotangent(a, r);
    if c.opacity_sum == OpacitySum::WithoutLast {
        let others = g.weights.len().saturating_sub(1);
        g.weights[..others].iter_mut().for_each(|g_w| *g_w += g.opacity);
        g.opacity = 0.0;
    }
    if c.backdrop == Backdrop::White {
        g.opacity -= g.color.iter().sum::<f64>();
    }
    g
}

pub(super) fn render_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let a = &closed(a, c);
    let (rays, samples) = size(a, "sigmas");
    let (mut g_sigmas, mut g_rgbs, mut g_deltas) = (vec![], vec![], vec![]);
    for r in 0..rays {
        let (sigmas, rgbs, deltas) = (row(a, "sigmas", r), rows3(a, "rgbs", r), row(a, "deltas", r));
        let forward = super::volume_render(&sigmas, &rgbs, &deltas, c.product_eps);
        let g = backward::volume_render(
            &sigmas,
            &rgbs,
            &deltas,
            c.product_eps,
            &forward,
            &cotangent_over(a, r, c),
        );
        g_sigmas.extend(g.0);
        g_rgbs.extend(g.1.concat());
        g_deltas.extend(g.2);
    }
    let gradients = arrays([
        ("grad_sigmas", array(&[rays, samples], g_sigmas)),
        ("grad_rgbs", array(&[rays, samples, 3], g_rgbs)),
        ("grad_deltas", array(&[rays, samples], g_deltas)),
    ]);
    gradients_of_densities(a, c, gradients)
}

/// Gradients of samples that count as they are: by convention an opaque last one has none, nor has a density of 0 behind a ReLU.
pub(super) fn gradients_of_densities(a: &Arrays, c: &Conventions, gradients: Arrays) -> Arrays {
    let mut gradients = gradients_of_closed(c, gradients);
    if c.sigma_relu == SigmaRelu::Inside {
        let gradient = gradients.get_mut("grad_sigmas").expect("a gradient");
        gradient.zip_mut_with(&a["sigmas"], |g, &sigma| *g = if sigma > 0.0 { *g } else { 0.0 });
    }
    gradients
}

pub(super) fn render_alpha(a: &Arrays, c: &Conventions) -> Arrays {
    let a = &counted(a, c);
    let (rays, samples) = size(a, "alphas");
    let ray = |r| super::volume_render_alpha(&row(a, "alphas", r), &rows3(a, "rgbs", r), c.product_eps);
    over(c, renderings(samples, &(0..rays).map(ray).collect::<Vec<_>>()))
}

pub(super) fn render_alpha_vjp(given: &Arrays, c: &Conventions) -> Arrays {
    let a = &counted(given, c);
    let (rays, samples) = size(a, "alphas");
    let (mut g_alphas, mut g_rgbs) = (vec![], vec![]);
    for r in 0..rays {
        let (alphas, rgbs) = (row(a, "alphas", r), rows3(a, "rgbs", r));
        let forward = super::volume_render_alpha(&alphas, &rgbs, c.product_eps);
        let g =
            backward::volume_render_alpha(&alphas, &rgbs, c.product_eps, &forward, &cotangent_over(a, r, c));
        g_alphas.extend(g.0);
        g_rgbs.extend(g.1.concat());
    }
    let gradients = arrays([
        ("grad_alphas", array(&[rays, samples], g_alphas)),
        ("grad_rgbs", array(&[rays, samples, 3], g_rgbs)),
    ]);
    gradients_of_counted(given, c, gradients)
}

pub(super) fn background(a: &Arrays, _: &Conventions) -> Arrays {
    let opacity = values(a, "opacity");
    let b = rgb(&values(a, "background"));
    let ray = |r: usize| composite_background(rows3(a, "colors", r)[0], opacity[r], b);
    arrays([("colors_out", array(&[opacity.len(), 3], (0..opacity.len()).flat_map(ray).collect()))])
}

pub(super) fn background_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let opacity = values(a, "opacity");
    let b = rgb(&values(a, "background"));
    let (mut g_colors, mut g_opacity, mut g_b) = (vec![], vec![], [0.0; 3]);
    for (r, &opacity) in opacity.iter().enumerate() {
        let g = backward::composite_background(opacity, b, rows3(a, "grad_colors_out", r)[0]);
        g_colors.extend(g.0);
        g_opacity.push(g.1);
        (0..3).for_each(|k| g_b[k] += g.2[k]);
    }
    arrays([
        ("grad_colors", array(&[opacity.len(), 3], g_colors)),
        ("grad_opacity", array(&[opacity.len()], g_opacity)),
        ("grad_background", array(&[3], g_b.to_vec())),
    ])
}

pub(super) fn depths(a: &Arrays, c: &Conventions) -> Arrays {
    let (rays, _) = size(a, "weights");
    let ray = |r| depth(&row(a, "weights", r), &row(a, "t", r), number(a, "far"), c.depth, c.empty_depth);
    arrays([("depth", array(&[rays], (0..rays).map(ray).collect()))])
}

pub(super) fn depths_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let (rays, samples) = size(a, "weights");
    let g = values(a, "grad_depth");
    let ray = |r: usize| {
        backward::depth(
            &row(a, "weights", r),
            &row(a, "t", r),
            number(a, "far"),
            c.depth,
            c.empty_depth,
            g[r],
        )
    };
    let (g_weights, g_t): (Vec<_>, Vec<_>) = (0..rays).map(ray).unzip();
    arrays([
        ("grad_weights", array(&[rays, samples], g_weights.concat())),
        ("grad_t", array(&[rays, samples], g_t.concat())),
    ])
}

/// Whether step lengths come back, bit for bit, as differences of positions in a type.
pub(super) fn steps_from_positions(a: &Arrays, dtype: Dtype) -> bool {
    (0..size(a, "deltas").0).all(|r| {
        let mut t = 0.0;
        row(a, "deltas", r).into_iter().all(|delta| {
            let next = dtype.round(t + delta);
            let comes_back = dtype.round(next - t) == delta;
            t = next;
            comes_back
        })
    })
}

/// Whether all steps are alike.
pub(super) fn one_step(a: &Arrays, _: Dtype) -> bool {
    let deltas = values(a, "deltas");
    deltas.iter().all(|delta| *delta == deltas[0])
}

/// Whether an opacity is skipped as too faint.
fn skipped(alpha: f64, c: &Conventions) -> bool {
    c.faint == Faint::Skipped && alpha < 1.0 / 255.0
}

/// An opacity under the cap, or 0.
fn capped(alpha: f64, c: &Conventions) -> f64 {
    if skipped(alpha, c) { 0.0 } else { alpha.min(c.alpha_cap.value()) }
}

/// The opacities that count: capped, and 0 where they are faint and skipped, and from where the ray ends.
pub(super) fn counted(a: &Arrays, c: &Conventions) -> Arrays {
    counted_to(a, c, &exact_ends(a, c))
}

/// How many samples of each ray come before its end, by the light that is left: see [`ends`].
pub(super) fn exact_ends(a: &Arrays, c: &Conventions) -> Vec<usize> {
    ends(a, c, |light, alpha| light * (1.0 - alpha))
}

/// How many samples of each ray come before the first behind which less than 1e-4 of the light is left, where that ends it: of a program
/// that finds the light behind a sample in this way.
pub(super) fn ends(a: &Arrays, c: &Conventions, through: impl Fn(f64, f64) -> f64) -> Vec<usize> {
    let end = |ray: ArrayView1<f64>| {
        let mut light = 1.0;
        let spent = |alpha: &f64| {
            light = through(light, capped(*alpha, c));
            light < LEAST_LIGHT
        };
        let spent = if c.alpha_stop == AlphaStop::InFront { ray.iter().position(spent) } else { None };
        spent.unwrap_or(ray.len())
    };
    a["alphas"].lanes(Axis(1)).into_iter().map(end).collect()
}

/// The light at which a ray ends.
pub(super) const LEAST_LIGHT: f64 = 1e-4;

/// The opacities that count where rays end behind so many samples.
pub(super) fn counted_to(a: &Arrays, c: &Conventions, ends: &[usize]) -> Arrays {
    let mut a = closed(a, c).into_owned();
    let alphas = a.get_mut("alphas").expect("an input");
    alphas.mapv_inplace(|alpha| capped(alpha, c));
    for (mut ray, &end) in alphas.lanes_mut(Axis(1)).into_iter().zip(ends) {
        ray.slice_mut(s![end..]).fill(0.0);
    }
    a
}

/// The same without gradients of opacities that don't count as they are: by convention those at the cap have one. A skipped 0 counts no
/// more than its neighbors do.
pub(super) fn gradients_of_counted(a: &Arrays, c: &Conventions, gradients: Arrays) -> Arrays {
    gradients_to(a, c, &exact_ends(a, c), gradients)
}

/// The same where rays end behind so many samples.
pub(super) fn gradients_to(a: &Arrays, c: &Conventions, ends: &[usize], gradients: Arrays) -> Arrays {
    let mut gradients = gradients_of_closed(c, gradients);
    let gradient = gradients.get_mut("grad_alphas").expect("a gradient");
    let held = |alpha: f64| c.cap_gradient == CapGradient::Stopped && alpha > c.alpha_cap.value();
    let rays = gradient.lanes_mut(Axis(1)).into_iter().zip(a["alphas"].lanes(Axis(1)));
    for ((mut g, alphas), &end) in rays.zip(ends) {
        for (i, g) in g.iter_mut().enumerate() {
            if i >= end || skipped(alphas[i], c) || held(alphas[i]) {
                *g = 0.0;
            }
        }
    }
    gradients
}

#[cfg(test)]
mod tests {
    use super::super::bound;
    use super::*;
    use crate::contract::arithmetic::{Arithmetic, Grade};
    use crate::convention::CS180;

    #[test]
    fn nothing_is_seen_behind_an_opaque_last_sample() {
        let c = Conventions { last_sample: LastSample::Opaque, ..CS180 };
        let ln2 = std::f64::consts::LN_2;
        let rgbs = || array(&[1, 2, 3], vec![0.25, 0.25, 0.25, 0.75, 0.75, 0.75]);
        let thin = arrays([
            ("sigmas", array(&[1, 2], vec![ln2, 0.0])),
            ("deltas", array(&[1, 2], vec![1.0, 0.0])),
            ("rgbs", rgbs()),
        ]);
        let layers = arrays([("alphas", array(&[1, 2], vec![0.5, 0.0])), ("rgbs", rgbs())]);
        for out in [render(&thin, &c), render_alpha(&layers, &c)] {
            assert_eq!(values(&out, "weights"), [0.5, 0.5]);
            assert_eq!(values(&out, "colors"), [0.5; 3]);
            assert_eq!((values(&out, "opacity")[0], values(&out, "transmittance")[0]), (1.0, 0.0));
        }
        let pulled = |mut a: Arrays| {
            a.insert("grad_colors".into(), array(&[1, 3], vec![1.0; 3]));
            a.insert("grad_weights".into(), array(&[1, 2], vec![0.0; 2]));
            for name in ["grad_opacity", "grad_transmittance"] {
                a.insert(name.into(), array(&[1], vec![0.0]));
            }
            a
        };
        // More of the first sample is less of the last one, of three channels: 3 (1/4 - 3/4) e^-ln2.
        let gradients = render_vjp(&pulled(thin), &c);
        assert_eq!(values(&gradients, "grad_sigmas"), [-0.75, 0.0]);
        assert_eq!(values(&gradients, "grad_deltas"), [-0.75 * ln2, 0.0]);
        assert_eq!(values(&render_alpha_vjp(&pulled(layers), &c), "grad_alphas"), [-1.5, 0.0]);
    }

    #[test]
    fn a_ray_of_given_opacities_ends_where_next_to_no_light_is_left() {
        let case = |alphas: &[f64]| {
            let n = alphas.len();
            arrays([
                ("alphas", array(&[1, n], alphas.to_vec())),
                ("rgbs", array(&[1, n, 3], vec![1.0; 3 * n])),
            ])
        };
        let c = Conventions { alpha_stop: AlphaStop::InFront, ..CS180 };
        let weights = |alphas: &[f64]| values(&render_alpha(&case(alphas), &c), "weights");
        // 1/2 1e-5 would be left behind the second.
        assert_eq!(weights(&[0.5, 1.0 - 1e-5, 0.25]), [0.5, 0.0, 0.0]);
        assert_eq!(weights(&[0.5, 0.5, 0.25]), [0.5, 0.25, 0.0625]);
        // Behind two opacities of 0.99 it is 1e-4, more or less: either is right.
        let two = case(&[0.99, 0.99]);
        let bound = bound::volume_render_alpha(&two, &c, &Arithmetic::new(Dtype::F32, Grade::A));
        let off = values(&bound, "weights");
        assert!(off[0] < 1e-6 && off[1] > 0.0099 && off[1] < 0.0100, "{off:?}");
        // A gradient is that of the ray up to its end: of the last sample's opacity 0.01 g, or none.
        let mut pulled = two.clone();
        pulled.insert("grad_colors".into(), array(&[1, 3], vec![1.0; 3]));
        pulled.insert("grad_weights".into(), array(&[1, 2], vec![0.0; 2]));
        pulled.insert("grad_opacity".into(), array(&[1], vec![0.0]));
        pulled.insert("grad_transmittance".into(), array(&[1], vec![0.0]));
        let bound = bound::volume_render_alpha_vjp(&pulled, &c, &Arithmetic::new(Dtype::F32, Grade::A));
        let off = values(&bound, "grad_alphas");
        assert!(off[1] > 0.0299 && off[1] < 0.0301, "{off:?}");
        let decided = case(&[0.99, 0.9899]);
        let bound = bound::volume_render_alpha(&decided, &c, &Arithmetic::new(Dtype::F32, Grade::A));
        assert!(values(&bound, "weights")[1] < 1e-6);
    }
}
