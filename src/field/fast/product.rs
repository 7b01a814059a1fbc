//! Matrix products on the `gemm` crate, after a bounds check; always on one thread, because threads take whole chunks.

use gemm::{Parallelism, gemm};

/// A matrix inside a slice: entry (i, j) lies at `i * row_stride + j * column_stride`.
#[derive(Clone, Copy)]
pub(crate) struct Matrix<'a> {
    data: &'a [f32],
    rows: usize,
    columns: usize,
    row_stride: usize,
    column_stride: usize,
}

impl<'a> Matrix<'a> {
    /// Rows `stride` entries apart.
    pub(crate) fn new(data: &'a [f32], rows: usize, columns: usize, stride: usize) -> Self {
        assert!(
            rows == 0 || columns == 0 || (rows - 1) * stride + columns <= data.len(),
            "a matrix inside its slice"
        );
        Matrix { data, rows, columns, row_stride: stride, column_stride: 1 }
    }

    /// The transpose, in place.
    pub(crate) fn t(self) -> Self {
        let Matrix { data, rows, columns, row_stride, column_stride } = self;
        Matrix { data, rows: columns, columns: rows, row_stride: column_stride, column_stride: row_stride }
    }

    /// (rows, columns).
    #[cfg(feature = "cli")]
    pub(crate) fn shape(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }

    /// Entry (i, j).
    #[cfg(feature = "cli")]
    pub(crate) fn at(&self, i: usize, j: usize) -> f32 {
        self.data[i * self.row_stride + j * self.column_stride]
    }
}

/// Who multiplies in a step: [`Plain`] does, in training; another one can time or check the products of the very same step.
pub(crate) trait Multiply: Sync {
    /// [`product`].
    fn product(&self, c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool);
}

/// The product, and nothing else.
#[derive(Debug)]
pub(crate) struct Plain;

impl Multiply for Plain {
    fn product(&self, c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool) {
        product(c, stride, a, b, accumulate);
    }
}

/// c = a b, or c += a b; rows of c `stride` entries apart.
pub(crate) fn product(c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool) {
    product_on(c, stride, a, b, accumulate, Parallelism::None);
}

/// c = a b of n x n matrices, row by row, on all threads: the machine's peak.
pub fn sgemm(n: usize, a: &[f32], b: &[f32], c: &mut [f32]) {
    let (a, b) = (Matrix::new(a, n, n, n), Matrix::new(b, n, n, n));
    product_on(c, n, a, b, false, Parallelism::Rayon(crate::parallel::threads()));
}

/// c = a b of shapes (m, k) and (k, n), row by row, on the calling thread: a layer as a chunk computes it.
pub fn sgemm_layer([m, n, k]: [usize; 3], a: &[f32], b: &[f32], c: &mut [f32]) {
    product(c, n, Matrix::new(a, m, k, k), Matrix::new(b, k, n, n), false);
}

#[allow(unsafe_code, reason = "gemm takes pointers; what it needs of them is asserted here")]
fn product_on(c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool, on: Parallelism) {
    let (m, n, k) = (a.rows, b.columns, a.columns);
    assert_eq!(k, b.rows, "inner dimensions of a product");
    if m == 0 || n == 0 {
        return;
    }
    assert!(n <= stride && (m - 1) * stride + n <= c.len(), "a product inside its slice");
    // SAFETY: a, b (checked by `Matrix::new`) and c (above) hold every entry that their shapes and strides name, c is
    // borrowed mutably and so overlaps neither, and its rows don't overlap each other.
    unsafe {
        gemm(
            m,
            n,
            k,
            c.as_mut_ptr(),
            1,
            stride as isize,
            accumulate,
            a.data.as_ptr(),
            a.column_stride as isize,
            a.row_stride as isize,
            b.data.as_ptr(),
            b.column_stride as isize,
            b.row_stride as isize,
            1.0,
            1.0,
            false,
            false,
            false,
            on,
        );
    }
}

/// The transpose of a (rows, columns) matrix as a matrix of its own: products run faster on it than on a strided view.
pub(crate) fn transposed(data: &[f32], rows: usize, columns: usize) -> Vec<f32> {
    let mut out = vec![0.0; rows * columns];
    for (i, row) in data.chunks_exact(columns).enumerate() {
        for (x, out) in row.iter().zip(out[i..].iter_mut().step_by(rows)) {
            *out = *x;
        }
    }
    out
}
