//! Traces, wrong on purpose: the rows' mistakes, and those that sit at the call between two rows.

use super::chain::chain;
use crate::camera::mistakes as camera;
use crate::convention::Conventions;
use crate::verify::component::{Arrays, Mistake};

/// Mistakes at the call, and some of the rows'; each row brings all of its own besides, by name.
pub const RENDER_TRACE: &[Mistake] = &[
    Mistake::new(
        "jitter_ignored",
        "u is ignored: the samples of training rest in the middle of their intervals",
        "stripes, and detail that the grid can't see",
        "draw u anew for every ray and every sample in training",
        "3 public implementations",
        3,
    ),
    camera::NO_HALF,
    camera::ROW_COLUMN,
    camera::ROTATION_TRANSPOSED,
];

/// The whole way from the pixel to its colour, with mistakes at the call or in any of its rows.
pub fn render_trace(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    if wrong.contains(&"jitter_ignored") {
        a.get_mut("u").expect("checked").fill(0.5);
    }
    chain(&a, |component, arrays| (component.forward.wrong)(arrays, c, wrong))
}
