//! The registry row of the trace.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};

const fn plain(name: &'static str, shape: &'static str, meaning: &'static str) -> Port {
    Port { name, shape, meaning, gradient: false }
}

/// The conventions that each output depends on, where these aren't all: a search for conventions rules them out output by output.
pub const READS: &[(&str, &[&str])] = &[
    ("uv", &["pixel_center"]),
    ("rays_o", &[]),
    ("rays_d", &["axes", "pixel_center", "directions"]),
    ("t", &["grid"]),
    ("deltas", &["axes", "pixel_center", "directions", "grid", "delta", "last_delta"]),
];

/// The whole way from the pixel to its color.
pub const RENDER_TRACE: Component = Component {
    name: "render_trace",
    folder: "trace",
    formula: "image_rays, sample_along_rays, step_sizes, volume_render and composite_background one after the other",
    source: "NeRF (Mildenhall et al. 2020) sections 4 and 5.2",
    inputs: &[
        plain("height", "", "H"),
        plain("width", "", "W"),
        plain("focal", "", "in pixels"),
        plain("cx", "", "principal point, in pixels"),
        plain("cy", "", "principal point, in pixels"),
        plain("c2w", "4,4", "pose"),
        plain("near", "", "where rays begin"),
        plain("far", "", "where rays end"),
        plain("u", "H,W,N", "numbers in [0, 1), one for every sample"),
        plain("sigmas", "H,W,N", "densities of the samples"),
        plain("rgbs", "H,W,N,3", "colors of the samples"),
        plain("background", "3", "color behind everything"),
    ],
    outputs: &[
        plain("uv", "H,W,2", "pixel positions"),
        plain("rays_o", "H,W,3", "origins"),
        plain("rays_d", "H,W,3", "directions"),
        plain("t", "H,W,N", "sample positions"),
        plain("deltas", "H,W,N", "step lengths"),
        plain("weights", "H,W,N", "T alpha"),
        plain("colors", "H,W,3", "over the background"),
    ],
    conventions: &["axes", "pixel_center", "directions", "grid", "delta", "last_delta", "product_eps"],
    forward: Direction {
        oracle: arrays::render_trace,
        bound: bound::render_trace,
        honest: honest::render_trace,
        wrong: mistakes::render_trace,
    },
    vjp: None,
    cases: cases::render_trace,
    mistakes: mistakes::RENDER_TRACE,
};
