//! Registry rows of volume rendering.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::{Form, Special};
use crate::convention::{AlphaCap, AlphaStop, Faint, LastSample};

/// How functions take step lengths.
const FORMS: &[Form] = &[
    Form {
        without: &["deltas"],
        takes: Some("t"),
        meaning: "t_0 = 0, t_{i+1} = t_i + delta_i, (R, N + 1): behind it lies an empty sample, for a last step of one's own",
        holds: arrays::steps_from_positions,
    },
    Form {
        without: &["deltas"],
        takes: Some("step"),
        meaning: "one number for all",
        holds: arrays::one_step,
    },
];

const SIGMAS: Port = Port::smooth("sigmas", "R,N", "densities, 1 / length");
const ALPHAS: Port = Port::smooth("alphas", "R,N", "opacities in [0, 1]");
const RGBS: Port = Port::smooth("rgbs", "R,N,3", "colors");
const DELTAS: Port = Port::smooth("deltas", "R,N", "step lengths");
const COLORS: Port = Port::smooth("colors", "R,3", "sum of w c");
const WEIGHTS: Port = Port::smooth("weights", "R,N", "T alpha");
const OPACITY: Port = Port::smooth("opacity", "R", "sum of w");
const TRANSMITTANCE: Port = Port::smooth("transmittance", "R", "T behind the last sample");

/// Rendering from densities.
pub(crate) const VOLUME_RENDER: Component = Component {
    name: "volume_render",
    folder: "volume_rendering",
    code: include_str!("honest.rs"),
    formula: "alpha_i = 1 - exp(-sigma_i delta_i), T_i = exp(-sum_{j<i} sigma_j delta_j), w_i = T_i alpha_i, C = sum w_i c_i",
    source: "NeRF (Mildenhall et al. 2020) equation 3",
    inputs: &[SIGMAS, RGBS, DELTAS],
    outputs: &[COLORS, WEIGHTS, OPACITY, TRANSMITTANCE],
    conventions: &["product_eps", "backdrop", "sigma_relu", "opacity_sum", "last_sample"],
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
    special: Special {
        rounds_inside: mistakes::rounds_alpha,
        forms: FORMS,
        large: cases::large::densities,
        left_of_one: &["transmittance"],
        seldom: &["last_sample"],
        of_gradients: arrays::gradients_of_densities,
        laws: Some(mistakes::weight_laws::OF_DENSITIES),
        gradient_laws: Some(mistakes::gradient_laws::OF_DENSITIES),
        ..Special::NONE
    },
};

/// Rendering from opacities.
pub(crate) const VOLUME_RENDER_ALPHA: Component = Component {
    name: "volume_render_alpha",
    folder: "volume_rendering",
    code: include_str!("honest.rs"),
    formula: "T_i = prod_{j<i} (1 - alpha_j), w_i = T_i alpha_i, C = sum w_i c_i",
    source: "NeRF (Mildenhall et al. 2020) equation 3, with alpha given",
    inputs: &[ALPHAS, RGBS],
    outputs: &[COLORS, WEIGHTS, OPACITY, TRANSMITTANCE],
    conventions: &[
        "product_eps",
        "alpha_cap",
        "faint",
        "alpha_stop",
        "cap_gradient",
        "backdrop",
        "opacity_sum",
        "last_sample",
    ],
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
    special: Special {
        large: cases::large::opacities,
        // An opaque last layer is no splat, which has a cap or an end.
        admits: |_, c| {
            c.last_sample == LastSample::AsItIs
                || c.alpha_cap == AlphaCap::None && c.alpha_stop == AlphaStop::None && c.faint == Faint::Kept
        },
        left_of_one: &["transmittance"],
        seldom: &["last_sample"],
        laws: Some(mistakes::weight_laws::OF_OPACITIES),
        gradient_laws: Some(mistakes::gradient_laws::OF_OPACITIES),
        ..Special::NONE
    },
};

/// Light from behind.
pub(crate) const COMPOSITE_BACKGROUND: Component = Component {
    name: "composite_background",
    folder: "volume_rendering",
    code: include_str!("honest.rs"),
    formula: "C' = C + (1 - A) b",
    source: "Porter and Duff 1984, premultiplied over",
    inputs: &[
        Port::smooth("colors", "R,3", "rendered colors, premultiplied"),
        Port::smooth("opacity", "R", "A"),
        Port::smooth("background", "3", "b"),
    ],
    outputs: &[Port::smooth("colors_out", "R,3", "colors over b")],
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
    special: Special { large: cases::large::backgrounds, ..Special::NONE },
};

/// Expected distance.
pub(crate) const DEPTH: Component = Component {
    name: "depth",
    folder: "volume_rendering",
    code: include_str!("honest.rs"),
    formula: "z = sum w_i t_i / sum w_i, far where the ray meets nothing (by convention 0, the first t or the last)",
    source: "bmild/nerf run_nerf.py raw2outputs (undivided); nerfstudio renderers.py (divided)",
    inputs: &[
        Port::smooth("weights", "R,N", "w"),
        Port::smooth("t", "R,N", "distances"),
        Port::plain("far", "", "depth of an empty ray"),
    ],
    outputs: &[Port::smooth("depth", "R", "expected distance")],
    conventions: &["depth", "empty_depth"],
    forward: Direction {
        oracle: arrays::depths,
        bound: bound::depth::expected,
        honest: honest::depth,
        wrong: mistakes::depth,
    },
    vjp: Some(Direction {
        oracle: arrays::depths_vjp,
        bound: bound::depth::expected_vjp,
        honest: honest::depth_vjp,
        wrong: mistakes::depth_vjp,
    }),
    cases: cases::depth,
    mistakes: mistakes::DEPTH,
    special: Special {
        large: cases::large::depths,
        laws: Some(mistakes::depth_laws::OF_DEPTHS),
        ..Special::NONE
    },
};
