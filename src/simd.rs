//! What the vector code of several components shares: fused products, and buffers that begin on a cache line. A vector of 64 bytes
//! whose buffer begins elsewhere lies in two lines, and costs two accesses.

use aligned_vec::{AVec, ConstAlign};
use pulp::Simd;

/// Bytes of a cache line, and of the widest vector.
const LINE: usize = 64;

/// A `Vec` that begins on a cache line.
pub type Aligned<T> = AVec<T, ConstAlign<LINE>>;

/// So many copies of `value`.
///
/// ```
/// let rows = nerf_oracle::simd::repeated([1f32; 16], 3);
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

/// a b + c in every lane, fused where the machine has it; without it, `mul_add` would be a library call.
#[inline(always)]
pub fn fma<S: Simd>(s: S, a: S::f32s, b: S::f32s, c: S::f32s) -> S::f32s {
    if S::IS_SCALAR { s.add_f32s(s.mul_f32s(a, b), c) } else { s.mul_add_f32s(a, b, c) }
}

/// The same for one number, in loops that the compiler makes vector code of.
#[inline(always)]
pub fn multiply_add<S: Simd>(a: f32, b: f32, c: f32) -> f32 {
    if S::IS_SCALAR { a * b + c } else { a.mul_add(b, c) }
}
