//! Honest similarities: means of squares less squares of means, by rows and then columns or by windows at once, or central moments.

use ndarray::{Array3, ArrayView3};

use super::arrays::{form, forward, peak, picture, vjp};
use super::{Form, reach, uniform, value};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{Arrays, number};
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, SsimVariance, SsimWindow};

/// The number of ways to a similarity.
pub(super) const WAYS: u64 = 3;
/// By rows and then columns.
const BY_AXES: u64 = 0;
/// By central moments.
pub(super) const CENTRAL: u64 = 2;

/// Two pictures in some arithmetic.
pub(super) struct Pictures<'a, O: Operations> {
    o: &'a O,
    a: ArrayView3<'a, f64>,
    b: ArrayView3<'a, f64>,
    form: Form,
    constants: [O::Number; 2],
    /// Weights along one axis.
    weights: Vec<O::Number>,
    /// Those of a whole window.
    square: Vec<O::Number>,
    way: u64,
}

/// A window: where its pixels are, both colors, row by row.
struct Window<O: Operations> {
    places: Vec<Option<[usize; 3]>>,
    a: Vec<O::Number>,
    b: Vec<O::Number>,
    mean: [O::Number; 2],
    /// Luminance over its largest value, and structure over its largest.
    parts: [O::Number; 4],
}

impl<'a, O: Operations> Pictures<'a, O> {
    /// In the arithmetic of `o`.
    pub(super) fn new(o: &'a O, inputs: &'a Arrays, c: &Conventions, way: u64) -> Self {
        let constants = [0.01, 0.03].map(|k| k * peak(inputs, c)).map(|k| o.hyper(k * k));
        let (a, b) = (picture(inputs, "prediction"), picture(inputs, "target"));
        let weights = weights(o, form(c).window);
        let square = weights.iter().flat_map(|y| weights.iter().map(|x| o.mul(*y, *x))).collect();
        Pictures { o, a, b, form: form(c), constants, weights, square, way: way % WAYS }
    }

    fn central(&self) -> bool {
        self.way == CENTRAL
    }

    /// sum of weights times x.
    fn mean(&self, x: &[O::Number]) -> O::Number {
        let (o, w) = (self.o, &self.weights);
        if self.way != BY_AXES {
            return o.dot(&self.square, x);
        }
        let rows: Vec<O::Number> = x.chunks_exact(w.len()).map(|row| o.dot(w, row)).collect();
        o.dot(w, &rows)
    }

    fn window(&self, rows: &[Option<usize>], columns: &[Option<usize>], channel: usize) -> Window<O> {
        let o = self.o;
        let at = |row: &Option<usize>, column: &Option<usize>| row.zip(*column).map(|(j, i)| [j, i, channel]);
        let places: Vec<_> = rows.iter().flat_map(|j| columns.iter().map(move |i| at(j, i))).collect();
        let [a, b] = [&self.a, &self.b]
            .map(|image| places.iter().map(|at| o.exact(value(image, *at))).collect::<Vec<_>>());
        let mean = [self.mean(&a), self.mean(&b)];
        let [var_a, var_b, cov] = [(&a, &a, [0, 0]), (&b, &b, [1, 1]), (&a, &b, [0, 1])]
            .map(|(x, y, which)| self.spread(x, y, which.map(|n| mean[n])));
        let twice = o.times(2.0, o.mul(mean[0], mean[1]));
        let squares = o.add(o.mul(mean[0], mean[0]), o.mul(mean[1], mean[1]));
        let [c1, c2] = self.constants;
        let parts = [
            o.add(twice, c1),
            o.add(squares, c1),
            o.add(o.times(2.0, cov), c2),
            o.add(o.add(var_a, var_b), c2),
        ];
        Window { places, a, b, mean, parts }
    }

    /// The covariance of x and y.
    fn spread(&self, x: &[O::Number], y: &[O::Number], mean: [O::Number; 2]) -> O::Number {
        let o = self.o;
        let both = |[a, b]: [O::Number; 2]| -> Vec<O::Number> {
            x.iter().zip(y).map(|(x, y)| o.mul(o.sub(*x, a), o.sub(*y, b))).collect()
        };
        let spread = if self.central() {
            self.mean(&both(mean))
        } else {
            o.sub(self.mean(&both([o.exact(0.0); 2])), o.mul(mean[0], mean[1]))
        };
        if self.form.variance == SsimVariance::Sample { o.mul(self.unbiased(), spread) } else { spread }
    }

    fn unbiased(&self) -> O::Number {
        let n = (self.weights.len() * self.weights.len()) as f64;
        self.o.hyper(n / (n - 1.0))
    }

    fn windows(&self) -> Vec<Window<O>> {
        let (height, width, channels) = self.a.dim();
        let [rows, columns] = [height, width].map(|n| reach(n, self.weights.len(), self.form.padding));
        let row = |j: &Vec<Option<usize>>| {
            let one =
                |i: &Vec<Option<usize>>| (0..channels).map(|c| self.window(j, i, c)).collect::<Vec<_>>();
            columns.iter().flat_map(one).collect::<Vec<_>>()
        };
        rows.iter().flat_map(row).collect()
    }

