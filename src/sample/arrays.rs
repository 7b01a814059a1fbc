//! The oracle of this folder on named arrays, and what turns these into its types and back.

use glam::DVec3;

use super::sample_along_ray;
use crate::contract::arrays::{Arrays, array, arrays, number, row, size, threes};
use crate::convention::Conventions;
use crate::ray::Ray;

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

pub(super) fn sample_along_rays(a: &Arrays, c: &Conventions) -> Arrays {
    let (near, far) = (number(a, "near"), number(a, "far"));
    let (rays, _) = size(a, "u");
    let t: Vec<_> = (0..rays).map(|r| sample_along_ray(near, far, &row(a, "u", r), c.grid)).collect();
    samples(a, &t)
}

pub(super) fn step_sizes(a: &Arrays, c: &Conventions) -> Arrays {
    let (near, far) = (number(a, "near"), number(a, "far"));
    let (rays, count) = size(a, "t");
    let ray = |r: usize| super::step_sizes(&row(a, "t", r), near, far, c.delta, c.last_delta);
    arrays([("deltas", array(&[rays, count], (0..rays).flat_map(ray).collect()))])
}
