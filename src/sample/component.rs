//! Registry rows of samples along rays.

use glam::DVec3;

use super::{bound, cases, honest, mistakes, sample_along_ray};
use crate::camera::component::threes;
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, number};
use crate::convention::Conventions;
use crate::ray::Ray;
use crate::volume_rendering::component::{row, size};

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
    forward: Pass {
        oracle: sample_along_rays,
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
    forward: Pass {
        oracle: step_sizes,
        bound: bound::step_sizes,
        honest: honest::step_sizes,
        wrong: mistakes::step_sizes,
    },
    vjp: None,
    cases: cases::step_sizes,
    mistakes: mistakes::STEP_SIZES,
};

/// Positions and their points, as arrays.
pub(crate) fn samples(a: &Arrays, t: &[Vec<f64>]) -> Arrays {
    let (rays, count) = size(a, "u");
    let (o, d) = (threes(a, "rays_o"), threes(a, "rays_d"));
    let mut points = vec![];
    for r in 0..rays {
        let ray = Ray { o: DVec3::from(o[r]), d: DVec3::from(d[r]) };
        points.extend(t[r].iter().flat_map(|&t| ray.at(t).to_array()));
    }
    arrays([("t", array(&[rays, count], t.concat())), ("points", array(&[rays, count, 3], points))])
}

fn sample_along_rays(a: &Arrays, c: &Conventions) -> Arrays {
    let (near, far) = (number(a, "near"), number(a, "far"));
    let (rays, _) = size(a, "u");
    let t: Vec<_> = (0..rays).map(|r| sample_along_ray(near, far, &row(a, "u", r), c.grid)).collect();
    samples(a, &t)
}

fn step_sizes(a: &Arrays, c: &Conventions) -> Arrays {
    let (near, far) = (number(a, "near"), number(a, "far"));
    let (rays, count) = size(a, "t");
    let ray = |r: usize| super::step_sizes(&row(a, "t", r), near, far, c.delta, c.last_delta);
    arrays([("deltas", array(&[rays, count], (0..rays).flat_map(ray).collect()))])
}
