//! Cases of the frustum's Gaussian: usual intervals, thin and empty ones, whole cones, axes, and what lies far away.

use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{floats, signed};

/// A frustum in numbers: origin, direction, radius, start, end.
type Numbers = ([f64; 3], [f64; 3], f64, f64, f64);

fn case(id: &str, comment: &'static str, frustums: &[Numbers]) -> Case {
    let m = frustums.len();
    let vectors = |f: fn(&Numbers) -> [f64; 3]| array(&[m, 3], frustums.iter().flat_map(f).collect());
    let numbers = |f: fn(&Numbers) -> f64| array(&[m], frustums.iter().map(f).collect());
    let inputs = vec![
        ("origins", vectors(|f| f.0)),
        ("directions", vectors(|f| f.1)),
        ("radii", numbers(|f| f.2)),
        ("starts", numbers(|f| f.3)),
        ("ends", numbers(|f| f.4)),
    ];
    Case::new(id, comment, inputs)
}

/// Frustums along drawn rays, with these intervals.
fn along(stream: u64, radii: [f64; 2], intervals: &[[f64; 2]]) -> Vec<Numbers> {
    let mut draw = Draw::new("conical_frustum", stream);
    let one = |&[start, end]: &[f64; 2]| {
        let mut three = |low, high| [0; 3].map(|_| draw.between(low, high));
        let (origin, direction) = (three(-1.0, 1.0), three(-1.0, 1.0));
        (origin, direction, draw.between(radii[0], radii[1]), start, end)
    };
    intervals.iter().map(one).collect()
}

/// Intervals from a start to as much further.
fn drawn(stream: u64, n: usize, starts: [f64; 2], lengths: [f64; 2]) -> Vec<[f64; 2]> {
    let mut draw = Draw::new("conical_frustum", stream);
    let mut one = |_| {
        let start = draw.between(starts[0], starts[1]);
        [start, short(start + draw.between(lengths[0], lengths[1]))]
    };
    (0..n).map(&mut one).collect()
}

/// The Gaussian of a frustum.
pub(crate) fn conical_frustum() -> Vec<Case> {
    // 2 + 1e-5, as near as f32 has it.
    let thin = 2.0 + 21.0 * libm::ldexp(1.0, -21);
    let axes: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, 0.5]];
    let usual = |id: &str, comment, stream, intervals: &[[f64; 2]]| {
        case(id, comment, &along(stream, [0.0625, 0.5], intervals))
    };
    let cases = vec![
        usual("usual", "directions of any length", 0, &drawn(1, 8, [0.5, 4.0], [0.5, 2.0])),
        usual(
            "from_the_apex",
            "the first interval of a ray from the camera: a whole cone",
            2,
            &[[0.0, 1.0], [0.0, 0.25], [0.0, 3.0]],
        ),
        usual(
            "PE5_thin",
            "[2, 2 + 1e-5] and its like: closed forms in powers of the ends have no digit left, in f64",
            3,
            &[[2.0, thin], [1.0, 1.0 + (thin - 2.0)], [3.0, 3.0 + (thin - 2.0)]],
        ),
        usual(
            "PE5_one_step",
            "an interval of one step of bf16: short types lose the difference of squares first",
            4,
            &[[2.0, 2.015625], [1.0, 1.0078125], [4.0, 4.03125]],
        ),
        usual("PE5_f64", "intervals of 1e-12", 5, &[[2.0, 2.0 + libm::ldexp(1.0, -40)], [0.5, 0.5 + 1e-12]]),
        usual(
            "PE5_empty",
            "an interval without length, as samplers make them where weights are 0: a disk",
            6,
            &[[3.0, 3.0], [0.5, 0.5]],
        ),
        usual(
            "to_the_far_plane",
            "the last interval of an unbounded scene",
            7,
            &[[0.0625, 1000.0], [4.0, 256.0]],
        ),
        usual(
            "beside_the_camera",
            "intervals of thousandths from the camera: what is held away from it shows",
            10,
            &drawn(11, 4, [0.001, 0.008], [0.002, 0.004]),
        ),
        case(
            "along_axes",
            "rays along axes: nothing of the radius along them, all of it across",
            &[0, 1, 2].map(|i| ([0.25, -0.5, 1.0], axes[i], 0.25, 1.0, 2.5)),
        ),
        case(
            "nearly_along_an_axis",
            "a ray beside an axis: 1 - d_i^2 / |d|^2 is small",
            &[([0.5, 0.0, 0.0], [0.0625, 1.0, -0.03125], 0.5, 1.0, 1.5)],
        ),
        case(
            "pixels",
            "radii of pixels, 1/1000, and samples of 1/64",
            &along(8, [0.0005, 0.002], &drawn(9, 6, [2.0, 3.0], [0.046875, 0.0625])),
        ),
        case(
            "long_directions",
            "directions in depths or pixels: lengths of 100",
            &[
                ([1.0, 2.0, -1.0], [60.0, -100.0, 24.0], 4.0, 0.015625, 0.0625),
                ([0.0, 0.5, -0.5], [-12.0, 30.0, 100.0], 1.0, 0.03125, 0.09375),
            ],
        ),
    ];
    in_full(cases, "usual")
}

/// More frustums than a grid has blocks.
pub(crate) fn large() -> Vec<Large> {
    let n = 100_003;
    let large = Large::new("frustums_100003", "100,003 frustums", n, 1024);
    let large = large.with("origins", &[n, 3], signed(-3, 5)).with("directions", &[n, 3], signed(-2, 3));
    let large = large.with("radii", &[n], floats(-4, 3));
    vec![large.with("starts", &[n], floats(-2, 3)).with("ends", &[n], floats(1, 3))]
}
