//! Cases of importance sampling: random rays, empty and opaque ones, ties, ends and bins of width 0.

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats};

/// Rows of equal length as an array.
fn table(rows: &[Vec<f64>]) -> ndarray::ArrayD<f64> {
    array(&[rows.len(), rows[0].len()], rows.concat())
}

fn case(id: &str, comment: &'static str, rays: [&[Vec<f64>]; 3], padding: f64) -> Case {
    let [edges, weights, u] = rays.map(table);
    Case::new(
        id,
        comment,
        vec![("edges", edges), ("weights", weights), ("padding", scalar(padding)), ("u", u)],
    )
}

/// Edges from 2 on in steps of 1/16 to 1/2: sixteenths up to 6 are representable in every type.
fn uneven(draw: &mut Draw, bins: usize) -> Vec<f64> {
    let mut edges = vec![2.0];
    for k in 0..bins {
        edges.push(edges[k] + (1.0 + draw.below(8) as f64) / 16.0);
    }
    edges
}

fn numbers(draw: &mut Draw, n: usize, low: f64, high: f64) -> Vec<f64> {
    (0..n).map(|_| draw.between(low, high)).collect()
}

/// `rays` random rays of `bins` bins and `samples` samples.
fn random(id: &str, comment: &'static str, [rays, bins, samples]: [usize; 3], padding: f64) -> Case {
    let mut draw = Draw::new("importance_sampling", id.len() as u64);
    let (mut edges, mut weights, mut u) = (vec![], vec![], vec![]);
    for _ in 0..rays {
        edges.push(uneven(&mut draw, bins));
        weights.push(numbers(&mut draw, bins, 0.03125, 1.0));
        u.push(numbers(&mut draw, samples, 0.015625, 0.984375));
    }
    case(id, comment, [&edges, &weights, &u], padding)
}

