//! Rays in normalized device coordinates, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{Ray, forward, view, vjp};
use super::{View, backward, ndc_ray};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;

const EPS_IN_DEPTH: Mistake = Mistake::new(
    "eps_in_depth",
    "t = -(near + o_z) / (d_z + eps)",
    "rays begin beside the near plane; beyond it where they hardly look ahead",
    "-(near + o_z) / d_z: a ray that doesn't look ahead has no place in this view",
    "1 public implementation: 1e-5",
    1,
)
.with("eps", 1e-5, [1e-8, 1e-2]);

/// Mistakes of rays in normalized device coordinates.
pub(crate) const NDC_RAYS: &[Mistake] = &[
    Mistake::new(
        "depth_of_the_other_axes",
        "x, y and t for a scene at positive z, o'_z = 1 + 2 near/p_z and d'_z = -2 near/p_z for one at negative z (or the reverse)",
        "samples run from 3 to 1 in depth: the cube is left empty, what is far is drawn near",
        "all signs of the same axes: 1 - 2 near/p_z and 2 near/p_z at positive z",
        "two codes that took the function over to OpenCV's axes",
        2,
    ),
    Mistake::new(
        "direction_normalized",
        "d' / |d'|",
        "samples at t' in [0, 1] end before infinity: the background is cut off, most where rays are oblique",
        "leave d' as it is: its length says where infinity is",
        "a code for bundles of rays, which normalizes after the change of coordinates",
        1,
    ),
    Mistake::new(
        "origin_not_moved",
        "the origin itself is projected, not the ray's point on the near plane",
        "0/0 for a camera at the origin, near planes at different depths for all others",
        "o + t d with t = -(near + o_z) / d_z first",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "moved_behind",
        "t = (near - o_z) / d_z at negative z: the plane behind the camera",
        "rays begin at 3 in depth, behind the scene",
        "t = -(near + o_z) / d_z",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "size_swapped",
        "height for width: 2f/H p_x, 2f/W p_y",
        "pictures that aren't square are stretched, and leave the cube on their longer side",
        "width with x",
        "never in this row; as size_swapped of pictures, which square ones hide",
        0,
    ),
    Mistake::new(
        "half_size_forgotten",
        "f/W for 2f/W",
        "the scene fills a quarter of the cube's face",
        "W / (2 f): the picture's half",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "origin_not_subtracted",
        "d'_x = 2f/W d_x/|d_z|, without p_x/near",
        "rays don't meet at their points at infinity: parallel ones end apart",
        "the difference of both",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "near_taken_as_one",
        "1 for near, whatever it is",
        "the near plane is elsewhere: what lies before it is lost, or samples are wasted",
        "the near that the scene has",
        "never by itself; callers that hand over 1 are many, and right where poses were scaled for it",
        0,
    ),
    Mistake::new(
        "unmoved_origin_subtracted",
        "d'_x = 2f/W (d_x/|d_z| - o_x/o_z): the origin as it was before it was moved",
        "rays don't meet at their points at infinity, but for cameras on the near plane",
        "the difference to what o' has",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "unmoved_depth",
        "o'_z and d'_z by the z of the origin as it was before it was moved",
        "rays begin at different depths of the cube",
        "-1 and 2, or by the z of the moved origin",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "two_forgotten_in_depth",
        "1 + near/p_z and -near/p_z",
        "rays begin in the middle of the cube and end at 1",
        "2 near/p_z",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "depth_moved_alone",
        "z is moved to the near plane first, in place; t is then 0 for x and y",
        "rays begin beside where they are seen",
        "one t for all three, from the ray as it came",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "depth_not_moved",
        "x and y are moved to the near plane, z isn't",
        "rays begin at different depths of the cube",
        "one t for all three",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "near_forgotten_in_origins_depth",
        "1 + 2 / o_z for 1 + 2 near / o_z",
        "rays don't begin at the cube's face, unless near is 1",
        "2 near / o_z",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "near_forgotten_in_directions_depth",
        "-2 / o_z for -2 near / o_z",
        "rays don't end at the cube's face, unless near is 1",
        "2 near / o_z",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "shift_in_lengths",
        "t of the unit direction, moved by the direction itself",
        "rays begin before the near plane, or behind it",
        "t and d of one direction",
        "never; cheap to keep",
        0,
    ),
    EPS_IN_DEPTH,
    Mistake::new(
        "direction_between_points",
        "d' is from o' to where o + d is projected",
        "directions of another length, and half of the cube is left",
        "d' = the limit of the projection less o'",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "both_signs_forgotten",
        "x' and y' without their minus: 2 f / W and 2 f / H at negative z",
        "a scene that is mirrored twice",
        "-2 f / W and -2 f / H where the camera looks along -z",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "half_sizes_cut",
        "W // 2 and H // 2: halves cut to whole numbers",
        "views of odd sizes are stretched by a part of a pixel",
        "W / 2 and H / 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "picture_flipped",
        "y' and its direction with the other sign",
        "a scene upside down",
        "the signs of one view",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "shift_not_differentiated",
        "t held constant in the gradient",
        "poses learn across the axis alone: none of their depth",
        "g_t = g_p . d, and t = -(near + o_z) / d_z",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "slope_not_differentiated",
        "d_x/|d_z| held constant in the gradient",
        "rotations learn from where rays begin alone, not from where they go",
        "g_d = t g_p and the slope's",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// A ray with what is wrong about it, as codes write it: by the z of the moved origin.
fn wrong_ray(o: [f64; 3], d: [f64; 3], view: &View, wrong: &[&str]) -> Ray {
    let has = |name: &str| wrong.contains(&name);
    let sign = view.sign();
    let near = if has("near_taken_as_one") { 1.0 } else { view.near };
    let plane = if has("moved_behind") { -sign * near } else { sign * near };
    let eps = EPS_IN_DEPTH.among(wrong);
    let t = if has("origin_not_moved") { 0.0 } else { (plane - o[2]) / (d[2] + eps.unwrap_or(0.0)) };
    let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    let t = if has("shift_in_lengths") { t * length } else { t };
    let still = ["origin_not_moved", "depth_not_moved", "shift_in_lengths"].iter().any(|name| has(name));
    let beside = still || eps.is_some();
    let o = if has("depth_moved_alone") { [o[0] - t * d[0], o[1] - t * d[1], o[2]] } else { o };
    let p = [
        o[0] + t * d[0],
        o[1] + t * d[1],
        match () {
            () if has("depth_not_moved") => o[2],
            () if beside => o[2] + t * d[2],
            () => plane,
        },
    ];
    let of_depth = if has("depth_of_the_other_axes") { -sign } else { sign };
    let twice = if has("two_forgotten_in_depth") { 1.0 } else { 2.0 };
    let depth = twice * of_depth * near / if has("unmoved_depth") { o[2] } else { p[2] };
    let of = |name: &str| if has(name) { depth / near } else { depth };
    let (origins, directions) =
        (of("near_forgotten_in_origins_depth"), of("near_forgotten_in_directions_depth"));
    let (mut o_ndc, mut d_ndc) = ([1.0 - origins; 3], [directions; 3]);
    let mut scales = view.scales();
    if has("size_swapped") {
        scales.swap(0, 1);
    }
    if has("half_sizes_cut") {
        scales = scales.map(|scale| 2.0 * view.focal / (2.0 * (view.focal / scale + 1e-9).floor()));
    }
    for j in 0..2 {
        let scale = sign * if has("half_size_forgotten") { scales[j] / 2.0 } else { scales[j] };
        let start = p[j] / p[2];
        o_ndc[j] = scale * start;
        let taken_off = match () {
            () if has("origin_not_subtracted") => 0.0,
            () if has("unmoved_origin_subtracted") => o[j] / o[2],
            () => start,
        };
        d_ndc[j] = scale * (d[j] / d[2] - taken_off);
    }
    if has("direction_between_points") {
        let q = [p[0] + d[0], p[1] + d[1], p[2] + d[2]];
        let place = |j: usize| sign * scales[j] * q[j] / q[2];
        let there = [place(0), place(1), 1.0 - sign * 2.0 * near / q[2]];
        d_ndc = [0, 1, 2].map(|j| there[j] - o_ndc[j]);
    }
    if has("both_signs_forgotten") {
        for j in 0..2 {
            (o_ndc[j], d_ndc[j]) = (-o_ndc[j], -d_ndc[j]);
        }
    }
    if has("picture_flipped") {
        (o_ndc[1], d_ndc[1]) = (-o_ndc[1], -d_ndc[1]);
    }
    if has("direction_normalized") {
        let length = (d_ndc[0] * d_ndc[0] + d_ndc[1] * d_ndc[1] + d_ndc[2] * d_ndc[2]).sqrt();
        d_ndc = d_ndc.map(|x| x / length);
    }
    (o_ndc, d_ndc)
}

/// Rays.
pub(crate) fn ndc_rays(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let view = view(a, c);
    forward(a, |o, d| if wrong.is_empty() { ndc_ray(o, d, &view) } else { wrong_ray(o, d, &view, wrong) })
}

/// Their gradient.
pub(crate) fn ndc_rays_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let view = view(a, c);
    vjp(a, |(o, d), (g_o, g_d)| {
        let (mut g_ox, mut g_dx) = backward::ndc_ray(o, d, &view, g_o, g_d);
        let (sign, scales) = (view.sign(), view.scales());
        let t = (sign * view.near - o[2]) / d[2];
        let g_p = [0, 1].map(|j| scales[j] * (g_o[j] - g_d[j]) / view.near);
        let of_slope = [0, 1].map(|j| sign * scales[j] * g_d[j] / d[2]);
        let by_slope = -(of_slope[0] * d[0] + of_slope[1] * d[1]) / d[2];
        if wrong.contains(&"slope_not_differentiated") {
            g_dx = [t * g_p[0], t * g_p[1], -t * (g_p[0] * d[0] + g_p[1] * d[1]) / d[2]];
        }
        if wrong.contains(&"shift_not_differentiated") {
            g_ox[2] = 0.0;
            g_dx[2] = if wrong.contains(&"slope_not_differentiated") { 0.0 } else { by_slope };
        }
        (g_ox, g_dx)
    })
}
