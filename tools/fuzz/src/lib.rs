//! Readers of bytes that nobody vouches for. `cargo fuzz run --fuzz-dir tools/fuzz --sanitizer none npz`; tests/fuzzed.rs of the crate
//! replays the corpora.

pub mod readers;
