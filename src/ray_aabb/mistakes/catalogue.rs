//! What is wrong with rays and boxes, what it does, and where it was seen.

use super::boxes::OF_BOXES;
use crate::contract::component::{Mistake, joined};

pub(super) const EPS_IN_DIRECTION: Mistake = Mistake::new(
    "eps_in_direction",
    "1 / (d + eps) for 1 / d",
    "t is off by 1e-6 / d, and a direction of -1e-6 is infinite or turned around",
    "a case of its own for d = 0, and nothing added elsewhere",
    "hand-written slab tests",
    5,
)
.with("eps", 1e-6, [1e-16, 1e-2]);

pub(super) const TINY_REPLACED: Mistake = Mistake::new(
    "tiny_direction_replaced",
    "d below eps, 0 too, is taken for eps, with the sign of d",
    "t is as if the ray had another direction; rays in a box's far face leave it at 0, and miss",
    "a case of its own for d = 0, and nothing else replaced",
    "hand-written slab tests: 1e-6 and 1e-9 (three codes), by clamping |d| or by a selection",
    3,
)
.with("eps", 1e-6, [1e-16, 1e-2]);

pub(super) const TINY_PARALLEL: Mistake = Mistake::new(
    "tiny_taken_for_parallel",
    "d below eps is taken for 0: a slab that is never entered or left",
    "a slow crossing of a long box is no crossing",
    "a case of its own for d = 0 alone: 1 / d is a number wherever d isn't 0",
    "hand-written slab tests: if |d| < 1e-9 (1e-8, 1e-6), three of three in one reading",
    3,
)
.with("eps", 1e-6, [1e-16, 1e-2]);

pub(super) const TINY_POSITIVE: Mistake = Mistake::new(
    "tiny_direction_positive",
    "d below eps, 0 and negative ones too, is taken for +eps: where(|d| > eps, 1 / d, 1 / eps)",
    "t is as if the ray had another direction; rays in a box's far face leave it at 0, and miss",
    "a case of its own for d = 0, and nothing else replaced",
    "a batched slab test in torch: 1e9 for 1 / d below 1e-9",
    1,
)
.with("eps", 1e-6, [1e-16, 1e-2]);

pub(super) const ZERO_REPLACED: Mistake = Mistake::new(
    "zero_direction_replaced",
    "d = 0 is taken for eps",
    "rays in a box's far face leave it at 0, and miss",
    "a case of its own for d = 0",
    "hand-written slab tests: 1e-30 in C++",
    1,
)
.with("eps", 1e-10, [1e-16, 1e-2]);

pub(super) const NEAR_OF_ITS_OWN: Mistake = Mistake::new(
    "near_of_its_own",
    "t_near is k at least, whatever near is",
    "what lies nearer isn't seen, or samples lie in front of near",
    "max(near, t_near)",
    "torch-ngp, whose min_near is 0.2; not handed over in ports",
    1,
)
.with("k", 0.2, [1e-3, 2.0]);

pub(super) const ENTERED_LATE: Mistake = Mistake::new(
    "entered_late",
    "eps is added to t_near",
    "rays begin a little inside the box",
    "t_near as it is",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-4, [1e-6, 0.1]);

/// Mistakes of rays and boxes.
pub(crate) const RAY_AABB: &[Mistake] = &joined::<{ OF_SLABS.len() + OF_BOXES.len() }>(&[OF_SLABS, OF_BOXES]);

