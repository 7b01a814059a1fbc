//! Which types are tried: a few, so that `cargo test` takes minutes, or all of them, as `.ci/run` has it.

/// Whether `NERF_ORACLE_TYPES=all` asks for all of them.
pub(crate) fn all_types() -> bool {
    std::env::var("NERF_ORACLE_TYPES").is_ok_and(|value| value == "all")
}

/// These, or all of those.
pub(crate) fn types<T>(few: &'static [T], all: &'static [T]) -> &'static [T] {
    if all_types() { all } else { few }
}
