//! The trace against the rows that it consists of.

use super::chain::{chain, plainly};
use super::component::RENDER_TRACE;
use crate::convention::{CHOICES, CS180};

/// In every convention, the pixel-by-pixel trace and the chain of rows agree bit for bit.
#[test]
fn a_trace_is_its_rows_one_after_the_other() {
    for key in RENDER_TRACE.conventions {
        let (_, values) = CHOICES.iter().find(|(name, _)| name == key).expect("a convention");
        for value in *values {
            let mut c = CS180.with(key, value).expect("listed");
            if *value == "differences_times_norm" {
                // Directions of other lengths than 1 show it.
                c = c.with("directions", "depth").expect("listed");
            }
            if *key == "last_delta" {
                c = c.with("delta", "differences").expect("listed");
            }
            for case in (RENDER_TRACE.cases)() {
                let traced = (RENDER_TRACE.forward.oracle)(&case.inputs, &c);
                let chained =
                    chain(&case.inputs, &c, |component, a| (component.forward.oracle)(a, &c), plainly);
                assert_eq!(traced, chained, "{key} {value} {}", case.id);
            }
        }
    }
}
