//! Traces, wrong on purpose: the rows' mistakes, and those that sit at the call between two rows.

use super::chain::chain;
use crate::convention::{Conventions, Delta, LastDelta};
use crate::verify::component::{Arrays, Mistake, number};

/// Mistakes at the call; each row brings its own besides, by name.
pub const RENDER_TRACE: &[Mistake] = &[
    Mistake::new(
        "jitter_ignored",
        "u is ignored: the samples of training rest in the middle of their intervals",
        "stripes, and detail that the grid can't see",
        "draw u anew for every ray and every sample in training",
        "3 public implementations",
        3,
    ),
    Mistake::new(
        "steps_of_rest",
        "steps are differences of t, but of the grid before the jitter moved it",
        "densities are learned for steps that the samples don't have",
        "take the differences of the positions that are used",
        "hand-written samplers",
        0,
    ),
];

/// The whole way from the pixel to its colour, with mistakes at the call or in any of its rows.
pub fn render_trace(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    let mut c = *c;
    let rest = wrong.contains(&"steps_of_rest").then(|| a["u"].mapv(|_| 0.5));
    if wrong.contains(&"jitter_ignored") {
        a.get_mut("u").expect("checked").fill(0.5);
    }
    if rest.is_some() {
        (c.delta, c.last_delta) = (Delta::Differences, LastDelta::Repeated);
    }
    chain(&a, |component, arrays| {
        let mut arrays = arrays.clone();
        if let (Some(rest), "step_sizes") = (&rest, component.name) {
            let t = crate::sample::sample_along_ray(
                number(&a, "near"),
                number(&a, "far"),
                &vec![0.5; rest.shape()[2]],
                c.grid,
            );
            arrays.get_mut("t").expect("checked").indexed_iter_mut().for_each(|(i, value)| *value = t[i[1]]);
        }
        (component.forward.wrong)(&arrays, &c, wrong)
    })
}
