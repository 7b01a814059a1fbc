//! Registry row of a proposal's distribution.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::arrays::{number, rows};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::{Form, Special};

/// What many functions do without.
const FORMS: &[Form] = &[
    Form {
        without: &["edges"],
        takes: None,
        meaning: "none at the place of another: every bin has some width",
        holds: |a, _| rows(a, "edges").iter().all(|edges| edges.windows(2).all(|e| e[0] < e[1])),
    },
    Form {
        without: &["padding"],
        takes: None,
        meaning: "0: nothing is added",
        holds: |a, _| number(a, "padding") == 0.0,
    },
    Form {
        without: &["anneal"],
        takes: None,
        meaning: "1: weights as they are",
        holds: |a, _| number(a, "anneal") == 1.0,
    },
];

/// From weights to shares.
pub(crate) const PROPOSAL_PDF: Component = Component {
    name: "proposal_pdf",
    folder: "proposal_pdf",
    code: include_str!("honest.rs"),
    formula: "p_i = x_i / sum_j x_j, x_i = (w_i + padding)^anneal, 0 of a bin without width",
    source: "mip-NeRF 360 (Barron et al. 2022) equation 18; google-research/multinerf internal/models.py: logits_resample; \
             nerfstudio/model_components/ray_samplers.py ProposalNetworkSampler, PDFSampler",
    inputs: &[
        Port::plain("edges", "R,E", "edges of the N = E - 1 bins of a ray, never falling"),
        Port::plain("weights", "R,N", "weights of the bins, none negative; detached"),
        Port::plain("anneal", "", "the exponent: 0 in the beginning of a training, 1 in its end"),
        Port::plain("padding", "", "added to every weight, or to its power"),
    ],
    outputs: &[Port::plain("pdf", "R,N", "shares of the bins: they add up to 1")],
    conventions: &["anneal_padding", "flat_bins", "histogram_floor"],
    forward: Direction {
        oracle: arrays::proposal_pdf,
        bound: bound::proposal_pdf,
        honest: honest::proposal_pdf,
        wrong: mistakes::proposal_pdf,
    },
    vjp: None,
    cases: cases::proposal_pdf,
    mistakes: mistakes::PROPOSAL_PDF,
    special: Special { forms: FORMS, large: cases::large, ..Special::NONE },
};
