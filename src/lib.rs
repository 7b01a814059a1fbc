//! # nerf-oracle
//!
//! The reference that neural radiance field implementations are checked against.
//!
//! Read this file top to bottom and you know the house. Data flows, and modules stand, in this order:
//!
//! | stage | module | what it does |
//! |---|---|---|
//! | camera | [`camera`] | pixel -> camera space -> world space |
//! | ray | [`ray`] | pixel -> origin and direction; random rays of a training set |
//! | sample | [`sample`] | positions t along a ray, step lengths delta |
//! | encoding | [`encoding`] | x -> x, sin 2^k pi x, cos 2^k pi x |
//! | field | [`field`] | encoded position and direction -> density sigma and color |
//! | volume rendering | [`volume_rendering`] | densities and colors along a ray -> one color |
//! | loss | [`loss`] | colors against photographs |
//! | optimizer | [`optimizer`] | gradients -> new parameters |
//! | training | [`training`] | the loop around all of this, in 3D and in 2D |
//! | evaluation | [`evaluation`] | whole pictures, and how far they are from photographs |
//!
//! Components that let work follow the scene, used by the compact model ([`training::compact`]): [`ray_aabb`], [`occupancy_grid`],
//! [`early_stop`], [`hash_grid`], [`importance_sampling`], [`spherical_harmonics`], [`trunc_exp`]; and [`trace`], the whole way of a pixel at once.
//!
//! Around the pipeline: [`scene`] reads cameras and photographs, [`contract`] says what a component is, [`judge`] gives verdicts on
//! others, [`proof`] is what our own tests need, [`bench`] measures speed against error,
//! [`convention`] the choices that differ between right implementations, [`math`], [`random`] and [`parallel`] what makes
//! results the same everywhere, [`simd`] what vector code shares, [`report`] and [`files`] what is written, [`cli`] the program.
//!
//! A component is a folder with the same files in it: `mod.rs` is the formula in plain f64, `backward.rs` its
//! vector-Jacobian product written by hand; both are *oracle* files, short enough to check against the paper.

#[cfg(feature = "fast")]
pub mod approximate;
pub mod convention;
pub mod error;
#[cfg(feature = "files")]
pub mod files;
pub mod math;
pub mod parallel;
pub mod random;
#[cfg(feature = "fast")]
pub mod simd;

pub mod contract;

pub mod camera;
pub mod encoding;
pub mod field;
pub mod loss;
pub mod optimizer;
pub mod ray;
pub mod sample;
pub mod trace;
pub mod volume_rendering;

pub mod early_stop;
pub mod hash_grid;
pub mod importance_sampling;
pub mod occupancy_grid;
pub mod ray_aabb;
pub mod spherical_harmonics;
pub mod trunc_exp;

pub mod registry;

pub mod judge;
#[cfg(feature = "files")]
pub mod proof;

#[cfg(feature = "cli")]
pub mod evaluation;
#[cfg(feature = "cli")]
pub mod training;

#[cfg(feature = "cli")]
pub mod bench;
#[cfg(feature = "files")]
pub mod scene;

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "cli")]
pub mod report;

pub use error::{Error, Result};
pub use registry::COMPONENTS;
