//! Registry row of packed rendering with early stop.
//!
//! Around the oracle, a ray with n live samples is a ray of n samples of `volume_render`: its bound and its honest forms are used here.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::{Form, Special};

/// Functions that never stop, or at a threshold of their own.
const FORMS: &[Form] = &[Form {
    without: &["eps"],
    takes: None,
    meaning: "0, or the function's own, up to 0.05: nothing stops",
    holds: arrays::nothing_stops,
}];

/// Packed rays, each as far as light comes through.
pub(crate) const EARLY_STOP: Component = Component {
    name: "early_stop",
    folder: "early_stop",
    code: include_str!("honest.rs"),
    formula: "ray r has samples offsets_r, ..., offsets_{r+1} - 1; live_r = up to and with the first behind which T < eps; volume_render of these, not renormalized",
    source: "Instant-NGP (Mueller et al. 2022) appendix C.1, without its division by the opacity",
    inputs: &[
        Port::smooth("sigmas", "S", "densities of all rays' samples, 1 / length"),
        Port::smooth("rgbs", "S,3", "colors"),
        Port::smooth("deltas", "S", "step lengths"),
        Port::plain("offsets", "R+1", "where each ray's samples begin, and S; whole numbers"),
        Port::plain("eps", "", "smallest transmittance that is followed; 0: never stop"),
    ],
    outputs: &[
        Port::plain("live", "R", "samples used of each ray, the last one included"),
        Port::smooth("colors", "R,3", "sum of w c over the live samples"),
        Port::smooth("weights", "S", "T alpha, 0 behind the last live sample"),
        Port::smooth("opacity", "R", "sum of w"),
        Port::smooth("transmittance", "R", "T behind the last live sample"),
    ],
    conventions: &["stop", "stopped"],
    forward: Direction {
        oracle: arrays::early_stop,
        bound: bound::early_stop,
        honest: honest::early_stop,
        wrong: mistakes::early_stop,
    },
    vjp: Some(Direction {
        oracle: arrays::early_stop_vjp,
        bound: bound::early_stop_vjp,
        honest: honest::early_stop_vjp,
        wrong: mistakes::early_stop_vjp,
    }),
    cases: cases::early_stop,
    mistakes: mistakes::EARLY_STOP,
    special: Special { forms: FORMS, large: cases::large, ..Special::NONE },
};
