//! Error bounds of the contraction of Gaussians: the widest of the ways that honest code takes, each in running error analysis.
//!
//! Where rounding leaves open whether a mean is inside, or coordinates tie for the largest, the bound covers each answer.

use super::Gaussian;
use super::arrays::{forward, vjp};
use super::honest::{Choice, Numbers, WAYS, Ways, points, radius};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::Bounded;
use crate::contraction::{bound::contraction, length};
use crate::convention::{ContractionNorm, Conventions};

/// What honest code may take a mean for, the oracle's choice first.
fn choices(m: &Arithmetic, x: [f64; 3], norm: ContractionNorm) -> Vec<Choice> {
    let r = radius(m, x, norm);
    let beyond = Choice::beyond(x, norm);
    match () {
        () if r.y + r.e < 1.0 => vec![Choice::INSIDE],
        () if r.y - r.e > 1.0 => beyond,
        () if length(x, norm) <= 1.0 => [vec![Choice::INSIDE], beyond].concat(),
        () => [beyond, vec![Choice::INSIDE]].concat(),
    }
}

/// How far off twelve numbers may be, on all ways and with all choices.
fn widest(
    m: &Arithmetic,
    x: &Gaussian,
    c: &Conventions,
    f: impl Fn(&Ways<Arithmetic>) -> [Bounded; 12],
) -> Gaussian {
    let choices = choices(m, x.mean, c.contraction_norm);
    let mut e = [0.0; 12];
    for way in 0..WAYS {
        let all: Vec<[Bounded; 12]> =
            choices.iter().map(|&choice| f(&Ways::new(m, x, c, way, choice))).collect();
        for one in &all {
            for n in 0..12 {
                e[n] = f64::max(e[n], one[n].e + (one[n].y - all[0][n].y).abs());
            }
        }
    }
    let row = |n: usize| [e[n], e[n + 1], e[n + 2]];
    Gaussian { mean: row(0), covariance: [row(3), row(6), row(9)] }
}

/// A Gaussian's numbers one after the other.
fn listed(x: &Numbers<Bounded>) -> [Bounded; 12] {
    std::array::from_fn(|n| if n < 3 { x.mean[n] } else { x.covariance[n / 3 - 1][n % 3] })
}

/// Bound of [`super::contract_gaussian`]; that of the means is the contraction's.
pub(crate) fn contract_gaussians(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let mut out = forward(a, |x| {
        widest(m, x, c, |ways| {
            let covariance = ways.covariance();
            listed(&Numbers { mean: covariance[0], covariance })
        })
    });
    let means = contraction(&points(a), c, m)["contracted"].clone();
    out.insert("contracted_means".into(), means);
    out
}

/// Bound of [`super::backward::contract_gaussian`].
pub(crate) fn contract_gaussians_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |x, g| widest(m, x, c, |ways| listed(&ways.gradients(g))))
}
