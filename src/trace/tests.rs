//! The trace against the components that it consists of.

use super::chain::{chain, plainly};
use super::component::RENDER_TRACE;
use crate::convention::{CHOICES, CS180, Conventions};

/// In every convention, the pixel-by-pixel trace and the chain of rows agree bit for bit.
#[test]
fn a_trace_is_its_rows_one_after_the_other() {
    for key in RENDER_TRACE.conventions {
        let (_, values) = CHOICES.iter().find(|(name, _)| name == key).expect("a convention");
        for value in *values {
            let mut c = CS180.with(key, value).expect("listed");
            if *value == "differences_times_norm" {
                // Directions that are not unit show it.
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

/// Changing a convention that an output is declared not to depend on leaves its bits unchanged, whatever the others are.
#[test]
fn an_output_reads_no_other_conventions() {
    let case = &(RENDER_TRACE.cases)()[2];
    let values = |key: &str| CHOICES.iter().find(|(name, _)| *name == key).expect("a convention").1;
    let mut starts: Vec<Conventions> = vec![CS180];
    for key in RENDER_TRACE.conventions.iter().filter(|key| **key != "product_eps") {
        let with =
            |c: &Conventions| values(key).iter().map(|v| c.with(key, v).expect("listed")).collect::<Vec<_>>();
        starts = starts.iter().flat_map(with).collect();
    }
    for (n, start) in starts.iter().enumerate() {
        let traced = (RENDER_TRACE.forward.oracle)(&case.inputs, start);
        // One convention from each start, in turn.
        let key = RENDER_TRACE.conventions[n % RENDER_TRACE.conventions.len()];
        for value in values(key) {
            let other = start.with(key, value).expect("listed");
            let other = (RENDER_TRACE.forward.oracle)(&case.inputs, &other);
            for (output, _) in RENDER_TRACE.special.reads.iter().filter(|(_, keys)| !keys.contains(&key)) {
                assert_eq!(traced[*output], other[*output], "{output} reads {key} {value}");
            }
        }
    }
}
