//! Cases of volume rendering: probes that separate mistakes, hard numbers, and seeded rays in every regime.
//!
//! VR5 (stop early and renormalize, or not) is a hazard of `early_stop`, which states that nothing is renormalized and tests it.

pub(crate) mod large;

use std::f64::consts::LN_2;

use ndarray::ArrayD;

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};

/// Seeded regimes: typical optical depth of one sample.
const REGIMES: [(&str, &str, f64, f64); 4] = [
    ("empty", "thin everywhere: alpha is about x", -7.0, -4.0),
    ("thin", "a few percent absorbed", -3.0, -1.5),
    ("mixed", "empty and dense samples on one ray", -3.0, 0.7),
    ("opaque", "light ends within a few samples", 0.0, 1.3),
];

/// Seeded densities in every regime, (rays, samples), with steps that differ from ray to ray (VR10).
fn seeded(
    component: &str,
    make: impl Fn(&mut Draw, f64, f64) -> Vec<(&'static str, ArrayD<f64>)>,
) -> Vec<Case> {
    let mut cases = vec![];
    for (n, (regime, comment, low, high)) in REGIMES.into_iter().enumerate() {
        for repeat in 0..2 {
            let mut draw = Draw::new(component, (2 * n + repeat) as u64);
            cases.push(Case::new(format!("{regime}_{repeat}"), comment, make(&mut draw, low, high)));
        }
    }
    cases
}

/// Red, green, blue at samples 0, 1 and N-1: the color equals the weights there.
fn one_hot(samples: usize) -> ArrayD<f64> {
    let mut rgbs = vec![0.0; 3 * samples];
    for (k, i) in [0, 1, samples - 1].into_iter().enumerate() {
        rgbs[3 * i + k] = 1.0;
    }
    array(&[1, samples, 3], rgbs)
}

/// From densities.
pub(crate) fn volume_render() -> Vec<Case> {
    let one_ray = |id, comment, sigmas: Vec<f64>, rgbs, deltas: Vec<f64>| {
        let n = sigmas.len();
        let inputs =
            vec![("sigmas", array(&[1, n], sigmas)), ("rgbs", rgbs), ("deltas", array(&[1, n], deltas))];
        Case::new(id, comment, inputs)
    };
    let gray = |n: usize| array(&[1, n, 3], vec![0.5; 3 * n]);
    let spikes = |ln2: f64| vec![ln2, ln2, 0.0, 0.0, 0.0, 0.0, 0.0, ln2];
    let mut cases = vec![
        one_ray(
            "spikes",
            "three spikes of x = ln 2: the color reads (.5, .25, .125)",
            spikes(LN_2),
            one_hot(8),
            vec![1.0; 8],
        ),
        one_ray(
            "spikes_short",
            "three spikes of about ln 2, in every number type",
            spikes(0.6875),
            one_hot(8),
            vec![1.0; 8],
        ),
        one_ray("slab", "constant density: 1 - exp(-sigma L)", vec![0.25; 16], gray(16), vec![0.25; 16]),
        one_ray(
            "empty_ray",
            "nothing on the ray: color, weights and opacity are 0",
            vec![0.0; 6],
            gray(6),
            vec![0.0625; 6],
        ),
        one_ray(
            "opaque_sample",
            "one opaque sample: its weight is 1, those behind it 0",
            vec![0.0, 0.0, 128.0, 1.0, 1.0],
            gray(5),
            vec![1.0; 5],
        ),
        one_ray("VR9_one_sample", "a ray with one sample", vec![0.75], gray(1), vec![0.5]).edge("one sample"),
        one_ray(
            "VR1_tiny_alpha",
            "x = 2^-20: 1 - exp(-x) loses every digit in f32",
            vec![9.5367431640625e-7; 8],
            gray(8),
            vec![1.0; 8],
        ),
        one_ray(
            "VR2_last_delta",
            "a last step of 1e10 on an empty end",
            vec![0.5, 1.0, 0.0, 0.0],
            gray(4),
            vec![0.25, 0.25, 0.25, 1e10],
        ),
        one_ray(
            "VR2_dense_end",
            "a last step of 1e10 in fog: T in front of it is no difference of two sums that contain it",
            vec![0.5, 1.0, 0.75, 0.5],
            gray(4),
            vec![0.25, 0.25, 0.25, 1e10],
        ),
        one_ray(
            "colors_beyond",
            "colors below 0 and above 1 aren't clipped, nor is their sum",
            vec![0.5, 1.0, 2.0],
            array(&[1, 3, 3], vec![-2.0, 2.0, 0.5, -1.0, 3.0, 1.5, 0.5, 1.0, -0.25]),
            vec![0.5; 3],
        ),
        one_ray(
            "VR9_no_step",
            "a step of 0 has no weight, whatever its density",
            vec![1.0, 800.0, 2.0],
            gray(3),
            vec![0.5, 0.0, 0.25],
        ),
        one_ray(
            "VR9_infinite",
            "an infinite density is opaque, and nothing behind it is NaN",
            vec![0.5, f64::INFINITY, 1.0],
            gray(3),
            vec![0.5; 3],
        )
        // sigma times a gradient of 0 has no value.
        .forward_only()
        .edge("an infinite density"),
        one_ray("VR9_underflow", "T underflows behind x = 800", vec![800.0, 1.0, 1.0], gray(3), vec![1.0; 3]),
        one_ray("VR9_huge", "sigma = 1e300 and 1e-300", vec![1e-300, 0.5, 1e300, 1.0], gray(4), vec![1.0; 4]),
        one_ray(
            "VR3_many_empty",
            "256 nearly empty samples: a number added to the product shows",
            vec![0.0009765625; 256],
            gray(256),
            vec![0.0625; 256],
        ),
        one_ray("VR9_no_samples", "no samples: color 0, T 1", vec![], array(&[1, 0, 3], vec![]), vec![])
            .edge("no samples"),
        Case::new(
            "VR10_unequal_steps",
            "two rays alike but for their steps: those of ray 0 for both would show",
            vec![
                ("sigmas", array(&[2, 2], vec![1.0; 4])),
                ("rgbs", array(&[2, 2, 3], vec![0.5; 12])),
                ("deltas", array(&[2, 2], vec![0.15625, 0.15625, 0.3125, 0.0390625])),
            ],
        ),
    ];
    // T is e^-10, e^-14.5 and e^-23.5 behind what is black: whoever gives up there sees nothing.
    cases.push(Case::new(
        "bright_behind_haze",
        "light that is seen through what leaves 5e-5, 5e-7 and 6e-11 of it",
        vec![
            ("sigmas", array(&[3, 3], vec![10.0, 0.75, 0.75, 14.5, 0.75, 0.75, 23.5, 0.75, 0.75])),
            ("rgbs", array(&[3, 3, 3], [[0.0; 3], [0.75; 3], [0.5; 3]].concat().repeat(3))),
            ("deltas", array(&[3, 3], vec![1.0; 9])),
        ],
    ));
    let thin: Vec<f64> = [3, 6, 9, 12, 13, 14, 17, 20].map(|n| libm::ldexp(1.0, -n)).to_vec();
    let deltas = thin.iter().map(|sigma| 0.25 / sigma).collect();
    cases.push(one_ray(
        "thin_air",
        "thin densities over long steps, 1/4 of optical depth each: none of them is too thin to matter",
        thin,
        gray(8),
        deltas,
    ));
    // Optical depths of 1/512, 1/2, 1, 1/4, nearly 0 and 4; and three times 1/512.
    let sigmas = [-19, -11, -10, -12, -60, -8, -19, -19, -19, -60, -60, -60].map(|n| libm::ldexp(1.0, n));
    cases.push(Case::new(
        "haze_of_long_steps",
        "densities below 1/250 that hide nearly all, and faint weights: who skips by one isn't who skips by the other",
        vec![
            ("sigmas", array(&[2, 6], sigmas.to_vec())),
            ("rgbs", Draw::new("volume_render", 101).array(&[2, 6, 3], 0.25, 1.0)),
            ("deltas", array(&[2, 6], vec![1024.0; 12])),
        ],
    ));
    let sigmas = SUNS.iter().flat_map(|&e| [0.6875 * f64::from(e), 0.75, 0.5]).collect();
    cases.push(Case::new(
        "suns_behind_haze",
        "suns so bright that they are seen through haze that leaves little of them: who gives up in front of one misses it",
        vec![
            ("sigmas", array(&[SUNS.len(), 3], sigmas)),
            ("rgbs", array(&[SUNS.len(), 3, 3], SUNS.iter().flat_map(|&e| seen_last(e, 3)).collect())),
            ("deltas", array(&[SUNS.len(), 3], vec![1.0; 3 * SUNS.len()])),
        ],
    ));
    let mut draw = Draw::new("volume_render", 100);
    let sigmas = (0..24).map(|_| draw.decades(-1.0, 1.0)).collect();
    cases.push(Case::new(
        "one_step",
        "several rays with one step for all: what functions of a step length can be asked",
        vec![
            ("sigmas", array(&[4, 6], sigmas)),
            ("rgbs", draw.array(&[4, 6, 3], 0.05, 1.0)),
            ("deltas", array(&[4, 6], vec![0.25; 24])),
        ],
    ));
    cases.extend(seeded("volume_render", |draw, low, high| {
        let (rays, samples) = (3, 12);
        let (mut sigmas, mut deltas) = (vec![], vec![]);
        for ray in 0..rays {
            let constant = draw.between(0.03, 0.1);
            for _ in 0..samples {
                // Ray 0 has equal steps, the others don't.
                let delta = if ray == 0 { constant } else { draw.between(0.03, 0.1) };
                let empty = draw.unit() < 0.2;
                let sigma = draw.decades(low, high) / delta;
                sigmas.push(if empty { 0.0 } else { crate::contract::case::short(sigma) });
                deltas.push(delta);
            }
        }
        vec![
            ("sigmas", array(&[rays, samples], sigmas)),
            ("rgbs", draw.array(&[rays, samples, 3], 0.05, 1.0)),
            ("deltas", array(&[rays, samples], deltas)),
        ]
    }));
    let mut cases = in_full(in_full(cases, "mixed_0"), "thin_0");
    // Optical depths of 3/4, 1, 3/2 and 2.
    cases.push(one_ray(
        "dense_thin_steps",
        "densities above 10^4, as of a scene in kilometers, on steps as short",
        vec![12_288.0, 16_384.0, 24_576.0, 32_768.0],
        array(&[1, 4, 3], (1..=12).map(|k| f64::from(k) / 16.0).collect()),
        vec![1.0 / 16_384.0; 4],
    ));
    cases
}

/// Suns behind a haze that leaves about 2^-e of their light.
const SUNS: [i32; 13] = [2, 3, 4, 5, 6, 7, 9, 10, 11, 13, 15, 17, 21];

/// The colors of a ray of so many samples: black, a sun, and what is behind it.
fn seen_last(e: i32, samples: usize) -> Vec<f64> {
    let sun = [0.75 * libm::ldexp(1.0, e.min(15)), 0.75, 0.5];
    [vec![0.0; 3 * (samples - 2)], sun.to_vec(), vec![0.5, 0.25, 0.75]].concat()
}

/// From opacities.
pub(crate) fn volume_render_alpha() -> Vec<Case> {
    let one_ray = |id, comment, alphas: Vec<f64>, rgbs| {
        let n = alphas.len();
        Case::new(id, comment, vec![("alphas", array(&[1, n], alphas)), ("rgbs", rgbs)])
    };
    let mut cases = vec![
        one_ray(
            "spikes",
            "three opacities of 1/2: the color reads (.5, .25, .125)",
            vec![0.5, 0.5, 0.0, 0.0, 0.5],
            one_hot(5),
        ),
        one_ray(
            "VR4_opaque",
            "alpha exactly 1 in the middle: the gradient must not divide by 1 - alpha",
            vec![0.5, 1.0, 0.25, 0.125],
            one_hot(4),
        ),
        one_ray(
            "two_opaque",
            "two samples of alpha 1: all gradients behind the first are 0",
            vec![0.25, 1.0, 0.5, 1.0, 0.5],
            one_hot(5),
        ),
        one_ray("empty_ray", "nothing on the ray", vec![0.0; 6], array(&[1, 6, 3], vec![0.5; 18])),
        one_ray(
            "colors_beyond",
            "colors below 0 and above 1 aren't clipped, nor is their sum",
            vec![0.25, 0.5, 0.75],
            array(&[1, 3, 3], vec![-2.0, 2.0, 0.5, -1.0, 3.0, 1.5, 0.5, 1.0, -0.25]),
        ),
        one_ray("one_sample", "a ray with one sample", vec![0.25], array(&[1, 1, 3], vec![0.5, 0.75, 1.0]))
            .edge("one sample"),
        one_ray(
            "VR9_underflow",
            "T reaches subnormals and 0",
            vec![0.99609375; 160],
            array(&[1, 160, 3], vec![0.5; 480]),
        ),
    ];
    // As many samples of 15/16 as fit, what is left, and the sun with what is behind it.
    let haze = |e: i32| (0..6).map(move |i| 1.0 - libm::ldexp(1.0, -(e - 4 * i).clamp(0, 4)));
    cases.push(Case::new(
        "suns_behind_haze",
        "suns so bright that they are seen through haze that leaves little of them: who gives up in front of one misses it",
        vec![
            ("alphas", array(&[SUNS.len(), 8], SUNS.iter().flat_map(|&e| haze(e).chain([0.5, 0.25])).collect())),
            ("rgbs", array(&[SUNS.len(), 8, 3], SUNS.iter().flat_map(|&e| seen_last(e, 8)).collect())),
        ],
    ));
    cases.extend(seeded("volume_render_alpha", |draw, low, high| {
        let (rays, samples) = (3, 12);
        let alpha = |draw: &mut Draw| draw.decades(low, high.min(-0.02)).min(1.0);
        let alphas = (0..rays * samples).map(|_| alpha(draw)).collect();
        vec![
            ("alphas", array(&[rays, samples], alphas)),
            ("rgbs", draw.array(&[rays, samples, 3], 0.05, 1.0)),
        ]
    }));
    in_full(cases, "mixed_0")
}

/// Background.
pub(crate) fn composite_background() -> Vec<Case> {
    let mut draw = Draw::new("composite_background", 0);
    let three = vec![
        ("colors", array(&[3, 3], vec![0.0, 0.0, 0.0, 0.25, 0.125, 0.5, 0.75, 0.5, 1.0])),
        ("opacity", array(&[3], vec![0.0, 0.5, 1.0])),
        ("background", array(&[3], vec![1.0, 0.5, 0.25])),
    ];
    let seeded = vec![
        ("colors", draw.array(&[16, 3], 0.01, 0.6)),
        ("opacity", draw.array(&[16], 0.05, 0.95)),
        ("background", array(&[3], vec![0.75, 0.25, 0.625])),
    ];
    let beyond = vec![
        ("colors", array(&[3, 3], vec![-0.5, 1.5, 0.25, 0.5, -1.0, 2.0, 1.25, -0.25, 0.75])),
        ("opacity", array(&[3], vec![0.5, 0.25, 0.75])),
        ("background", array(&[3], vec![0.25, 0.75, 0.5])),
    ];
    let nearly = vec![
        ("colors", draw.array(&[10, 3], 0.01, 0.6)),
        ("opacity", array(&[10], (7..17).map(|n| 1.0 - libm::ldexp(1.0, -n)).collect())),
        ("background", array(&[3], vec![0.75, 1.0, 0.625])),
    ];
    let cases = vec![
        Case::new("three_opacities", "A = 0, 1/2, 1 over three different channels", three),
        Case::new("colors_beyond", "colors below 0 and above 1 aren't clipped", beyond),
        Case::new(
            "nearly_opaque",
            "opacities from 1 - 2^-7 to 1 - 2^-16: next to nothing is left of the light",
            nearly,
        ),
        Case::new("seeded", "random rays", seeded),
    ];
    in_full(cases, "seeded")
}

/// Expected distance.
pub(crate) fn depth() -> Vec<Case> {
    let mut draw = Draw::new("depth", 0);
    let t = |rays: usize| {
        let row = (0..8).map(|i| 2.25 + 0.5 * f64::from(i));
        array(&[rays, 8], std::iter::repeat_n(row, rays).flatten().collect())
    };
    let spike = vec![0.0, 0.0, 0.5, 0.0, 0.25, 0.0, 0.0, 0.0];
    let share = [0.125, 0.0, 0.25, 0.0625, 0.3125, 0.0, 0.125, 0.125];
    let thin = [0.0625, 0.01171875, 0.0029296875, 0.000244140625]
        .iter()
        .flat_map(|whole| share.map(|w| w * whole))
        .collect();
    let thin = array(&[4, 8], thin);
    let cases = vec![
        Case::new(
            "spike",
            "two weights: (0.5 * 3.25 + 0.25 * 4.25) / 0.75",
            vec![("weights", array(&[1, 8], spike)), ("t", t(1)), ("far", scalar(6.25))],
        ),
        Case::new(
            "VR7_empty_ray",
            "no weight at all: far, not NaN",
            vec![("weights", array(&[1, 8], vec![0.0; 8])), ("t", t(1)), ("far", scalar(6.25))],
        ),
        Case::new(
            "VR7_empty_beside_others",
            "no weight at all beside a ray that lies farther on: each has its own t",
            vec![
                ("weights", array(&[2, 4], vec![0.0, 0.0, 0.0, 0.0, 0.25, 0.0, 0.5, 0.125])),
                ("t", array(&[2, 4], vec![2.25, 2.75, 3.25, 3.75, 4.25, 4.75, 5.25, 5.75])),
                ("far", scalar(6.25)),
            ],
        ),
        Case::new(
            "thin_rays",
            "opacities of 1/16, 3/256, 3/1024 and 1/4096: thin rays have a depth too",
            vec![("weights", thin), ("t", t(4)), ("far", scalar(6.25))],
        ),
        Case::new(
            "two_ends",
            "weights at both ends alone: t - z loses no digits",
            vec![
                ("weights", array(&[1, 2], vec![0.5, 0.25])),
                ("t", array(&[1, 2], vec![0.5, 8.0])),
                ("far", scalar(8.0)),
            ],
        ),
        Case::new(
            "seeded",
            "random weights",
            vec![("weights", draw.array(&[6, 8], 0.001, 0.12)), ("t", t(6)), ("far", scalar(6.25))],
        ),
    ];
    in_full(cases, "seeded")
}
