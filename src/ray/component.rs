//! Registry rows of rays.

use super::{arrays, bound, cases, honest, mistakes};
use crate::camera::component::{C2W, K, UV};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Form, Special};

/// The ray through a pixel.
pub(crate) const PIXEL_TO_RAY: Component = Component {
    name: "pixel_to_ray",
    folder: "ray",
    code: include_str!("honest.rs"),
    formula: "o = translation of c2w, d = R K^-1 (u, v, 1) / |R K^-1 (u, v, 1)|",
    source: "NeRF (Mildenhall et al. 2020) section 4; CS180 project 4, part 2.1",
    inputs: &[K, C2W, UV],
    outputs: &[
        Port::smooth("rays_o", "M,3", "origins, world space"),
        Port::smooth("rays_d", "M,3", "directions, world space"),
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
    special: Special { large: cases::large_pixel_to_ray, ..Special::NONE },
};

/// How functions take a picture's lens.
pub(crate) const PICTURE_FORMS: &[Form] = &[
    Form {
        without: &["focal", "cx", "cy"],
        takes: Some("K"),
        meaning: "((focal, 0, cx), (0, focal, cy), (0, 0, 1))",
        holds: |_, _| true,
    },
    Form {
        without: &["cx", "cy"],
        takes: None,
        meaning: "width / 2 and height / 2",
        holds: arrays::centered,
    },
];

/// The rays of a whole picture.
pub(crate) const IMAGE_RAYS: Component = Component {
    name: "image_rays",
    folder: "ray",
    code: include_str!("honest.rs"),
    formula: "pixel_to_ray at uv[j, i] = (i + 0.5, j + 0.5), with fx = fy = focal",
    source: "bmild/nerf run_nerf_helpers.py get_rays; CS180 project 4, part 2.2",
    inputs: &[
        Port::plain("height", "", "rows of pixels").of(Entries::Count),
        Port::plain("width", "", "columns of pixels").of(Entries::Count),
        Port::plain("focal", "", "focal length in pixels"),
        Port::plain("cx", "", "principal point, u"),
        Port::plain("cy", "", "principal point, v"),
        Port::plain("c2w", "4,4", "camera to world"),
    ],
    outputs: &[
        Port::plain("uv", "H,W,2", "pixel positions").of(Entries::Pixel),
        Port::plain("rays_o", "H,W,3", "origins"),
        Port::plain("rays_d", "H,W,3", "directions"),
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
    special: Special {
        forms: PICTURE_FORMS,
        large: cases::large_image_rays,
        laws: Some(mistakes::laws::OF_PICTURES),
        ..Special::NONE
    },
};
