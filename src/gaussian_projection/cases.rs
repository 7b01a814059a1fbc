//! Cases of the projection: in the picture, at its edge, beside it; needles, lines, points and clouds that fill it.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, floats, signed};

/// A camera of 64 x 48 pixels whose principal point isn't the middle, turned and moved; its rotation has 7 bits.
const W2C: [f64; 16] = [
    0.75, -0.25, 0.609375, 0.5, 0.375, 0.921875, -0.09375, -0.25, -0.5390625, 0.296875, 0.7890625, 1.5, 0.0,
    0.0, 0.0, 1.0,
];
const K: [f64; 9] = [40.0, 0.0, 28.0, 0.0, 44.0, 26.0, 0.0, 0.0, 1.0];

/// Gaussians in front of a camera.
fn seen(id: &str, comment: &'static str, w2c: [f64; 16], means: Vec<f64>, covariances: Vec<f64>) -> Case {
    let n = means.len() / 3;
    let inputs = vec![
        ("means", array(&[n, 3], means)),
        ("covariances", array(&[n, 6], covariances)),
        ("w2c", array(&[4, 4], w2c.to_vec())),
        ("K", array(&[3, 3], K.to_vec())),
        ("width", scalar(64.0)),
        ("height", scalar(48.0)),
    ];
    Case::new(id, comment, inputs)
}

/// The point of the world with these slopes at this depth, of 7 bits.
fn point([x, y]: [f64; 2], depth: f64) -> [f64; 3] {
    let t = [x * depth - W2C[3], y * depth - W2C[7], depth - W2C[11]];
    [0, 1, 2].map(|k| short(W2C[k] * t[0] + W2C[4 + k] * t[1] + W2C[8 + k] * t[2]))
}

/// Means with slopes of either sign within these sizes, and depths in a range.
fn means(draw: &mut Draw, n: usize, slopes: [f64; 2], depths: [f64; 2]) -> Vec<f64> {
    let one = |_| {
        let mut slope = || {
            let size = draw.between(slopes[0], slopes[1]);
            if draw.unit() < 0.5 { -size } else { size }
        };
        let slopes = [slope(), slope()];
        point(slopes, draw.between(depths[0], depths[1]))
    };
    (0..n).flat_map(one).collect()
}

/// Covariances with deviations of about `size` and correlations below a half.
fn blobs(draw: &mut Draw, n: usize, size: f64) -> Vec<f64> {
    let one = |_| {
        let s = [0, 1, 2].map(|_| size * draw.decades(-0.5, 0.0));
        let mut cross = |i: usize, j: usize| short(s[i] * s[j] * draw.between(-0.45, 0.45));
        let [xy, xz, yz] = [cross(0, 1), cross(0, 2), cross(1, 2)];
        [short(s[0] * s[0]), xy, xz, short(s[1] * s[1]), yz, short(s[2] * s[2])]
    };
    (0..n).flat_map(one).collect()
}

