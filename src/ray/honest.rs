//! Honest implementations of rays in emulated arithmetic: what the bound must never reject.

use super::arrays::{picture, positions};
use crate::camera::Intrinsics;
use crate::camera::arrays::{intrinsics, rows34};
use crate::camera::honest::{Gather, dot, inverse, point, pose_gradient, rotate_transposed, transformed};
use crate::contract::arrays::{Arrays, array, arrays, threes, twos, values};
use crate::contract::machine::Machine;
use crate::convention::{Axes, Conventions, Directions};

/// One ray: what R is applied to, what is divided, by which norm, the quotient, and the direction.
struct RayDirection {
    camera: [f64; 3],
    r: [f64; 3],
    norm: f64,
    unit: [f64; 3],
    d: [f64; 3],
}

fn direction(
    k: &Intrinsics,
    rows: &[[f64; 4]; 3],
    uv: [f64; 2],
    c: &Conventions,
    m: &Machine,
) -> RayDirection {
    let mut camera = point(k, uv, 1.0, m);
    if c.axes == Axes::Opengl {
        camera = [camera[0], -camera[1], -camera[2]];
    }
    if c.directions == Directions::UnitInCamera {
        let (unit, norm) = divided(camera, m);
        return RayDirection { camera: unit, r: camera, norm, unit, d: rotated(rows, unit, m) };
    }
    let r = if m.stable && m.form % 3 == 2 {
        multiplied_first(k, rows, uv, c, m)
    } else {
        rotated(rows, camera, m)
    };
    if c.directions == Directions::Depth {
        return RayDirection { camera, r, norm: 1.0, unit: r, d: r };
    }
    let (unit, norm) = divided(r, m);
    RayDirection { camera, r, norm, unit, d: unit }
}

/// R d_c; in the textbook form two points, and their difference.
fn rotated(rows: &[[f64; 4]; 3], camera: [f64; 3], m: &Machine) -> [f64; 3] {
    if m.stable {
        return rows.map(|row| dot(&row[..3], &camera, m));
    }
    let x_w = transformed(rows, &camera, m);
    std::array::from_fn(|n| m.sub(x_w[n], rows[n][3]))
}

/// r / |r|, and |r|.
fn divided(r: [f64; 3], m: &Machine) -> ([f64; 3], f64) {
    let norm = m.sqrt(dot(&r, &r, m));
    let unit =
        if m.form % 2 == 0 { r.map(|r| m.div(r, norm)) } else { r.map(|r| m.mul(r, m.div(1.0, norm))) };
    (unit, norm)
}

/// (R K^-1) (u, v, 1).
fn multiplied_first(
    k: &Intrinsics,
    rows: &[[f64; 4]; 3],
    uv: [f64; 2],
    c: &Conventions,
    m: &Machine,
) -> [f64; 3] {
    let mut inverse = inverse(k, m);
    if c.axes == Axes::Opengl {
        (1..3).for_each(|n| inverse[n] = inverse[n].map(|x| -x));
    }
    rows.map(|row| {
        let product: [f64; 3] =
            std::array::from_fn(|j| dot(&row[..3], &[inverse[0][j], inverse[1][j], inverse[2][j]], m));
        dot(&product, &[uv[0], uv[1], 1.0], m)
    })
}

/// Pixel to ray.
pub(crate) fn pixel_to_ray(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (k, c2w, uv) = (intrinsics(&values(a, "K")), values(a, "c2w"), twos(a, "uv"));
    let origin = |n: usize| rows34(&c2w, n).map(|row| row[3]);
    let rays_d = (0..uv.len()).flat_map(|n| direction(&k, &rows34(&c2w, n), uv[n], c, m).d).collect();
    arrays([
        ("rays_o", array(&[uv.len(), 3], (0..uv.len()).flat_map(origin).collect())),
        ("rays_d", array(&[uv.len(), 3], rays_d)),
    ])
}

