//! Buffers that begin on a cache line: a vector of 64 bytes whose buffer begins elsewhere lies in two lines, and costs two accesses.

use aligned_vec::{AVec, ConstAlign};

/// Bytes of a cache line, and of the widest vector.
const LINE: usize = 64;

/// A `Vec` that begins on a cache line.
pub type Aligned<T> = AVec<T, ConstAlign<LINE>>;

/// So many copies of `value`.
///
/// ```
/// let rows = nerf_oracle::aligned::repeated([1f32; 16], 3);
/// assert_eq!((rows.len(), rows.as_ptr() as usize % 64), (3, 0));
/// ```
pub fn repeated<T: Clone>(value: T, count: usize) -> Aligned<T> {
    let mut out = Aligned::new(LINE);
    out.resize(count, value);
    out
}

/// The same as a `Vec`, copied.
pub fn copied<T: Clone>(values: &[T]) -> Aligned<T> {
    Aligned::from_slice(LINE, values)
}

/// A value on the stack that begins on a cache line.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct OnLine<T>(pub T);
