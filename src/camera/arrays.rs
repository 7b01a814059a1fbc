//! The camera on named arrays: row-major on one side, glam's column-major matrices on the other.

use glam::{DMat4, DVec2, DVec3};

use super::{Intrinsics, backward};
use crate::contract::arrays::{Arrays, array, arrays, threes, twos, values};
use crate::convention::{Axes, Conventions};

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

pub(super) fn transform(a: &Arrays, _: &Conventions) -> Arrays {
    let (c2w, x_c) = (values(a, "c2w"), threes(a, "x_c"));
    let point = |m: usize| super::transform(&pose(&c2w, m), DVec3::from(x_c[m])).to_array();
    arrays([("x_w", array(&[x_c.len(), 3], (0..x_c.len()).flat_map(point).collect()))])
}

pub(super) fn transform_vjp(a: &Arrays, _: &Conventions) -> Arrays {
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

/// Points (M, 3), or their cotangents, in the axes of the convention: OpenGL's y and z are the other way round.
pub(super) fn in_axes(mut a: Arrays, name: &str, c: &Conventions) -> Arrays {
    if c.camera_axes == Axes::Opengl {
        let points = a.get_mut(name).expect("points");
        points.indexed_iter_mut().filter(|(i, _)| i[1] > 0).for_each(|(_, x)| *x = -*x);
    }
    a
}

pub(super) fn pixel_to_camera(a: &Arrays, c: &Conventions) -> Arrays {
    let (k, uv, s) = (intrinsics(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    let point = |m: usize| super::pixel_to_camera(&k, DVec2::from(uv[m]), s[m]).to_array();
    in_axes(arrays([("x_c", array(&[s.len(), 3], (0..s.len()).flat_map(point).collect()))]), "x_c", c)
}

pub(super) fn pixel_to_camera_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let a = &in_axes(a.clone(), "grad_x_c", c);
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
