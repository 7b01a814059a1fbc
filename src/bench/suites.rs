//! Every component's suite, in pipeline order. To add a variant: one entry in the component's file in `variants/`.

use super::{Dense, Scaling, Suite, dense};
use crate::bench::variants::{
    encoding, field, hash_grid, occupancy_grid, optimizer, sample, spherical_harmonics, training,
    volume_rendering,
};

/// All suites.
pub const SUITES: &[Suite] = &[
    sample::SUITE,
    encoding::SUITE,
    field::MLP,
    field::NERF_MLP,
    hash_grid::SUITE,
    spherical_harmonics::SUITE,
    occupancy_grid::SUITE,
    volume_rendering::SUITE,
    optimizer::SUITE,
    training::SUITE,
];

/// The networks whose dense layers are measured.
pub const DENSE: &[Dense] = &[dense::nerf_mlp::DENSE, dense::compact::DENSE];

/// Time and memory against size, of all components.
pub fn scalings() -> Vec<Scaling> {
    [
        encoding::SCALING,
        field::SCALING,
        hash_grid::SCALING,
        occupancy_grid::SCALING,
        volume_rendering::SCALING,
        optimizer::SCALING,
    ]
    .concat()
}
