//! Samples along a ray: positions t and step lengths delta.
//!
//! Letters: N samples, `t` distance along the ray, `u` a number in [0, 1) for each sample, D = (far - near) / N the width of
//! an interval, S = (far - near) / (N - 1) the spacing of a grid that includes both ends.

use crate::convention::{Delta, Grid, LastDelta, Rest};
use crate::math::Sum;

pub(crate) mod arrays;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;
pub(crate) mod sampler;
pub(crate) mod statistics;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Positions of one ray's samples; `u` has one number for each.
///
/// With [`Grid::Intervals`], t_i = near + (i + u_i) D: stratified sampling, NeRF (Mildenhall et al. 2020) equation 2.
/// The other grids are defined at [`Grid`].
///
/// # Convention
/// `u` is drawn anew for every ray and every sample in training; at evaluation it is [`rest_u`] everywhere.
///
/// ```
/// use nerf_oracle::convention::Grid;
/// use nerf_oracle::sample::sample_along_ray;
/// assert_eq!(sample_along_ray(2.0, 6.0, &[0.5; 4], Grid::Intervals), [2.5, 3.5, 4.5, 5.5]);
/// assert_eq!(sample_along_ray(2.0, 6.0, &[0.0; 5], Grid::EndsPlusSpacing), [2.0, 3.0, 4.0, 5.0, 6.0]);
/// ```
pub fn sample_along_ray(near: f64, far: f64, u: &[f64], grid: Grid) -> Vec<f64> {
    let n = u.len();
    let width = (far - near) / n as f64;
    let spacing = if n > 1 { (far - near) / (n - 1) as f64 } else { 0.0 };
    let mut t = Vec::with_capacity(n);
    for (i, &u) in u.iter().enumerate() {
        let i = i as f64;
        t.push(match grid {
            Grid::Intervals => near + (i + u) * width,
            Grid::EndsPlusWidth => near + i * spacing + u * width,
            Grid::EndsPlusSpacing => near + (i + u) * spacing,
            Grid::EndsBetweenMidpoints => {
                let last = (n - 1) as f64;
                let (lower, upper) = ((i - 0.5).max(0.0), (i + 0.5).min(last));
                near + (lower + u * (upper - lower)) * spacing
            }
        });
    }
    t
}

/// The `u` of every sample at evaluation, when nothing is drawn.
pub fn rest_u(rest: Rest) -> f64 {
    match rest {
        Rest::Left => 0.0,
        Rest::Mid => 0.5,
        Rest::Right => 1.0,
    }
}

/// Step lengths of one ray's samples.
///
/// Constant D, differences t_{i+1} - t_i with a last one by convention (NeRF equation 3 and its code), or the lengths of cells that meet
/// in the middle between two samples; the outer ones end at near and far, or have their samples in the middle.
///
/// ```
/// use nerf_oracle::convention::{Delta, LastDelta};
/// use nerf_oracle::sample::step_sizes;
/// let t = [2.0, 3.0, 5.0];
/// assert_eq!(step_sizes(&t, 2.0, 6.5, Delta::Width, LastDelta::Width), [1.5, 1.5, 1.5]);
/// assert_eq!(step_sizes(&t, 2.0, 6.5, Delta::Differences, LastDelta::ToFar), [1.0, 2.0, 1.5]);
/// ```
pub fn step_sizes(t: &[f64], near: f64, far: f64, delta: Delta, last: LastDelta) -> Vec<f64> {
    let n = t.len();
    let width = (far - near) / n as f64;
    if delta == Delta::Width || n == 0 {
        return vec![width; n];
    }
    if delta == Delta::Central {
        return central(t, width);
    }
    if delta == Delta::Midpoints {
        let edge = |i: usize| match i {
            0 => near,
            i if i == n => far,
            i => 0.5 * (t[i - 1] + t[i]),
        };
        return (0..n).map(|i| edge(i + 1) - edge(i)).collect();
    }
    let mut deltas: Vec<f64> = (1..n).map(|i| t[i] - t[i - 1]).collect();
    deltas.push(match last {
        LastDelta::Width => width,
        LastDelta::Repeated => deltas.last().copied().unwrap_or(width),
        LastDelta::Mean if n == 1 => width,
        LastDelta::Mean => {
            let mut sum = Sum::default();
            deltas.iter().for_each(|&delta| sum.add(delta));
            sum.value() / (n - 1) as f64
        }
        LastDelta::TenToTen => 1e10,
        LastDelta::TenToNine => 1e9,
        LastDelta::Thousandth => 1e-3,
        LastDelta::ToFar => far - t[n - 1],
    });
    deltas
}

/// Half of the way from the sample before to the next one; the whole gap at both ends. One sample has the `width`.
fn central(t: &[f64], width: f64) -> Vec<f64> {
    let last = t.len() - 1;
    let step = |i: usize| match i {
        0 if last == 0 => width,
        0 => t[1] - t[0],
        i if i == last => t[i] - t[i - 1],
        i => 0.5 * (t[i + 1] - t[i - 1]),
    };
    (0..=last).map(step).collect()
}
