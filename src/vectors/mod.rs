//! Frozen vectors: every small case with what should come out and how far off an honest answer in f64 and in f32 may be, as files that a
//! project keeps beside its tests and checks without this crate.
//!
//! A case is `valid`, with an answer that a checker must accept, and so whatever lies within `allowed` of it; or `invalid`, with the answer
//! that a known mistake gives, which a checker must reject: that is how a checker is itself checked. What isn't there is said by name, with
//! its reason: statistics of samplers, of which no single answer is the right one, and networks of full size.
//!
//! The same version of this crate writes the same bytes every time: no dates, no compression, arrays in the order of their names.

mod index;
mod lines;
mod release;
mod sums;
mod verify;

pub use index::{Case, Flag, Index, Outcome, Port, Row, SCHEMA};
pub use release::{LARGEST, Release};
pub use verify::{Verified, verify};
