//! Honest training steps in emulated arithmetic: honest rows one after the other.

use super::arrays::usual;
use super::chain::chain;
use crate::contract::arrays::Arrays;
use crate::contract::check::Kind;
use crate::contract::component::Component;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// Trains for all steps.
pub(crate) fn training_step(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let c = &usual(c);
    let run = |kind: Kind, component: &Component, a: &Arrays| {
        (component.direction(kind).expect("rows that are differentiated").honest)(a, c, m)
    };
    chain(a, c, &run, &|delta, d: [f64; 3]| m.mul(delta, m.sqrt(m.dot(&d, &d))))
}
