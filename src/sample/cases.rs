//! Cases of samples: jittered, at rest, at the ends of [0, 1), one sample, near = 0, cameras far away.

use ndarray::ArrayD;

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, signed};

/// Positions and points.
pub(crate) fn sample_along_rays() -> Vec<Case> {
    let case = |id: &str, comment, [near, far]: [f64; 2], u: ArrayD<f64>, size: f64| {
        let mut draw = Draw::new("sample_along_rays", id.len() as u64);
        let rays = u.shape()[0];
        let inputs = vec![
            ("rays_o", draw.array(&[rays, 3], -size, size)),
            ("rays_d", draw.array(&[rays, 3], -1.0, 1.0)),
            ("near", scalar(near)),
            ("far", scalar(far)),
            ("u", u),
        ];
        Case::new(id, comment, inputs)
    };
    let constant = |rays: usize, n: usize, u: f64| array(&[rays, n], vec![u; rays * n]);
    let random = |stream: u64, rays: usize, n: usize| Draw::new("u", stream).array(&[rays, n], 0.0, 0.984375);
    let cases = vec![
        case(
            "rest",
            "u = 0.5 everywhere: the middle of each interval, the same for all rays",
            [2.0, 6.0],
            constant(2, 8, 0.5),
            4.0,
        ),
        case("left", "u = 0: left edges, the first at near", [2.0, 6.0], constant(2, 8, 0.0), 4.0),
        case(
            "almost_1",
            "u = 1 - 2^-7: nearly the right edges, still inside",
            [2.0, 6.0],
            constant(2, 8, 0.9921875),
            4.0,
        ),
        case("jittered", "an independent u for every ray and sample", [2.0, 6.0], random(0, 4, 8), 4.0),
        case("jittered_64", "the course's 64 samples from 2 to 6", [2.0, 6.0], random(1, 2, 64), 4.0),
        case("one_sample", "N = 1: the interval is the whole ray", [2.0, 6.0], random(2, 3, 1), 4.0)
            .edge("one sample"),
        case("SA4_near_0", "near = 0 and a far that no type holds", [0.0, 0.7], random(3, 3, 5), 1.0),
        case("inexact_bounds", "near and far that no type holds", [0.1, 3.7], random(4, 3, 7), 2.0),
        case("CG9_far_away", "origins up to 2^20: o + t d cancels", [2.0, 6.0], random(5, 3, 6), 1_048_576.0),
    ];
    let mut cases = in_full(cases, "jittered");
    cases.push(case("one_ray", "a single ray", [2.0, 6.0], random(6, 1, 7), 4.0));
    cases
}

/// Step lengths.
pub(crate) fn step_sizes() -> Vec<Case> {
    let case = |id: &str, comment, [near, far]: [f64; 2], t: ArrayD<f64>| {
        Case::new(id, comment, vec![("t", t), ("near", scalar(near)), ("far", scalar(far))])
    };
    // Jittered positions near + (i + u) D in short numbers.
    let jittered = |stream: u64, rays: usize, n: usize, near: f64, width: f64| {
        let mut draw = Draw::new("step_sizes", stream);
        let t = (0..rays * n).map(|k| {
            let lower = near + (k % n) as f64 * width;
            draw.between(lower, lower + width)
        });
        array(&[rays, n], t.collect())
    };
    let even: Vec<f64> = (0..8).map(|i| 2.25 + 0.5 * f64::from(i)).collect();
    let cases = vec![
        case("even", "the middles of 8 intervals of 1/2", [2.0, 6.0], array(&[1, 8], even)),
        case(
            "jittered",
            "jittered positions, other ones on every ray",
            [2.0, 6.0],
            jittered(0, 3, 8, 2.0, 0.5),
        ),
        case("one_sample", "N = 1: no difference to take", [2.0, 6.0], array(&[2, 1], vec![3.5, 4.25]))
            .edge("one sample"),
        case(
            "SA4_near_0",
            "near = 0 and a far that no type holds",
            [0.0, 0.7],
            jittered(1, 2, 5, 0.0, 0.125),
        ),
        case("inexact_bounds", "near and far that no type holds", [0.1, 3.7], jittered(2, 2, 6, 0.125, 0.5)),
    ];
    in_full(cases, "jittered")
}

/// More rays than threads, more samples than a warp has lanes.
pub(crate) fn large_samples() -> Vec<Large> {
    let (rays, n) = (1025, 193);
    let large = Large::new("rays_1025x193", "1,025 rays of 193 samples", rays, 64);
    let large = large.with("rays_o", &[rays, 3], signed(-2, 3)).with("rays_d", &[rays, 3], signed(-2, 3));
    let large = large.with("near", &[], Recipe::Constant(2.0)).with("far", &[], Recipe::Constant(6.0));
    vec![large.with("u", &[rays, n], Recipe::Unit)]
}

/// The same, in 193 cells of 1/256.
pub(crate) fn large_steps() -> Vec<Large> {
    let (rays, n) = (1025, 193);
    let large = Large::new("rays_1025x193", "1,025 rays of 193 samples", rays, 64);
    let large = large.with("t", &[rays, n], Recipe::Ascending { cells: 8 });
    vec![large.with("near", &[], Recipe::Constant(0.0)).with("far", &[], Recipe::Constant(0.75390625))]
}
