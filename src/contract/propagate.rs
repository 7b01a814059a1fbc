//! How rounding errors travel through a network: the probabilistic bound that `mlp` and `nerf_mlp` share.
//!
//! Worst-case sums over wide layers are uselessly large, so local errors are taken as independent, of mean zero and bounded (Higham and
//! Mary, "A new approach to probabilistic rounding error analysis", 2019). A sum of a_i d_i with |d_i| <= u then exceeds lambda u sqrt(sum
//! a_i^2) with probability below 2 exp(-lambda^2 / 2) (Hoeffding); with [`LAMBDA`] = 8 that is 3e-14 per element, 3e-8 for a run of a
//! million elements. Variances travel through the oracle's own signed weights as a full covariance matrix. Errors that are not independent
//! (the encoding's, the same in many columns) travel as signed columns whose absolute values are summed at the end, and errors without a
//! known sign (a ReLU that may be on or off, a flush to zero) as plain absolute values.

use ndarray::{Array1, Array2, Axis, concatenate, s};

use super::arithmetic::Arithmetic;
use super::bounded::{Bounded, gamma};

/// The number of standard deviations that an honest error stays within.
pub const LAMBDA: f64 = 8.0;

/// A vector with everything that is known about its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector {
    /// Values.
    pub y: Array1<f64>,
    /// Covariance of the independent errors, as a variance proxy.
    covariance: Array2<f64>,
    /// The worst case of the same errors, all of one sign: the smaller of the two estimates counts.
    worst: Array1<f64>,
    /// Signed effect of each error that isn't independent, (entries, sources).
    signed: Array2<f64>,
    /// Errors that are neither independent nor of known sign.
    residual: Array1<f64>,
}

impl Vector {
    /// Values whose entry i is off by source `first + i`, of `sources` in all.
    pub fn from_bounded(values: &[Bounded], first: usize, sources: usize) -> Vector {
        let n = values.len();
        let mut signed = Array2::zeros((n, sources));
        let mut residual = Array1::zeros(n);
        for (i, value) in values.iter().enumerate() {
            // An infinite error has no sign.
            if value.e.is_finite() {
                signed[[i, first + i]] = value.e;
            } else {
                residual[i] = value.e;
            }
        }
        let y = values.iter().map(|value| value.y).collect();
        Vector { y, covariance: Array2::zeros((n, n)), worst: Array1::zeros(n), signed, residual }
    }

    /// How far entry i may be off.
    pub fn error(&self, i: usize) -> f64 {
        let likely = LAMBDA * self.covariance[[i, i]].max(0.0).sqrt();
        let signed: f64 = self.signed.row(i).iter().map(|x| x.abs()).sum();
        likely.min(self.worst[i]) + signed + self.residual[i]
    }

    /// Entry i with its error.
    pub fn entry(&self, i: usize) -> Bounded {
        Bounded { y: self.y[i], e: self.error(i) }
    }

    /// All entries with their errors.
    pub fn entries(&self) -> Vec<Bounded> {
        (0..self.y.len()).map(|i| self.entry(i)).collect()
    }

    /// This vector followed by another with the same sources.
    pub fn followed_by(&self, other: &Vector) -> Vector {
        let (n, k) = (self.y.len(), other.y.len());
        let mut covariance = Array2::zeros((n + k, n + k));
        covariance.slice_mut(s![..n, ..n]).assign(&self.covariance);
        covariance.slice_mut(s![n.., n..]).assign(&other.covariance);
        let join = |a: &Array1<f64>, b: &Array1<f64>| concatenate![Axis(0), a.view(), b.view()];
        Vector {
            y: join(&self.y, &other.y),
            covariance,
            worst: join(&self.worst, &other.worst),
            signed: concatenate![Axis(0), self.signed.view(), other.signed.view()],
            residual: join(&self.residual, &other.residual),
        }
    }

    /// Entries `from` to `to`.
    pub fn part(&self, from: usize, to: usize) -> Vector {
        Vector {
            y: self.y.slice(s![from..to]).to_owned(),
            covariance: self.covariance.slice(s![from..to, from..to]).to_owned(),
            worst: self.worst.slice(s![from..to]).to_owned(),
            signed: self.signed.slice(s![from..to, ..]).to_owned(),
            residual: self.residual.slice(s![from..to]).to_owned(),
        }
    }

