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
//! Around the pipeline: [`scene`] reads cameras and photographs, [`verify`] is the harness that checks and judges,
//! [`convention`] the choices that differ between right implementations, [`math`], [`random`] and [`parallel`] what makes
//! results the same everywhere, [`simd`] what vector code shares, [`report`] and [`files`] what is written, [`cli`] the program.
//!
//! A component is a folder with the same files in it: `mod.rs` is the formula in plain f64, `backward.rs` its
//! vector-Jacobian product written by hand; both are *oracle* files, short enough to check against the paper.

pub mod approximate;
pub mod convention;
pub mod error;
pub mod files;
pub mod math;
pub mod parallel;
pub mod random;
pub mod simd;

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

pub mod evaluation;
pub mod training;

pub mod scene;
pub mod verify;

pub mod cli;
pub mod report;

pub use error::{Error, Result};

use verify::Component;

/// Every component, in pipeline order: the rows of the judging contract. Tests, commands and reports iterate this.
pub const COMPONENTS: &[Component] = &[
    camera::component::TRANSFORM,
    camera::component::PIXEL_TO_CAMERA,
    ray::component::PIXEL_TO_RAY,
    ray::component::IMAGE_RAYS,
    sample::component::SAMPLE_ALONG_RAYS,
    sample::component::STEP_SIZES,
    encoding::component::POSITIONAL_ENCODING,
    field::component::MLP,
    field::component::NERF_MLP,
    hash_grid::component::HASH_GRID,
    spherical_harmonics::component::SPHERICAL_HARMONICS,
    trunc_exp::component::TRUNC_EXP,
    volume_rendering::component::VOLUME_RENDER,
    volume_rendering::component::VOLUME_RENDER_ALPHA,
    volume_rendering::component::COMPOSITE_BACKGROUND,
    volume_rendering::component::DEPTH,
    early_stop::component::EARLY_STOP,
    trace::component::RENDER_TRACE,
    loss::component::MSE,
    loss::component::PSNR,
    loss::component::TO_UINT8,
    optimizer::component::ADAM_STEP,
    importance_sampling::component::IMPORTANCE_SAMPLING,
    ray_aabb::component::RAY_AABB,
    occupancy_grid::component::OCCUPANCY_GRID,
    occupancy_grid::component::GRID_TRAVERSAL,
];
