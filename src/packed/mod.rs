//! Packed rays: the samples of all rays in one array, as many of each ray as it has; sums and products that begin anew with each ray.
//!
//! Where space is skipped, rays have different numbers of samples, often none (nerfacc, Li et al. 2023, section 4). Letters: S samples,
//! R rays; ray r has the samples `offsets[r]..offsets[r + 1]`.

use crate::math::{Product, Sum};

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

/// Where each ray's samples begin, and how many it has.
///
/// start_r = sum_{q<r} count_q. What code calls `packed_info` has these in two columns; `offsets` are the starts and, last, S.
///
/// # Shapes
/// `ray_ids` (S): the ray of each sample, in ascending order; the result has `rays` pairs (start, count). A ray without samples begins
/// where the next one does.
///
/// # Panics
/// Where an id isn't below `rays`.
///
/// ```
/// use nerf_oracle::packed::pack_info;
/// assert_eq!(pack_info(&[0, 0, 2], 4), [(0, 2), (2, 0), (2, 1), (3, 0)]);
/// ```
pub fn pack_info(ray_ids: &[usize], rays: usize) -> Vec<(usize, usize)> {
    let mut info = vec![(0, 0); rays];
    for &ray in ray_ids {
        info[ray].1 += 1;
    }
    let mut start = 0;
    for (first, count) in &mut info {
        *first = start;
        start += *count;
    }
    info
}

/// Running sums and products of packed rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scan {
    /// Of what lies in front of a sample: 0 for the first of a ray.
    pub exclusive_sum: Vec<f64>,
    /// Of these and the sample itself.
    pub inclusive_sum: Vec<f64>,
    /// Of what lies in front of a sample: 1 for the first of a ray.
    pub exclusive_product: Vec<f64>,
    /// Of these and the sample itself.
    pub inclusive_product: Vec<f64>,
}

/// sum_{j<i} x_j, sum_{j<=i} x_j, prod_{j<i} x_j, prod_{j<=i} x_j, over the samples j of i's ray.
///
/// # Shapes
/// `x` (S), `offsets` (R + 1) from 0 to S, never falling; a ray may have no samples. Each result is (S).
///
/// # Panics
/// Where `offsets` are none, fall, or don't end at S.
///
/// ```
/// use nerf_oracle::packed::scan;
/// // Rays of 3, 0 and 2 samples.
/// let scan = scan(&[2.0, 3.0, 4.0, 5.0, 6.0], &[0, 3, 3, 5]);
/// assert_eq!(scan.exclusive_sum, [0.0, 2.0, 5.0, 0.0, 5.0]);
/// assert_eq!(scan.inclusive_product, [2.0, 6.0, 24.0, 5.0, 30.0]);
/// ```
pub fn scan(x: &[f64], offsets: &[usize]) -> Scan {
    check(x.len(), offsets);
    let mut scan = Scan::default();
    for ray in offsets.windows(2) {
        let (mut sum, mut product) = (Sum::default(), Product::default());
        for &x in &x[ray[0]..ray[1]] {
            scan.exclusive_sum.push(sum.value());
            scan.exclusive_product.push(product.value());
            let mut factor = Sum::default();
            factor.add(x);
            sum.add(x);
            product.multiply(factor);
            scan.inclusive_sum.push(sum.value());
            scan.inclusive_product.push(product.value());
        }
    }
    scan
}

/// sum_i w_i v_i over the samples of each ray: a ray's color from weights and colors, 0 for a ray without samples.
///
/// # Shapes
/// `weights` (S), `values` (S), `offsets` (R + 1) as in [`scan`]; the result is (R).
///
/// # Panics
/// Where the lengths differ, and where `offsets` are none, fall, or don't end at S.
///
/// ```
/// use nerf_oracle::packed::accumulate;
/// let values = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// assert_eq!(accumulate(&[0.5, 0.25, 1.0], &values, &[0, 2, 2, 3]), [[0.5, 0.25, 0.0], [0.0; 3], [0.0, 0.0, 1.0]]);
/// ```
pub fn accumulate(weights: &[f64], values: &[[f64; 3]], offsets: &[usize]) -> Vec<[f64; 3]> {
    assert_eq!(weights.len(), values.len(), "weights and values: one each a sample");
    check(weights.len(), offsets);
    let mut out = vec![];
    for ray in offsets.windows(2) {
        let mut sums = [Sum::default(); 3];
        for i in ray[0]..ray[1] {
            for a in 0..3 {
                sums[a].add(weights[i] * values[i][a]);
            }
        }
        out.push(sums.map(|sum| sum.value()));
    }
    out
}

/// Offsets go from 0 to the number of samples, and never fall.
fn check(samples: usize, offsets: &[usize]) {
    assert!(!offsets.is_empty(), "offsets and rays: one more than rays, and not none");
    assert_eq!(offsets[0], 0, "offsets and samples: from 0");
    assert_eq!(offsets[offsets.len() - 1], samples, "offsets and samples: to their number");
    assert!(offsets.is_sorted(), "offsets and samples: never falling");
}