    /// w x + b (without b: w x), rounded as a product of arrays is.
    pub fn through(&self, w: &Array2<f64>, b: Option<&Array1<f64>>, m: &Arithmetic) -> Vector {
        let mut y = w.dot(&self.y);
        if let Some(b) = b {
            y += b;
        }
        let size = w.mapv(f64::abs);
        let mut out = Vector {
            y,
            covariance: w.dot(&self.covariance).dot(&w.t()),
            worst: size.dot(&self.worst),
            signed: w.dot(&self.signed),
            residual: absolute(&size, &self.residual),
        };
        let reach: Vec<f64> = self.entries().iter().map(|x| x.size()).collect();
        for o in 0..out.y.len() {
            let terms: Vec<f64> = reach.iter().zip(size.row(o)).map(|(x, w)| times(*x, *w)).collect();
            let bias = b.map_or(0.0, |b| b[o].abs());
            out.round_dot(o, &terms, bias, m);
        }
        out
    }

    /// Adds the rounding of entry o as a dot product: each product rounded or fused, a sum in any order, the result rounded, and once more
    /// after the bias in the short types.
    fn round_dot(&mut self, o: usize, terms: &[f64], bias: f64, m: &Arithmetic) {
        let sum: f64 = terms.iter().sum::<f64>() + bias;
        // A product that is exactly 0 neither rounds nor flushes.
        let n = terms.iter().filter(|term| **term > 0.0).count() as f64;
        let reach = self.y[o].abs() + self.error(o);
        let result = if m.u_sum < m.u { m.u * (2.0 * reach + bias) } else { 0.0 };
        let squares: f64 = terms.iter().map(|term| term * term).sum();
        let variance = m.u * m.u * squares + n * (m.u_sum * sum).powi(2) + result * result;
        self.add_local(o, variance, m.u * sum + gamma(n, m.u_sum) * sum * (1.0 + m.u) + result, m);
        if sum > m.largest {
            self.residual[o] = f64::INFINITY;
        }
        if sum > 0.0 {
            self.residual[o] += 2.0 * (n + 1.0) * m.tiny;
        }
    }

    fn add_local(&mut self, o: usize, variance: f64, worst: f64, m: &Arithmetic) {
        if variance.is_finite() {
            self.covariance[[o, o]] += variance * (1.0 + m.u).powi(4);
            self.worst[o] += worst;
        } else {
            self.residual[o] = f64::INFINITY;
        }
    }

    /// max(z, 0). A unit that may be on or off adds what the linear prediction misses: at most e - |z|.
    pub fn relu(&self) -> Vector {
        let mut out = self.clone();
        for i in 0..self.y.len() {
            let z = self.entry(i);
            if z.y <= 0.0 {
                out.silence(i, 0.0, (z.e - z.y.abs()).max(0.0));
            } else {
                out.residual[i] += (z.e - z.y).max(0.0);
            }
        }
        out
    }

    /// The gradient passed back through a ReLU of `z`: where the unit may be on or off, the whole of it is uncertain.
    pub fn masked(&self, z: &Vector) -> Vector {
        let mut out = self.clone();
        for i in 0..self.y.len() {
            let (z, on) = (z.entry(i), z.y[i] > 0.0);
            let undecided = z.e >= z.y.abs() && z.e > 0.0;
            match (undecided, on) {
                (true, _) => out.silence(i, if on { self.y[i] } else { 0.0 }, self.entry(i).size()),
                (false, false) => out.silence(i, 0.0, 0.0),
                (false, true) => {}
            }
        }
        out
    }

    /// Entry i becomes y, off by `residual` and nothing else.
    fn silence(&mut self, i: usize, y: f64, residual: f64) {
        self.y[i] = y;
        self.covariance.row_mut(i).fill(0.0);
        self.covariance.column_mut(i).fill(0.0);
        self.worst[i] = 0.0;
        self.signed.row_mut(i).fill(0.0);
        self.residual[i] = residual;
    }

    /// The sum of two vectors with the same sources, rounded.
    pub fn plus(&self, other: &Vector, m: &Arithmetic) -> Vector {
        let mut out = Vector {
            y: &self.y + &other.y,
            covariance: &self.covariance + &other.covariance,
            worst: &self.worst + &other.worst,
            signed: &self.signed + &other.signed,
            residual: &self.residual + &other.residual,
        };
        for i in 0..out.y.len() {
            let local = m.u * (out.y[i].abs() + out.error(i));
            out.add_local(i, local * local, local, m);
            out.residual[i] += if local > 0.0 { m.tiny } else { 0.0 };
        }
        out
    }
}

/// size times residual, with 0 times infinity being 0.
fn absolute(size: &Array2<f64>, residual: &Array1<f64>) -> Array1<f64> {
    size.rows().into_iter().map(|row| row.iter().zip(residual).map(|(&a, &b)| times(a, b)).sum()).collect()
}

fn times(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}
