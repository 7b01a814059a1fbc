//! Registry row of rays in normalized device coordinates.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// Rays of forward-facing cameras, in the cube of one view.
pub(crate) const NDC_RAYS: Component = Component {
    name: "ndc_rays",
    folder: "ndc",
    code: include_str!("honest.rs"),
    formula: "p = o + t d at depth near; o' = (2f/W p_x/near, 2f/H p_y/near, -1), d' = (2f/W (d_x/|d_z| - p_x/near), 2f/H (d_y/|d_z| - p_y/near), 2)",
    source: "NeRF (Mildenhall et al. 2020), appendix C, equations 25 and 26",
    inputs: &[
        Port::smooth("rays_o", "R,3", "origins"),
        Port::smooth("rays_d", "R,3", "directions, as they come, not across the axis (d_z = 0)"),
        Port::plain("width", "", "width of the picture, in pixels"),
        Port::plain("height", "", "height of the picture, in pixels"),
        Port::plain("focal", "", "focal length, in pixels"),
        Port::plain("near", "", "depth of the near plane"),
    ],
    outputs: &[
        Port::smooth("rays_o_ndc", "R,3", "where rays meet the near plane, z = -1"),
        Port::smooth("rays_d_ndc", "R,3", "from there to where they meet infinity, z = 2; not unit"),
    ],
    conventions: &["ndc_depth"],
    forward: Direction {
        oracle: arrays::ndc_rays,
        bound: bound::ndc_rays,
        honest: honest::ndc_rays,
        wrong: mistakes::ndc_rays,
    },
    vjp: Some(Direction {
        oracle: arrays::ndc_rays_vjp,
        bound: bound::ndc_rays_vjp,
        honest: honest::ndc_rays_vjp,
        wrong: mistakes::ndc_rays_vjp,
    }),
    cases: cases::ndc_rays,
    mistakes: mistakes::NDC_RAYS,
    special: Special { large: cases::large, ..Special::NONE },
};
