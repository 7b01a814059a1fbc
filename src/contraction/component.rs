//! Registry row of the scene contraction.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// All of space into a ball or a cube.
pub(crate) const CONTRACTION: Component = Component {
    name: "contraction",
    folder: "contraction",
    code: include_str!("honest.rs"),
    formula: "x for |x| <= 1, (2 - 1/|x|) x/|x| beyond; which norm, and the scale of the result, by convention",
    source: "mip-NeRF 360 (Barron et al. 2022), equation 10; MERF (Reiser et al. 2023), equation 4",
    inputs: &[Port::smooth("x", "M,3", "points; what is near lies within length 1")],
    outputs: &[Port::smooth(
        "contracted",
        "M,3",
        "where they come to lie, within 2 of the origin, or scaled",
    )],
    conventions: &["contraction_norm", "contraction_range"],
    forward: Direction {
        oracle: arrays::contraction,
        bound: bound::contraction,
        honest: honest::contraction,
        wrong: mistakes::contraction,
    },
    vjp: Some(Direction {
        oracle: arrays::contraction_vjp,
        bound: bound::contraction_vjp,
        honest: honest::contraction_vjp,
        wrong: mistakes::contraction_vjp,
    }),
    cases: cases::contraction,
    mistakes: mistakes::CONTRACTION,
    special: Special { large: cases::large, ..Special::NONE },
};
