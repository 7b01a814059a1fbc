//! Cases of the distortion loss: normalized and long rays, one surface and two, fog, intervals without length, far from 0.

use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats, sparse};

/// Rays of as many intervals, from rows of weights and of edges.
fn case(id: &str, comment: &'static str, weights: &[Vec<f64>], t: &[Vec<f64>]) -> Case {
    let rows = |rows: &[Vec<f64>]| array(&[rows.len(), rows[0].len()], rows.concat());
    Case::new(id, comment, vec![("weights", rows(weights)), ("t", rows(t))])
}

/// `n` edges and one from `near`, each so much further, times 1/2 to 3/2.
fn edges(draw: &mut Draw, n: usize, near: f64, step: f64) -> Vec<f64> {
    let mut t = vec![near];
    (0..n).for_each(|i| t.push(short(t[i] + step * draw.between(0.5, 1.5)).max(t[i])));
    t
}

/// Weights that add up to about `total`.
fn weights(draw: &mut Draw, n: usize, total: f64) -> Vec<f64> {
    (0..n).map(|_| draw.between(0.0, 2.0 * total / n as f64)).collect()
}

/// Edges from 1e4 on, in steps of 1/64: numbers of f32 and longer types alone.
fn far_away() -> Case {
    let mut draw = Draw::new("distortion_loss", 3);
    let mut t = vec![10_000.0];
    (0..8).for_each(|i| t.push(t[i] + (16.0 + draw.below(96) as f64) / 64.0));
    let w = weights(&mut draw, 8, 0.9);
    case("VR8_far", "edges from 1e4 on: running sums are a difference of large numbers", &[w], &[t])
}

/// How far apart along a ray its weights lie.
pub(crate) fn distortion_loss() -> Vec<Case> {
    let seeded = |id: &str, comment, stream: u64, rays: usize, n: usize, near: f64, step: f64| {
        let mut draw = Draw::new("distortion_loss", stream);
        let t: Vec<Vec<f64>> = (0..rays).map(|_| edges(&mut draw, n, near, step)).collect();
        let w: Vec<Vec<f64>> = (0..rays).map(|_| weights(&mut draw, n, 0.9)).collect();
        case(id, comment, &w, &t)
    };
    let cases = vec![
        seeded("usual", "rays of eight intervals of different lengths", 0, 4, 8, 2.0, 0.5),
        seeded("normalized", "normalized distances from 0 to about 1", 1, 4, 8, 0.0, 0.125),
        seeded("long", "32 intervals", 2, 2, 32, 0.0, 0.25),
        case(
            "one_surface",
            "all weight in one interval: a third of its length",
            &[vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 0.5]],
            &[vec![1.0, 1.25, 1.5, 4.0], vec![0.0, 1.0, 2.0, 8.0]],
        ),
        case(
            "two_surfaces",
            "weight in two places: their distance counts in either order",
            &[vec![0.5, 0.0, 0.0, 0.5], vec![0.75, 0.0, 0.25, 0.0]],
            &[vec![1.0, 1.0625, 2.0, 3.0, 3.0625], vec![0.0, 0.125, 1.0, 1.125, 4.0]],
        ),
        case(
            "empty",
            "no weight on one ray of two",
            &[vec![0.0; 4], vec![0.25, 0.0, 0.5, 0.125]],
            &[vec![0.0, 1.0, 2.0, 3.0, 4.0], vec![0.5, 1.0, 1.5, 3.0, 6.0]],
        ),
        case(
            "VR11_no_length",
            "intervals without length, two of them in one place: their middles tie",
            &[vec![0.25, 0.5, 0.125, 0.125]],
            &[vec![1.0, 2.0, 2.0, 2.0, 3.0]],
        ),
        case("one_interval", "one interval", &[vec![0.75]], &[vec![1.0, 3.0]]).edge("one sample"),
        far_away(),
    ];
    in_full(cases, "usual")
}

/// More rays than a block has threads, more intervals than a warp has lanes.
pub(crate) fn large() -> Vec<Large> {
    let case = |id, comment, [rays, n, block]: [usize; 3], cells, weights| {
        let large = Large::new(id, comment, rays, block).with("weights", &[rays, n], weights);
        large.with("t", &[rays, n + 1], Recipe::Ascending { cells })
    };
    vec![
        case("rays_4099x3", "4,099 rays of 3 intervals", [4099, 3, 512], 2, floats(-3, 2)),
        case("rays_257x193", "257 rays of 193 intervals", [257, 193, 16], 8, sparse(-10, 4, 2)),
    ]
}
