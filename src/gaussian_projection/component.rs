//! Registry row of a Gaussian's projection.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::Special;

/// A Gaussian in a picture.
pub(crate) const GAUSSIAN_PROJECTION: Component = Component {
    name: "gaussian_projection",
    folder: "gaussian_projection",
    code: include_str!("honest.rs"),
    formula: "t = R mean + translation; (fx t_x/t_z + cx, fy t_y/t_z + cy); J R Sigma R^T J^T + 0.3 with t_x/t_z clamped in J; its inverse; \
              ceil(3 sqrt(lambda)); sqrt(det before / det after the dilation)",
    source: "Zwicker et al. 2001, EWA Volume Splatting; 3D Gaussian Splatting (Kerbl et al. 2023), equation 5, and its rasterizer",
    inputs: &[
        Port::smooth("means", "M,3", "means, in front of the camera"),
        Port::smooth("covariances", "M,6", "upper triangles, row by row: xx, xy, xz, yy, yz, zz"),
        Port::plain("w2c", "4,4", "from the world to the camera's axes: x right, y down, z forward"),
        Port::plain("K", "3,3", "fx, fy, cx, cy"),
        Port::plain("width", "", "width of the picture, in pixels"),
        Port::plain("height", "", "height of the picture, in pixels"),
    ],
    outputs: &[
        Port::smooth("means2d", "M,2", "means in the picture, in pixels"),
        Port::smooth("covariances2d", "M,3", "xx, xy, yy, with the dilation"),
        Port::smooth("conics", "M,3", "the inverse of that: xx, xy, yy"),
        Port::smooth("depths", "M", "along the camera's axis"),
        Port::plain("radii", "M", "pixels that a splat reaches").of(Entries::Count),
        Port::smooth("compensations", "M", "factor of the opacity for the light that the dilation adds"),
    ],
    conventions: &[
        "splat_center",
        "splat_dilation",
        "splat_clamp",
        "splat_clamp_gradient",
        "radius_floor",
        "compensation_floor",
        "splat_culling",
    ],
    forward: Direction {
        oracle: arrays::projection,
        bound: bound::projection,
        honest: honest::projection,
        wrong: mistakes::projection,
    },
    vjp: Some(Direction {
        oracle: arrays::projection_vjp,
        bound: bound::projection_vjp,
        honest: honest::projection_vjp,
        wrong: mistakes::projection_vjp,
    }),
    cases: cases::gaussian_projection,
    mistakes: mistakes::GAUSSIAN_PROJECTION,
    special: Special {
        reads: &[
            ("means2d", &["splat_center", "splat_culling"]),
            ("covariances2d", &["splat_dilation", "splat_clamp", "splat_culling"]),
            ("conics", &["splat_dilation", "splat_clamp", "splat_culling"]),
            ("depths", &["splat_culling"]),
            ("radii", &["splat_dilation", "splat_clamp", "radius_floor", "splat_culling"]),
            ("compensations", &["splat_dilation", "splat_clamp", "compensation_floor", "splat_culling"]),
        ],
        large: cases::large,
        laws: Some(mistakes::laws::OF_SPLATS),
        gradient_laws: Some(mistakes::gradient_laws::OF_SPLATS),
        ..Special::NONE
    },
};
