//! Cases of rays: cameras that tell mistakes apart, and seeded ones.

use crate::camera::cases::{
    IDENTITY, INTRINSICS, LENS, MOVED, lens, marked, pixels, poses, random_rotation, repeated, rigid,
};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, floats};

/// The ray through a pixel.
pub(crate) fn pixel_to_ray() -> Vec<Case> {
    // Three pixels: the smallest batch on which a norm without its axis goes wrong instead of failing.
    let uv = || array(&[3, 2], vec![17.5, 11.5, 2.5, 20.5, 33.5, 5.5]);
    let mut cases: Vec<Case> = poses()
        .into_iter()
        .map(|(id, comment, pose)| {
            Case::new(id, comment, vec![("K", lens(LENS)), ("c2w", repeated(&pose, 3)), ("uv", uv())])
        })
        .map(marked)
        .collect();
    cases.push(Case::new(
        "on_the_axis",
        "the only pixel is the center: its gradient loses no digits",
        vec![("K", lens(LENS)), ("c2w", repeated(&IDENTITY, 1)), ("uv", array(&[1, 2], LENS[2..].to_vec()))],
    ));
    for n in 0..4 {
        let mut draw = Draw::new("pixel_to_ray", n);
        let k = [
            draw.between(20.0, 60.0),
            draw.between(20.0, 60.0),
            draw.between(10.0, 26.0),
            draw.between(6.0, 18.0),
        ];
        let poses = (0..6).flat_map(|_| random_rotation(&mut draw)).collect();
        let inputs = vec![("K", lens(k)), ("c2w", array(&[6, 4, 4], poses)), ("uv", pixels(&mut draw, 6))];
        cases.extend(rigid(&Case::new(format!("random_{n}"), "a random lens, poses and pixels", inputs)));
    }
    cases
}

/// The rays of a picture.
pub(crate) fn image_rays() -> Vec<Case> {
    let case = |id: &str, comment, [height, width]: [f64; 2], [focal, cx, cy]: [f64; 3], pose: &[f64; 16]| {
        let inputs = vec![
            ("height", scalar(height)),
            ("width", scalar(width)),
            ("focal", scalar(focal)),
            ("cx", scalar(cx)),
            ("cy", scalar(cy)),
            ("c2w", array(&[4, 4], pose.to_vec())),
        ];
        Case::new(id, comment, inputs)
    };
    let mut cases: Vec<Case> = poses()
        .into_iter()
        .map(|(id, comment, pose)| case(id, comment, [3.0, 5.0], [4.5, 2.5, 1.5], &pose))
        .map(marked)
        .collect();
    let identity = &poses()[0].2;
    cases.push(case(
        "one_pixel",
        "the only pixel looks down the axis",
        [1.0, 1.0],
        [1.0, 0.5, 0.5],
        identity,
    ));
    cases.push(case(
        "inexact_lens",
        "a focal length that no type holds",
        [2.0, 3.0],
        [4.1, 1.3, 1.1],
        identity,
    ));
    let turned = &poses()[3].2;
    cases.push(case("portrait", "taller than wide", [7.0, 3.0], [5.5, 1.25, 3.75], turned));
    for n in 0..3 {
        let mut draw = Draw::new("image_rays", n);
        let size = [2.0 + draw.below(4) as f64, 7.0 + draw.below(4) as f64];
        let k = [draw.between(4.0, 12.0), draw.between(3.0, 5.0), draw.between(1.0, 2.5)];
        let pose = random_rotation(&mut draw);
        let wide = case(&format!("random_{n}"), "wide pictures, the center off the middle", size, k, &pose);
        cases.extend(rigid(&wide));
    }
    // What functions of height, width, focal and pose can be asked: portrait and landscape.
    for (n, size) in [[6.0, 5.0], [3.0, 8.0]].into_iter().enumerate() {
        let mut draw = Draw::new("image_rays", 3 + n as u64);
        let k = [draw.between(4.0, 12.0), size[1] / 2.0, size[0] / 2.0];
        let pose = random_rotation(&mut draw);
        let middle =
            case(&format!("centered_{n}"), "the center in the middle, a random pose", size, k, &pose);
        cases.extend(rigid(&middle));
    }
    cases
}

/// Many pixels with poses of their own. The gradient of the intrinsics adds up over all of them, so that a gradient is judged at once, and in
/// types in which so long a sum has digits.
pub(crate) fn large_pixel_to_ray() -> Vec<Large> {
    let pixels = |id, comment, n: usize, block| {
        let large = Large::new(id, comment, n, block).with("K", &[3, 3], INTRINSICS);
        large.with("c2w", &[n, 4, 4], MOVED).with("uv", &[n, 2], floats(3, 6))
    };
    vec![
        pixels("pixels_4099", "4,099 pixels", 4099, 4099).in_types(&[Dtype::F64, Dtype::F32]),
        pixels("pixels_40009", "40,009 pixels", 40_009, 512).forward_only(),
    ]
}

/// A picture in portrait, judged at once: neither side a multiple of anything.
pub(crate) fn large_image_rays() -> Vec<Large> {
    const POSE: Recipe = Recipe::Cycle(&constants([
        0.0, 1.0, 0.0, 0.5, 0.0, 0.0, 1.0, -1.25, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0,
    ]));
    let (height, width) = (67, 37);
    let large = Large::new("portrait_67x37", "a picture of 67 rows and 37 columns", height, height);
    let (height, width) = (height as f64, f64::from(width));
    let scalars =
        [("height", height), ("width", width), ("focal", 48.0), ("cx", width / 2.0), ("cy", height / 2.0)];
    let large =
        scalars.into_iter().fold(large, |large, (name, x)| large.with(name, &[], Recipe::Constant(x)));
    vec![large.with("c2w", &[4, 4], POSE)]
}
