//! The networks in f32, for training and rendering: the same functions and gradients as the oracle, about 10^5 times as fast.
//!
//! What makes them fast, and what it costs in accuracy:
//!
//! * **Batched layers.** A layer of many points is one matrix product (`gemm`); bias, ReLU and masks are one pass over the
//!   result while it is in the cache. Chunks of [`CHUNK`] points keep the activations small. Costs nothing.
//! * **Whole chunks on one thread each.** Forward, rendering, loss and backward of a chunk follow each other, so that nothing
//!   of it is stored; partial gradients are added up in a fixed order. The same bits on any number of threads.
//! * **Folded feature.** No activation stands between the feature layer and the color layer, so their product
//!   M = w_color w_feature is formed once a step, and a point costs (128, 256) instead of (256, 256) and (128, 256).
//!   Both gradients follow from that of M: g_color = g_M w_feature^T + g_b b^T, g_feature = w_color^T g_M. Exact, in another
//!   order of summation.
//! * **One direction per ray.** Its columns of the color layer are multiplied once per ray instead of once per sample. Exact.
//! * **No work without effect.** A sample whose density has slope 0, or that stands behind T = 0, has weight 0 and passes no
//!   gradient: its color is not computed, and it takes no part in the backward pass. Exact; `dense: true` computes it
//!   anyway, for measurements.
//! * **No work in empty space.** [`Skipping`] leaves out samples that an occupancy grid calls empty, before they are evaluated, and
//!   those after the early stop. Costs what the grid misses, and at most `stop` per color.
//!
//! Conventions are those of the profile `cs180`, with any density activation.

pub(crate) mod activation;
mod chunk;
mod descent;
mod gradient;
mod image;
mod network;
pub(crate) mod passes;
pub(crate) mod product;
mod rays;
mod skipping;
mod trunk;

#[cfg(test)]
mod tests;

pub use gradient::Gradient;
pub use image::ImageNetwork;
pub use network::{Batch, Network};
pub use product::{sgemm, sgemm_layer};
pub use rays::{Rays, Rendered};
pub use skipping::Skipping;

/// Points that pass through the layers together (whole rays; one ray where it has more samples).
pub const CHUNK: usize = 512;
