//! What `bench` compares: each component's practical variants with their workload, one file per component.

pub(super) mod encoding;
pub(super) mod field;
pub(super) mod hash_grid;
pub(super) mod occupancy_grid;
pub(super) mod optimizer;
pub(super) mod sample;
pub(super) mod spherical_harmonics;
pub(super) mod training;
pub(super) mod volume_rendering;
