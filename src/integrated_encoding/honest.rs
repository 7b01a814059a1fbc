//! Honest integrated encodings: the variance times the band's square, times the band twice, or times the factor's square in the end;
//! gradients column by column, band by band, or with the factor outside of one sum. Waves are those of the encoding.

use super::arrays::{forward, settings, vjp};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, Frequency};
use crate::encoding::{Encoding, factor, honest::waves};

/// The number of ways.
pub(super) const WAYS: u64 = 3;

/// One band of one dimension in some arithmetic.
#[derive(Clone, Copy)]
pub(super) struct Band<N> {
    /// f_k.
    pub(super) f: N,
    pub(super) sin: N,
    pub(super) cos: N,
}

/// A dimension of a Gaussian in some arithmetic, on one of the ways.
pub(super) struct Dimension<'a, O: Operations> {
    pub(super) o: &'a O,
    pub(super) encoding: &'a Encoding,
    pub(super) way: u64,
    pub(super) variance: f64,
}

impl<O: Operations> Dimension<'_, O> {
    /// pi, 2 pi or 1.
    fn factor(&self) -> O::Number {
        self.o.hyper(factor(self.encoding.frequency))
    }

    /// Times the factor, where there is one.
    fn scaled(&self, x: O::Number, factor: O::Number) -> O::Number {
        if self.encoding.frequency == Frequency::One { x } else { self.o.mul(factor, x) }
    }

    fn square(&self, x: O::Number) -> O::Number {
        self.o.mul(x, x)
    }

    /// What is left of a band.
    fn left(&self, band: &Band<O::Number>) -> O::Number {
        let (o, v, a) = (self.o, self.o.exact(self.variance), self.scaled(band.f, self.factor()));
        let variance = match self.way % WAYS {
            0 => o.mul(self.square(a), v),
            1 => o.mul(a, o.mul(a, v)),
            _ => self.scaled(o.mul(self.square(band.f), v), self.square(self.factor())),
        };
        o.exp(o.neg(o.times(0.5, variance)))
    }

    /// The columns of a band.
    pub(super) fn columns(&self, band: &Band<O::Number>) -> [O::Number; 2] {
        let left = self.left(band);
        [self.o.mul(left, band.sin), self.o.mul(left, band.cos)]
    }

    /// The gradients of mean and variance from those of each band's columns and of the identity.
    pub(super) fn gradients(
        &self,
        bands: &[Band<O::Number>],
        g: &[[f64; 2]],
        identity: f64,
    ) -> [O::Number; 2] {
        let (o, mut to_mean, mut to_variance) = (self.o, vec![], vec![]);
        for (band, g) in bands.iter().zip(g) {
            let (left, g) = (self.left(band), g.map(|g| o.exact(g)));
            let (slopes, waves) = ([band.cos, o.neg(band.sin)], [band.sin, band.cos]);
            let a = if self.way % WAYS == 2 { band.f } else { self.scaled(band.f, self.factor()) };
            if self.way % WAYS == 1 {
                to_mean.push(o.mul(o.mul(a, left), o.dot(&g, &slopes)));
                to_variance.push(o.mul(self.square(a), o.mul(left, o.dot(&g, &waves))));
                continue;
            }
            for n in 0..2 {
                to_mean.push(o.mul(a, o.mul(left, o.mul(g[n], slopes[n]))));
                to_variance.push(o.mul(a, o.mul(a, o.mul(g[n], o.mul(left, waves[n])))));
            }
        }
        let half = |x: O::Number| o.neg(o.times(0.5, x));
        if self.way % WAYS == 2 {
            let (mean, variance) = (o.sum(&to_mean), o.sum(&to_variance));
            let mean = o.add(self.scaled(mean, self.factor()), o.exact(identity));
            return [mean, half(self.scaled(variance, self.square(self.factor())))];
        }
        to_mean.push(o.exact(identity));
        [o.sum(&to_mean), half(o.sum(&to_variance))]
    }
}

/// The cotangents of each band's two columns in dimension d, and of the identity.
pub(super) fn cotangents(encoding: &Encoding, dims: usize, d: usize, g: &[f64]) -> (Vec<[f64; 2]>, f64) {
    let pair = |k| [0, 1].map(|cosine| g[encoding.column(dims, k, d, cosine)]);
    let identity = if encoding.identity { g[encoding.identity_column(dims, d)] } else { 0.0 };
    ((0..encoding.levels).map(pair).collect(), identity)
}

fn bands(encoding: &Encoding, x: f64, c: &Conventions, m: &Machine) -> Vec<Band<f64>> {
    let one = |k| {
        let (sin, cos) = waves(encoding, c.cosine, k, x, m);
        Band { f: m.round(encoding.band(k)), sin, cos }
    };
    (0..encoding.levels).map(one).collect()
}

/// Integrated encoding.
pub(crate) fn integrated_encoding(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let encoding = &settings(a, c);
    forward(a, c, |x, v| {
        let dims = x.len();
        let mut out = vec![0.0; encoding.width(dims)];
        for d in 0..dims {
            if encoding.identity {
                out[encoding.identity_column(dims, d)] = x[d];
            }
            let dimension = Dimension { o: m, encoding, way: m.noise, variance: v[d] };
            for (k, band) in bands(encoding, x[d], c, m).iter().enumerate() {
                let columns = dimension.columns(band);
                (0..2).for_each(|cosine| out[encoding.column(dims, k, d, cosine)] = columns[cosine]);
            }
        }
        out
    })
}

/// Its gradient.
pub(crate) fn integrated_encoding_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let encoding = &settings(a, c);
    vjp(a, |x, v, g| {
        let one = |d: usize| {
            let (g, identity) = cotangents(encoding, x.len(), d, g);
            let dimension = Dimension { o: m, encoding, way: m.noise, variance: v[d] };
            dimension.gradients(&bands(encoding, x[d], c, m), &g, identity).into()
        };
        (0..x.len()).map(one).unzip()
    })
}
