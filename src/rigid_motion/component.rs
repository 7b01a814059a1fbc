//! Registry rows of rigid motions.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// Rotation vectors to rotations.
pub(crate) const SO3_EXP: Component = Component {
    name: "so3_exp",
    folder: "rigid_motion",
    code: include_str!("honest.rs"),
    formula: "R = I + sin(theta) / theta K + (1 - cos theta) / theta^2 K^2, K = [w]_x, theta = |w|; at 0 the factors are 1 and 1/2",
    source: "Rodrigues 1840; Murray, Li and Sastry 1994, equation 2.14; nerfstudio/cameras/lie_groups.py exp_map_SO3xR3, BARF camera.py \
             so3_to_SO3",
    inputs: &[Port::smooth("w", "P,3", "rotation vectors: axis times angle in radians")],
    outputs: &[Port::smooth("rotations", "P,3,3", "matrices that turn columns")],
    conventions: &["rotation_clamp"],
    forward: Direction {
        oracle: arrays::so3_exp,
        bound: bound::so3_exp,
        honest: honest::so3_exp,
        wrong: mistakes::so3_exp,
    },
    vjp: Some(Direction {
        oracle: arrays::so3_exp_vjp,
        bound: bound::so3_exp_vjp,
        honest: honest::so3_exp_vjp,
        wrong: mistakes::so3_exp_vjp,
    }),
    cases: cases::so3_exp,
    mistakes: mistakes::SO3_EXP,
    special: Special { large: cases::large_so3, laws: Some(mistakes::laws::OF_ROTATIONS), ..Special::NONE },
};

/// Twists to motions.
pub(crate) const SE3_EXP: Component = Component {
    name: "se3_exp",
    folder: "rigid_motion",
    code: include_str!("honest.rs"),
    formula: "[R, V rho; 0, 0, 0, 1] of a twist (rho, w): R = so3_exp(w), V = I + (1 - cos theta) / theta^2 K + (theta - sin theta) / \
              theta^3 K^2; at 0 the factors are 1/2 and 1/6",
    source: "Murray, Li and Sastry 1994, equation 2.36; Blanco 2010, section 10.1; nerfstudio/cameras/lie_groups.py exp_map_SE3, BARF \
             camera.py se3_to_SE3",
    inputs: &[Port::smooth(
        "twists",
        "P,6",
        "translational and rotational halves: rho in the scene's units, w in radians",
    )],
    outputs: &[Port::smooth("motions", "P,4,4", "matrices for columns, last row 0, 0, 0, 1")],
    conventions: &["twist_order", "twist_translation", "rotation_clamp", "motion_layout"],
    forward: Direction {
        oracle: arrays::se3_exp,
        bound: bound::se3_exp,
        honest: honest::se3_exp,
        wrong: mistakes::se3_exp,
    },
    vjp: Some(Direction {
        oracle: arrays::se3_exp_vjp,
        bound: bound::se3_exp_vjp,
        honest: honest::se3_exp_vjp,
        wrong: mistakes::se3_exp_vjp,
    }),
    cases: cases::se3_exp,
    mistakes: mistakes::SE3_EXP,
    special: Special { large: cases::large_se3, laws: Some(mistakes::laws::OF_TWISTS), ..Special::NONE },
};
