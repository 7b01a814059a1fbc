//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{backward, made_opaque, render_packed_to};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, number, scalar, threes, values, values_of};
use crate::convention::{CS180, Conventions, Stopped};
use crate::packed::arrays::offsets;
use crate::volume_rendering::Rendering;
use crate::volume_rendering::backward::Cotangent;

/// (first sample, number of samples) of each ray.
pub(crate) fn spans(a: &Arrays) -> Vec<(usize, usize)> {
    offsets(a, "sigmas").windows(2).map(|pair| (pair[0], pair[1] - pair[0])).collect()
}

/// Samples `first`, ..., `first + n - 1` as one ray of `volume_render`; with ray r's cotangents where the case has some.
pub(crate) fn one_ray(a: &Arrays, r: usize, first: usize, n: usize) -> Arrays {
    let part = |name: &str| values_of(a, name, first..first + n);
    let mut ray = arrays([
        ("sigmas", array(&[1, n], part("sigmas"))),
        ("rgbs", array(&[1, n, 3], part("rgbs"))),
        ("deltas", array(&[1, n], part("deltas"))),
    ]);
    if a.contains_key("grad_colors") {
        ray.insert("grad_colors".into(), array(&[1, 3], values_of(a, "grad_colors", r..r + 1)));
        ray.insert("grad_weights".into(), array(&[1, n], part("grad_weights")));
        for name in ["grad_opacity", "grad_transmittance"] {
            ray.insert(name.into(), array(&[1], values_of(a, name, r..r + 1)));
        }
    }
    ray
}

/// The values that `volume_render` returns for a ray's first n samples (`of`), padded with zeros to `length`.
pub(crate) fn stopped(n: usize, length: usize, of: Arrays) -> Arrays {
    let pad = |(name, values): (String, ndarray::ArrayD<f64>)| {
        let mut values: Vec<f64> = values.into_iter().collect();
        match name.as_str() {
            "weights" | "grad_sigmas" | "grad_deltas" => values.resize(length, 0.0),
            "grad_rgbs" => values.resize(3 * length, 0.0),
            _ => {}
        }
        (name, array(&[values.len()], values))
    };
    let mut all: Arrays = of.into_iter().map(pad).collect();
    if all.contains_key("weights") {
        all.insert("live".into(), array(&[1], vec![n as f64]));
    }
    all
}

/// The rays' arrays, one after the other.
pub(crate) fn packed(rays: Vec<Arrays>) -> Arrays {
    let names: &[&str] = if rays.iter().any(|ray| ray.contains_key("grad_sigmas")) {
        &["grad_sigmas", "grad_rgbs", "grad_deltas"]
    } else {
        &["live", "colors", "weights", "opacity", "transmittance"]
    };
    let join = |name: &&str| {
        let all: Vec<f64> = rays.iter().flat_map(|ray| values(ray, name)).collect();
        let shape = if name.ends_with("rgbs") || *name == "colors" {
            vec![all.len() / 3, 3]
        } else {
            vec![all.len()]
        };
        (name.to_string(), array(&shape, all))
    };
    names.iter().map(join).collect()
}

/// Whether a ray is made opaque: by convention, where T behind its last live sample is below the limit. A limit above 1 stops empty
/// rays, which stay empty.
pub(super) fn becomes_opaque(ray: &Rendering, eps: f64, c: &Conventions) -> bool {
    c.stopped == Stopped::MadeOpaque && ray.transmittance[ray.weights.len()] < eps && ray.opacity > 0.0
}

pub(super) fn early_stop(a: &Arrays, c: &Conventions) -> Arrays {
    let (sigmas, deltas) = (values(a, "sigmas"), values(a, "deltas"));
    let rays = render_packed_to(
        &sigmas,
        &threes(a, "rgbs"),
        &deltas,
        &offsets(a, "sigmas"),
        number(a, "eps"),
        c.stop,
    );
    let one = |(ray, (_, length)): (&Rendering, (usize, usize))| {
        let live = ray.weights.len();
        let ray = if becomes_opaque(ray, number(a, "eps"), c) { made_opaque(ray) } else { ray.clone() };
        stopped(live, length, crate::volume_rendering::arrays::renderings(live, &[ray]))
    };
    packed(rays.iter().zip(spans(a)).map(one).collect())
}

pub(super) fn early_stop_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let (sigmas, rgbs, deltas, offsets) =
        (values(a, "sigmas"), threes(a, "rgbs"), values(a, "deltas"), offsets(a, "sigmas"));
    let rays = render_packed_to(&sigmas, &rgbs, &deltas, &offsets, number(a, "eps"), c.stop);
    let (g_colors, g_weights) = (threes(a, "grad_colors"), values(a, "grad_weights"));
    let (g_opacity, g_transmittance) = (values(a, "grad_opacity"), values(a, "grad_transmittance"));
    let g = |r: usize| {
        let g = Cotangent {
            color: g_colors[r],
            weights: g_weights[offsets[r]..offsets[r] + rays[r].weights.len()].to_vec(),
            opacity: g_opacity[r],
            transmittance: g_transmittance[r],
        };
        if becomes_opaque(&rays[r], number(a, "eps"), c) { backward::made_opaque(&rays[r], &g) } else { g }
    };
    let g: Vec<Cotangent> = (0..rays.len()).map(g).collect();
    let (g_sigmas, g_rgbs, g_deltas) = backward::render_packed(&sigmas, &rgbs, &deltas, &offsets, &rays, &g);
    arrays([
        ("grad_sigmas", array(&[g_sigmas.len()], g_sigmas)),
        ("grad_rgbs", array(&[g_rgbs.len(), 3], g_rgbs.concat())),
        ("grad_deltas", array(&[g_deltas.len()], g_deltas)),
    ])
}

/// The largest threshold that a function without `eps` may have written into it; 1e-4 to 1e-2 are met.
const WRITTEN_IN: f64 = 0.05;

/// Whether no ray reaches a threshold, not with its last sample either, whatever the function's own is.
pub(super) fn nothing_stops(a: &Arrays, _: Dtype) -> bool {
    let eps = number(a, "eps").max(WRITTEN_IN);
    let mut to_the_end = a.clone();
    to_the_end.insert("eps".into(), scalar(0.0));
    values(&early_stop(&to_the_end, &CS180), "transmittance").iter().all(|&left| left >= eps)
}
