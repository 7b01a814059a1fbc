//! Honest contractions of Gaussians: Jacobians in closed form, or as automatic differentiation has them, formed or applied to the
//! covariance's columns; 1 / r divided, or a reciprocal root; products from either side; gradients by hand, or by way of the length, of
//! x / r and of the factor.

use super::arrays::{forward, vjp};
use super::{Gaussian, scale};
use crate::contract::arrays::{Arrays, arrays, input};
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::contraction::{honest::contraction, length};
use crate::convention::{ContractionNorm, ContractionRange, Conventions};

/// The number of ways.
pub(super) const WAYS: u64 = 36;

type Matrix<N> = [[N; 3]; 3];

/// What code takes a mean for, where it has a choice.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    /// Whether it stays where it is.
    inside: bool,
    /// The largest coordinate, and the slope of the length along each, in a norm that isn't L2.
    largest: usize,
    slope: [f64; 3],
}

impl Choice {
    pub(super) const INSIDE: Choice = Choice { inside: true, largest: 0, slope: [0.0; 3] };

    /// Those beyond r = 1, the oracle's first: each of the coordinates that tie for the largest, or shares of all of them.
    pub(super) fn beyond(x: [f64; 3], norm: ContractionNorm) -> Vec<Choice> {
        let outside = Choice { inside: false, ..Choice::INSIDE };
        if norm == ContractionNorm::L2 {
            return vec![outside];
        }
        let size = length(x, norm);
        let tied: Vec<usize> = (0..3).filter(|&k| x[k].abs() == size).collect();
        let shares = |one: &[usize]| {
            let mut slope = [0.0; 3];
            one.iter().for_each(|&k| slope[k] = x[k].signum() / one.len() as f64);
            Choice { largest: one[0], slope, ..outside }
        };
        let mut all: Vec<Choice> = tied.iter().map(|&k| shares(&[k])).collect();
        if tied.len() > 1 && norm == ContractionNorm::Linf {
            all.push(shares(&tied));
        }
        all
    }
}

/// The length of a mean.
pub(super) fn radius<O: Operations>(o: &O, x: [f64; 3], norm: ContractionNorm) -> O::Number {
    let exact = x.map(|x| o.exact(x));
    if norm == ContractionNorm::L2 { o.sqrt(o.dot(&exact, &exact)) } else { o.exact(length(x, norm)) }
}

/// A Gaussian, or its gradients.
pub(super) struct Numbers<N> {
    pub(super) mean: [N; 3],
    pub(super) covariance: Matrix<N>,
}

/// A Gaussian in some arithmetic, on one of the ways.
pub(super) struct Ways<'a, O: Operations> {
    o: &'a O,
    norm: ContractionNorm,
    range: ContractionRange,
    way: u64,
    choice: Choice,
    x: [O::Number; 3],
    sigma: Matrix<O::Number>,
    /// 1 / r, and its powers.
    inverse: O::Number,
    square: O::Number,
    cube: O::Number,
    /// x / r, and the slope of r.
    unit: [O::Number; 3],
    slope: [O::Number; 3],
    /// (2 - 1/r) / r.
    s: O::Number,
}

impl<'a, O: Operations> Ways<'a, O> {
    pub(super) fn new(o: &'a O, x: &Gaussian, c: &Conventions, way: u64, choice: Choice) -> Self {
        let norm = c.contraction_norm;
        let r = radius(o, x.mean, norm);
        let mean = x.mean.map(|x| o.exact(x));
        let inverse = if norm == ContractionNorm::L2 && way / 18 == 1 {
            o.pow(o.dot(&mean, &mean), o.exact(-0.5))
        } else {
            o.div(o.exact(1.0), r)
        };
        let rr = o.mul(r, r);
        let square = if way / 18 == 0 { o.mul(inverse, inverse) } else { o.div(o.exact(1.0), rr) };
        let s = match (way + way / 6) % 3 {
            0 => o.mul(o.sub(o.exact(2.0), inverse), inverse),
            1 => o.div(o.sub(o.exact(2.0), inverse), r),
            _ => o.div(o.sub(o.times(2.0, r), o.exact(1.0)), rr),
        };
        let unit = mean.map(|x| if way % 2 == 0 { o.div(x, r) } else { o.mul(x, inverse) });
        let slope = if norm == ContractionNorm::L2 { unit } else { choice.slope.map(|x| o.hyper(x)) };
        Ways {
            o,
            norm,
            range: c.contraction_range,
            way,
            choice,
            x: mean,
            sigma: x.covariance.map(|row| row.map(|x| o.exact(x))),
            inverse,
            square,
            cube: o.mul(square, inverse),
            unit,
            slope,
            s,
        }
    }

