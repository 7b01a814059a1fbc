//! Somebody's hash grid, judged.

use ndarray::{Array2, ArrayView2};

use super::component::HASH_GRID;
use super::{Level, arrays};
use crate::convention::CS180;
use crate::judge::Door;
use crate::judge::typed::Output;

/// The signature of [`judge()`].
#[derive(Clone, Copy, Debug)]
pub struct Points;

/// Judges the features of many points: (levels, `x` (M, 3)) -> (M, L F), level by level.
///
/// ```
/// use nerf_oracle::hash_grid::{encode, judge};
/// use nerf_oracle::ndarray::Array2;
/// judge(|levels, x| {
///     let rows: Vec<Vec<f64>> = x.iter().map(|x| encode(levels, *x)).collect();
///     let width = levels.iter().map(|level| level.table.ncols()).sum();
///     Array2::from_shape_fn((x.len(), width), |(m, f)| rows[m][f])
/// })
/// .in_f32()
/// .assert_pass();
/// ```
pub fn judge<'a>(kernel: impl Fn(&[Level], &[[f64; 3]]) -> Array2<f64> + Sync + 'a) -> Door<'a, Points> {
    Door::whole(&HASH_GRID, move |of| {
        vec![kernel(&arrays::levels(of.arrays, &CS180), of.get("x")).into_array()]
    })
}

impl<'a> Door<'a, Points> {
    /// With its gradient: (levels, x, grad_encoding) -> (grad_x, the gradients of the tables in their levels).
    pub fn vjp(
        self,
        kernel: impl Fn(&[Level], &[[f64; 3]], ArrayView2<f64>) -> (Vec<[f64; 3]>, Vec<Level>) + Sync + 'a,
    ) -> Self {
        self.whole_vjp(move |of| {
            let (x, g) = (of.get("x"), of.get("grad_encoding"));
            let (g_x, g_levels) = kernel(&arrays::levels(of.arrays, &CS180), x, g);
            let table = |level: &Level| level.table.clone().into_array();
            std::iter::once(g_x.into_array()).chain(g_levels.iter().map(table)).collect()
        })
    }
}
