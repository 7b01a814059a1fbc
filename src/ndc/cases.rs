//! Cases of rays in normalized device coordinates: cameras before, on and behind the near plane, rays of any length, grazing ones.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, signed};

/// Rays in the view of 40 x 24 pixels with a focal length of 36, and a near plane.
fn case(id: &str, comment: &'static str, rays: &[[f64; 6]], near: f64) -> Case {
    let part = |from: usize| {
        let rows = rays.iter().flat_map(|ray| [ray[from], ray[from + 1], ray[from + 2]]).collect();
        array(&[rays.len(), 3], rows)
    };
    let inputs = vec![
        ("rays_o", part(0)),
        ("rays_d", part(3)),
        ("width", scalar(40.0)),
        ("height", scalar(24.0)),
        ("focal", scalar(36.0)),
        ("near", scalar(near)),
    ];
    Case::new(id, comment, inputs)
}

/// `n` rays from about the origin into the picture, along negative z (forward, `way` = -1) or positive.
fn rays(stream: u64, n: usize, way: f64) -> Vec<[f64; 6]> {
    let mut draw = Draw::new("ndc_rays", stream);
    let ray = |_| {
        let o = [draw.between(-0.5, 0.5), draw.between(-0.5, 0.5), draw.between(-0.25, 0.25)];
        let d = [draw.between(-0.5, 0.5), draw.between(-0.375, 0.375), way * draw.between(0.5, 1.5)];
        [o[0], o[1], o[2], d[0], d[1], d[2]]
    };
    (0..n).map(ray).collect()
}

/// The same with this z of the origin.
fn from(z: f64, mut rays: Vec<[f64; 6]>) -> Vec<[f64; 6]> {
    rays.iter_mut().for_each(|ray| ray[2] = z);
    rays
}

/// Rays of forward-facing cameras, in the cube of one view.
pub(crate) fn ndc_rays() -> Vec<Case> {
    let step = libm::ldexp(1.0, -6);
    let grazing = vec![[0.25, -0.5, 0.125, 1.0, 0.25, -step], [-0.25, 0.0, 0.0, -0.5, 1.0, -2.0 * step]];
    let far: Vec<[f64; 6]> = rays(6, 3, -1.0)
        .into_iter()
        .map(|ray| [4.0 * ray[0], -8.0 * ray[1], 48.0, ray[3], ray[4], ray[5]])
        .collect();
    let mut odd = case("", "", &rays(7, 4, -1.0), 1.0).inputs;
    odd.extend([("width".to_string(), scalar(41.0)), ("height".to_string(), scalar(25.0))]);
    let odd = odd.iter().map(|(name, array)| (name.as_str(), array.clone())).collect();
    let cases = vec![
        case(
            "usual",
            "cameras about the origin, as of a phone that is held and moved",
            &rays(0, 8, -1.0),
            1.0,
        ),
        Case::new("odd_size", "a picture of 41 x 25", odd),
        case("near_quarter", "a near plane that isn't 1", &rays(1, 6, -1.0), 0.25),
        case("near_uneven", "one that no short type holds", &rays(2, 4, -1.0), 1.1),
        case("other_way", "rays along positive z: forward, or back to the near plane", &rays(3, 6, 1.0), 1.0),
        case(
            "axis",
            "straight ahead from the middle: to the middle",
            &[[0.0, 0.0, 0.0, 0.0, 0.0, -1.0]],
            1.0,
        ),
        case(
            "CG10_o_z_0",
            "origins at z = 0, which must be moved before anything is divided by z",
            &from(0.0, rays(4, 4, -1.0)),
            1.0,
        ),
        case("CG10_on_the_near_plane", "origins there: nothing moves", &from(-1.0, rays(5, 4, -1.0)), 1.0),
        case(
            "CG10_beyond_the_near_plane",
            "origins in the scene: moved back",
            &from(-3.0, rays(7, 4, -1.0)),
            1.0,
        ),
        case("CG10_grazing", "d_z of a 64th: the near plane is far along the ray", &grazing, 1.0),
        case("CG9_far_behind", "origins 48 behind the near plane: its z is what a sum leaves", &far, 1.0),
    ];
    in_full(cases, "usual")
}

/// More rays than 16 bits count, forward and back, in the view of the small cases.
pub(crate) fn large() -> Vec<Large> {
    const ORIGINS: Recipe = Recipe::Cycle(&[signed(-4, 3), signed(-4, 3), signed(-5, 3)]);
    const DIRECTIONS: Recipe = Recipe::Cycle(&[signed(-4, 3), signed(-4, 3), signed(-1, 1)]);
    let n = 100_003;
    let large = Large::new("rays_100003", "100,003 rays", n, 1024);
    let large = large.with("rays_o", &[n, 3], ORIGINS).with("rays_d", &[n, 3], DIRECTIONS);
    let scalars = [("width", 40.0), ("height", 24.0), ("focal", 36.0), ("near", 1.0)];
    vec![scalars.into_iter().fold(large, |large, (name, x)| large.with(name, &[], Recipe::Constant(x)))]
}
