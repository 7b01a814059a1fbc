//! Registry row of the integrated encoding.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Only, Special};

/// Integrated positional encoding.
pub(crate) const INTEGRATED_ENCODING: Component = Component {
    name: "integrated_encoding",
    folder: "integrated_encoding",
    code: include_str!("honest.rs"),
    formula: "sin(2^k pi x) e, cos(2^k pi x) e with e = exp(-(2^k pi)^2 v / 2), for k = 0, ..., L - 1",
    source: "mip-NeRF (Barron et al. 2021) equations 11 to 16; google/mipnerf internal/mip.py integrated_pos_enc",
    inputs: &[
        Port::smooth("means", "M,D", "of Gaussians, period 2 in band 0"),
        Port::smooth("variances", "M,D", "diagonals of their covariances"),
        Port::plain("L", "", "number of bands").of(Entries::Count),
    ],
    outputs: &[Port::smooth("encoding", "M,2LD", "the bands; identity, where it is kept")],
    conventions: &["integrated_identity", "identity_place", "frequency", "bands", "columns", "cosine"],
    forward: Direction {
        oracle: arrays::integrated_encoding,
        bound: bound::integrated_encoding,
        honest: honest::integrated_encoding,
        wrong: mistakes::integrated_encoding,
    },
    vjp: Some(Direction {
        oracle: arrays::integrated_encoding_vjp,
        bound: bound::integrated_encoding_vjp,
        honest: honest::integrated_encoding_vjp,
        wrong: mistakes::integrated_encoding_vjp,
    }),
    cases: cases::integrated_encoding,
    mistakes: mistakes::INTEGRATED_ENCODING,
    special: Special {
        columns: Some(("columns", "band_sin_cos")),
        admits: arrays::admits,
        only: Some(Only { input: "means", axis: 1, lengths: &[3], what: "coordinates" }),
        large: cases::large,
        ..Special::NONE
    },
};
