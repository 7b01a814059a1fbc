//! Honest rays in normalized device coordinates, in emulated arithmetic: divided by the z that the moved origin has, or by the near
//! plane's; directions as a difference of slopes, or of two points of the cube; gradients of either.

use super::View;
use super::arrays::{Ray, forward, view, vjp};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// Near plane, 2f/W and 2f/H with the sign of the scene's z, as this machine has them.
fn constants(view: &View, m: &Machine) -> (f64, [f64; 2]) {
    let (sign, twice) = (view.sign(), m.mul(2.0, m.round(view.focal)));
    let scale = |size: f64| {
        let size = m.round(size);
        if m.form % 2 == 0 { m.div(twice, size) } else { m.div(1.0, m.div(size, twice)) }
    };
    (sign * m.round(view.near), [sign * scale(view.width), sign * scale(view.height)])
}

/// t of the near plane, and the point there.
fn moved(o: [f64; 3], d: [f64; 3], plane: f64, m: &Machine) -> (f64, [f64; 3]) {
    let t = m.div(m.sub(plane, o[2]), d[2]);
    let step = |j: usize| if m.fused { m.round(o[j] + t * d[j]) } else { m.add(o[j], m.mul(t, d[j])) };
    let mut p = [0, 1, 2].map(step);
    if m.form % 3 == 2 {
        p[2] = plane;
    }
    (t, p)
}

/// A ray.
fn ndc_ray(o: [f64; 3], d: [f64; 3], view: &View, m: &Machine) -> Ray {
    let (plane, scales) = constants(view, m);
    let (_, p) = moved(o, d, plane, m);
    let depth = m.div(m.mul(2.0, plane), p[2]);
    let first = m.sub(1.0, depth);
    let last = if m.form % 2 == 0 { depth } else { m.sub(1.0, first) };
    let (mut o_ndc, mut d_ndc) = ([first; 3], [last; 3]);
    if m.form % 3 == 1 {
        (o_ndc[2], d_ndc[2]) = (-1.0, 2.0);
    }
    for j in 0..2 {
        let (start, slope) = (m.div(p[j], p[2]), m.div(d[j], d[2]));
        let joined = m.div(m.mul(scales[j], p[j]), p[2]);
        o_ndc[j] = if m.stable { joined } else { m.mul(scales[j], start) };
        d_ndc[j] = match m.form % 3 {
            1 => m.sub(m.mul(scales[j], slope), o_ndc[j]),
            _ => m.mul(scales[j], m.sub(slope, start)),
        };
    }
    (o_ndc, d_ndc)
}

/// Rays.
pub(crate) fn ndc_rays(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |o, d| ndc_ray(o, d, &view(a, c), m))
}

/// By the formula: what the near plane's z passes cancels, and isn't computed.
fn short(o: [f64; 3], d: [f64; 3], (g_o, g_d): Ray, view: &View, m: &Machine) -> Ray {
    let (plane, scales) = constants(view, m);
    let t = m.div(m.sub(plane, o[2]), d[2]);
    let (mut g_ox, mut g_dx) = ([0.0; 3], [0.0; 3]);
    for j in 0..2 {
        g_ox[j] = m.div(m.mul(scales[j], m.sub(g_o[j], g_d[j])), plane);
        g_dx[j] = m.add(m.mul(t, g_ox[j]), m.div(m.mul(scales[j], g_d[j]), d[2]));
    }
    let over = |g: [f64; 3]| -m.div(m.dot(&g[..2], &d[..2]), d[2]);
    (g_ox[2], g_dx[2]) = (over(g_ox), over(g_dx));
    (g_ox, g_dx)
}

/// As automatic differentiation has it, by way of the moved origin's z.
fn long(o: [f64; 3], d: [f64; 3], (g_o, g_d): Ray, view: &View, m: &Machine) -> Ray {
    let (plane, scales) = constants(view, m);
    let (t, p) = moved(o, d, plane, m);
    let square = m.mul(p[2], p[2]);
    let g_start = [0, 1].map(|j| match m.stable {
        true => m.sub(m.mul(scales[j], g_o[j]), m.mul(scales[j], g_d[j])),
        false => m.mul(scales[j], m.sub(g_o[j], g_d[j])),
    });
    let of_depth = m.div(m.mul(m.mul(2.0, plane), m.sub(g_o[2], g_d[2])), square);
    let through = [0, 1].map(|j| -m.div(m.mul(g_start[j], p[j]), square));
    let g_z = m.sum(&[through[0], through[1], of_depth]);
    let g_p = [m.div(g_start[0], p[2]), m.div(g_start[1], p[2]), g_z];
    let shared = m.div(m.dot(&g_p, &d), d[2]);
    let of_slope = [0, 1].map(|j| m.div(m.mul(scales[j], g_d[j]), d[2]));
    let back = [0, 1].map(|j| -m.div(m.mul(of_slope[j], d[j]), d[2]));
    let last = m.sum(&[m.mul(g_z, t), -m.mul(shared, t), back[0], back[1]]);
    let across = [0, 1].map(|j| m.add(m.mul(g_p[j], t), of_slope[j]));
    ([g_p[0], g_p[1], m.sub(g_z, shared)], [across[0], across[1], last])
}

/// Their gradient.
pub(crate) fn ndc_rays_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let pass = if m.form % 3 == 1 { short } else { long };
    vjp(a, |(o, d), g| pass(o, d, g, &view(a, c), m))
}