/// Samples of a piecewise-constant distribution.
pub(crate) fn importance_sampling() -> Vec<Case> {
    let mut draw = Draw::new("importance_sampling", 100);
    let even = |bins: i32| (0..=bins).map(|k| 2.0 + f64::from(k) / 16.0).collect::<Vec<f64>>();
    let quarters = vec![2.0, 3.0, 4.0, 5.0, 6.0];
    // A weight of 1 among empty bins with the original code's + 1e-5, and samples in the empty ones.
    let mut opaque = vec![0.0; 62];
    opaque[40] = 1.0;
    let faint =
        (0..8).map(|k| crate::contract::case::short((5.0 * f64::from(k) + 0.5) * 1e-5 / 1.00062)).collect();
    // Shares of about 0.001, 0.0001 and 0.00003, between which programs draw the line below which they divide by 1.
    let faint_weights = [1.0, 0.001, 0.0001, 0.00003].map(crate::contract::case::short).to_vec();
    let mut front = 0.0;
    let mut faint_places = vec![0.5];
    for k in 0..4 {
        let (w, whole) = (faint_weights[k] + 1e-5, faint_weights.iter().map(|w| w + 1e-5).sum::<f64>());
        if k > 0 {
            faint_places.push((front + 0.75 * w) / whole);
        }
        front += w;
    }
    let faint_places = faint_places.into_iter().map(|u| Dtype::F32.round(u)).collect::<Vec<f64>>();
    let mut empty_between = numbers(&mut draw, 8, 0.25, 1.0);
    [0, 1, 4, 7].into_iter().for_each(|k| empty_between[k] = 0.0);
    let inner = numbers(&mut draw, 6, 0.0625, 0.9375);
    let mut of_ends = Draw::new("importance_sampling", 101);
    let ends: Vec<Vec<f64>> = (0..8).map(|_| numbers(&mut of_ends, 62, 0.0625, 1.0)).collect();
    let steps = numbers(&mut draw, 4, 0.125, 0.875);
    let cases = vec![
        random("plain", "uneven bins, random weights, u in any order", [3, 6, 5], 0.0),
        random("one_bin", "N = 1: uniform between the two edges", [2, 1, 4], 0.0).edge("one bin"),
        random("two_bins", "N = 2", [3, 2, 3], 0.0),
        random("sixty_four_bins", "the paper's 64 coarse samples", [1, 64, 16], 0.0),
        random("padded", "0.01 added to every weight, as in nerfstudio", [2, 7, 6], 0.0078125),
        case(
            "SA1_zero_weights",
            "bins without weight before, between and after: no sample in them",
            [&[uneven(&mut draw, 8)], &[empty_between], std::slice::from_ref(&inner)],
            0.0,
        ),
        case(
            "SA1_empty_ray",
            "no weight anywhere: all bins weigh the same, whatever their width",
            [&[vec![2.0, 2.25, 3.0, 5.0]], &[vec![0.0; 3]], std::slice::from_ref(&steps)],
            0.0,
        ),
        case(
            "SA1_padding_of_nothing",
            "1e-5 added to weights of 0, and to one of 2^-14",
            [
                &[quarters.clone(), quarters.clone()],
                &[vec![0.0; 4], vec![0.0, 0.00006103515625, 0.0, 0.0]],
                &[steps.clone(), steps.clone()],
            ],
            1e-5,
        ),
        case(
            "SA2_opaque",
            "one opaque bin and 61 with 1e-5: 1e-5 / 1.00062 is below 1e-5, and still a bin to sample in",
            [&[even(62)], &[opaque], &[faint]],
            1e-5,
        ),
        case(
            "SA2_faint_shares",
            "bins that hold a 1,000th, a 10,000th and a 30,000th of all, and samples in them: still bins to sample in",
            [std::slice::from_ref(&quarters), &[faint_weights], &[faint_places]],
            1e-5,
        ),
        case(
            "SA3_u_1",
            "u = 1 and nearly 1 where ten times 0.1 make 0.99999994 or 1.0000001",
            [&[even(10)], &[vec![0.10009765625; 10]], &[vec![1.0, 0.99609375, 0.984375]]],
            0.0,
        ),
        case(
            "SA3_ties",
            "u on every edge of F, and between: the sample is the edge",
            [
                std::slice::from_ref(&quarters),
                &[vec![0.5, 1.0, 0.25, 0.25]],
                &[vec![0.0, 0.25, 0.75, 0.875, 1.0, 0.5]],
            ],
            0.0,
        )
        // The slope has a kink at each: one-sided differences in the tests.
        .forward_only(),
        case(
            "SA3_zero_width",
            "two edges at the same place: all of a bin's samples are there",
            [&[vec![2.0, 3.0, 3.0, 4.5]], &[vec![1.0, 2.0, 1.0]], &[vec![0.125, 0.40625, 0.625, 0.9375]]],
            0.0,
        ),
        case(
            "SA3_end_below_1",
            "u = 1 in rays whose F ends below 1 in short types, or above: the last edge, not the last bin's first",
            [&vec![even(62); 8], &ends, &vec![vec![1.0, 0.5]; 8]],
            0.0,
        ),
        case(
            "SA3_empty_start",
            "u = 0 after empty bins: where the first weight begins, not where the ray does",
            [&[quarters], &[vec![0.0, 0.0, 0.75, 1.25]], &[vec![0.0, 0.25, 0.6875]]],
            0.0,
        ),
    ];
    in_full(in_full(cases, "plain"), "SA3_end_below_1")
}

/// More bins than a block has threads; short types can't tell so many edges apart.
pub(crate) fn large() -> Vec<Large> {
    let rays = 257;
    let large = Large::new("bins_1024", "257 rays of 1,024 bins, 129 samples each", rays, 16);
    let large = large.with("edges", &[rays, 1025], Recipe::Ascending { cells: 10 });
    let large =
        large.with("weights", &[rays, 1024], floats(-8, 6)).with("padding", &[], Recipe::Constant(0.0));
    vec![large.with("u", &[rays, 129], Recipe::Unit).in_types(&[Dtype::F64, Dtype::F32])]
}
