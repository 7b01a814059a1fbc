//! # nerf-oracle
//!
//! The reference that neural radiance field implementations are checked against.
//!
//! # Two examples
//!
//! The oracle: a component in plain f64, as the paper has it.
//!
//! ```
//! use nerf_oracle::{convention::ProductEps, volume_rendering::volume_render};
//!
//! let ln2 = std::f64::consts::LN_2;
//! let ray = volume_render(&[ln2, ln2, 0.0, ln2], &[[1.0, 0.5, 0.0]; 4], &[1.0; 4], ProductEps::None);
//! assert_eq!(ray.weights, [0.5, 0.25, 0.0, 0.125]);
//! assert_eq!(ray.color, [0.875, 0.4375, 0.0]);
//! ```
//!
//! The judge: a kernel of yours inside your `cargo test`. It is asked the hard cases, and may be off by what honest arithmetic in its
//! type can cost, element by element. Where it is wrong, the panic shows the worst element and names the mistake that explains the
//! numbers. Every component has such a front door in its module: `judge(...)`, and the module `judge` with the others.
//!
//! ```
//! use nerf_oracle::volume_rendering;
//!
//! /// Your kernel, in f32.
//! fn render(sigmas: &[f64], rgbs: &[[f64; 3]], deltas: &[f64]) -> [f32; 3] {
//!     let (mut color, mut through) = ([0f32; 3], 1f32);
//!     for i in 0..sigmas.len() {
//!         let x = -(sigmas[i] as f32 * deltas[i] as f32);
//!         (0..3).for_each(|a| color[a] -= through * x.exp_m1() * rgbs[i][a] as f32);
//!         through *= x.exp();
//!     }
//!     color
//! }
//!
//! # /*
//! #[test]
//! # */
//! fn renders_as_the_paper_says() {
//!     volume_rendering::judge(render).in_f32().assert_pass();
//! }
//! # renders_as_the_paper_says();
//! ```
//!
//! `default-features = false` is all that these need: the oracle and the judge, 31 crates besides this one. The feature `fast` adds the
//! f32 paths, `files` readers and writers (npz, pictures, scenes; the judge's folders of cases and answers), and `cli`, the default, the
//! program with training, evaluation and bench; `serve`, a part of it, live pages.
//!
//! # The map
//!
//! Data flows through the modules in this order:
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
//! Components that save work where a scene is empty or opaque, used by the compact model ([`training::compact`]): [`ray_aabb`], [`occupancy_grid`],
//! [`early_stop`], [`hash_grid`], [`importance_sampling`], [`spherical_harmonics`], [`trunc_exp`]; and [`trace`], all of these
//! steps for one picture, and [`training_step`], all of them forth and back. [`srgb`] is the curve between linear light and a picture file, [`ssim`] how
//! alike two pictures look, [`robust_loss`] has Huber's and Charbonnier's losses, [`contraction`] lays an unbounded scene into
//! a bounded one, [`gaussian_contraction`] its Gaussians, [`ndc`] the view of a camera that looks ahead; [`conical_frustum`] is what a pixel sees of a ray's interval,
//! [`integrated_encoding`] its encoding; [`packed`] has the sums and products of rays of different lengths,
//! [`distortion`] the loss that gathers weights into surfaces, [`interlevel_loss`] the one that keeps proposals around them; [`proposal_pdf`] and
//! [`resample_edges`] draw the next level's intervals from a proposal. [`lens`] and [`fisheye`] bend points as lenses do, and back; [`pose`] reads
//! poses of a structure from motion, [`rigid_motion`] makes them of what refinement learns. Splats: [`gaussian_covariance`] from rotation and
//! scales, [`gaussian_projection`] into a picture, [`gaussian_alpha`] at a pixel, [`gaussian_color`] from a direction. Beside the optimizer:
//! [`loss_scaling`] of f16, [`gradient_clipping`] before its step,
//! [`learning_rate`] from step to step.
//!
//! Rooms, from the ground up: each may import those before it; `tests/architecture` reads this list and fails on anything else.
//!
//! 1. the ground: [`shown`], [`error`], [`limits`], [`math`], [`random`], [`parallel`], [`simd`], [`approximate`], [`convention`]
//!    (the choices that differ between right implementations), [`files`], `process`
//! 2. what a component is, without knowing any: [`contract`]
//! 3. the components: [`lens`], [`fisheye`], [`camera`], [`pose`], [`rigid_motion`], [`ray`], [`sample`], [`encoding`], [`conical_frustum`], [`integrated_encoding`], [`hash_grid`], [`spherical_harmonics`], [`trunc_exp`],
//!    [`field`], [`volume_rendering`], [`packed`], [`early_stop`], [`trace`], [`loss`], [`optimizer`], [`training_step`], [`importance_sampling`], [`ray_aabb`],
//!    [`occupancy_grid`], [`srgb`], [`robust_loss`], [`ssim`], [`contraction`], [`gaussian_contraction`], [`ndc`], [`distortion`], [`interlevel_loss`], [`gaussian_covariance`],
//!    [`gaussian_projection`], [`gaussian_alpha`], [`gaussian_color`], [`loss_scaling`], [`gradient_clipping`], [`learning_rate`],
//!    [`proposal_pdf`], [`resample_edges`]
//! 4. their f32 variants, in each folder's `fast`
//! 5. all of them in a list: [`registry`]
//! 6. verdicts on others: [`judge`]; answers to keep beside one's tests: [`vectors`]
//! 7. the judge behind one component's name and types: `judge.rs` in its folder
//! 8. what our own tests need: [`proof`]
//! 9. photographs and cameras: [`scene`]
//! 10. quality of pictures, and training: [`evaluation`], [`training`]
//! 11. charts, tables and pages: `report`
//! 12. speed against error: [`bench`]
//! 13. a class, by a rubric: `grading`
//! 14. a run as a live page: `serve`
//! 15. the program: [`cli`]
//!
//! A component is a folder with the same files in it: `mod.rs` is the formula in plain f64, `backward.rs` its
//! vector-Jacobian product written by hand; both are *oracle* files, short enough to check against the paper. `arrays.rs` has the same on
//! named arrays, `bound.rs` how far off an honest implementation may be, `honest.rs` such implementations, `mistakes.rs` wrong ones,
//! `cases.rs` the questions, and `component.rs` puts them together as rows of the registry.

