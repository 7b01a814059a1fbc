//! Cases of packed rays: of every length, with empty ones first, in the middle and last; factors of 0, of 1 and below 0.

use ndarray::ArrayD;

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats, sparse};

/// Lengths of rays as offsets.
fn offsets(lengths: &[usize]) -> ArrayD<f64> {
    let mut all = vec![0.0];
    lengths.iter().for_each(|n| all.push(all[all.len() - 1] + *n as f64));
    array(&[all.len()], all)
}

/// Names, what they probe, and lengths of rays: the same for all rows.
const PACKED: &[(&str, &str, &[usize])] = &[
    ("ragged", "rays of 5, 3, 1 and 8 samples", &[5, 3, 1, 8]),
    ("PK1_first_empty", "rays without samples in front of all others", &[0, 0, 4, 3]),
    ("PK1_middle_empty", "rays without samples between others", &[3, 0, 0, 2, 0, 4]),
    ("PK1_last_empty", "rays without samples behind all others", &[4, 2, 0, 0]),
    ("one_each", "rays of one sample", &[1, 1, 1, 1]),
    ("one_ray", "a single ray", &[7]),
];

/// Where each ray's samples begin.
pub(crate) fn pack_info() -> Vec<Case> {
    let case = |&(id, comment, lengths): &(&str, &'static str, &[usize])| {
        let ids: Vec<f64> = lengths.iter().enumerate().flat_map(|(r, n)| vec![r as f64; *n]).collect();
        Case::new(
            id,
            comment,
            vec![("ray_ids", array(&[ids.len()], ids)), ("rays", scalar(lengths.len() as f64))],
        )
    };
    let mut cases: Vec<Case> = PACKED.iter().map(case).collect();
    cases.push(case(&("PK1_all_empty", "no samples at all", &[0, 0, 0])).edge("no samples"));
    cases
}

/// Running sums and products.
pub(crate) fn scan() -> Vec<Case> {
    let case = |id: &str, comment, lengths: &[usize], x: Vec<f64>| {
        Case::new(id, comment, vec![("x", array(&[x.len()], x)), ("offsets", offsets(lengths))])
    };
    let seeded = |stream: u64, n: usize, low: f64, high: f64| {
        let mut draw = Draw::new("packed_scan", stream);
        (0..n).map(|_| draw.between(low, high)).collect::<Vec<f64>>()
    };
    let count = |lengths: &[usize]| lengths.iter().sum::<usize>();
    let packed = |(n, &(id, comment, lengths)): (usize, &(&str, &'static str, &[usize]))| {
        case(id, comment, lengths, seeded(n as u64, count(lengths), 0.25, 1.25))
    };
    let mut cases: Vec<Case> = PACKED.iter().enumerate().map(packed).collect();
    cases.extend([
        case("long", "what rays of 40 and 24 samples let through", &[40, 24], seeded(10, 64, 0.75, 1.0)),
        case("both_signs", "sums that cancel", &[8, 6], seeded(11, 14, -1.5, 1.5)),
        case(
            "VR4_opaque",
            "factors of 0 inside, first and last, and two in a ray: none has anything divided by it",
            &[4, 3, 3, 5],
            vec![0.5, 0.0, 0.75, 0.5, 0.0, 0.5, 0.25, 0.5, 0.25, 0.0, 0.5, 0.0, 0.75, 0.0, 0.5],
        ),
        case("ones", "empty space: every product is 1", &[3, 2], vec![1.0; 5]),
        case("PK1_all_empty", "no samples at all", &[0, 0], vec![]).edge("no samples"),
    ]);
    in_full(cases, "ragged")
}

/// Weighted sums.
pub(crate) fn accumulate() -> Vec<Case> {
    let case = |id: &str, comment, lengths: &[usize], stream: u64| {
        let (mut draw, n) = (Draw::new("accumulate_along_rays", stream), lengths.iter().sum());
        let inputs = vec![
            ("weights", draw.array(&[n], 0.0, 0.5)),
            ("values", draw.array(&[n, 3], -0.25, 1.0)),
            ("offsets", offsets(lengths)),
        ];
        Case::new(id, comment, inputs)
    };
    let packed = |(n, &(id, comment, lengths)): (usize, &(&str, &'static str, &[usize]))| {
        case(id, comment, lengths, n as u64)
    };
    let mut cases: Vec<Case> = PACKED.iter().enumerate().map(packed).collect();
    cases.push(case("long", "rays of 40 and 24 samples", &[40, 24], 10));
    cases.push(case("PK1_all_empty", "no samples at all: black", &[0, 0], 11).edge("no samples"));
    in_full(cases, "ragged")
}

/// Rays of 0 to 96 samples, one after the other.
fn large(row: &str) -> (Large, usize, Recipe, usize) {
    let (id, rays) = ("rays_20011", 20_011);
    let offsets = Recipe::Offsets { most: 96 };
    let samples = offsets.total(row, id, "offsets", rays);
    (
        Large::new(id, "20,011 rays of 0 to 96 samples", rays, 256).packed("S", "offsets"),
        rays,
        offsets,
        samples,
    )
}

/// Running sums and products, of factors near 1.
pub(crate) fn large_scan() -> Vec<Large> {
    let (large, rays, offsets, samples) = large("packed_scan");
    vec![large.with("x", &[samples], floats(-1, 2)).with("offsets", &[rays + 1], offsets)]
}

/// Weighted sums.
pub(crate) fn large_accumulate() -> Vec<Large> {
    let (large, rays, offsets, samples) = large("accumulate_along_rays");
    let large =
        large.with("weights", &[samples], sparse(-9, 6, 1)).with("values", &[samples, 3], Recipe::Unit);
    vec![large.with("offsets", &[rays + 1], offsets)]
}

/// Rays of five samples, and the last eleven of them without any: their number is of all samples, so that they are judged at once.
pub(crate) fn large_info() -> Vec<Large> {
    let (rays, samples) = (20_011, 99_998);
    let large = Large::new("rays_20011", "20,011 rays of 5 samples", rays, rays);
    let large = large.with("ray_ids", &[samples], Recipe::Each(5));
    vec![large.with("rays", &[], Recipe::Constant(rays as f64))]
}
