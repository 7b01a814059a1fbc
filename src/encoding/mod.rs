//! Positional encoding: x -> (x, sin(2^0 pi x), cos(2^0 pi x), ..., sin(2^(L-1) pi x), cos(2^(L-1) pi x)).
//!
//! NeRF (Mildenhall et al. 2020) equation 4. L = 10 for positions, 4 for directions, 10 for pixels of a 2D image.

use std::f64::consts::PI;

use crate::convention::{Bands, Columns, Conventions, Frequency, IdentityPlace};
use crate::math::{cos, cos_pi, pow, power_of_two, sin, sin_pi};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
#[cfg(feature = "fast")]
pub mod fast;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// What the encoding depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoding {
    /// L, the number of bands.
    pub levels: usize,
    /// Whether x itself is kept.
    pub identity: bool,
    /// In front of the bands, or behind them.
    pub identity_place: IdentityPlace,
    /// pi, 1 or 2 pi.
    pub frequency: Frequency,
    /// Octaves or evenly spaced.
    pub bands: Bands,
    /// Column order.
    pub columns: Columns,
}

impl Encoding {
    /// The encoding with L `levels` in these conventions.
    pub fn new(levels: usize, conventions: &Conventions) -> Self {
        let Conventions { identity, identity_place, frequency, bands, columns, .. } = *conventions;
        Encoding { levels, identity, identity_place, frequency, bands, columns }
    }

    /// Columns for `dims` dimensions: D + 2 L D, or 2 L D without the identity.
    pub fn width(&self, dims: usize) -> usize {
        dims * (2 * self.levels + usize::from(self.identity))
    }

    /// f_k: 2^k, or evenly spaced from 1 to 2^(L-1), or in even octaves from 1 to 2^(L-2) or to 2^L. 2^k x is exact; other bands are
    /// rounded, and so is f_k x.
    pub fn band(&self, k: usize) -> f64 {
        let last = self.levels - 1;
        if last == 0 {
            return 1.0;
        }
        match self.bands {
            Bands::Octaves => power_of_two(k as i32),
            Bands::Linear => 1.0 + k as f64 * (power_of_two(last as i32) - 1.0) / last as f64,
            Bands::Stretched => pow(2.0, k as f64 * (last - 1) as f64 / last as f64),
            Bands::Widened => pow(2.0, k as f64 * (last + 1) as f64 / last as f64),
        }
    }

    /// The column of (band k, dimension d, 0 for sin or 1 for cos).
    pub fn column(&self, dims: usize, k: usize, d: usize, cosine: usize) -> usize {
        let levels = self.levels;
        let encoded = match self.columns {
            Columns::BandSinCos => (2 * k + cosine) * dims + d,
            Columns::DimSinCos => (2 * d + cosine) * levels + k,
            Columns::DimInterleaved => (d * levels + k) * 2 + cosine,
            Columns::AllSinAllCos => (cosine * dims + d) * levels + k,
            Columns::AllSinAllCosByBand => (cosine * levels + k) * dims + d,
            Columns::BandInterleaved => (k * dims + d) * 2 + cosine,
        };
        if !self.identity {
            return encoded;
        }
        encoded
            + match self.identity_place {
                IdentityPlace::Last => 0,
                IdentityPlace::ByDimension if self.by_dimension() => d + 1,
                _ => dims,
            }
    }

    /// Whether all columns of a dimension stand together.
    fn by_dimension(&self) -> bool {
        matches!(self.columns, Columns::DimSinCos | Columns::DimInterleaved)
    }

    /// The column of x itself in dimension d, where it is kept.
    pub fn identity_column(&self, dims: usize, d: usize) -> usize {
        match self.identity_place {
            IdentityPlace::Last => 2 * self.levels * dims + d,
            IdentityPlace::ByDimension if self.by_dimension() => (2 * self.levels + 1) * d,
            _ => d,
        }
    }
}

/// (sin, cos) of factor * f * x. Multiplying by pi happens inside [`sin_pi`], after an exact range reduction.
pub(crate) fn wave(frequency: Frequency, f: f64, x: f64) -> (f64, f64) {
    match frequency {
        Frequency::Pi => (sin_pi(f * x), cos_pi(f * x)),
        Frequency::TwoPi => (sin_pi(2.0 * f * x), cos_pi(2.0 * f * x)),
        Frequency::One => (sin(f * x), cos(f * x)),
    }
}

/// The factor of the bands as a number.
pub(crate) fn factor(frequency: Frequency) -> f64 {
    match frequency {
        Frequency::Pi => PI,
        Frequency::TwoPi => 2.0 * PI,
        Frequency::One => 1.0,
    }
}

/// The encoding of one point.
///
/// # Shapes
/// `x` (D), result (D + 2 L D).
///
/// # Units
/// x in scene units: period 2 in band 0, so that [-1, 1] is covered once.
///
/// ```
/// use nerf_oracle::{convention::CS180, encoding::{Encoding, positional_encoding}};
/// let e = positional_encoding(&[0.5], &Encoding::new(3, &CS180));
/// assert_eq!(e, [0.5, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0]);
/// ```
pub fn positional_encoding(x: &[f64], encoding: &Encoding) -> Vec<f64> {
    let dims = x.len();
    let mut out = vec![0.0; encoding.width(dims)];
    if encoding.identity {
        for d in 0..dims {
            out[encoding.identity_column(dims, d)] = x[d];
        }
    }
    for k in 0..encoding.levels {
        for d in 0..dims {
            let (sin, cos) = wave(encoding.frequency, encoding.band(k), x[d]);
            out[encoding.column(dims, k, d, 0)] = sin;
            out[encoding.column(dims, k, d, 1)] = cos;
        }
    }
    out
}
