//! Registry rows of volume rendering: named arrays on one side, slices of one ray on the other.

use ndarray::Axis;

use super::backward::Cotangent;
use super::{Rendering, backward, bound, cases, composite_background, depth, honest, mistakes};
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, input, number, values};
use crate::convention::Conventions;

const SIGMAS: Port = Port { name: "sigmas", shape: "R,N", meaning: "densities, 1 / length", gradient: true };
const ALPHAS: Port = Port { name: "alphas", shape: "R,N", meaning: "opacities in [0, 1]", gradient: true };
const RGBS: Port = Port { name: "rgbs", shape: "R,N,3", meaning: "colors", gradient: true };
const DELTAS: Port = Port { name: "deltas", shape: "R,N", meaning: "step lengths", gradient: true };
const COLORS: Port = Port { name: "colors", shape: "R,3", meaning: "sum of w c", gradient: true };
const WEIGHTS: Port = Port { name: "weights", shape: "R,N", meaning: "T alpha", gradient: true };
const OPACITY: Port = Port { name: "opacity", shape: "R", meaning: "sum of w", gradient: true };
const TRANSMITTANCE: Port =
    Port { name: "transmittance", shape: "R", meaning: "T behind the last sample", gradient: true };

/// Rendering from densities.
pub const VOLUME_RENDER: Component = Component {
    name: "volume_render",
    folder: "volume_rendering",
    formula: "alpha_i = 1 - exp(-sigma_i delta_i), T_i = exp(-sum_{j<i} sigma_j delta_j), w_i = T_i alpha_i, C = sum w_i c_i",
    source: "NeRF (Mildenhall et al. 2020) equation 3",
    inputs: &[SIGMAS, RGBS, DELTAS],
    outputs: &[COLORS, WEIGHTS, OPACITY, TRANSMITTANCE],
    conventions: &["product_eps"],
    forward: Pass {
        oracle: render,
        bound: bound::volume_render,
        honest: honest::volume_render,
        wrong: mistakes::volume_render,
    },
    vjp: Some(Pass {
        oracle: render_vjp,
        bound: bound::volume_render_vjp,
        honest: honest::volume_render_vjp,
        wrong: mistakes::volume_render_vjp,
    }),
    cases: cases::volume_render,
    mistakes: mistakes::VOLUME_RENDER,
};

/// Rendering from opacities.
pub const VOLUME_RENDER_ALPHA: Component = Component {
    name: "volume_render_alpha",
    folder: "volume_rendering",
    formula: "T_i = prod_{j<i} (1 - alpha_j), w_i = T_i alpha_i, C = sum w_i c_i",
    source: "NeRF (Mildenhall et al. 2020) equation 3, with alpha given",
    inputs: &[ALPHAS, RGBS],
    outputs: &[COLORS, WEIGHTS, OPACITY, TRANSMITTANCE],
    conventions: &["product_eps"],
    forward: Pass {
        oracle: render_alpha,
        bound: bound::volume_render_alpha,
        honest: honest::volume_render_alpha,
        wrong: mistakes::volume_render_alpha,
    },
    vjp: Some(Pass {
        oracle: render_alpha_vjp,
        bound: bound::volume_render_alpha_vjp,
        honest: honest::volume_render_alpha_vjp,
        wrong: mistakes::volume_render_alpha_vjp,
    }),
    cases: cases::volume_render_alpha,
    mistakes: mistakes::VOLUME_RENDER_ALPHA,
};

/// Light from behind.
pub const COMPOSITE_BACKGROUND: Component = Component {
    name: "composite_background",
    folder: "volume_rendering",
    formula: "C' = C + (1 - A) b",
    source: "Porter and Duff 1984, premultiplied over",
    inputs: &[
        Port { name: "colors", shape: "R,3", meaning: "rendered colors, premultiplied", gradient: true },
        Port { name: "opacity", shape: "R", meaning: "A", gradient: true },
        Port { name: "background", shape: "3", meaning: "b", gradient: true },
    ],
    outputs: &[Port { name: "colors_out", shape: "R,3", meaning: "colors over b", gradient: true }],
    conventions: &[],
    forward: Pass {
        oracle: background,
        bound: bound::composite_background,
        honest: honest::composite_background,
        wrong: mistakes::composite_background,
    },
    vjp: Some(Pass {
        oracle: background_vjp,
        bound: bound::composite_background_vjp,
        honest: honest::composite_background_vjp,
        wrong: mistakes::composite_background_vjp,
    }),
    cases: cases::composite_background,
    mistakes: mistakes::COMPOSITE_BACKGROUND,
};

/// Expected distance.
pub const DEPTH: Component = Component {
    name: "depth",
    folder: "volume_rendering",
    formula: "z = sum w_i t_i / sum w_i, far where the ray meets nothing",
    source: "bmild/nerf run_nerf.py raw2outputs (undivided); nerfstudio renderers.py (divided)",
    inputs: &[
        Port { name: "weights", shape: "R,N", meaning: "w", gradient: true },
        Port { name: "t", shape: "R,N", meaning: "distances", gradient: true },
        Port { name: "far", shape: "", meaning: "depth of an empty ray", gradient: false },
    ],
    outputs: &[Port { name: "depth", shape: "R", meaning: "expected distance", gradient: true }],
    conventions: &["depth"],
    forward: Pass { oracle: depths, bound: bound::depth, honest: honest::depth, wrong: mistakes::depth },
    vjp: Some(Pass {
        oracle: depths_vjp,
        bound: bound::depth_vjp,
        honest: honest::depth_vjp,
        wrong: mistakes::depth_vjp,
    }),
    cases: cases::depth,
    mistakes: mistakes::DEPTH,
};

