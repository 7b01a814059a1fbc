//! Registry row of the sRGB curve.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// Linear light to the values of picture files.
pub(crate) const LINEAR_TO_SRGB: Component = Component {
    name: "linear_to_srgb",
    folder: "srgb",
    code: include_str!("honest.rs"),
    formula: "srgb = 12.92 x for x <= 0.0031308, else 1.055 x^(1/2.4) - 0.055; x >= 0, not clamped above 1",
    source: "IEC 61966-2-1:1999, section 5.2",
    inputs: &[Port::smooth("linear", "M", "linear light, 1 is white, not negative")],
    outputs: &[Port::smooth("srgb", "M", "sRGB values, 1 is white")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::linear_to_srgb,
        bound: bound::linear_to_srgb,
        honest: honest::linear_to_srgb,
        wrong: mistakes::linear_to_srgb,
    },
    vjp: Some(Direction {
        oracle: arrays::linear_to_srgb_vjp,
        bound: bound::linear_to_srgb_vjp,
        honest: honest::linear_to_srgb_vjp,
        wrong: mistakes::linear_to_srgb_vjp,
    }),
    cases: cases::linear_to_srgb,
    mistakes: mistakes::LINEAR_TO_SRGB,
    special: Special { large: cases::large, laws: Some(mistakes::laws::OF_LIGHT), ..Special::NONE },
};
