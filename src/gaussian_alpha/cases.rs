//! Cases of splats' opacities: in and around them, opaque and faint ones, needles, and conics that aren't positive.

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats, signed};

/// Pixels and splats: means, conics, opacities.
fn case(
    id: &str,
    comment: &'static str,
    pixels: Vec<f64>,
    [means, conics, opacities]: [Vec<f64>; 3],
) -> Case {
    let (p, n) = (pixels.len() / 2, opacities.len());
    let inputs = vec![
        ("pixels", array(&[p, 2], pixels)),
        ("means2d", array(&[n, 2], means)),
        ("conics", array(&[n, 3], conics)),
        ("opacities", array(&[n], opacities)),
    ];
    Case::new(id, comment, inputs)
}

/// Splats with these deviations in pixels and opacities, in a picture of 8 x 8.
fn splats(stream: u64, n: usize, deviations: [f64; 2], opacities: [f64; 2]) -> [Vec<f64>; 3] {
    let mut draw = Draw::new("gaussian_alpha", stream);
    let means = (0..2 * n).map(|_| draw.between(0.0, 8.0)).collect();
    let mut conic = || {
        let [x, y] = [0, 1].map(|_| 1.0 / draw.between(deviations[0], deviations[1]));
        [short(x * x), short(x * y * draw.between(-0.75, 0.75)), short(y * y)]
    };
    let conics = (0..n).flat_map(|_| conic()).collect();
    [means, conics, (0..n).map(|_| draw.between(opacities[0], opacities[1])).collect()]
}

/// Centers of pixels along the diagonals.
fn diagonal() -> Vec<f64> {
    vec![0.5, 0.5, 2.5, 5.5, 3.5, 3.5, 4.5, 3.5, 6.5, 1.5, 7.5, 7.5]
}

