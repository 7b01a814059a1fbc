//! Registry rows of the robust losses.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

const PREDICTION: Port = Port::smooth("prediction", "...", "rendered colors");
const TARGET: Port = Port::plain("target", "...", "photographed colors");

/// Huber's loss.
pub(crate) const HUBER: Component = Component {
    name: "huber",
    folder: "robust_loss",
    code: include_str!("honest.rs"),
    formula: "mean over entries of d^2 / 2 for |d| <= delta, else delta (|d| - delta / 2); d = prediction - target",
    source: "Huber 1964; torch.nn.functional.huber_loss, and smooth_l1_loss which divides by delta",
    inputs: &[PREDICTION, TARGET, Port::plain("delta", "", "where squares end")],
    outputs: &[Port::smooth("value", "", "the loss")],
    conventions: &["huber_slope", "loss_reduction"],
    forward: Direction {
        oracle: arrays::huber,
        bound: bound::huber,
        honest: honest::huber,
        wrong: mistakes::huber,
    },
    vjp: Some(Direction {
        oracle: arrays::huber_vjp,
        bound: bound::huber_vjp,
        honest: honest::huber_vjp,
        wrong: mistakes::huber_vjp,
    }),
    cases: cases::huber,
    mistakes: mistakes::HUBER,
    special: Special {
        large: cases::large_huber,
        laws: Some(mistakes::huber_laws::OF_HUBER),
        ..Special::NONE
    },
};

/// Charbonnier's loss.
pub(crate) const CHARBONNIER: Component = Component {
    name: "charbonnier",
    folder: "robust_loss",
    code: include_str!("honest.rs"),
    formula: "mean over entries of sqrt(d^2 + eps^2); d = prediction - target",
    source: "Charbonnier et al. 1994; google-research/multinerf internal/train_utils.py compute_data_loss",
    inputs: &[PREDICTION, TARGET, Port::plain("eps", "", "the value at d = 0")],
    outputs: &[Port::smooth("value", "", "the loss")],
    conventions: &["charbonnier_eps", "loss_reduction"],
    forward: Direction {
        oracle: arrays::charbonnier,
        bound: bound::charbonnier,
        honest: honest::charbonnier,
        wrong: mistakes::charbonnier,
    },
    vjp: Some(Direction {
        oracle: arrays::charbonnier_vjp,
        bound: bound::charbonnier_vjp,
        honest: honest::charbonnier_vjp,
        wrong: mistakes::charbonnier_vjp,
    }),
    cases: cases::charbonnier,
    mistakes: mistakes::CHARBONNIER,
    special: Special {
        large: cases::large_charbonnier,
        laws: Some(mistakes::charbonnier_laws::OF_CHARBONNIER),
        ..Special::NONE
    },
};
