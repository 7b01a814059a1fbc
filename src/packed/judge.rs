//! Somebody's packed rays, judged. Ray r has the samples `offsets[r]..offsets[r + 1]`.

use super::component::{ACCUMULATE_ALONG_RAYS, PACK_INFO, PACKED_SCAN};
use crate::judge::door::front_door;

front_door! {
    /// Judges running sums and products: (x, offsets) -> (exclusive_sum, inclusive_sum, exclusive_product, inclusive_product), S each,
    /// or the first of these.
    ///
    /// ```
    /// use nerf_oracle::packed::{judge, scan};
    /// judge(|x, offsets| {
    ///     let all = scan(x, &offsets);
    ///     (all.exclusive_sum, all.inclusive_sum, all.exclusive_product, all.inclusive_product)
    /// })
    /// .assert_pass();
    /// ```
    whole PACKED_SCAN: judge as Scan(x: &[f64], offsets: Vec<usize>);
    /// With its gradient: the same and one cotangent for each output -> grad_x.
    whole_vjp(
        grad_exclusive_sum: &[f64],
        grad_inclusive_sum: &[f64],
        grad_exclusive_product: &[f64],
        grad_inclusive_product: &[f64],
    );
}

front_door! {
    /// Judges where rays begin: (ray_ids, rays) -> (starts, counts), R each.
    ///
    /// ```
    /// use nerf_oracle::packed::{judge, pack_info};
    /// judge::pack_info(|ids, rays| -> (Vec<usize>, Vec<usize>) { pack_info(&ids, rays).into_iter().unzip() }).assert_pass();
    /// ```
    whole PACK_INFO: pack_info as Ids(ray_ids: Vec<usize>, rays: usize);
}

front_door! {
    /// Judges weighted sums along rays: (weights, values, offsets) -> sums, (R, 3).
    ///
    /// ```
    /// use nerf_oracle::packed::{accumulate, judge};
    /// judge::accumulate_along_rays(|weights, values, offsets| accumulate(weights, values, &offsets)).assert_pass();
    /// ```
    whole ACCUMULATE_ALONG_RAYS: accumulate_along_rays as Weighted(weights: &[f64], values: &[[f64; 3]], offsets: Vec<usize>);
    /// With its gradient: the same and grad_sums -> (grad_weights, grad_values).
    whole_vjp(grad_sums: &[[f64; 3]]);
}