/// The gradient of r where g is that of r / |r|: the projection over the norm (form 0), or as autograd writes it (1), or with the cube
/// of the norm (2).
fn across(ray: &RayDirection, g: [f64; 3], m: &Machine) -> [f64; 3] {
    let norm = ray.norm;
    match m.form % 3 {
        0 => {
            let along = dot(&ray.unit, &g, m);
            std::array::from_fn(|k| m.div(m.sub(g[k], m.mul(ray.unit[k], along)), norm))
        }
        1 => {
            let terms: [f64; 3] = std::array::from_fn(|k| -m.mul(g[k], m.div(m.div(ray.r[k], norm), norm)));
            let on_norm = m.sum(&terms);
            std::array::from_fn(|k| m.add(m.div(g[k], norm), m.mul(m.div(ray.r[k], norm), on_norm)))
        }
        _ => {
            let scaled = m.div(dot(&ray.r, &g, m), m.mul(norm, m.mul(norm, norm)));
            std::array::from_fn(|k| m.sub(m.div(g[k], norm), m.mul(ray.r[k], scaled)))
        }
    }
}

/// Gradient of pixel to ray.
pub(crate) fn pixel_to_ray_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (k, c2w, uv) = (intrinsics(&values(a, "K")), values(a, "c2w"), twos(a, "uv"));
    let (g_o, g_d) = (threes(a, "grad_rays_o"), threes(a, "grad_rays_d"));
    let (mut gather, mut g_c2w, mut g_u, mut g_v) = (Gather::default(), vec![], vec![], vec![]);
    for n in 0..uv.len() {
        let rows = rows34(&c2w, n);
        let ray = direction(&k, &rows, uv[n], c, m);
        let g_r = if c.directions == Directions::Unit { across(&ray, g_d[n], m) } else { g_d[n] };
        let translation = |k: usize| match m.stable {
            true => g_o[n][k],
            // The part through x_w, then the part through -o, which cancels it.
            false => m.sub(m.add(g_o[n][k], g_r[k]), g_r[k]),
        };
        g_c2w.extend(pose_gradient(g_r, ray.camera, std::array::from_fn(translation), m));
        let mut g_camera = rotate_transposed(&rows, g_r, m);
        if c.directions == Directions::UnitInCamera {
            g_camera = across(&ray, g_camera, m);
        }
        let [x, y, z] = g_camera;
        let g_camera = if c.axes == Axes::Opengl { [x, -y, -z] } else { [x, y, z] };
        let (g_uv, _) = gather.pixel(&k, uv[n], 1.0, g_camera, m);
        g_u.push(g_uv[0]);
        g_v.push(g_uv[1]);
    }
    let g_uv = g_u.iter().zip(&g_v).flat_map(|(&u, &v)| [u, v]).collect();
    arrays([
        ("grad_K", gather.k(&k, [&g_u, &g_v], m)),
        ("grad_c2w", array(&[uv.len(), 4, 4], g_c2w)),
        ("grad_uv", array(&[uv.len(), 2], g_uv)),
    ])
}

/// The rays of a picture.
pub(crate) fn image_rays(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (height, width, k, _) = picture(a);
    let k = Intrinsics { fx: m.round(k.fx), fy: m.round(k.fy), cx: m.round(k.cx), cy: m.round(k.cy) };
    let rows = rows34(&values(a, "c2w"), 0);
    let uv: Vec<[f64; 2]> = positions(a, c).iter().map(|uv| uv.to_array().map(|x| m.round(x))).collect();
    let rays_o = uv.iter().flat_map(|_| rows.map(|row| row[3])).collect();
    let rays_d = uv.iter().flat_map(|&uv| direction(&k, &rows, uv, c, m).d).collect();
    arrays([
        ("uv", array(&[height, width, 2], uv.concat())),
        ("rays_o", array(&[height, width, 3], rays_o)),
        ("rays_d", array(&[height, width, 3], rays_d)),
    ])
}