    /// A window's similarity.
    fn similarity(&self, window: &Window<O>) -> O::Number {
        let (o, [luminance, over, structure, under]) = (self.o, window.parts);
        match self.way {
            BY_AXES | CENTRAL => o.div(o.mul(luminance, structure), o.mul(over, under)),
            _ => o.mul(o.div(luminance, over), o.div(structure, under)),
        }
    }

    pub(super) fn value(&self) -> O::Number {
        let all: Vec<O::Number> = self.windows().iter().map(|window| self.similarity(window)).collect();
        self.o.div(self.o.sum(&all), self.o.exact(all.len() as f64))
    }

    /// The gradient of the prediction.
    pub(super) fn gradient(&self, g: f64, read: impl Fn(O::Number) -> f64) -> Array3<f64> {
        let (o, windows) = (self.o, self.windows());
        let (height, width, channels) = self.a.dim();
        let mut terms = vec![[vec![], vec![], vec![]]; height * width * channels];
        let each = o.div(o.exact(g), o.exact(windows.len() as f64));
        for window in &windows {
            let [of_mean, of_var, of_cov] = self.shares(window).map(|share| o.mul(each, share));
            for (n, at) in window.places.iter().enumerate() {
                let Some([j, i, c]) = at else { continue };
                let weight = self.square[n];
                let terms = &mut terms[(j * width + i) * channels + c];
                if self.central() {
                    let apart = [o.sub(window.a[n], window.mean[0]), o.sub(window.b[n], window.mean[1])];
                    let spread = o.add(o.mul(of_var, apart[0]), o.mul(of_cov, apart[1]));
                    terms[0].push(o.mul(weight, o.add(of_mean, spread)));
                } else {
                    let all = [of_mean, of_var, of_cov].map(|share| o.mul(weight, share));
                    terms.iter_mut().zip(all).for_each(|(terms, term)| terms.push(term));
                }
            }
        }
        Array3::from_shape_fn((height, width, channels), |(j, i, c)| {
            let sums = terms[(j * width + i) * channels + c].each_ref().map(|terms| o.sum(terms));
            if self.central() {
                return read(sums[0]);
            }
            let [a, b] = [&self.a, &self.b].map(|image| o.exact(image[[j, i, c]]));
            read(o.add(sums[0], o.add(o.mul(sums[1], a), o.mul(sums[2], b))))
        })
    }

    /// What a window passes to its mean, times deviations of the prediction, and times those of the target; where moments aren't central,
    /// times the colors themselves, the mean having the rest.
    fn shares(&self, window: &Window<O>) -> [O::Number; 3] {
        let (o, [luminance, over, structure, under]) = (self.o, window.parts);
        let both = o.mul(over, under);
        let similarity = self.similarity(window);
        let by_mean = o.sub(
            o.div(o.mul(window.mean[1], structure), both),
            o.div(o.mul(similarity, window.mean[0]), over),
        );
        let [by_cov, by_var] = [o.div(luminance, both), o.neg(o.div(similarity, under))]
            .map(|share| o.times(2.0, share))
            .map(|share| {
                if self.form.variance == SsimVariance::Sample { o.mul(self.unbiased(), share) } else { share }
            });
        let by_mean = o.times(2.0, by_mean);
        if self.central() {
            return [by_mean, by_var, by_cov];
        }
        let rest = o.add(o.mul(by_var, window.mean[0]), o.mul(by_cov, window.mean[1]));
        [o.sub(by_mean, rest), by_var, by_cov]
    }
}

/// Weights along one axis.
fn weights<O: Operations>(o: &O, window: SsimWindow) -> Vec<O::Number> {
    if let Some(size) = uniform(window) {
        return vec![o.div(o.exact(1.0), o.exact(size as f64)); size];
    }
    let weight = |x: i32| o.exp(o.hyper(-0.5 * f64::from(x * x) / (1.5 * 1.5)));
    let weights: Vec<O::Number> = (-5..=5).map(weight).collect();
    let sum = o.sum(&weights);
    weights.iter().map(|w| o.div(*w, sum)).collect()
}

/// Which way a machine takes.
fn way(m: &Machine) -> u64 {
    if m.stable { CENTRAL } else { m.form % CENTRAL }
}

/// The machine that everything but the result is computed on: of f32 at least.
fn fine(m: &Machine) -> Machine {
    Machine { dtype: if m.dtype == Dtype::F64 { Dtype::F64 } else { Dtype::F32 }, ..*m }
}

/// Similarity.
pub(crate) fn ssim(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(m.round(Pictures::new(&fine(m), a, c, way(m)).value()))
}

/// Its gradient.
pub(crate) fn ssim_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(Pictures::new(&fine(m), a, c, way(m)).gradient(number(a, "grad_value"), |g| m.round(g)))
}
