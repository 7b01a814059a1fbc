//! Every component's suite, in pipeline order. To add a variant: one entry in the component's `variants.rs`.

use super::{Dense, Scaling, Suite};
use crate::field::fast::variants as field;
use crate::{
    encoding, hash_grid, occupancy_grid, optimizer, sample, spherical_harmonics, training, volume_rendering,
};

/// All suites.
pub const SUITES: &[Suite] = &[
    sample::variants::SUITE,
    encoding::variants::SUITE,
    field::MLP,
    field::NERF_MLP,
    hash_grid::variants::SUITE,
    spherical_harmonics::variants::SUITE,
    occupancy_grid::variants::SUITE,
    volume_rendering::variants::SUITE,
    optimizer::variants::SUITE,
    training::variants::SUITE,
];

/// The networks whose dense layers are measured.
pub const DENSE: &[Dense] = &[crate::field::fast::DENSE, training::compact::DENSE];

/// Time and memory against size, of all components.
pub fn scalings() -> Vec<Scaling> {
    [
        encoding::variants::SCALING,
        field::SCALING,
        hash_grid::variants::SCALING,
        occupancy_grid::variants::SCALING,
        volume_rendering::variants::SCALING,
        optimizer::variants::SCALING,
    ]
    .concat()
}
