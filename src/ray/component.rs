//! Registry rows of rays.

use super::{arrays, bound, cases, honest, mistakes};
use crate::camera::component::{C2W, K, UV};
use crate::contract::component::{Component, Direction, Port};

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
    forward: Direction {
        oracle: arrays::pixel_to_ray,
        bound: bound::pixel_to_ray,
        honest: honest::pixel_to_ray,
        wrong: mistakes::pixel_to_ray,
    },
    vjp: Some(Direction {
        oracle: arrays::pixel_to_ray_vjp,
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
    forward: Direction {
        oracle: arrays::image_rays,
        bound: bound::image_rays,
        honest: honest::image_rays,
        wrong: mistakes::image_rays,
    },
    vjp: None,
    cases: cases::image_rays,
    mistakes: mistakes::IMAGE_RAYS,
};
