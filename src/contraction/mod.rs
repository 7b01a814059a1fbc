//! Scene contraction: all of space into a ball or a cube, so that a field of bounded size holds an unbounded scene.
//!
//! Mip-NeRF 360 (Barron et al. 2022), equation 10: what is near stays where it is, what is far comes closer, by the disparity of its
//! distance. Letters: `r` the length of x, in the norm of the convention.

use crate::convention::{ContractionNorm, ContractionRange};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// x for r <= 1, (2 - 1/r) x/r beyond.
///
/// # Shapes
/// A point to a point.
///
/// # Units
/// x in those of the scene, whose near part lies within length 1. A code that knows a box maps it to [-1, 1]^3 first.
///
/// # Convention
/// `norm` says which length, and so which shape space is contracted to: a ball (L2, the paper) or a cube. With [`ContractionNorm::Merf`]
/// the coordinates are contracted one by one: the largest to 2 - 1/r, the others to x/r, so that straight lines away from the origin's
/// cube stay straight. `range` says what the result is scaled to. At r = 1 both pieces agree.
///
/// ```
/// use nerf_oracle::contraction::contract;
/// use nerf_oracle::convention::{ContractionNorm::{L2, Linf, Merf}, ContractionRange::{Two, Unit}};
/// assert_eq!(contract([0.0, 0.5, 0.0], L2, Two), [0.0, 0.5, 0.0]);
/// assert_eq!(contract([0.0, 4.0, 0.0], L2, Two), [0.0, 1.75, 0.0]);
/// assert_eq!(contract([2.0, 4.0, 0.0], Linf, Two), [0.875, 1.75, 0.0]);
/// assert_eq!(contract([2.0, 4.0, 0.0], Merf, Two), [0.5, 1.75, 0.0]);
/// assert_eq!(contract([0.0, 4.0, 0.0], L2, Unit), [0.5, 0.9375, 0.5]);
/// ```
pub fn contract(x: [f64; 3], norm: ContractionNorm, range: ContractionRange) -> [f64; 3] {
    scaled(folded(x, norm), range)
}

/// The contraction, into the ball or cube of radius 2.
fn folded(x: [f64; 3], norm: ContractionNorm) -> [f64; 3] {
    let r = length(x, norm);
    if r <= 1.0 {
        return x;
    }
    if norm == ContractionNorm::Merf {
        let mut y = x.map(|x| x / r);
        y[largest(x)] *= 2.0 - 1.0 / r;
        return y;
    }
    x.map(|x| (2.0 - 1.0 / r) * (x / r))
}

/// What lies within [-2, 2], scaled to the range of the convention.
fn scaled(y: [f64; 3], range: ContractionRange) -> [f64; 3] {
    match range {
        ContractionRange::Two => y,
        ContractionRange::One => y.map(|y| y / 2.0),
        ContractionRange::Unit => y.map(|y| y / 4.0 + 0.5),
    }
}

/// The length of x: the root of the sum of squares, or the largest size of a coordinate.
pub(crate) fn length(x: [f64; 3], norm: ContractionNorm) -> f64 {
    match norm {
        ContractionNorm::L2 => (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt(),
        ContractionNorm::Linf | ContractionNorm::Merf => x[largest(x)].abs(),
    }
}

/// The coordinate of the largest size; the first of them where several tie.
pub(crate) fn largest(x: [f64; 3]) -> usize {
    let mut k = 0;
    for j in 1..3 {
        if x[j].abs() > x[k].abs() {
            k = j;
        }
    }
    k
}
