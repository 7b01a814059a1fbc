//! Registry rows of packed rays.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::Special;

/// From the ray of each sample to where each ray's samples lie.
pub(crate) const PACK_INFO: Component = Component {
    name: "pack_info",
    folder: "packed",
    code: include_str!("honest.rs"),
    formula: "count_r = the number of samples of ray r, start_r = sum_{q<r} count_q",
    source: "nerfacc (Li et al. 2023), pack_info",
    inputs: &[
        Port::plain("ray_ids", "S", "the ray of each sample, ascending").of(Entries::Count),
        Port::plain("rays", "", "the number of rays, with those that have no samples").of(Entries::Count),
    ],
    outputs: &[
        Port::plain("starts", "R", "a ray's first sample; of an empty ray, the next one's")
            .of(Entries::Count),
        Port::plain("counts", "R", "a ray's number of samples").of(Entries::Count),
    ],
    conventions: &[],
    forward: Direction {
        oracle: arrays::pack_info,
        bound: bound::pack_info,
        honest: honest::pack_info,
        wrong: mistakes::pack_info,
    },
    vjp: None,
    cases: cases::pack_info,
    mistakes: mistakes::PACK_INFO,
    special: Special { large: cases::large_info, ..Special::NONE },
};

/// Running sums and products that begin anew with each ray.
pub(crate) const PACKED_SCAN: Component = Component {
    name: "packed_scan",
    folder: "packed",
    code: include_str!("honest.rs"),
    formula: "over the samples j of i's ray: sum_{j<i} x_j, sum_{j<=i} x_j, prod_{j<i} x_j, prod_{j<=i} x_j",
    source: "nerfacc (Li et al. 2023), exclusive_sum, inclusive_sum, exclusive_prod, inclusive_prod",
    inputs: &[
        Port::smooth("x", "S", "a number for each sample, rays one after the other"),
        Port::plain("offsets", "R+1", "each ray's first sample and, last, S; a ray may have none")
            .of(Entries::Count),
    ],
    outputs: &[
        Port::smooth("exclusive_sum", "S", "0 for a ray's first sample"),
        Port::smooth("inclusive_sum", "S", "with the sample itself"),
        Port::smooth("exclusive_product", "S", "1 for a ray's first sample"),
        Port::smooth("inclusive_product", "S", "with the sample itself"),
    ],
    conventions: &[],
    forward: Direction {
        oracle: arrays::scan,
        bound: bound::scan,
        honest: honest::scan,
        wrong: mistakes::scan,
    },
    vjp: Some(Direction {
        oracle: arrays::scan_vjp,
        bound: bound::scan_vjp,
        honest: honest::scan_vjp,
        wrong: mistakes::scan_vjp,
    }),
    cases: cases::scan,
    mistakes: mistakes::PACKED_SCAN,
    special: Special { large: cases::large_scan, ..Special::NONE },
};

/// Weighted sums over each ray.
pub(crate) const ACCUMULATE_ALONG_RAYS: Component = Component {
    name: "accumulate_along_rays",
    folder: "packed",
    code: include_str!("honest.rs"),
    formula: "sum_i w_i v_i over the samples i of each ray; 0 without samples",
    source: "nerfacc (Li et al. 2023), accumulate_along_rays; NeRF equation 3",
    inputs: &[
        Port::smooth("weights", "S", "weights, rays one after the other"),
        Port::smooth("values", "S,3", "colors, or whatever is weighted"),
        Port::plain("offsets", "R+1", "each ray's first sample and, last, S; a ray may have none")
            .of(Entries::Count),
    ],
    outputs: &[Port::smooth("sums", "R,3", "weighted sums, not divided by the weights' sum")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::accumulate,
        bound: bound::accumulate,
        honest: honest::accumulate,
        wrong: mistakes::accumulate,
    },
    vjp: Some(Direction {
        oracle: arrays::accumulate_vjp,
        bound: bound::accumulate_vjp,
        honest: honest::accumulate_vjp,
        wrong: mistakes::accumulate_vjp,
    }),
    cases: cases::accumulate,
    mistakes: mistakes::ACCUMULATE_ALONG_RAYS,
    special: Special { large: cases::large_accumulate, ..Special::NONE },
};
