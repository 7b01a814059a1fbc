//! What `bench` compares: each component's practical variants with their workload, one file per component.

pub mod encoding;
pub mod field;
pub mod hash_grid;
pub mod occupancy_grid;
pub mod optimizer;
pub mod sample;
pub mod spherical_harmonics;
pub mod training;
pub mod volume_rendering;
