//! Registry rows of loss scales.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::arrays::number;
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Form, Special};

/// Scalers with one factor for both.
const ONE_FACTOR: &[Form] = &[Form {
    without: &["backoff_factor"],
    takes: None,
    meaning: "1 / growth_factor",
    holds: |a, _| number(a, "backoff_factor") * number(a, "growth_factor") == 1.0,
}];

/// An update of a loss scale.
pub(crate) const LOSS_SCALE_UPDATE: Component = Component {
    name: "loss_scale_update",
    folder: "loss_scaling",
    code: include_str!("honest.rs"),
    formula: "found_inf: scale backoff_factor, tracker 0; else tracker + 1, and where that is growth_interval scale growth_factor, tracker 0",
    source: "Micikevicius et al. 2018 (Mixed Precision Training), section 3.2; torch.amp.GradScaler.update, _amp_update_scale_",
    inputs: &[
        Port::plain("scale", "", "what the loss is multiplied by"),
        Port::plain("growth_tracker", "", "steps without an overflow since the scale last changed")
            .of(Entries::Count),
        Port::plain("found_inf", "", "1 where a gradient of this step isn't finite, else 0").of(Entries::Bit),
        Port::plain("growth_factor", "", "above 1"),
        Port::plain("backoff_factor", "", "below 1"),
        Port::plain("growth_interval", "", "steps without an overflow after which the scale grows")
            .of(Entries::Count),
    ],
    outputs: &[
        Port::plain("scale_out", "", "the scale of the next step"),
        Port::plain("growth_tracker_out", "", "its tracker").of(Entries::Count),
    ],
    conventions: &["loss_scale_floor", "loss_scale_ceiling"],
    forward: Direction {
        oracle: arrays::loss_scale_update,
        bound: bound::loss_scale_update,
        honest: honest::loss_scale_update,
        wrong: mistakes::loss_scale_update,
    },
    vjp: None,
    cases: cases::loss_scale_update,
    mistakes: mistakes::LOSS_SCALE_UPDATE,
    special: Special { reads: &[("growth_tracker_out", &[])], forms: ONE_FACTOR, ..Special::NONE },
};

/// Gradients without the loss scale.
pub(crate) const UNSCALE_GRADIENTS: Component = Component {
    name: "unscale_gradients",
    folder: "loss_scaling",
    code: include_str!("honest.rs"),
    formula: "g / scale; found_inf = 1 where a g is infinite or NaN: then the step is skipped, and what is in g / scale is open",
    source: "Micikevicius et al. 2018 (Mixed Precision Training), section 3.2; torch.amp.GradScaler.unscale_",
    inputs: &[
        Port::plain("gradients", "P", "of the scaled loss; what has overflowed is infinite or NaN"),
        Port::plain("scale", "", "what the loss was multiplied by"),
    ],
    outputs: &[
        Port::plain("found_inf", "", "1: parameters, moments and the count of steps stay as they are")
            .of(Entries::Bit),
        Port::plain("unscaled", "P", "gradients of the loss, where found_inf is 0"),
    ],
    conventions: &[],
    forward: Direction {
        oracle: arrays::unscale_gradients,
        bound: bound::unscale_gradients,
        honest: honest::unscale_gradients,
        wrong: mistakes::unscale_gradients,
    },
    vjp: None,
    cases: cases::unscale_gradients,
    mistakes: mistakes::UNSCALE_GRADIENTS,
    special: Special::NONE,
};
