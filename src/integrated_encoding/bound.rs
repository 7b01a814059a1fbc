//! Error bounds of the integrated encoding: those of the waves, times what is left of them, on the widest of the ways that honest code
//! takes.

use super::arrays::{forward, settings, vjp};
use super::honest::{Band, Dimension, WAYS, cotangents};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::Bounded;
use crate::convention::Conventions;
use crate::encoding::Encoding;
use crate::encoding::bound::{band, waves};

fn bands(encoding: &Encoding, x: f64, c: &Conventions, m: &Arithmetic) -> Vec<Band<Bounded>> {
    let one = |k| {
        let (sin, cos) = waves(encoding, c.cosine, k, x, m);
        Band { f: band(encoding, k, m), sin, cos }
    };
    (0..encoding.levels).map(one).collect()
}

/// The larger errors on all ways.
fn widest(way: impl Fn(u64) -> [Bounded; 2]) -> [f64; 2] {
    let errors = (0..WAYS).map(|n| way(n).map(|x| x.e));
    errors.fold([0.0; 2], |all, one| [0, 1].map(|n| f64::max(all[n], one[n])))
}

/// Bound of [`super::integrated_encoding`].
pub(crate) fn integrated_encoding(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let encoding = &settings(a, c);
    forward(a, c, |x, v| {
        let dims = x.len();
        // The identity is handed on as it is.
        let mut out = vec![0.0; encoding.width(dims)];
        for d in 0..dims {
            for (k, band) in bands(encoding, x[d], c, m).iter().enumerate() {
                let columns = widest(|way| Dimension { o: m, encoding, way, variance: v[d] }.columns(band));
                (0..2).for_each(|cosine| out[encoding.column(dims, k, d, cosine)] = columns[cosine]);
            }
        }
        out
    })
}

/// Bound of [`super::backward::integrated_encoding`].
pub(crate) fn integrated_encoding_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let encoding = &settings(a, c);
    vjp(a, |x, v, g| {
        let one = |d: usize| {
            let (g, identity) = cotangents(encoding, x.len(), d, g);
            let bands = bands(encoding, x[d], c, m);
            let way = |way| Dimension { o: m, encoding, way, variance: v[d] }.gradients(&bands, &g, identity);
            widest(way).into()
        };
        (0..x.len()).map(one).unzip()
    })
}
