//! Honest traces in emulated arithmetic: honest rows one after the other.

use super::chain::{chain, without_backdrop};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// Traces all pixels, from position to color.
pub(crate) fn render_trace(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let c = &without_backdrop(c);
    let stretch = |delta, d: [f64; 3]| m.mul(delta, m.sqrt(m.dot(&d, &d)));
    chain(a, c, |component, a| (component.forward.honest)(a, c, m), stretch)
}