/// Splats at pixels.
pub(crate) fn gaussian_alpha() -> Vec<Case> {
    let cases = vec![
        case(
            "usual",
            "splats of one to four pixels, seen from six",
            diagonal(),
            splats(0, 6, [1.0, 4.0], [0.1, 0.9]),
        ),
        case(
            "in_the_middle",
            "pixels on a mean, and beside it: the exponent is 0",
            vec![2.5, 3.5, 2.75, 3.5],
            [vec![2.5, 3.5, 2.5, 3.25], vec![0.5, 0.125, 1.0, 2.0, -0.5, 0.25], vec![0.75, 0.5]],
        ),
        case(
            "opaque",
            "opacities from 0.98 to 1, which some cap",
            diagonal(),
            splats(1, 6, [16.0, 64.0], [0.98, 1.0]),
        ),
        case(
            "GS5_faint",
            "opacities around 1 / 255, which some skip",
            diagonal(),
            splats(2, 8, [2.0, 6.0], [0.003, 0.03]),
        ),
        case(
            "GS2_needles",
            "conics of hairs: 16 across, 1/64 along, straight and slanted",
            diagonal(),
            [
                vec![3.0, 3.5, 3.5, 4.0, 4.25, 3.75],
                vec![16.0, 0.0, 0.015625, 0.015625, 0.0, 16.0, 8.0, 7.9375, 8.0],
                vec![0.75, 0.5, 0.875],
            ],
        ),
        case(
            "GS5_not_positive",
            "a conic that isn't positive: the splat grows with the distance",
            vec![2.5, 2.5, 3.5, 1.5, 2.0, 4.0],
            [vec![2.0, 2.0, 3.0, 2.25], vec![0.25, 0.5, 0.25, 0.5, -0.75, 0.5], vec![0.25, 0.125]],
        )
        .edge("a conic that isn't positive"),
        case(
            "rims",
            "just inside and outside of two, three and four deviations, along both axes, of splats that aren't faint there",
            vec![
                4.0, 4.0, 8.5, 4.0, 10.5, 4.0, 10.375, 4.0, 11.0, 4.0, 4.0, 13.25, 4.0, 10.625, 7.0, 8.0,
                8.5, 8.5,
            ],
            [
                vec![4.0, 4.0, 4.125, 4.0, 4.0, 4.0],
                vec![0.25390625, 0.0, 0.25390625, 0.25, 0.0625, 0.125, 0.21875, 0.0, 1.0],
                vec![1.0, 0.9375, 0.875],
            ],
        ),
        case(
            "all_around",
            "pixels all around an oblique splat, inside and outside of its ellipses, of the discs, squares and boxes about it",
            vec![
                -3.5, -3.5, -0.5, -3.5, 2.5, -3.5, 8.0, -3.5, 13.5, -3.5, 16.5, -3.5, 19.5, -3.5, -3.5, -1.5,
                -0.5, -1.5, 2.5, -1.5, 8.0, -1.5, 13.5, -1.5, 16.5, -1.5, 19.5, -1.5, -3.5, 0.5, -0.5, 0.5,
                2.5, 0.5, 8.0, 0.5, 13.5, 0.5, 16.5, 0.5, 19.5, 0.5, -3.5, 8.0, -0.5, 8.0, 2.5, 8.0, 8.0,
                8.0, 13.5, 8.0, 16.5, 8.0, 19.5, 8.0, -3.5, 14.5, -0.5, 14.5, 2.5, 14.5, 8.0, 14.5, 13.5,
                14.5, 16.5, 14.5, 19.5, 14.5, -3.5, 17.5, -0.5, 17.5, 2.5, 17.5, 8.0, 17.5, 13.5, 17.5, 16.5,
                17.5, 19.5, 17.5, -3.5, 19.5, -0.5, 19.5, 2.5, 19.5, 8.0, 19.5, 13.5, 19.5, 16.5, 19.5, 19.5,
                19.5,
            ],
            [vec![8.0, 8.0], vec![0.21875, -0.09375, 0.15625], vec![1.0]],
        ),
        case(
            "beyond_three_sigmas",
            "a long splat between three deviations, where tiles end, and where it is faint: its radius is 48 pixels",
            vec![54.0, 4.0, 50.0, 4.0, 4.0, 29.0],
            [vec![4.0, 4.0], vec![0.00390625, 0.0, 0.015625], vec![1.0]],
        ),
        case(
            "nearly_opaque",
            "opacities from 0.99 to 1 in and beside the middle, around what codes cap at",
            vec![2.5, 2.5, 2.5625, 2.5],
            [
                vec![2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5, 2.5],
                vec![0.5, 0.0, 0.5, 0.25, 0.125, 0.5, 0.5, 0.0, 1.0, 0.25, 0.0, 0.25, 0.5, 0.125, 0.25],
                vec![0.9921875, 0.99609375, 0.998046875, 0.99951171875, 0.9998779296875],
            ],
        ),
        // A number between the two thresholds, which short types don't have.
        case(
            "GS5_beside_the_threshold",
            "opacities between 1/256 and 1/255, and just above",
            vec![2.5, 2.5],
            [
                vec![2.5; 4],
                vec![0.5, 0.0, 0.5, 0.5, 0.0, 0.5],
                vec![0.003_913_879_394_531_25, 0.003_929_138_183_593_75],
            ],
        ),
        case("no_opacity", "opacities of 0: there is a gradient", diagonal(), {
            let [means, conics, _] = splats(3, 2, [1.0, 4.0], [0.0, 1.0]);
            [means, conics, vec![0.0, 0.5]]
        }),
        case(
            "far",
            "many deviations away: next to nothing, or nothing",
            diagonal(),
            splats(4, 3, [0.25, 0.5], [0.5, 1.0]),
        ),
    ];
    in_full(cases, "usual")
}

/// More pixels than 16 bits count. Gradients of splats add up over all pixels, so that a gradient is judged at once, and in types in which
/// so long a sum has digits.
pub(crate) fn large() -> Vec<Large> {
    const CONICS: Recipe = Recipe::Cycle(&[floats(-5, 2), signed(-8, 2), floats(-5, 2)]);
    let picture = |id, comment, [pixels, splats, block]: [usize; 3]| {
        let large = Large::new(id, comment, pixels, block).with("pixels", &[pixels, 2], floats(0, 3));
        let large = large.with("means2d", &[splats, 2], floats(0, 3)).with("conics", &[splats, 3], CONICS);
        large.with("opacities", &[splats], floats(-4, 3))
    };
    vec![
        picture("pixels_1025x9", "9 splats at 1,025 pixels", [1025, 9, 1025])
            .in_types(&[Dtype::F64, Dtype::F32]),
        picture("pixels_66001x9", "9 splats at 66,001 pixels", [66_001, 9, 1024]).forward_only(),
    ]
}
