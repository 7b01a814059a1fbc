//! What the vector code of several components shares: fused products, and buffers that begin on a cache line. A vector of 64 bytes
//! whose buffer begins elsewhere lies in two lines, and costs two accesses.

use aligned_vec::{AVec, ConstAlign};
use pulp::{Arch, Simd};

use std::sync::OnceLock;

/// Bytes of a cache line, and of the widest vector.
const LINE: usize = 64;

/// A `Vec` that begins on a cache line.
pub type Aligned<T> = AVec<T, ConstAlign<LINE>>;

/// The instructions that vector code uses: the best that the machine has, or none with `NERF_ORACLE_SIMD=scalar` in the environment, which
/// is what a machine without vector units runs. The two round differently: f32 results agree within their bounds, not bit for bit.
///
/// # Panics
/// Where the variable has another value than `scalar`, `best` or nothing.
pub fn arch() -> Arch {
    static ARCH: OnceLock<Arch> = OnceLock::new();
    *ARCH.get_or_init(|| chosen(std::env::var("NERF_ORACLE_SIMD").as_deref().unwrap_or_default()))
}

fn chosen(by: &str) -> Arch {
    match by {
        "scalar" => Arch::Scalar,
        "" | "best" => Arch::new(),
        other => panic!("NERF_ORACLE_SIMD is `{other}`, and can be `scalar` or `best`"),
    }
}

/// `count` copies of `value`.
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct CacheAligned<T>(pub T);

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vector_instructions_can_be_forbidden() {
        struct Lanes;
        impl pulp::WithSimd for Lanes {
            type Output = usize;

            fn with_simd<S: Simd>(self, _: S) -> usize {
                S::F32_LANES
            }
        }
        assert_eq!(chosen("scalar").dispatch(Lanes), 1);
        assert_eq!(chosen("").dispatch(Lanes), Arch::new().dispatch(Lanes));
        assert!(std::panic::catch_unwind(|| chosen("avx9")).is_err());
        // In CI's own run without vectors, all of the library is.
        let forced = std::env::var("NERF_ORACLE_SIMD").is_ok_and(|value| value == "scalar");
        assert_eq!(arch().dispatch(Lanes), if forced { 1 } else { Arch::new().dispatch(Lanes) });
    }
}
