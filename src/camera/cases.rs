//! Cases of the camera: poses and lenses that tell mistakes apart, and seeded ones.

use ndarray::ArrayD;

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full, lengthen, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, floats, signed};

/// fx, fy, cx, cy that differ, with the center off the middle and between pixels.
pub(crate) const LENS: [f64; 4] = [40.0, 28.0, 17.5, 11.5];
/// The identity pose.
pub(crate) const IDENTITY: [f64; 16] =
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// A lens as a (3, 3) array.
pub(crate) fn lens([fx, fy, cx, cy]: [f64; 4]) -> ArrayD<f64> {
    array(&[3, 3], vec![fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0])
}

/// A pose from its rotation, row by row, and its translation.
pub(crate) fn posed(r: [f64; 9], o: [f64; 3]) -> [f64; 16] {
    let mut c2w = IDENTITY;
    for k in 0..3 {
        (0..3).for_each(|j| c2w[4 * k + j] = r[3 * k + j]);
        c2w[4 * k + 3] = o[k];
    }
    c2w
}

/// A random rotation, its entries not yet numbers of any type, within 4 of the origin.
pub(crate) fn random_rotation(draw: &mut Draw) -> [f64; 16] {
    let q: [f64; 4] = std::array::from_fn(|_| draw.between(-1.0, 1.0));
    let length = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    let [w, x, y, z] = q.map(|q| q / length);
    let r = [
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - z * w),
        2.0 * (x * z + y * w),
        2.0 * (x * y + z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - x * w),
        2.0 * (x * z - y * w),
        2.0 * (y * z + x * w),
        1.0 - 2.0 * (x * x + y * y),
    ];
    posed(r, std::array::from_fn(|_| draw.between(-4.0, 4.0)))
}

/// The same with short numbers: a rotation to within 1 part in 100, which is as good as any where nothing is normalized.
pub(crate) fn random_pose(draw: &mut Draw) -> [f64; 16] {
    random_rotation(draw).map(short)
}

/// A case with [`random_rotation`]s, once for each type: rounded to it, they are rotations as nearly as it can tell, and whether
/// directions are divided by their length before or after they are turned is a matter of rounding. In f32 and f64 the other numbers use
/// every bit too.
pub(crate) fn rigid(case: &Case) -> Vec<Case> {
    let one = |dtype: Dtype| {
        let id = format!("{}_{dtype}", case.id);
        let full = [Dtype::F32, Dtype::F64].contains(&dtype).then_some(dtype);
        let mut own = Case { id, full, only: Some(dtype), ..case.clone() };
        let mut draw = Draw::new(&own.id, 0);
        for (name, array) in own.inputs.iter_mut() {
            match full {
                _ if name == "c2w" => array.mapv_inplace(|x| dtype.round(x)),
                Some(_) => lengthen(array, dtype, &mut draw),
                None => {}
            }
        }
        own
    };
    Dtype::ALL.into_iter().map(one).collect()
}

/// Named poses that several rows share; a case uses one of them for all of its points or rays.
pub(crate) fn poses() -> Vec<(&'static str, &'static str, [f64; 16])> {
    let turn = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let far = 1_048_576.0;
    let twice = [2., 0., 0., 0., 2., 0., 0., 0., 2.];
    vec![
        ("identity", "camera and world agree", IDENTITY),
        (
            "moved",
            "translated alone: directions must not change",
            posed([1., 0., 0., 0., 1., 0., 0., 0., 1.], [3.0, -1.0, 0.5]),
        ),
        (
            "turned",
            "turned alone, by 120 degrees about (1, 1, 1): origins must not change",
            posed(turn, [0.0; 3]),
        ),
        ("moved_and_turned", "a turn whose transpose is another turn", posed(turn, [1.5, 2.0, -0.75])),
        (
            "CG9_far_away",
            "a camera at 2^20: x_w - o loses 20 bits, R K^-1 uv none",
            posed(turn, [far, -far, 0.5 * far]),
        ),
        ("CG9_scale_2", "not rigid: everything twice as large", posed(twice, [0.0; 3])),
        (
            "CG9_mirrored",
            "not a rotation: determinant -1",
            posed([-1., 0., 0., 0., 1., 0., 0., 0., 1.], [1.0, 0.0, 0.0]),
        ),
    ]
}

/// A case of one of these poses, marked where no real camera has it.
pub(crate) fn marked(case: Case) -> Case {
    let strange = ["CG9_scale_2", "CG9_mirrored"].contains(&&*case.id);
    if strange { case.edge("a pose that isn't rigid") } else { case }
}

/// The same pose n times, (n, 4, 4).
pub(crate) fn repeated(pose: &[f64; 16], n: usize) -> ArrayD<f64> {
    array(&[n, 4, 4], std::iter::repeat_n(*pose, n).flatten().collect())
}

/// n random poses, (n, 4, 4).
pub(crate) fn random_poses(draw: &mut Draw, n: usize) -> ArrayD<f64> {
    array(&[n, 4, 4], (0..n).flat_map(|_| random_pose(draw)).collect())
}

