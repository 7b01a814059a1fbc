//! Training: the optimization loops of the 2D and the 3D experiment, and what they leave on disk.
//!
//! [`mod@reference`] is the whole step in plain f64; [`model`] what a trainable field is to the loop; [`run`] the loop over a scene;
//! [`image`] the loop over a picture.

pub mod checkpoint;
pub mod compact;
pub mod image;
pub mod model;
pub mod nerf;
pub mod reference;
pub mod run;
pub mod schedule;

pub use model::{Model, Pixel, StepReport};