    fn one_less(&self) -> O::Number {
        self.o.sub(self.o.exact(1.0), self.inverse)
    }

    /// The slope of s: two terms, three, or a product.
    fn slope_of_s(&self) -> O::Number {
        let o = self.o;
        match self.way % 6 {
            0 | 1 => o.times(2.0, o.sub(self.cube, self.square)),
            2 => {
                let twice = o.sub(o.exact(2.0), self.inverse);
                o.times(2.0, o.sub(self.square, o.mul(twice, self.square)))
            }
            _ => o.mul(o.times(-2.0, self.one_less()), self.square),
        }
    }

    /// p in J = s I + p slope^T, of the norms that have it.
    fn bent(&self) -> [O::Number; 3] {
        let (o, i, square) = (self.o, self.inverse, self.square);
        match self.way % 6 {
            0 | 2 => self.x.map(|x| o.mul(self.slope_of_s(), x)),
            1 => self.x.map(|x| {
                let far = o.mul(o.sub(o.exact(2.0), i), o.mul(x, square));
                o.sub(o.mul(o.mul(x, i), square), far)
            }),
            3 => self.unit.map(|u| o.mul(o.mul(o.times(-2.0, self.one_less()), i), u)),
            _ => self.unit.map(|u| o.mul(o.sub(square, self.s), u)),
        }
    }