/// Gaussians in a picture.
pub(crate) fn gaussian_projection() -> Vec<Case> {
    let seeded = |id: &str, comment, stream, n: usize, slopes, depths, size| {
        let mut draw = Draw::new("gaussian_projection", stream);
        let means = means(&mut draw, n, slopes, depths);
        seen(id, comment, W2C, means, blobs(&mut draw, n, size))
    };
    let ahead = |n: usize| {
        let mut draw = Draw::new("gaussian_projection", 20);
        means(&mut draw, n, [0.0, 0.5], [2.0, 6.0])
    };
    let straight = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let thin = libm::ldexp(1.0, -12);
    let cases = vec![
        seeded("usual", "splats in the picture", 0, 8, [0.0, 0.5], [2.0, 6.0], 0.5),
        seen(
            "close_up",
            "a camera at the origin, splats close to it: what is added to z shows",
            straight,
            vec![0.0625, -0.03125, 0.25, -0.125, 0.0625, 0.375, 0.125, 0.09375, 0.5],
            [0.0009765625, 0.0, 0.0, 0.0009765625, 0.0, 0.0009765625].repeat(3),
        ),
        seen(
            "on_the_axis",
            "a camera at the origin, a splat in its middle: no part of the Jacobian tilts",
            straight,
            vec![0.0, 0.0, 2.0, 0.0, 0.0, 4.0],
            vec![0.25, 0.0, 0.0, 0.0625, 0.0, 0.5, 0.25, 0.125, 0.0625, 0.5, -0.125, 0.25],
        ),
        seeded("near", "at depths of 1/4 to 1", 1, 6, [0.0, 0.5], [0.25, 1.0], 0.125),
        seeded(
            "small",
            "splats of less than a pixel: little but the dilation is left",
            2,
            6,
            [0.0, 0.5],
            [2.0, 6.0],
            0.0625,
        ),
        seeded(
            "GS3_beside",
            "means beside the picture, beyond every limit of the Jacobian",
            3,
            8,
            [1.5, 4.0],
            [1.0, 4.0],
            0.5,
        ),
        seen(
            "GS3_elongated_beside",
            "needles beside the picture: clamped, they point elsewhere",
            W2C,
            [
                point([2.5, 0.25], 2.0),
                point([-0.25, -3.0], 1.5),
                point([-2.0, 2.0], 1.0),
                point([1.75, -2.5], 3.0),
            ]
            .concat(),
            vec![
                4.0, 0.0, 0.0, thin, 0.0, thin, thin, 0.0, 0.0, 4.0, 0.0, thin, thin, 0.0, 0.0, thin, 0.0,
                4.0, 1.0, 0.5, 0.25, 0.5, 0.125, 0.25,
            ],
        ),
        seen(
            "GS2_needles",
            "deviations of 1 and 1/64, in the picture",
            W2C,
            ahead(6),
            [
                [1.0, thin, thin],
                [thin, 1.0, thin],
                [thin, thin, 1.0],
                [1.0, 1.0, thin],
                [thin, 1.0, 1.0],
                [1.0, thin, 1.0],
            ]
            .iter()
            .flat_map(|[x, y, z]| [*x, 0.0, 0.0, *y, 0.0, *z])
            .collect(),
        ),
        seen(
            "GS4_lines",
            "no thickness at all, along the camera's axes: the determinant before the dilation is 0, exactly",
            straight,
            vec![0.0, 0.0, 2.0, 0.0, 0.0, 4.0, 1.0, 0.0, 2.0],
            vec![0.25, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25],
        )
        .forward_only(),
        seen("GS4_points", "no size at all: the dilation alone", W2C, ahead(2), vec![0.0; 12]).forward_only(),
        seeded("clouds", "splats as large as the scene", 4, 4, [0.0, 0.5], [2.0, 6.0], 8.0),
    ];
    // Where splats are small, their compensation counts as much as their shape.
    in_full(in_full(cases, "usual"), "small")
}

/// More Gaussians than threads, in front of the small cases' camera. A variance is more than its row's other entries together.
pub(crate) fn large() -> Vec<Large> {
    const MEANS: Recipe = Recipe::Cycle(&[signed(-3, 3), signed(-3, 3), floats(1, 2)]);
    const VARIANCE: Recipe = floats(-3, 3);
    const OTHER: Recipe = signed(-6, 2);
    const COVARIANCES: Recipe = Recipe::Cycle(&[VARIANCE, OTHER, OTHER, VARIANCE, OTHER, VARIANCE]);
    let n = 5003;
    let large = Large::new("gaussians_5003", "5,003 Gaussians before a camera", n, 1024);
    let large = large.with("means", &[n, 3], MEANS).with("covariances", &[n, 6], COVARIANCES);
    let large = large.with("w2c", &[4, 4], Recipe::Cycle(&const { constants(W2C) }));
    let large = large.with("K", &[3, 3], Recipe::Cycle(&const { constants(K) }));
    let large = large.with("width", &[], Recipe::Constant(64.0));
    vec![large.with("height", &[], Recipe::Constant(48.0))]
}