const OF_SLABS: &[Mistake] = &[
    EPS_IN_DIRECTION,
    TINY_PARALLEL,
    Mistake::new(
        "face_is_a_miss",
        "a ray in a face: 0 * inf is NaN, and every comparison with it false",
        "pictures with seams along the box",
        "where d_a = 0 compare o_a with both faces, which are inside",
        "half of nerfacc's code paths, and numpy's minimum and maximum",
        4,
    ),
    Mistake::new(
        "face_at_infinity",
        "a ray in a face: 0 * inf is NaN, which min and max pass over: both ends are the other face's infinity. In a flat box's plane it hits",
        "pictures with seams along the box",
        "where d_a = 0 compare o_a with both faces, which are inside",
        "slab tests with fmin and fmax, HLSL's min and max, and Rust's",
        3,
    ),
    Mistake::new(
        "one_face_is_a_miss",
        "a ray in a face: 0 * inf is NaN, which min and max drop or keep by their order, so that it misses in the high face alone; in a flat box's plane it hits",
        "pictures with seams along three sides of the box",
        "where d_a = 0 compare o_a with both faces, which are inside",
        "hand-written slab tests with std::min and std::max, or comparisons in their place: six of eleven in one reading",
        6,
    ),
    Mistake::new(
        "nan_in_a_face",
        "a ray in a face: 0 * inf is NaN, and what becomes of it depends on the order of comparisons: NaN, a miss or the other face",
        "pictures with seams along some sides of the box, or pixels that are NaN",
        "where d_a = 0 compare o_a with both faces, which are inside",
        "instant-ngp's chain of comparisons and its ports, which keep x's NaN and pass over y's and z's; NaN taken for 0 in Julia; nerfstudio's minima and maxima",
        4,
    )
    .open_where_nan(),
    Mistake::new(
        "parallel_is_a_miss",
        "d_a = 0 anywhere counts as a miss",
        "no ray along an axis sees anything",
        "inside the slab it is no condition at all",
        "hand-written slab tests",
        2,
    ),
    Mistake::new(
        "parallel_outside_is_a_hit",
        "a ray along a slab, d_a = 0, isn't asked whether it runs inside of it",
        "boxes are seen by rays that pass beside them",
        "where d_a = 0 and o_a isn't between the faces: a miss",
        "a voxel game, and a tree of boxes in numpy: -inf and inf where d is 0",
        2,
    ),
    Mistake::new(
        "sign_ignored",
        "enters by the low face and leaves by the high one, whatever the sign of d",
        "rays of negative directions miss",
        "exchange the two where d_a < 0",
        "hand-written slab tests",
        3,
    ),
    Mistake::new(
        "first_slab",
        "entered where the first slab is, left where the last one is",
        "stretches far too long",
        "the largest entry and the smallest exit",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "first_entry",
        "the smallest entry and the smallest exit: min for max",
        "rays enter in front of the box, and hit where they pass it by",
        "the largest entry",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_exit",
        "the largest entry and the largest exit: max for min",
        "rays leave behind the box, and hit where they pass it by",
        "the smallest exit",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "near_ignored",
        "t_near isn't cut at near",
        "samples behind the camera where it is inside the box",
        "max(near, t_near)",
        "ray-box tests of lines",
        3,
    ),
    Mistake::new(
        "near_asked_not_cut",
        "boxes behind near are missed, and t_near of a ray that begins inside lies in front of near",
        "samples behind the camera where it is inside the box",
        "max(near, t_near)",
        "slab tests that return the first t as it is: a picture's renderer in numpy; shaders",
        2,
    ),
    Mistake::new(
        "far_ignored",
        "t_far isn't cut at far",
        "samples beyond far",
        "min(far, t_far)",
        "ray-box tests of lines",
        1,
    ),
    Mistake::new(
        "behind_is_a_hit",
        "a box behind near counts as hit",
        "samples behind the camera",
        "hit = max(near, t_near) <= min(far, t_far)",
        "ray-box tests of lines",
        2,
    ),
    Mistake::new(
        "zero_for_near",
        "t_near is cut at 0, whatever near is",
        "samples in front of near",
        "max(near, t_near)",
        "a batched slab test in torch, clamp_min(0)",
        1,
    ),
    Mistake::new(
        "ends_of_its_own",
        "t is cut at 0 and at infinity, whatever near and far are",
        "samples in front of near and beyond far",
        "max(near, t_near) and min(far, t_far)",
        "slab tests in shaders that begin with 0 and 1e30",
        1,
    ),
    Mistake::new(
        "range_ignored",
        "the line's t as they are; a hit where t_far >= max(t_near, 0)",
        "samples behind the camera and beyond far",
        "cut both at near and far, then compare them",
        "slab tests for one ray and a box in graphics and robotics",
        2,
    ),
    Mistake::new(
        "range_asked_not_cut",
        "the line's t as they are; a hit where some of it lies between near and far",
        "samples behind the camera and beyond far",
        "max(near, t_near) and min(far, t_far)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "range_never_asked",
        "the line's t as they are; a hit where t_far >= t_near, behind the camera too",
        "samples behind the camera and beyond far",
        "cut both at near and far, then compare them",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "inside_is_a_miss",
        "a ray that begins inside the box, t_near < 0, counts as a miss",
        "nothing is seen once the camera is inside the scene's box",
        "max(near, t_near) <= min(far, t_far)",
        "a voxel game",
        1,
    ),
    Mistake::new(
        "exit_where_inside",
        "t_far for t_near where the ray begins inside: the first face in front of the camera",
        "no stretch is left of a ray that begins inside the box",
        "max(near, t_near)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "unit_directions",
        "t counts in units of length, not of the direction",
        "points o + t d lie elsewhere where directions aren't unit",
        "leave the direction as it is",
        "between code with and without normalized directions",
        1,
    ),
    Mistake::new(
        "center_and_size",
        "the box is [low - high / 2, low + high / 2]",
        "another box",
        "two corners",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "direction_forgotten",
        "no gradient with respect to the direction",
        "cameras that are optimized don't turn",
        "dt / dd = -t / d",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_where_cut",
        "near and far have the gradient of the face they replace",
        "gradients of rays that begin inside the box",
        "0 where the range decides",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    TINY_REPLACED,
    TINY_POSITIVE,
    ZERO_REPLACED,
    Mistake::new(
        "beyond_far_is_a_hit",
        "hit = max(near, enter) <= leave: far isn't asked",
        "samples beyond far, in steps that run backward",
        "hit = max(near, enter) <= min(far, leave)",
        "a batched slab test in JAX, which asks near < far of the line and far > 0",
        1,
    ),
    Mistake::new(
        "not_a_number_along_axes",
        "1 / d differentiated where d_a = 0: 0 times infinity",
        "one ray along an axis makes every camera NaN",
        "a case of its own for d = 0, selected before it is divided",
        "automatic differentiation of slab tests in PyTorch, a port of a WebGL path tracer among them",
        1,
    )
    .of_gradient(),
    NEAR_OF_ITS_OWN,
    ENTERED_LATE,
    Mistake::new(
        "high_taken_for_size",
        "the box is [low, low + high]",
        "another box",
        "two corners",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "two_axes_alone",
        "the slabs of x and y alone",
        "rays hit what they pass above or below",
        "all three axes",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "length_for_exit",
        "t_far is the length of the way inside",
        "samples in front of the box",
        "t_far, and t_far - t_near where it is asked",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "ahead_is_a_hit",
        "a hit wherever t_far > 0",
        "rays that miss the box are hits, whose t_near lies beyond t_far",
        "max(near, t_near) <= min(far, t_far)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "range_cut_not_asked",
        "a hit where the line leaves the box at t > 0; t are cut at near and far, which aren't asked",
        "samples that run backward, of boxes in front of near or beyond far",
        "max(near, t_near) <= min(far, t_far)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cube_of_the_first_axis",
        "low_x and high_x for all three axes",
        "nothing for a cube, another box elsewhere",
        "one pair for each axis",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "box_about_the_origin",
        "the box is [-high, high]",
        "nothing for a box about the origin, another one elsewhere",
        "two corners",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "unit_box",
        "the box is [0, 1], whatever low and high are",
        "another box",
        "two corners",
        "never; cheap to keep",
        0,
    ),
];
