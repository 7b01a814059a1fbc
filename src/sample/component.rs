//! Registry rows of samples along rays.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::{Chosen, Special};

const NEAR: Port = Port::plain("near", "", "where rays begin");
const FAR: Port = Port::plain("far", "", "where rays end");

/// Positions and points.
pub(crate) const SAMPLE_ALONG_RAYS: Component = Component {
    name: "sample_along_rays",
    folder: "sample",
    code: include_str!("honest.rs"),
    formula: "D = (far - near) / N, t_i = near + (i + u_i) D, points = o + t d",
    source: "NeRF (Mildenhall et al. 2020) equation 2",
    inputs: &[
        Port::plain("rays_o", "R,3", "origins"),
        Port::plain("rays_d", "R,3", "directions, as they come"),
        NEAR,
        FAR,
        Port::plain("u", "R,N", "numbers in [0, 1), one for every sample"),
    ],
    outputs: &[Port::plain("t", "R,N", "positions along the ray"), Port::plain("points", "R,N,3", "o + t d")],
    conventions: &["grid"],
    forward: Direction {
        oracle: arrays::sample_along_rays,
        bound: bound::sample_along_rays,
        honest: honest::sample_along_rays,
        wrong: mistakes::sample_along_rays,
    },
    vjp: None,
    cases: cases::sample_along_rays,
    mistakes: mistakes::SAMPLE_ALONG_RAYS,
    special: Special { large: cases::large_samples, laws: Some(mistakes::laws::OF_SAMPLES), ..Special::NONE },
};

/// Step lengths.
pub(crate) const STEP_SIZES: Component = Component {
    name: "step_sizes",
    folder: "sample",
    code: include_str!("honest.rs"),
    formula: "delta = (far - near) / N; by convention t_{i+1} - t_i, with a stated last one",
    source: "NeRF (Mildenhall et al. 2020) equation 3; CS180 project 4, part 2.5",
    inputs: &[Port::plain("t", "R,N", "positions along the ray"), NEAR, FAR],
    outputs: &[Port::plain("deltas", "R,N", "step lengths")],
    conventions: &["delta", "last_delta"],
    forward: Direction {
        oracle: arrays::step_sizes,
        bound: bound::step_sizes,
        honest: honest::step_sizes,
        wrong: mistakes::step_sizes,
    },
    vjp: None,
    cases: cases::step_sizes,
    mistakes: mistakes::STEP_SIZES,
    special: Special {
        chosen: Some(Chosen {
            output: "deltas",
            what: "the last step",
            at: |index, shape| index[1] + 1 == shape[1],
            less: Some("t"),
            listed: 1e10,
        }),
        large: cases::large_steps,
        laws: Some(mistakes::laws::OF_STEPS),
        ..Special::NONE
    },
};
