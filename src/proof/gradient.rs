//! Gradients by finite differences: the check of every hand-written backward pass.

use crate::contract::arrays::Arrays;

/// A derivative, and by how much its last two estimates differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The derivative.
    pub value: f64,
    /// Its uncertainty: large where the function has a kink or a jump within reach of the smallest step.
    pub error: f64,
}

/// f'(0) by central differences at steps h, h/2, h/4, ..., each column of the tableau freed from one more even power of h
/// (Richardson 1911; the choice by the smallest difference is Ridders 1982).
///
/// ```
/// use nerf_oracle::proof::gradient::richardson;
/// let d = richardson(|s| (1.0 + s).powi(3), 0.5);
/// assert!((d.value - 3.0).abs() < 1e-13 && d.error < 1e-12);
/// ```
pub fn richardson(mut f: impl FnMut(f64) -> f64, step: f64) -> Estimate {
    let central = |h: f64| {
        let (ahead, back) = (f(h), f(-h));
        // The error from one rounding of f: tableau entries that agree by chance are no better than that.
        ((ahead - back) / (2.0 * h), f64::EPSILON * ahead.abs().max(back.abs()) / h)
    };
    extrapolated(central, 4.0, step)
}

/// f'(0+), or f'(0-) where `step` is negative: differences to one side, freed from one more power of h a column.
///
/// ```
/// use nerf_oracle::proof::gradient::one_sided;
/// let relu = |s: f64| s.max(0.0);
/// assert_eq!([one_sided(relu, 0.5).value, one_sided(relu, -0.5).value], [1.0, 0.0]);
/// ```
pub fn one_sided(f: impl Fn(f64) -> f64, step: f64) -> Estimate {
    let here = f(0.0);
    let difference = |h: f64| {
        let there = f(h);
        ((there - here) / h, 2.0 * f64::EPSILON * there.abs().max(here.abs()) / h.abs())
    };
    extrapolated(difference, 2.0, step)
}

/// The limit of differences (each with its noise) whose error is a series in powers of h, h^2 where `base` is 4.
fn extrapolated(mut difference: impl FnMut(f64) -> (f64, f64), base: f64, step: f64) -> Estimate {
    const HALVINGS: usize = 12;
    let mut best = Estimate { value: f64::NAN, error: f64::INFINITY };
    let mut above: Vec<f64> = vec![];
    let mut h = step;
    for _ in 0..HALVINGS {
        let (value, noise) = difference(h);
        let mut row = vec![value];
        for (column, &coarse) in above.iter().enumerate() {
            let power = base.powi(column as i32 + 1);
            let fine = row[column];
            let value = (power * fine - coarse) / (power - 1.0);
            let error = (value - fine).abs().max((value - coarse).abs()).max(noise);
            if value.is_finite() && error < best.error {
                best = Estimate { value, error };
            }
            row.push(value);
        }
        if best.error <= 1e-12 * best.value.abs() {
            break;
        }
        above = row;
        h /= 2.0;
    }
    best
}

/// The derivative of `f` at `x` along `v` (arrays that `v` lacks stay where they are); the first step is `step` times v.
pub fn directional(f: impl Fn(&Arrays) -> f64, x: &Arrays, v: &Arrays, step: f64) -> Estimate {
    richardson(|s| f(&moved(x, v, s)), step)
}

/// x + s v, over the arrays that `v` has.
pub fn moved(x: &Arrays, v: &Arrays, s: f64) -> Arrays {
    let mut moved = x.clone();
    for (name, v) in v {
        moved.get_mut(name).expect("a direction moves an input").scaled_add(s, v);
    }
    moved
}

/// The sum of products of all entries of the arrays that both have.
pub fn inner(a: &Arrays, b: &Arrays) -> f64 {
    let mut sum = crate::math::Sum::default();
    for (name, a) in a {
        for (a, b) in a.iter().zip(b.get(name).into_iter().flatten()) {
            sum.add(a * b);
        }
    }
    sum.value()
}
