//! Registry rows of volume rendering.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};

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
    forward: Direction {
        oracle: arrays::render,
        bound: bound::volume_render,
        honest: honest::volume_render,
        wrong: mistakes::volume_render,
    },
    vjp: Some(Direction {
        oracle: arrays::render_vjp,
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
    forward: Direction {
        oracle: arrays::render_alpha,
        bound: bound::volume_render_alpha,
        honest: honest::volume_render_alpha,
        wrong: mistakes::volume_render_alpha,
    },
    vjp: Some(Direction {
        oracle: arrays::render_alpha_vjp,
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
    forward: Direction {
        oracle: arrays::background,
        bound: bound::composite_background,
        honest: honest::composite_background,
        wrong: mistakes::composite_background,
    },
    vjp: Some(Direction {
        oracle: arrays::background_vjp,
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
    forward: Direction {
        oracle: arrays::depths,
        bound: bound::depth,
        honest: honest::depth,
        wrong: mistakes::depth,
    },
    vjp: Some(Direction {
        oracle: arrays::depths_vjp,
        bound: bound::depth_vjp,
        honest: honest::depth_vjp,
        wrong: mistakes::depth_vjp,
    }),
    cases: cases::depth,
    mistakes: mistakes::DEPTH,
};
