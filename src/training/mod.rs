//! Training: the optimization loops of the 2D and the 3D experiment, and the files that they write.
//!
//! [`mod@reference`] is the whole step in plain f64; [`model`] the interface of a trainable field; [`run`] the loop over a scene;
//! [`image`] the loop over a picture. [`probe`]: what a trained field holds in space.

pub mod checkpoint;
pub mod compact;
pub mod fit;
pub mod foreign;
pub mod identity;
pub mod image;
mod log;
pub mod model;
pub mod nerf;
pub mod outlook;
mod pace;
pub mod probe;
pub mod rate;
pub mod reference;
pub mod run;
pub mod schedule;
pub(crate) mod sound;
pub mod watch;

pub use model::{Model, Pixel, StepReport};