/// n pixel positions in a picture of 36 x 24 pixels: centers, exact in every type.
pub(crate) fn pixels(draw: &mut Draw, n: usize) -> ArrayD<f64> {
    let centers = (0..n).flat_map(|_| [draw.below(36) as f64 + 0.5, draw.below(24) as f64 + 0.5]);
    array(&[n, 2], centers.collect())
}

/// Camera space to world space.
pub(crate) fn transform() -> Vec<Case> {
    let points = vec![0.5, -0.25, 2.0, 0.0, 0.0, 0.0, -1.5, 0.75, 4.0];
    let mut cases: Vec<Case> = poses()
        .into_iter()
        .map(|(id, comment, pose)| {
            let x_c = array(&[3, 3], points.clone());
            Case::new(id, comment, vec![("c2w", repeated(&pose, 3)), ("x_c", x_c)])
        })
        .map(marked)
        .collect();
    for n in 0..4 {
        let mut draw = Draw::new("transform", n);
        let inputs = vec![("c2w", random_poses(&mut draw, 8)), ("x_c", draw.array(&[8, 3], -4.0, 4.0))];
        cases.push(Case::new(format!("random_{n}"), "a random pose for every point", inputs));
    }
    in_full(cases, "random_0")
}

/// Pixel and depth to camera space.
pub(crate) fn pixel_to_camera() -> Vec<Case> {
    let case = |id, comment, k, uv: &[f64], s: Vec<f64>| {
        let n = s.len();
        Case::new(
            id,
            comment,
            vec![("K", lens(k)), ("uv", array(&[n, 2], uv.to_vec())), ("s", array(&[n], s))],
        )
    };
    let mut cases = vec![
        case(
            "center",
            "the principal point, at any depth, lies on the axis",
            LENS,
            &[17.5, 11.5, 17.5, 11.5],
            vec![1.0, 3.0],
        ),
        case(
            "corners",
            "the corners of a picture that isn't square",
            LENS,
            &[0.5, 0.5, 35.5, 0.5, 0.5, 23.5, 35.5, 23.5],
            vec![1.0; 4],
        ),
        case("unit_lens", "f = 1, c = 0: the pixel itself", [1.0, 1.0, 0.0, 0.0], &[3.0, -2.0], vec![2.0]),
        case(
            "depths",
            "one pixel at several depths, one of them 0 and one behind",
            LENS,
            &[20.5, 2.5, 20.5, 2.5, 20.5, 2.5],
            vec![0.0, 2.0, -4.0],
        ),
        case("far_points", "depths of 48 and 1000", LENS, &[20.5, 2.5, 3.5, 17.5], vec![48.0, 1000.0]),
        case(
            "near_the_center",
            "u - cx = 2^-4: a matrix inverse cancels, the difference doesn't",
            LENS,
            &[17.5625, 11.5625],
            vec![4.0],
        ),
    ];
    for n in 0..4 {
        let mut draw = Draw::new("pixel_to_camera", n);
        let k = [
            draw.between(20.0, 60.0),
            draw.between(20.0, 60.0),
            draw.between(10.0, 26.0),
            draw.between(6.0, 18.0),
        ];
        let inputs = vec![("K", lens(k)), ("uv", pixels(&mut draw, 8)), ("s", draw.array(&[8], 0.5, 6.0))];
        cases.push(Case::new(format!("random_{n}"), "a random lens and random pixels", inputs));
    }
    in_full(cases, "random_1")
}

/// Poses that exchange the axes in a ring, at places of their own: words make no rotation.
pub(crate) const MOVED: Recipe = {
    const ZERO: Recipe = Recipe::Constant(0.0);
    const ONE: Recipe = Recipe::Constant(1.0);
    const PLACE: Recipe = signed(-2, 3);
    Recipe::Cycle(&[
        ZERO, ONE, ZERO, PLACE, ZERO, ZERO, ONE, PLACE, ONE, ZERO, ZERO, PLACE, ZERO, ZERO, ZERO, ONE,
    ])
};

/// Intrinsics whose principal point isn't the middle of anything.
pub(crate) const INTRINSICS: Recipe =
    Recipe::Cycle(&constants([400.0, 0.0, 250.0, 0.0, 416.0, 270.0, 0.0, 0.0, 1.0]));

/// As many points as a picture has pixels, each with a pose of its own.
pub(crate) fn large_transform() -> Vec<Large> {
    let n = 40_009;
    let large = Large::new("points_40009", "40,009 points", n, 512).with("c2w", &[n, 4, 4], MOVED);
    vec![large.with("x_c", &[n, 3], signed(-3, 5))]
}

/// More pixels than 16 bits count. The gradient of the intrinsics adds up over all of them, so that a gradient is judged at once, and in
/// types in which so long a sum has digits.
pub(crate) fn large_pixel_to_camera() -> Vec<Large> {
    let pixels = |id, comment, n: usize, block| {
        let large = Large::new(id, comment, n, block).with("K", &[3, 3], INTRINSICS);
        large.with("uv", &[n, 2], floats(3, 6)).with("s", &[n], floats(-1, 3))
    };
    vec![
        pixels("pixels_4099", "4,099 pixels", 4099, 4099).in_types(&[Dtype::F64, Dtype::F32]),
        pixels("pixels_100003", "100,003 pixels", 100_003, 1024).forward_only(),
    ]
}
