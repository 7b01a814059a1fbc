//! Lenses: where a lens bends what a pinhole would see, and back.
//!
//! Letters: `p` = (x, y) an ideal point, x_c / z_c and y_c / z_c of a point in camera space (OpenCV axes); `target` where it lands on the
//! distorted picture, in the same units; `r^2` = x^2 + y^2.

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub mod distortion;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

#[cfg(test)]
mod tests;

pub use distortion::Distortion;
pub use judge::judge;