#[cfg(feature = "fast")]
#[doc(hidden)]
pub mod approximate;
pub mod convention;
pub mod error;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod files;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod limits;
pub mod math;
#[doc(hidden)]
pub mod parallel;
#[cfg(feature = "cli")]
pub(crate) mod process;
pub mod random;
#[doc(hidden)]
pub mod shown;
#[cfg(feature = "fast")]
#[doc(hidden)]
pub mod simd;

pub mod contract;

pub mod camera;
pub mod encoding;
pub mod field;
pub mod fisheye;
pub mod lens;
pub mod loss;
pub mod optimizer;
pub mod pose;
pub mod ray;
pub mod rigid_motion;
pub mod sample;
pub mod trace;
pub mod training_step;
pub mod volume_rendering;

pub mod conical_frustum;
pub mod contraction;
pub mod distortion;
pub mod early_stop;
pub mod gaussian_alpha;
pub mod gaussian_color;
pub mod gaussian_contraction;
pub mod gaussian_covariance;
pub mod gaussian_projection;
pub mod gradient_clipping;
pub mod hash_grid;
pub mod importance_sampling;
pub mod integrated_encoding;
pub mod interlevel_loss;
pub mod learning_rate;
pub mod loss_scaling;
pub mod ndc;
pub mod occupancy_grid;
pub mod packed;
pub mod proposal_pdf;
pub mod ray_aabb;
pub mod resample_edges;
pub mod robust_loss;
pub mod spherical_harmonics;
pub mod srgb;
pub mod ssim;
pub mod trunc_exp;

#[doc(hidden)]
pub mod registry;

pub mod judge;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod proof;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod vectors;

#[cfg(feature = "cli")]
pub mod evaluation;
#[cfg(feature = "cli")]
pub mod training;

#[cfg(feature = "cli")]
#[doc(hidden)]
#[allow(missing_debug_implementations, reason = "for the program and the tests alone")]
pub mod bench;
#[cfg(feature = "files")]
pub mod scene;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "cli")]
pub(crate) mod grading;
#[cfg(feature = "cli")]
pub(crate) mod report;
#[cfg(feature = "cli")]
pub(crate) mod serve;

// What the types of this crate are made of.
pub use {glam, ndarray};

pub use error::{Error, Result};
pub use registry::COMPONENTS;

/// The README's examples, compiled and run with the others.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
