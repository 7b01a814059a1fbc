//! Registry row of the positional encoding.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Only, Special};

/// Positional encoding.
pub(crate) const POSITIONAL_ENCODING: Component = Component {
    name: "positional_encoding",
    folder: "encoding",
    code: include_str!("honest.rs"),
    formula: "x, then sin(2^k pi x), cos(2^k pi x) for k = 0, ..., L - 1",
    source: "NeRF (Mildenhall et al. 2020) equation 4",
    inputs: &[
        Port::smooth("x", "M,D", "points, period 2 in band 0"),
        Port::plain("L", "", "number of bands").of(Entries::Count),
    ],
    outputs: &[Port::smooth("encoding", "M,D+2LD", "identity, then the bands")],
    conventions: &["identity", "identity_place", "frequency", "bands", "columns", "cosine"],
    forward: Direction {
        oracle: arrays::encoding,
        bound: bound::positional_encoding,
        honest: honest::positional_encoding,
        wrong: mistakes::positional_encoding,
    },
    vjp: Some(Direction {
        oracle: arrays::encoding_vjp,
        bound: bound::positional_encoding_vjp,
        honest: honest::positional_encoding_vjp,
        wrong: mistakes::positional_encoding_vjp,
    }),
    cases: cases::positional_encoding,
    mistakes: mistakes::POSITIONAL_ENCODING,
    special: Special {
        columns: Some(("columns", "band_sin_cos")),
        admits: arrays::admits,
        only: Some(Only { input: "x", axis: 1, lengths: &[3], what: "coordinates" }),
        large: cases::large,
        laws: Some(mistakes::laws::OF_POINTS),
        ..Special::NONE
    },
};
