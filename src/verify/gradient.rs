//! Gradients by differences: the judge of every hand-written backward.

use super::component::Arrays;

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
/// use nerf_oracle::verify::gradient::richardson;
/// let d = richardson(|s| (1.0 + s).powi(3), 0.5);
/// assert!((d.value - 3.0).abs() < 1e-13 && d.error < 1e-12);
/// ```
pub fn richardson(mut f: impl FnMut(f64) -> f64, step: f64) -> Estimate {
    const HALVINGS: usize = 12;
    let mut best = Estimate { value: f64::NAN, error: f64::INFINITY };
    let mut above: Vec<f64> = vec![];
    let mut h = step;
    for _ in 0..HALVINGS {
        let (ahead, behind) = (f(h), f(-h));
        // What one rounding of f costs: tableau entries that agree by chance are worth no more.
        let noise = f64::EPSILON * ahead.abs().max(behind.abs()) / h;
        let mut row = vec![(ahead - behind) / (2.0 * h)];
        for (column, &coarse) in above.iter().enumerate() {
            let power = 4f64.powi(column as i32 + 1);
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
    let mut sum = crate::maths::Sum::default();
    for (name, a) in a {
        for (a, b) in a.iter().zip(b.get(name).into_iter().flatten()) {
            sum.add(a * b);
        }
    }
    sum.value()
}
