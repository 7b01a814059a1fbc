//! What in a component's folder is no oracle file. `tests/refuses` and `tools/mutants.py` read the same lists.

/// Harness and fast variants.
pub(crate) const AROUND: &[&str] = &[
    "arrays",
    "bound",
    "cases",
    "chain",
    "component",
    "fast",
    "honest",
    "judge",
    "mistakes",
    "sampler",
    "statistics",
];

/// Tests, which need nothing of those around them.
pub(crate) const TESTS: &[&str] = &["by_hand", "tests"];

/// Whether a file or folder of this name is an oracle's.
pub(crate) fn is_oracle(name: &str) -> bool {
    !AROUND.contains(&name) && !TESTS.contains(&name)
}