    fn jacobian(&self) -> Matrix<O::Number> {
        if self.norm == ContractionNorm::Merf {
            return self.jacobian_of_merf();
        }
        let (o, u, p, k) = (self.o, self.unit, self.bent(), self.choice.largest);
        let entry = |i: usize, j: usize| {
            let round = self.norm == ContractionNorm::L2;
            let direct = self.way % 6 == 3 && self.choice.slope[k].abs() == 1.0;
            match self.way % 6 {
                4 if round => {
                    let along = o.mul(u[i], u[j]);
                    let across = if i == j { o.sub(o.exact(1.0), along) } else { o.neg(along) };
                    o.add(o.mul(self.s, across), o.mul(along, self.square))
                }
                5 if round && i == j => {
                    let (a, b) = (u[(i + 1) % 3], u[(i + 2) % 3]);
                    let across = o.add(o.mul(a, a), o.mul(b, b));
                    o.add(o.mul(self.s, across), o.mul(o.mul(u[i], u[i]), self.square))
                }
                _ if direct && !round && i == j && i == k => self.square,
                _ if i == j => o.add(self.s, o.mul(p[i], self.slope[i])),
                _ => o.mul(p[i], self.slope[j]),
            }
        };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    fn jacobian_of_merf(&self) -> Matrix<O::Number> {
        let (o, k) = (self.o, self.choice.largest);
        let sign = self.slope[k];
        let entry = |i: usize, j: usize| match () {
            () if i == k && j == k && self.way % 6 < 3 => {
                o.add(self.s, o.mul(o.mul(self.x[k], sign), self.slope_of_s()))
            }
            () if i == k && j == k => self.square,
            () if i == j => self.inverse,
            () if j == k && self.way % 2 == 0 => o.neg(o.mul(sign, o.mul(self.x[i], self.square))),
            () if j == k => o.neg(o.mul(sign, o.mul(self.unit[i], self.inverse))),
            () => o.exact(0.0),
        };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    /// J m, or s t + p (slope . t) of each column t.
    fn applied(&self, m: &Matrix<O::Number>) -> Matrix<O::Number> {
        let (o, columns) = (self.o, transposed(m));
        if self.norm == ContractionNorm::Merf || self.way / 6 % 3 != 2 {
            return product(o, &self.jacobian(), m);
        }
        let p = self.bent();
        transposed(&columns.map(|t| {
            let along = o.dot(&self.slope, &t);
            [0, 1, 2].map(|i| o.add(o.mul(self.s, t[i]), o.mul(p[i], along)))
        }))
    }

    /// How much smaller the range is, once or twice.
    fn scaled<const N: usize>(&self, x: [O::Number; N], times: i32) -> [O::Number; N] {
        if self.range == ContractionRange::Two {
            return x;
        }
        x.map(|x| self.o.times(scale(self.range).powi(times), x))
    }

    /// J Sigma J^T.
    pub(super) fn covariance(&self) -> Matrix<O::Number> {
        let all = match () {
            () if self.choice.inside => self.sigma,
            () if self.way / 6 % 3 == 1 => {
                let j = self.jacobian();
                product(self.o, &j, &product(self.o, &self.sigma, &transposed(&j)))
            }
            () => transposed(&self.applied(&transposed(&self.applied(&self.sigma)))),
        };
        all.map(|row| self.scaled(row, 2))
    }

    pub(super) fn gradients(&self, g: &Gaussian) -> Numbers<O::Number> {
        let o = self.o;
        let g_mean = self.scaled(g.mean.map(|x| o.exact(x)), 1);
        let g_sigma = g.covariance.map(|row| self.scaled(row.map(|x| o.exact(x)), 2));
        if self.choice.inside {
            return Numbers { mean: g_mean, covariance: g_sigma };
        }
        let j = self.jacobian();
        let (across, right) = (transposed(&j), product(o, &g_sigma, &j));
        let covariance = if self.way / 6 % 3 == 0 {
            product(o, &product(o, &across, &g_sigma), &j)
        } else {
            product(o, &across, &right)
        };
        let once = if self.way / 18 == 0 {
            product(o, &right, &transposed(&self.sigma))
        } else {
            product(o, &g_sigma, &product(o, &j, &transposed(&self.sigma)))
        };
        let twice = product(o, &transposed(&g_sigma), &product(o, &j, &self.sigma));
        let b = std::array::from_fn(|i| std::array::from_fn(|k| o.add(once[i][k], twice[i][k])));
        let of_length = (self.way + self.way / 6) % 3 == 1;
        let mean = match (self.norm == ContractionNorm::Merf, of_length) {
            (true, true) => self.merf_by_length(&b, &g_mean),
            (false, true) => self.by_length(&b, &g_mean),
            (merf, false) => {
                let by_slope = if merf { self.bend_of_merf(&b) } else { self.bend(&b) };
                [0, 1, 2].map(|a| o.add(o.dot(&across[a], &g_mean), by_slope[a]))
            }
        };
        Numbers { mean, covariance }
    }

    /// B slope, and in L2, where the slope is x / r, B^T slope too; the trace of B; and (x / r)^T B slope.
    fn parts(&self, b: &Matrix<O::Number>) -> ([O::Number; 3], O::Number, O::Number) {
        let (o, across) = (self.o, transposed(b));
        let once = [0, 1, 2].map(|i| o.dot(&b[i], &self.slope));
        let both = [0, 1, 2].map(|i| o.add(once[i], o.dot(&across[i], &self.slope)));
        let along = o.dot(&self.unit, &once);
        let trace = o.sum(&[b[0][0], b[1][1], b[2][2]]);
        (if self.norm == ContractionNorm::L2 { both } else { once }, trace, along)
    }

    /// What the gradient B of J adds to that of the mean: by the slopes of s and of p, or split by what is along and across.
    fn bend(&self, b: &Matrix<O::Number>) -> [O::Number; 3] {
        let o = self.o;
        let ((w, trace, along), p) = (self.parts(b), self.slope_of_s());
        let round = self.norm == ContractionNorm::L2;
        if round && self.way % 3 == 0 {
            let rest = o.sub(trace, o.times(3.0, along));
            return [0, 1, 2].map(|a| {
                let across = o.mul(p, o.add(o.mul(self.slope[a], rest), w[a]));
                o.sub(across, o.mul(o.mul(o.times(2.0, along), self.slope[a]), self.cube))
            });
        }
        let (second, third) = if round { (6.0, 8.0) } else { (4.0, 6.0) };
        let of_p = o.sub(o.times(second, self.square), o.times(third, self.cube));
        // Shares of several coordinates take the slope as it is.
        let alone = self.choice.slope[self.choice.largest].abs() == 1.0;
        if !round && alone && self.way % 3 == 0 {
            return self.bend_of_cube(b, p, of_p);
        }
        let radial = o.add(o.mul(p, trace), o.mul(of_p, along));
        [0, 1, 2].map(|a| o.add(o.mul(p, w[a]), o.mul(self.slope[a], radial)))
    }

    /// The same coordinate by coordinate, in the norm of the largest.
    fn bend_of_cube(&self, b: &Matrix<O::Number>, p: O::Number, of_p: O::Number) -> [O::Number; 3] {
        let (o, k) = (self.o, self.choice.largest);
        let mut g = [0, 1, 2].map(|j| o.mul(p, o.mul(self.slope[k], b[j][k])));
        let own = o.neg(o.mul(o.times(2.0, b[k][k]), o.mul(self.slope[k], self.cube)));
        let mut terms = vec![own];
        for j in (0..3).filter(|&j| j != k) {
            terms.push(o.mul(p, o.mul(self.slope[k], b[j][j])));
            terms.push(o.mul(of_p, o.mul(self.unit[j], b[j][k])));
        }
        g[k] = o.sum(&terms);
        g
    }

    fn bend_of_merf(&self, b: &Matrix<O::Number>) -> [O::Number; 3] {
        let (o, k) = (self.o, self.choice.largest);
        let sign = self.slope[k];
        let less = |x: O::Number| o.neg(o.mul(sign, o.mul(self.square, x)));
        let mut g = [0, 1, 2].map(|j| less(b[j][k]));
        let mut terms = vec![o.neg(o.mul(o.times(2.0, b[k][k]), o.mul(sign, self.cube)))];
        for j in (0..3).filter(|&j| j != k) {
            terms.push(less(b[j][j]));
            terms.push(o.mul(o.times(2.0, self.square), o.mul(self.unit[j], b[j][k])));
        }
        g[k] = o.sum(&terms);
        g
    }

    /// The gradient of the mean as automatic differentiation has it, of s x and of s I + t (x / r) slope^T: by way of r.
    fn by_length(&self, b: &Matrix<O::Number>, g: &[O::Number; 3]) -> [O::Number; 3] {
        let (o, i) = (self.o, self.inverse);
        let (w, trace, along) = self.parts(b);
        let t = o.mul(o.times(-2.0, self.one_less()), i);
        let of_t = o.sub(o.times(2.0, self.square), o.times(4.0, self.cube));
        let of_s = self.slope_of_s();
        let g_unit = w.map(|w| o.mul(t, w));
        let turned = o.neg(o.mul(o.dot(&g_unit, &self.unit), i));
        let g_r = o.sum(&[o.mul(of_s, trace), o.mul(of_t, along), o.mul(of_s, o.dot(&self.x, g)), turned]);
        [0, 1, 2].map(|a| o.sum(&[o.mul(self.s, g[a]), o.mul(g_unit[a], i), o.mul(self.slope[a], g_r)]))
    }

    /// The same of MERF's x_j / r and 2 - 1/r: by way of 1/r.
    fn merf_by_length(&self, b: &Matrix<O::Number>, g: &[O::Number; 3]) -> [O::Number; 3] {
        let (o, i, k) = (self.o, self.inverse, self.choice.largest);
        let sign = self.slope[k];
        let mut terms = vec![o.neg(o.mul(sign, g[k])), o.mul(o.times(2.0, i), b[k][k])];
        let mut out = [i; 3];
        for j in (0..3).filter(|&j| j != k) {
            let g_unit = o.neg(o.mul(sign, o.mul(i, b[j][k])));
            terms.extend([o.mul(self.x[j], g[j]), b[j][j], o.mul(self.x[j], g_unit)]);
            terms.push(o.neg(o.mul(sign, o.mul(b[j][k], self.unit[j]))));
            out[j] = o.mul(i, o.add(g[j], g_unit));
        }
        out[k] = o.neg(o.mul(sign, o.mul(self.square, o.sum(&terms))));
        out
    }
}

fn transposed<N: Copy>(m: &Matrix<N>) -> Matrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

fn product<O: Operations>(o: &O, a: &Matrix<O::Number>, b: &Matrix<O::Number>) -> Matrix<O::Number> {
    let columns = transposed(b);
    a.map(|row| columns.map(|column| o.dot(&row, &column)))
}

/// What this machine takes a mean for.
fn choice(m: &Machine, x: [f64; 3], norm: ContractionNorm) -> Choice {
    let r = radius(m, x, norm);
    if r < 1.0 || (r == 1.0 && m.form % 2 == 0) {
        return Choice::INSIDE;
    }
    let all = Choice::beyond(x, norm);
    all[m.noise as usize % all.len()]
}

/// The way that this machine takes.
fn way(m: &Machine) -> u64 {
    (m.noise + m.form) % WAYS
}

/// The means as points of the row of contractions.
pub(super) fn points(a: &Arrays) -> Arrays {
    arrays([("x", input(a, "means").clone())])
}

/// Contracted Gaussians.
pub(crate) fn contract_gaussians(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let mut out = forward(a, |x| {
        let choice = choice(m, x.mean, c.contraction_norm);
        Gaussian { mean: [0.0; 3], covariance: Ways::new(m, x, c, way(m), choice).covariance() }
    });
    let means = contraction(&points(a), c, m)["contracted"].clone();
    out.insert("contracted_means".into(), means);
    out
}

/// Their gradients.
pub(crate) fn contract_gaussians_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |x, g| {
        let choice = choice(m, x.mean, c.contraction_norm);
        let Numbers { mean, covariance } = Ways::new(m, x, c, way(m), choice).gradients(g);
        Gaussian { mean, covariance }
    })
}
