//! Adam on one flat f32 vector, as PyTorch defines it (Kingma and Ba 2015, algorithm 1, eps outside the root); the only Adam in f32.

use pulp::{Arch, Simd, WithSimd};

use super::{Adam, bias_correction};
use crate::parallel;

/// Entries that one task updates.
const CHUNK: usize = 1 << 15;

/// Running means of all parameters, and the number of steps taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    /// Steps taken so far.
    pub step: u64,
    /// Means of gradients.
    pub m: Vec<f32>,
    /// Means of squared gradients.
    pub v: Vec<f32>,
}

impl Moments {
    /// Before the first step, for `len` parameters.
    pub fn new(len: usize) -> Self {
        Moments { step: 0, m: vec![0.0; len], v: vec![0.0; len] }
    }

    /// One step of [`super::adam_step`] for every parameter. What depends on the step alone is computed in f64.
    ///
    /// # Panics
    /// Where the lengths differ.
    pub fn update(&mut self, arch: Arch, adam: &Adam, params: &mut [f32], gradient: &[f32]) {
        assert!(params.len() == self.m.len() && gradient.len() == self.m.len(), "one gradient a parameter");
        self.step += 1;
        let rates = Rates::new(adam, self.step);
        let mut tasks: Vec<_> = params
            .chunks_mut(CHUNK)
            .zip(self.m.chunks_mut(CHUNK).zip(self.v.chunks_mut(CHUNK)))
            .zip(gradient.chunks(CHUNK))
            .collect();
        parallel::for_each(&mut tasks, |((params, (m, v)), gradient)| {
            arch.dispatch(Task { rates, params, m, v, gradient });
        });
    }
}

/// The factors that all parameters share in a step, computed in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    rate: f32,
    /// One over the root of the second bias correction: a product a parameter where there would be a division.
    root: f32,
    keep: [f32; 2],
    take: [f32; 2],
    eps: f32,
    decay: f32,
}

impl Rates {
    /// Those of `step`, counted from 1.
    pub fn new(adam: &Adam, step: u64) -> Self {
        let Adam { lr, beta1, beta2, eps, weight_decay } = *adam;
        Rates {
            rate: (lr / bias_correction(beta1, step)) as f32,
            root: (1.0 / bias_correction(beta2, step).sqrt()) as f32,
            keep: [beta1 as f32, beta2 as f32],
            take: [(1.0 - beta1) as f32, (1.0 - beta2) as f32],
            eps: eps as f32,
            decay: weight_decay as f32,
        }
    }

    /// The step of some parameters.
    #[inline(always)]
    pub fn apply(&self, params: &mut [f32], gradient: &[f32], m: &mut [f32], v: &mut [f32]) {
        for (((p, &g), m), v) in params.iter_mut().zip(gradient).zip(m).zip(v) {
            (*p, *m, *v) = self.one(*p, g, *m, *v);
        }
    }

    /// The step of one parameter: (param, m, v) after it.
    #[inline(always)]
    pub fn one(&self, p: f32, g: f32, m: f32, v: f32) -> (f32, f32, f32) {
        let g = g + self.decay * p;
        let m = self.keep[0] * m + self.take[0] * g;
        let v = self.keep[1] * v + self.take[1] * g * g;
        (p - self.rate * m / (v.sqrt() * self.root + self.eps), m, v)
    }
}

struct Task<'a> {
    rates: Rates,
    params: &'a mut [f32],
    m: &'a mut [f32],
    v: &'a mut [f32],
    gradient: &'a [f32],
}

impl WithSimd for Task<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.rates.apply(self.params, self.gradient, self.m, self.v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimizer::{Moments as Oracle, adam_step};

    /// Twenty steps with gradients of all sizes stay within a few roundings of the oracle, decayed weights too.
    #[test]
    fn agrees_with_the_oracle() {
        let adam = Adam { lr: 1e-2, weight_decay: 1e-3, ..Adam::default() };
        for arch in [crate::simd::arch(), Arch::Scalar] {
            let mut params: Vec<f32> = (0..100).map(|i| (i as f32).sin()).collect();
            let mut oracle: Vec<_> =
                params.iter().map(|&p| Oracle { param: p.into(), m: 0.0, v: 0.0 }).collect();
            let mut moments = Moments::new(100);
            for step in 1..=20 {
                let g: Vec<f32> =
                    (0..100).map(|i| (i as f32 - 50.0).exp2() * ((i * step) as f32).cos()).collect();
                moments.update(arch, &adam, &mut params, &g);
                for (o, g) in oracle.iter_mut().zip(g) {
                    *o = adam_step(&adam, *o, g.into(), step as u64);
                }
            }
            for (p, o) in params.iter().zip(oracle) {
                // 20 steps of at most lr, each within 8 roundings, and 20 roundings of a parameter of size 1.
                assert!((f64::from(*p) - o.param).abs() < 20.0 * (8.0 * 1e-2 + 1.0) * (-24f64).exp2());
            }
        }
    }
}
