//! Registry rows of rays.

use glam::{DMat4, DVec2, DVec3};

use super::{Ray, backward, bound, cases, honest, mistakes, pixel_position};
use crate::camera::Intrinsics;
use crate::camera::component::{C2W, K, UV, flat, intrinsics, matrix, pose, threes, twos};
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, number, values};
use crate::convention::Conventions;

/// The ray through a pixel.
pub const PIXEL_TO_RAY: Component = Component {
    name: "pixel_to_ray",
    folder: "ray",
    formula: "o = translation of c2w, d = R K^-1 (u, v, 1) / |R K^-1 (u, v, 1)|",
    source: "NeRF (Mildenhall et al. 2020) section 4; CS180 project 4, part 2.1",
    inputs: &[K, C2W, UV],
    outputs: &[
        Port { name: "rays_o", shape: "M,3", meaning: "origins, world space", gradient: true },
        Port { name: "rays_d", shape: "M,3", meaning: "directions, world space", gradient: true },
    ],
    conventions: &["axes", "directions"],
    forward: Pass {
        oracle: pixel_to_ray,
        bound: bound::pixel_to_ray,
        honest: honest::pixel_to_ray,
        wrong: mistakes::pixel_to_ray,
    },
    vjp: Some(Pass {
        oracle: pixel_to_ray_vjp,
        bound: bound::pixel_to_ray_vjp,
        honest: honest::pixel_to_ray_vjp,
        wrong: mistakes::pixel_to_ray_vjp,
    }),
    cases: cases::pixel_to_ray,
    mistakes: mistakes::PIXEL_TO_RAY,
};

/// The rays of a whole picture.
pub const IMAGE_RAYS: Component = Component {
    name: "image_rays",
    folder: "ray",
    formula: "pixel_to_ray at uv[j, i] = (i + 0.5, j + 0.5), with fx = fy = focal",
    source: "bmild/nerf run_nerf_helpers.py get_rays; CS180 project 4, part 2.2",
    inputs: &[
        Port { name: "height", shape: "", meaning: "rows of pixels", gradient: false },
        Port { name: "width", shape: "", meaning: "columns of pixels", gradient: false },
        Port { name: "focal", shape: "", meaning: "focal length in pixels", gradient: false },
        Port { name: "cx", shape: "", meaning: "principal point, u", gradient: false },
        Port { name: "cy", shape: "", meaning: "principal point, v", gradient: false },
        Port { name: "c2w", shape: "4,4", meaning: "camera to world", gradient: false },
    ],
    outputs: &[
        Port { name: "uv", shape: "H,W,2", meaning: "pixel positions", gradient: false },
        Port { name: "rays_o", shape: "H,W,3", meaning: "origins", gradient: false },
        Port { name: "rays_d", shape: "H,W,3", meaning: "directions", gradient: false },
    ],
    conventions: &["axes", "pixel_center", "directions"],
    forward: Pass {
        oracle: image_rays,
        bound: bound::image_rays,
        honest: honest::image_rays,
        wrong: mistakes::image_rays,
    },
    vjp: None,
    cases: cases::image_rays,
    mistakes: mistakes::IMAGE_RAYS,
};

fn pixel_to_ray(a: &Arrays, c: &Conventions) -> Arrays {
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

fn pixel_to_ray_vjp(a: &Arrays, c: &Conventions) -> Arrays {
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

/// Positions of all pixels, row by row.
pub(crate) fn positions(a: &Arrays, c: &Conventions) -> Vec<DVec2> {
    let (height, width, ..) = picture(a);
    (0..height * width).map(|n| pixel_position(n % width, n / width, c.pixel_center)).collect()
}

fn image_rays(a: &Arrays, c: &Conventions) -> Arrays {
    let (height, width, k, c2w) = picture(a);
    let uv = positions(a, c);
    let ray = |uv: &DVec2| super::pixel_to_ray(&k, &c2w, *uv, c.axes, c.directions);
    let mut out = bundle(&uv.iter().map(ray).collect::<Vec<_>>(), &[height, width, 3]);
    let uv = uv.iter().flat_map(|uv| uv.to_array()).collect();
    out.insert("uv".into(), array(&[height, width, 2], uv));
    out
}
