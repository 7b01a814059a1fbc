//! Cases of packed rendering with early stop: rays of every length, and stops at every place.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats, sparse};

/// Packed rendering with early stop.
pub(crate) fn early_stop() -> Vec<Case> {
    let case =
        |id, comment, eps: f64, lengths: &[usize], sigmas: Vec<f64>, rgbs: Vec<f64>, deltas: Vec<f64>| {
            let mut offsets = vec![0.0];
            lengths.iter().for_each(|n| offsets.push(offsets[offsets.len() - 1] + *n as f64));
            let n = sigmas.len();
            let inputs = vec![
                ("sigmas", array(&[n], sigmas)),
                ("rgbs", array(&[n, 3], rgbs)),
                ("deltas", array(&[n], deltas)),
                ("offsets", array(&[offsets.len()], offsets)),
                ("eps", scalar(eps)),
            ];
            Case::new(id, comment, inputs)
        };
    // Optical depths of 2/3 bring T to .51, .26, .13, .07, ...: eps lies between two of them.
    let even = |n: usize| (vec![1.375; n], vec![0.5; n]);
    let white = |n: usize| vec![1.0; 3 * n];
    let plain = |id, comment, eps, lengths: &[usize]| {
        let n = lengths.iter().sum();
        let (sigmas, deltas) = even(n);
        case(id, comment, eps, lengths, sigmas, white(n), deltas)
    };
    let mut cases = vec![
        plain("stops", "T behind the samples: .50, .25, .13, .06: the fourth is the last", 0.09, &[8]),
        plain("never", "eps = 0: every sample is used, as in volume_render", 0.0, &[3, 5]),
        plain("VR9_ragged", "rays of 5, 0, 1 and 6 samples, one after the other", 0.09, &[5, 0, 1, 6]),
        plain(
            "VR5_not_renormalized",
            "the color of a white ray that stops at T = .25 is .75, not 1",
            0.35,
            &[6],
        ),
        case(
            "opaque_first",
            "an opaque first sample: nothing behind it is looked at",
            0.01,
            &[4, 2],
            vec![128.0, 1.0, 2.0, 1.0, 128.0, 1.0],
            white(6),
            vec![1.0; 6],
        ),
        case(
            "empty_in_front",
            "samples without density in front: a weight of 0 is no reason to stop",
            0.09,
            &[8],
            vec![0.0, 0.0, 1.375, 1.375, 0.0, 1.375, 1.375, 1.375],
            white(8),
            vec![0.5; 8],
        ),
        case(
            "VR2_last_delta",
            "a last step of 1e10 on an empty end: it stops nothing, not even where the type has infinity for it",
            0.09,
            &[4, 5],
            vec![1.375, 0.0, 1.375, 0.0, 1.375, 1.375, 0.0, 1.375, 0.0],
            white(9),
            vec![0.5, 0.5, 0.5, 1e10, 0.5, 0.5, 0.5, 0.5, 1e10],
        ),
        case(
            "colors_beyond",
            "colors below 0 and above 1 aren't clipped, nor is their sum",
            0.09,
            &[3],
            vec![0.5, 1.0, 2.0],
            vec![-2.0, 2.0, 0.5, -1.0, 3.0, 1.5, 0.5, 1.0, -0.25],
            vec![0.5; 3],
        ),
        case("VR9_nothing", "two rays and no sample", 0.5, &[0, 0], vec![], vec![], vec![])
            .edge("no samples"),
    ];
    for (n, (regime, comment, thick, eps)) in [
        ("thin", "nothing stops", 0.02, 0.25),
        ("mixed", "some rays stop", 0.4, 0.1),
        ("opaque", "all rays stop within a few samples", 1.5, 0.01),
        ("tiny_eps", "the usual 1e-4", 1.0, 1e-4),
    ]
    .into_iter()
    .enumerate()
    {
        let mut draw = Draw::new("early_stop", n as u64);
        let lengths = [7, 3, 12, 1, 9];
        let samples = 32;
        let sigmas = (0..samples).map(|_| draw.between(0.125 * thick, 2.0 * thick)).collect();
        let rgbs = (0..3 * samples).map(|_| draw.between(0.05, 1.0)).collect();
        let deltas = (0..samples).map(|_| draw.between(0.5, 1.5)).collect();
        cases.push(case(regime, comment, eps, &lengths, sigmas, rgbs, deltas));
    }
    let mut cases = in_full(cases, "mixed");
    let thin = [4, 7, 9, 12, 14, 17].map(|n| libm::ldexp(1.0, -n)).to_vec();
    let long = thin.iter().map(|sigma| 0.25 / sigma).collect();
    cases.push(case(
        "thin_air",
        "thin densities over long steps, 1/4 of optical depth each: none of them is too thin to matter",
        0.09,
        &[4, 2],
        thin,
        white(6),
        long,
    ));
    cases.push(case(
        "written_in",
        "T behind the samples: .50, .25, .13, .064, .060: who stops on his own from .05 on sees them all",
        0.0,
        &[5],
        vec![1.375, 1.375, 1.375, 1.375, 0.125],
        vec![1.0, 0.5, 0.25, 0.5, 1.0, 0.25, 0.25, 0.5, 1.0, 1.0, 0.25, 0.5, 0.5, 0.25, 1.0],
        vec![0.5; 5],
    ));
    cases
}

/// Rays of up to 96 samples, of which about half are stopped.
pub(crate) fn large() -> Vec<Large> {
    let (id, rays) = ("rays_20011", 20_011);
    let offsets = Recipe::Offsets { most: 96 };
    let samples = offsets.total("early_stop", id, "offsets", rays);
    let large = Large::new(id, "20,011 rays of 0 to 96 samples, half of them stopped", rays, 64)
        .packed("S", "offsets");
    let large = large.with("sigmas", &[samples], sparse(-1, 5, 1)).with("rgbs", &[samples, 3], Recipe::Unit);
    let large = large.with("deltas", &[samples], floats(-7, 2)).with("offsets", &[rays + 1], offsets);
    vec![large.with("eps", &[], Recipe::Constant(0.0625))]
}
