//! Named arrays, and how they become numbers, rows and colors.

use std::collections::BTreeMap;
use std::ops::Range;

use ndarray::{Array2, ArrayD, ArrayViewD, Axis, IxDyn, Slice};

/// Name -> array: the only thing that crosses the harness boundary. Row-major.
pub type Arrays = BTreeMap<String, ArrayD<f64>>;

/// A scalar as an array.
pub fn scalar(x: f64) -> ArrayD<f64> {
    ArrayD::from_elem(IxDyn(&[]), x)
}

/// An array from its shape and its entries, row by row.
///
/// # Panics
/// Where their numbers differ.
pub fn array(shape: &[usize], data: Vec<f64>) -> ArrayD<f64> {
    ArrayD::from_shape_vec(IxDyn(shape), data).expect("as many entries as the shape says")
}

/// An input by name, as rows of its last axis.
///
/// # Panics
/// Where it is missing: the judge has checked the names before.
pub fn values(arrays: &Arrays, name: &str) -> Vec<f64> {
    entries(input(arrays, name).view())
}

/// Some rows of an input, entry by entry.
pub(crate) fn values_of(arrays: &Arrays, name: &str, rows: Range<usize>) -> Vec<f64> {
    entries(input(arrays, name).slice_axis(Axis(0), Slice::from(rows)))
}

/// All entries, row by row. An iterator over axes whose number is only known when it runs takes ten times as long as a copy.
fn entries(array: ArrayViewD<f64>) -> Vec<f64> {
    array.as_slice().map_or_else(|| array.iter().copied().collect(), <[f64]>::to_vec)
}

/// An input by name.
///
/// # Panics
/// Where it is missing: the judge has checked the names before.
pub fn input<'a>(arrays: &'a Arrays, name: &str) -> &'a ArrayD<f64> {
    arrays.get(name).unwrap_or_else(|| panic!("no array {name}"))
}

/// A scalar input by name.
pub fn number(arrays: &Arrays, name: &str) -> f64 {
    input(arrays, name).iter().copied().next().unwrap_or_else(|| panic!("{name} is empty"))
}

/// Arrays from pairs.
pub fn arrays<const N: usize>(pairs: [(&str, ArrayD<f64>); N]) -> Arrays {
    pairs.into_iter().map(|(name, array)| (name.to_string(), array)).collect()
}

/// Rows of an (M, D) array.
pub(crate) fn rows(a: &Arrays, name: &str) -> Vec<Vec<f64>> {
    input(a, name).axis_iter(Axis(0)).map(entries).collect()
}

/// An (M, D) array from its rows; `width` is needed where there are none.
pub(crate) fn from_rows(rows: &[Vec<f64>], width: usize) -> ArrayD<f64> {
    Array2::from_shape_fn((rows.len(), width), |(m, d)| rows[m][d]).into_dyn()
}

/// An (M, 3) array in threes.
pub(crate) fn threes(a: &Arrays, name: &str) -> Vec<[f64; 3]> {
    values(a, name).chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect()
}

/// An array in groups of N: the rows of (M, N), or of N numbers in whatever shape.
pub(crate) fn groups<const N: usize>(a: &Arrays, name: &str) -> Vec<[f64; N]> {
    values(a, name).chunks_exact(N).map(|x| std::array::from_fn(|i| x[i])).collect()
}

/// An (M, 3, 3) array as matrices, row by row.
pub(crate) fn matrices3(a: &Arrays, name: &str) -> Vec<[[f64; 3]; 3]> {
    groups::<9>(a, name)
        .iter()
        .map(|x| std::array::from_fn(|i| [x[3 * i], x[3 * i + 1], x[3 * i + 2]]))
        .collect()
}

/// An (M, 2) array in twos.
pub(crate) fn twos(a: &Arrays, name: &str) -> Vec<[f64; 2]> {
    values(a, name).chunks_exact(2).map(|x| [x[0], x[1]]).collect()
}

/// Row r of an (R, N) array.
pub(crate) fn row(arrays: &Arrays, name: &str, r: usize) -> Vec<f64> {
    let array = input(arrays, name);
    let width = array.shape()[1..].iter().product::<usize>();
    match array.as_slice() {
        Some(all) => all[r * width..(r + 1) * width].to_vec(),
        None => array.index_axis(Axis(0), r).iter().copied().collect(),
    }
}

/// Row r of an (R, N, 3) or (R, 3) array, in threes.
pub(crate) fn rows3(arrays: &Arrays, name: &str, r: usize) -> Vec<[f64; 3]> {
    row(arrays, name, r).chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
}

/// Number of rays and samples.
pub(crate) fn size(arrays: &Arrays, name: &str) -> (usize, usize) {
    (input(arrays, name).shape()[0], input(arrays, name).shape()[1])
}

/// Three numbers as a color.
pub(crate) fn rgb(values: &[f64]) -> [f64; 3] {
    [values[0], values[1], values[2]]
}
