//! Registry rows of the camera: row-major arrays on one side, glam's column-major matrices on the other.

use glam::{DMat4, DVec2, DVec3};

use super::{Intrinsics, backward, bound, cases, honest, mistakes};
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, values};
use crate::convention::Conventions;

/// The pose of each point or ray.
pub(crate) const C2W: Port =
    Port { name: "c2w", shape: "M,4,4", meaning: "camera to world; the upper 3x4 is used", gradient: true };
/// Intrinsic parameters.
pub(crate) const K: Port =
    Port { name: "K", shape: "3,3", meaning: "intrinsics in pixels: fx, fy, cx, cy alone", gradient: true };
/// Pixel positions.
pub(crate) const UV: Port =
    Port { name: "uv", shape: "M,2", meaning: "pixel positions, u right, v down", gradient: true };

/// Camera space to world space.
pub const TRANSFORM: Component = Component {
    name: "transform",
    folder: "camera",
    formula: "x_w = R x_c + o, with R and o the upper 3x4 of c2w",
    source: "homogeneous coordinates; Hartley and Zisserman 2004, section 6.1",
    inputs: &[C2W, Port { name: "x_c", shape: "M,3", meaning: "points in camera space", gradient: true }],
    outputs: &[Port { name: "x_w", shape: "M,3", meaning: "points in world space", gradient: true }],
    conventions: &[],
    forward: Pass {
        oracle: transform,
        bound: bound::transform,
        honest: honest::transform,
        wrong: mistakes::transform,
    },
    vjp: Some(Pass {
        oracle: transform_vjp,
        bound: bound::transform_vjp,
        honest: honest::transform_vjp,
        wrong: mistakes::transform_vjp,
    }),
    cases: cases::transform,
    mistakes: mistakes::TRANSFORM,
};

/// Pixel and depth to camera space.
pub const PIXEL_TO_CAMERA: Component = Component {
    name: "pixel_to_camera",
    folder: "camera",
    formula: "x_c = s K^-1 (u, v, 1) = s ((u - cx) / fx, (v - cy) / fy, 1)",
    source: "pinhole camera; Hartley and Zisserman 2004, section 6.1",
    inputs: &[
        K,
        UV,
        Port { name: "s", shape: "M", meaning: "depths along the camera's axis", gradient: true },
    ],
    outputs: &[Port { name: "x_c", shape: "M,3", meaning: "points in camera space", gradient: true }],
    conventions: &[],
    forward: Pass {
        oracle: pixel_to_camera,
        bound: bound::pixel_to_camera,
        honest: honest::pixel_to_camera,
        wrong: mistakes::pixel_to_camera,
    },
    vjp: Some(Pass {
        oracle: pixel_to_camera_vjp,
        bound: bound::pixel_to_camera_vjp,
        honest: honest::pixel_to_camera_vjp,
        wrong: mistakes::pixel_to_camera_vjp,
    }),
    cases: cases::pixel_to_camera,
    mistakes: mistakes::PIXEL_TO_CAMERA,
};

/// The m-th 4x4 matrix of a flat row-major list.
pub(crate) fn pose(c2w: &[f64], m: usize) -> DMat4 {
    let entries: [f64; 16] = std::array::from_fn(|n| c2w[16 * m + n]);
    DMat4::from_cols_array(&entries).transpose()
}

/// The m-th upper 3x4 of a flat list, row by row.
pub(crate) fn rows34(c2w: &[f64], m: usize) -> [[f64; 4]; 3] {
    std::array::from_fn(|k| std::array::from_fn(|j| c2w[16 * m + 4 * k + j]))
}

/// A gradient of c2w as 16 row-major entries.
pub(crate) fn flat(g: &DMat4) -> [f64; 16] {
    g.transpose().to_cols_array()
}

/// fx, fy, cx, cy of a row-major K.
pub(crate) fn intrinsics(k: &[f64]) -> Intrinsics {
    Intrinsics { fx: k[0], fy: k[4], cx: k[2], cy: k[5] }
}

/// A (3,3) array with four entries: fx, fy, cx, cy.
pub(crate) fn matrix(k: [f64; 4]) -> ndarray::ArrayD<f64> {
    array(&[3, 3], vec![k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 0.0])
}

/// An (M, 3) array in threes.
pub(crate) fn threes(a: &Arrays, name: &str) -> Vec<[f64; 3]> {
    values(a, name).chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect()
}

/// An (M, 2) array in twos.
pub(crate) fn twos(a: &Arrays, name: &str) -> Vec<[f64; 2]> {
    values(a, name).chunks_exact(2).map(|x| [x[0], x[1]]).collect()
}

fn transform(a: &Arrays, _: &Conventions) -> Arrays {
    let (c2w, x_c) = (values(a, "c2w"), threes(a, "x_c"));
    let point = |m: usize| super::transform(&pose(&c2w, m), DVec3::from(x_c[m])).to_array();
    arrays([("x_w", array(&[x_c.len(), 3], (0..x_c.len()).flat_map(point).collect()))])
}

fn transform_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let (c2w, x_c, g) = (values(a, "c2w"), threes(a, "x_c"), threes(a, "grad_x_w"));
    let (mut g_c2w, mut g_x_c) = (vec![], vec![]);
    for m in 0..x_c.len() {
        let (on_c2w, on_x_c) = backward::transform(&pose(&c2w, m), DVec3::from(x_c[m]), DVec3::from(g[m]));
        g_c2w.extend(flat(&on_c2w));
        g_x_c.extend(on_x_c.to_array());
    }
    let points = x_c.len();
    arrays([("grad_c2w", array(&[points, 4, 4], g_c2w)), ("grad_x_c", array(&[points, 3], g_x_c))])
}

fn pixel_to_camera(a: &Arrays, _: &Conventions) -> Arrays {
    let (k, uv, s) = (intrinsics(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    let point = |m: usize| super::pixel_to_camera(&k, DVec2::from(uv[m]), s[m]).to_array();
    arrays([("x_c", array(&[s.len(), 3], (0..s.len()).flat_map(point).collect()))])
}

fn pixel_to_camera_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let (k, uv, s) = (intrinsics(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    let g = threes(a, "grad_x_c");
    let (mut g_k, mut g_uv, mut g_s) = ([0.0; 4], vec![], vec![]);
    for m in 0..s.len() {
        let (on_k, on_uv, on_s) = backward::pixel_to_camera(&k, DVec2::from(uv[m]), s[m], DVec3::from(g[m]));
        let on_k = [on_k.fx, on_k.fy, on_k.cx, on_k.cy];
        (0..4).for_each(|n| g_k[n] += on_k[n]);
        g_uv.extend(on_uv.to_array());
        g_s.push(on_s);
    }
    arrays([
        ("grad_K", matrix(g_k)),
        ("grad_uv", array(&[s.len(), 2], g_uv)),
        ("grad_s", array(&[s.len()], g_s)),
    ])
}
