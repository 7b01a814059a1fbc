//! Registry row of new edges.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// From a histogram to new intervals.
pub(crate) const RESAMPLE_EDGES: Component = Component {
    name: "resample_edges",
    folder: "resample_edges",
    code: include_str!("honest.rs"),
    formula: "c_i = F^-1(u_i); t_i = (c_{i-1} + c_i) / 2, t_0 = max(e_0, 2 c_0 - t_1), t_M = min(e_N, 2 c_{M-1} - t_{M-1})",
    source: "google-research/multinerf internal/stepfun.py sample_intervals; nerfacc/cuda/csrc/pdf.cu compute_intervels_kernel; \
             nerfstudio/model_components/ray_samplers.py PDFSampler",
    inputs: &[
        Port::plain("edges", "R,E", "edges of the N = E - 1 bins of a ray, never falling"),
        Port::plain("weights", "R,N", "weights of the bins, not normalized; detached"),
        Port::plain("u", "R,M", "numbers in [0, 1], ascending: jittered, or (i + 1/2) / M"),
    ],
    outputs: &[Port::plain(
        "t",
        "R,M+1",
        "edges of the new intervals; M where they are samples, E more with the old ones",
    )],
    conventions: &["edges_from", "old_edges"],
    forward: Direction {
        oracle: arrays::resample_edges,
        bound: bound::resample_edges,
        honest: honest::resample_edges,
        wrong: mistakes::resample_edges,
    },
    vjp: None,
    cases: cases::resample_edges,
    mistakes: mistakes::RESAMPLE_EDGES,
    special: Special { large: cases::large, ..Special::NONE },
};
