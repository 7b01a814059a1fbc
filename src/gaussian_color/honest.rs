//! Honest colors of splats: directions divided by their length or multiplied by its inverse, polynomials with 1 for x^2 + y^2 + z^2 or
//! without, and the gradients of these.

use super::arrays::{form, forward, vjp};
use super::{Form, degree};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, HarmonicForm, SplatColor};
use crate::spherical_harmonics::polynomial;

/// The number of ways to a color.
pub(super) const WAYS: u64 = 4;

/// A splat as a camera sees it, in some arithmetic.
pub(super) struct Seen<'a, O: Operations> {
    o: &'a O,
    form: Form,
    polynomials: HarmonicForm,
    length: O::Number,
    u: [O::Number; 3],
    coefficients: &'a [[f64; 3]],
    harmonics: Vec<O::Number>,
}

impl<'a, O: Operations> Seen<'a, O> {
    pub(super) fn new(
        o: &'a O,
        [mean, center]: [[f64; 3]; 2],
        coefficients: &'a [[f64; 3]],
        form: Form,
        way: u64,
    ) -> Self {
        let d = [0, 1, 2].map(|k| o.sub(o.exact(mean[k]), o.exact(center[k])));
        let length = o.sqrt(o.dot(&d, &d));
        let inverse = o.div(o.exact(1.0), length);
        let u = d.map(|x| if way % 2 == 0 { o.div(x, length) } else { o.mul(x, inverse) });
        let polynomials = if way / 2 % 2 == 0 { HarmonicForm::Sphere } else { HarmonicForm::Homogeneous };
        let mut seen = Seen { o, form, polynomials, length, u, coefficients, harmonics: vec![] };
        let values = 0..(degree(coefficients) + 1).pow(2);
        seen.harmonics = values.map(|n| seen.value(n, |exponents| seen.monomial(1.0, exponents))).collect();
        seen
    }

    /// factor x^i y^j z^k.
    fn monomial(&self, factor: f64, exponents: [u32; 3]) -> O::Number {
        let mut product = self.o.hyper(factor);
        for (x, power) in self.u.into_iter().zip(exponents) {
            (0..power).for_each(|_| product = self.o.mul(product, x));
        }
        product
    }

    /// The polynomial of harmonic n with `of(exponents)` for its monomials.
    fn value(&self, n: usize, of: impl Fn([u32; 3]) -> O::Number) -> O::Number {
        let (polynomial, sign) = polynomial(n, self.polynomials, self.form.sign);
        let term = |&(c, exponents): &(f64, [u32; 3])| self.o.mul(self.o.hyper(sign * c), of(exponents));
        self.o.sum(&polynomial.iter().map(term).collect::<Vec<_>>())
    }

    /// The slope of harmonic n along an axis.
    fn slope(&self, n: usize, axis: usize) -> O::Number {
        self.value(n, |mut exponents| {
            let power = exponents[axis];
            exponents[axis] = power.saturating_sub(1);
            if power == 0 { self.o.exact(0.0) } else { self.monomial(f64::from(power), exponents) }
        })
    }

    /// A channel before it is clamped.
    fn shifted(&self, channel: usize) -> O::Number {
        let f: Vec<O::Number> = self.coefficients.iter().map(|f| self.o.exact(f[channel])).collect();
        let sum = self.o.dot(&f, &self.harmonics);
        if self.form.color == SplatColor::Sum { sum } else { self.o.add(sum, self.o.exact(0.5)) }
    }

    pub(super) fn color(&self) -> [O::Number; 3] {
        let clamped = self.form.color == SplatColor::Clamped;
        let cut = |x: O::Number| if clamped { self.o.max(x, self.o.exact(0.0)) } else { x };
        [0, 1, 2].map(|channel| cut(self.shifted(channel)))
    }

    /// Gradients of the mean and of the coefficients.
    pub(super) fn gradients(&self, g: [f64; 3]) -> ([O::Number; 3], Vec<[O::Number; 3]>) {
        let o = self.o;
        let g: [O::Number; 3] = std::array::from_fn(|channel| {
            let g = o.exact(g[channel]);
            let clamped = self.form.color == SplatColor::Clamped;
            if clamped { o.above(self.shifted(channel), o.exact(0.0), g) } else { g }
        });
        let g_f = self.harmonics.iter().map(|&y| g.map(|g| o.mul(g, y))).collect();
        let of_y = |f: &[f64; 3]| o.dot(&g, &f.map(|f| o.exact(f)));
        let g_y: Vec<O::Number> = self.coefficients.iter().map(of_y).collect();
        let g_u = [0, 1, 2].map(|axis| {
            let slopes: Vec<O::Number> = (0..g_y.len()).map(|n| self.slope(n, axis)).collect();
            o.dot(&g_y, &slopes)
        });
        let radial = o.dot(&g_u, &self.u);
        ([0, 1, 2].map(|k| o.div(o.sub(g_u[k], o.mul(radial, self.u[k])), self.length)), g_f)
    }
}

/// Which way a machine takes.
fn way(m: &Machine) -> u64 {
    2 * m.form + u64::from(m.stable)
}

/// Colors.
pub(crate) fn color(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |mean, center, f| Seen::new(m, [mean, center], f, form(c), way(m)).color())
}

/// Their gradients.
pub(crate) fn color_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |mean, center, f, g| Seen::new(m, [mean, center], f, form(c), way(m)).gradients(g))
}
