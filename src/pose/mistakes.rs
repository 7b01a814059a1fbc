//! Poses, wrong on purpose. Without a mistake every function equals the oracle.

pub(crate) mod signs;

use glam::{DMat3, DMat4, DVec3};

use self::signs::{SIGNS, signed};
use super::arrays::{Written, forward, vjp};
use super::{backward, flip, from_colmap, rotation};
use crate::camera::arrays::{flat, pose};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::{Conventions, Quaternion};

/// Mistakes of COLMAP's poses.
pub(crate) const POSE_FROM_COLMAP: &[Mistake] = &[
    Mistake::new(
        "scalar_last",
        "q read as (x, y, z, w), as scipy's and glm's constructors and ROS have it",
        "every camera looks somewhere else: nothing is learned but fog",
        "w first; or reorder before a library that wants it last",
        "COLMAP's qvec handed to scipy's Rotation.from_quat as it is",
        1,
    ),
    Mistake::new(
        "not_inverted",
        "[R, t]: the way from the world to the camera, taken for the way back",
        "cameras turn the wrong way about the scene; the training finds fog that fits each alone",
        "invert: [R^T, -R^T t]",
        "kornia's NerfModelRenderer takes the translation of its world-to-camera matrix for the place",
        1,
    ),
    Mistake::new(
        "translation_not_turned",
        "-t for the camera's place",
        "cameras look the right way from the wrong places",
        "-R^T t",
        "never by itself; cheap to keep",
        0,
    ),
    Mistake::new(
        "translation_not_negated",
        "R^T t for the camera's place",
        "cameras stand on the other side of the origin and look away from the scene",
        "-R^T t",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "rotation_alone_inverted",
        "[R^T, t]: the translation as it is",
        "cameras look the right way from the wrong places",
        "-R^T t",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "rotation_not_transposed",
        "[R, -R^T t]: the place alone is inverted",
        "cameras stand where they should and look elsewhere",
        "R^T: its columns are the camera's axes in the world",
        "row-major matrices handed to column-major code, which transposes once more",
        1,
    ),
    Mistake::new(
        "conjugated",
        "the rotation of (w, -x, -y, -z), and that inverted: [R, -R t]",
        "cameras turn the wrong way",
        "one inverse, of the matrix or of the quaternion",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "translation_turned_on",
        "-R t for -R^T t beside R^T",
        "cameras at the right distance in the wrong places",
        "-R^T t",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "translation_turned_on_not_negated",
        "R t for -R^T t beside R^T",
        "cameras at the right distance in the wrong places",
        "-R^T t",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "world_axes_flipped",
        "rows 2 and 3 negative, where the columns of the camera's axes were meant",
        "the world is upside down, and the camera's own axes are as before",
        "columns 2 and 3: c2w[:3, 1:3] *= -1",
        "never by itself; world flips in converters, copied without the axes' one",
        0,
    ),
    Mistake::new(
        "place_flipped",
        "the place's y and z negative too, with the axes",
        "cameras stand on the other side of the world's planes",
        "columns 2 and 3 alone: the camera stays where it is",
        "never; cheap to keep",
        0,
    ),
    SIGNS[0],
    SIGNS[1],
    SIGNS[2],
    SIGNS[3],
    SIGNS[4],
    SIGNS[5],
    Mistake::new(
        "place_held_constant",
        "the rotation learns from the axes alone, not from where the camera stands",
        "poses are refined in a wrong direction: a turn moves the place as well",
        "g_R gains -t g_o^T",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// (x, y, z, w) read as (w, x, y, z).
fn scalar_last(q: [f64; 4]) -> [f64; 4] {
    [q[3], q[0], q[1], q[2]]
}

/// Rotation and place of a picture, with a mistake.
fn wrong_pose((q, t): Written, length: Quaternion, wrong: &[&str]) -> (DMat3, DVec3) {
    let has = |name: &str| wrong.contains(&name);
    let q = if has("scalar_last") { scalar_last(q) } else { q };
    let q = if has("conjugated") { [q[0], -q[1], -q[2], -q[3]] } else { q };
    // By columns, as glam has matrices.
    let rows = rotation(q, length).transpose().to_cols_array_2d();
    let (r, t) = (DMat3::from_cols_array_2d(&signed(rows, wrong)).transpose(), DVec3::from(t));
    if has("not_inverted") {
        return (r, t);
    }
    let back = r.transpose();
    let place = match () {
        () if has("translation_not_turned") => -t,
        () if has("translation_not_negated") => back * t,
        () if has("rotation_alone_inverted") => t,
        () if has("translation_turned_on") => -(r * t),
        () if has("translation_turned_on_not_negated") => r * t,
        () => -(back * t),
    };
    (if has("rotation_not_transposed") { r } else { back }, place)
}

/// Camera to world.
pub(crate) fn pose_from_colmap(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let has = |name: &str| wrong.contains(&name);
    forward(a, |(q, t)| {
        if wrong.is_empty() {
            return flat(&from_colmap(q, t, c.axes, c.quaternion));
        }
        let (back, place) = wrong_pose((q, t), c.quaternion, wrong);
        let mut c2w = DMat4::from_cols(
            back.x_axis.extend(0.0),
            (flip(c.axes) * back.y_axis).extend(0.0),
            (flip(c.axes) * back.z_axis).extend(0.0),
            place.extend(1.0),
        );
        if has("place_flipped") {
            (c2w.w_axis.y, c2w.w_axis.z) = (-c2w.w_axis.y, -c2w.w_axis.z);
        }
        if has("world_axes_flipped") {
            c2w = DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0)) * c2w;
        }
        flat(&c2w)
    })
}

/// Their gradient.
pub(crate) fn pose_from_colmap_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, |(q, t), g| {
        let g = pose(&g, 0);
        let right = |q, t| backward::from_colmap(q, t, c.axes, c.quaternion, &g);
        match wrong.first() {
            Some(&"scalar_last") => {
                let (g_q, g_t) = right(scalar_last(q), t);
                ([g_q[1], g_q[2], g_q[3], g_q[0]], g_t)
            }
            Some(&"place_held_constant") => (right(q, [0.0; 3]).0, right(q, t).1),
            _ => right(q, t),
        }
    })
}