/// Row r of an (R, N) array.
pub(crate) fn row(arrays: &Arrays, name: &str, r: usize) -> Vec<f64> {
    input(arrays, name).index_axis(Axis(0), r).iter().copied().collect()
}

/// Row r of an (R, N, 3) or (R, 3) array, in threes.
pub(crate) fn rows3(arrays: &Arrays, name: &str, r: usize) -> Vec<[f64; 3]> {
    row(arrays, name, r).chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
}

/// Number of rays and samples.
pub(crate) fn size(arrays: &Arrays, name: &str) -> (usize, usize) {
    (input(arrays, name).shape()[0], input(arrays, name).shape()[1])
}

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

fn render(a: &Arrays, c: &Conventions) -> Arrays {
    let (rays, samples) = size(a, "sigmas");
    let ray = |r| {
        super::volume_render(&row(a, "sigmas", r), &rows3(a, "rgbs", r), &row(a, "deltas", r), c.product_eps)
    };
    renderings(samples, &(0..rays).map(ray).collect::<Vec<_>>())
}

fn render_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let (rays, samples) = size(a, "sigmas");
    let (mut g_sigmas, mut g_rgbs, mut g_deltas) = (vec![], vec![], vec![]);
    for r in 0..rays {
        let (sigmas, rgbs, deltas) = (row(a, "sigmas", r), rows3(a, "rgbs", r), row(a, "deltas", r));
        let forward = super::volume_render(&sigmas, &rgbs, &deltas, c.product_eps);
        let g = backward::volume_render(&sigmas, &rgbs, &deltas, c.product_eps, &forward, &cotangent(a, r));
        g_sigmas.extend(g.0);
        g_rgbs.extend(g.1.concat());
        g_deltas.extend(g.2);
    }
    arrays([
        ("grad_sigmas", array(&[rays, samples], g_sigmas)),
        ("grad_rgbs", array(&[rays, samples, 3], g_rgbs)),
        ("grad_deltas", array(&[rays, samples], g_deltas)),
    ])
}

fn render_alpha(a: &Arrays, c: &Conventions) -> Arrays {
    let (rays, samples) = size(a, "alphas");
    let ray = |r| super::volume_render_alpha(&row(a, "alphas", r), &rows3(a, "rgbs", r), c.product_eps);
    renderings(samples, &(0..rays).map(ray).collect::<Vec<_>>())
}

fn render_alpha_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let (rays, samples) = size(a, "alphas");
    let (mut g_alphas, mut g_rgbs) = (vec![], vec![]);
    for r in 0..rays {
        let (alphas, rgbs) = (row(a, "alphas", r), rows3(a, "rgbs", r));
        let forward = super::volume_render_alpha(&alphas, &rgbs, c.product_eps);
        let g = backward::volume_render_alpha(&alphas, &rgbs, c.product_eps, &forward, &cotangent(a, r));
        g_alphas.extend(g.0);
        g_rgbs.extend(g.1.concat());
    }
    arrays([
        ("grad_alphas", array(&[rays, samples], g_alphas)),
        ("grad_rgbs", array(&[rays, samples, 3], g_rgbs)),
    ])
}

fn background(a: &Arrays, _: &Conventions) -> Arrays {
    let opacity = values(a, "opacity");
    let b = rgb(&values(a, "background"));
    let ray = |r: usize| composite_background(rows3(a, "colors", r)[0], opacity[r], b);
    arrays([("colors_out", array(&[opacity.len(), 3], (0..opacity.len()).flat_map(ray).collect()))])
}

fn background_vjp(a: &Arrays, _: &Conventions) -> Arrays {
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

fn depths(a: &Arrays, c: &Conventions) -> Arrays {
    let (rays, _) = size(a, "weights");
    let ray = |r| depth(&row(a, "weights", r), &row(a, "t", r), number(a, "far"), c.depth);
    arrays([("depth", array(&[rays], (0..rays).map(ray).collect()))])
}

fn depths_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let (rays, samples) = size(a, "weights");
    let g = values(a, "grad_depth");
    let ray = |r: usize| backward::depth(&row(a, "weights", r), &row(a, "t", r), c.depth, g[r]);
    let (g_weights, g_t): (Vec<_>, Vec<_>) = (0..rays).map(ray).unzip();
    arrays([
        ("grad_weights", array(&[rays, samples], g_weights.concat())),
        ("grad_t", array(&[rays, samples], g_t.concat())),
    ])
}

/// Three numbers as a color.
pub(crate) fn rgb(values: &[f64]) -> [f64; 3] {
    [values[0], values[1], values[2]]
}
