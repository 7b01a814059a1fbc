//! The oracle of this folder on named arrays, and what turns these into its types and back.

use glam::{DMat4, DVec2, DVec3};

use super::{Ray, backward, pixel_position};
use crate::camera::Intrinsics;
use crate::camera::arrays::{flat, intrinsics, matrix, pose};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, number, threes, twos, values};
use crate::convention::Conventions;

pub(super) fn pixel_to_ray(a: &Arrays, c: &Conventions) -> Arrays {
    let (k, c2w) = (intrinsics(&values(a, "K")), values(a, "c2w"));
    let ray = |(m, uv): (usize, [f64; 2])| {
        super::pixel_to_ray(&k, &pose(&c2w, m), DVec2::from(uv), c.axes, c.directions)
    };
    let rays: Vec<Ray> = twos(a, "uv").into_iter().enumerate().map(ray).collect();
    bundle(&rays, &[rays.len(), 3])
}

/// Origins and directions as arrays.
pub(crate) fn bundle(rays: &[Ray], shape: &[usize]) -> Arrays {
    arrays([
        ("rays_o", array(shape, rays.iter().flat_map(|ray| ray.o.to_array()).collect())),
        ("rays_d", array(shape, rays.iter().flat_map(|ray| ray.d.to_array()).collect())),
    ])
}

pub(super) fn pixel_to_ray_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let (k, c2w, uv) = (intrinsics(&values(a, "K")), values(a, "c2w"), twos(a, "uv"));
    let (g_o, g_d) = (threes(a, "grad_rays_o"), threes(a, "grad_rays_d"));
    let (mut g_k, mut g_c2w, mut g_uv) = ([0.0; 4], vec![], vec![]);
    for m in 0..uv.len() {
        let (g_o, g_d) = (DVec3::from(g_o[m]), DVec3::from(g_d[m]));
        let (pose, uv) = (pose(&c2w, m), DVec2::from(uv[m]));
        let g = backward::pixel_to_ray(&k, &pose, uv, c.axes, c.directions, g_o, g_d);
        let on_k = [g.0.fx, g.0.fy, g.0.cx, g.0.cy];
        (0..4).for_each(|n| g_k[n] += on_k[n]);
        g_c2w.extend(flat(&g.1));
        g_uv.extend(g.2.to_array());
    }
    arrays([
        ("grad_K", matrix(g_k)),
        ("grad_c2w", array(&[uv.len(), 4, 4], g_c2w)),
        ("grad_uv", array(&[uv.len(), 2], g_uv)),
    ])
}

/// A picture's size, lens and pose.
pub(crate) fn picture(a: &Arrays) -> (usize, usize, Intrinsics, DMat4) {
    let focal = number(a, "focal");
    let k = Intrinsics { fx: focal, fy: focal, cx: number(a, "cx"), cy: number(a, "cy") };
    (number(a, "height") as usize, number(a, "width") as usize, k, pose(&values(a, "c2w"), 0))
}

/// Whether the principal point is the middle of the picture.
pub(crate) fn centered(a: &Arrays, _: Dtype) -> bool {
    number(a, "cx") == number(a, "width") / 2.0 && number(a, "cy") == number(a, "height") / 2.0
}

/// Positions of all pixels, row by row.
pub(crate) fn positions(a: &Arrays, c: &Conventions) -> Vec<DVec2> {
    let (height, width, ..) = picture(a);
    (0..height * width).map(|n| pixel_position(n % width, n / width, c.pixel_center)).collect()
}

pub(super) fn image_rays(a: &Arrays, c: &Conventions) -> Arrays {
    let (height, width, k, c2w) = picture(a);
    let uv = positions(a, c);
    let ray = |uv: &DVec2| super::pixel_to_ray(&k, &c2w, *uv, c.axes, c.directions);
    let mut out = bundle(&uv.iter().map(ray).collect::<Vec<_>>(), &[height, width, 3]);
    let uv = uv.iter().flat_map(|uv| uv.to_array()).collect();
    out.insert("uv".into(), array(&[height, width, 2], uv));
    out
}
