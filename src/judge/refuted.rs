//! What forward answers say of a gradient's diagnosis: right ones refute whatever would have made them wrong, and wrong ones that are
//! explained whatever else would.

use super::evidence::{Explanation, Suspect};
use super::report::{Report, Row, Verdict};

/// Drops what the forward answers of a component refute; `known` are the mistakes that they showed.
pub(super) fn refuted(diagnosis: &mut Vec<Explanation>, known: &[Suspect], report: &Report, component: &str) {
    let forward = |row: &&Row| row.name == component && row.kind == "forward";
    let Some(forward) = report.rows.iter().find(forward) else { return };
    let whole = |e: &Explanation| e.whole() && e.wrong() && e.slip.is_none();
    let explained = !known.is_empty() && forward.diagnosis.first().is_some_and(whole);
    if forward.verdict == Verdict::Pass || explained {
        diagnosis.retain(|e| !e.of_forward() || shown_by(known, e));
    }
}

/// Whether the forward answers showed what is wrong about the forward function.
fn shown_by(known: &[Suspect], e: &Explanation) -> bool {
    let forward = |name: &str| e.mistakes.iter().any(|m| m.name == name && !m.gradient);
    known.iter().any(|(set, _)| set.iter().any(|name| forward(name)))
}
