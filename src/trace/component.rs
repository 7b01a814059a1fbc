//! The registry row of the trace.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::Special;
use crate::ray::component::PICTURE_FORMS;
use crate::volume_rendering::mistakes::rounds_alpha;

/// The conventions that each output depends on; the others depend on all.
const READS: &[(&str, &[&str])] = &[
    ("uv", &["pixel_center"]),
    ("rays_o", &[]),
    ("rays_d", &["axes", "pixel_center", "directions"]),
    ("t", &["grid"]),
    ("deltas", &["axes", "pixel_center", "directions", "grid", "delta", "last_delta"]),
];

/// The whole way from the pixel to its color.
pub(crate) const RENDER_TRACE: Component = Component {
    name: "render_trace",
    folder: "trace",
    code: include_str!("honest.rs"),
    formula: "image_rays, sample_along_rays, step_sizes, volume_render and composite_background one after the other",
    source: "NeRF (Mildenhall et al. 2020) sections 4 and 5.2",
    inputs: &[
        Port::plain("height", "", "H").of(Entries::Count),
        Port::plain("width", "", "W").of(Entries::Count),
        Port::plain("focal", "", "in pixels"),
        Port::plain("cx", "", "principal point, in pixels"),
        Port::plain("cy", "", "principal point, in pixels"),
        Port::plain("c2w", "4,4", "pose"),
        Port::plain("near", "", "where rays begin"),
        Port::plain("far", "", "where rays end"),
        Port::plain("u", "H,W,N", "numbers in [0, 1), one for every sample"),
        Port::plain("sigmas", "H,W,N", "densities of the samples"),
        Port::plain("rgbs", "H,W,N,3", "colors of the samples"),
        Port::plain("background", "3", "color behind everything"),
    ],
    outputs: &[
        Port::plain("uv", "H,W,2", "pixel positions").of(Entries::Pixel),
        Port::plain("rays_o", "H,W,3", "origins"),
        Port::plain("rays_d", "H,W,3", "directions"),
        Port::plain("t", "H,W,N", "sample positions"),
        Port::plain("deltas", "H,W,N", "step lengths"),
        Port::plain("weights", "H,W,N", "T alpha"),
        Port::plain("colors", "H,W,3", "over the background"),
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
    special: Special {
        forward_name: "trace",
        reads: READS,
        rounds_inside: rounds_alpha,
        forms: PICTURE_FORMS,
        ..Special::NONE
    },
};
