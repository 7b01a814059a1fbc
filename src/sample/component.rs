//! Registry rows of samples along rays.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};

const NEAR: Port = Port { name: "near", shape: "", meaning: "where rays begin", gradient: false };
const FAR: Port = Port { name: "far", shape: "", meaning: "where rays end", gradient: false };

/// Positions and points.
pub const SAMPLE_ALONG_RAYS: Component = Component {
    name: "sample_along_rays",
    folder: "sample",
    formula: "D = (far - near) / N, t_i = near + (i + u_i) D, points = o + t d",
    source: "NeRF (Mildenhall et al. 2020) equation 2",
    inputs: &[
        Port { name: "rays_o", shape: "R,3", meaning: "origins", gradient: false },
        Port { name: "rays_d", shape: "R,3", meaning: "directions, as they come", gradient: false },
        NEAR,
        FAR,
        Port { name: "u", shape: "R,N", meaning: "numbers in [0, 1), one for every sample", gradient: false },
    ],
    outputs: &[
        Port { name: "t", shape: "R,N", meaning: "positions along the ray", gradient: false },
        Port { name: "points", shape: "R,N,3", meaning: "o + t d", gradient: false },
    ],
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
};

/// Step lengths.
pub const STEP_SIZES: Component = Component {
    name: "step_sizes",
    folder: "sample",
    formula: "delta = (far - near) / N; by convention t_{i+1} - t_i, with a stated last one",
    source: "NeRF (Mildenhall et al. 2020) equation 3; CS180 project 4, part 2.5",
    inputs: &[
        Port { name: "t", shape: "R,N", meaning: "positions along the ray", gradient: false },
        NEAR,
        FAR,
    ],
    outputs: &[Port { name: "deltas", shape: "R,N", meaning: "step lengths", gradient: false }],
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
};
