//! Honest fisheyes in emulated arithmetic: powers or Horner's scheme, quotient or factor; inverses by Newton's method; gradients by the two
//! stretches, or as the chain rule has them.

use super::arrays::coefficients;
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;
use crate::lens::arrays::{Pair, forward, vjp};

/// 1 + a t^2 + b t^4 + c t^6 + d t^8.
fn polynomial(k: [f64; 4], theta: f64, m: &Machine) -> f64 {
    let t2 = m.mul(theta, theta);
    if m.form % 2 == 0 {
        return m.add(1.0, k.iter().rev().fold(0.0, |inner, &k| m.mul(t2, m.add(k, inner))));
    }
    let t4 = m.mul(t2, t2);
    m.add(1.0, m.dot(&k, &[t2, t4, m.mul(t4, t2), m.mul(t4, t4)]))
}

fn bent(k: [f64; 4], theta: f64, m: &Machine) -> f64 {
    m.mul(theta, polynomial(k, theta, m))
}

fn slope(k: [f64; 4], theta: f64, m: &Machine) -> f64 {
    let steep = [m.mul(3.0, k[0]), m.mul(5.0, k[1]), m.mul(7.0, k[2]), m.mul(9.0, k[3])];
    polynomial(steep, theta, m)
}

fn length(x: Pair, m: &Machine) -> f64 {
    m.sqrt(m.dot(&x, &x))
}

/// (to / from) x.
fn scaled(x: Pair, to: f64, from: f64, m: &Machine) -> Pair {
    x.map(|x| match m.form % 3 {
        0 => m.mul(x, m.div(to, from)),
        1 => m.mul(to, m.div(x, from)),
        _ => m.div(m.mul(x, to), from),
    })
}

/// Distorted points.
pub(crate) fn fisheye_distort(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let k = coefficients(a);
    forward(a, "points", "distorted", |p| {
        let r = length(p, m);
        if r == 0.0 {
            return p;
        }
        let theta = m.elementary(libm::atan(r));
        scaled(p, bent(k, theta, m), r, m)
    })
}

/// A point's direction, its two stretches and its angle.
fn stretches(k: [f64; 4], p: Pair, m: &Machine) -> (Pair, [f64; 2], f64) {
    let r = length(p, m);
    let theta = m.elementary(libm::atan(r));
    let along = m.div(slope(k, theta, m), m.add(1.0, m.mul(r, r)));
    (p.map(|x| m.div(x, r)), [along, m.div(bent(k, theta, m), r)], theta)
}

/// a (u . g) u + b (g - (u . g) u), or b g + (a - b) (u . g) u.
fn stretched(u: Pair, [a, b]: [f64; 2], g: Pair, m: &Machine) -> Pair {
    let radial = m.dot(&u, &g);
    [0, 1].map(|j| match m.stable {
        true => m.add(m.mul(a, m.mul(radial, u[j])), m.mul(b, m.sub(g[j], m.mul(radial, u[j])))),
        false => m.add(m.mul(b, g[j]), m.mul(m.mul(m.sub(a, b), radial), u[j])),
    })
}

/// theta^3, ..., theta^9, times a factor.
fn odd_powers(theta: f64, factor: f64, m: &Machine) -> [f64; 4] {
    let t2 = m.mul(theta, theta);
    let mut power = theta;
    [(); 4].map(|()| {
        power = m.mul(power, t2);
        m.mul(power, factor)
    })
}

/// Their gradient.
pub(crate) fn fisheye_distort_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let k = coefficients(a);
    let f = |p: Pair, g: Pair| {
        if p == [0.0; 2] {
            return (g, [0.0; 4]);
        }
        let (u, both, theta) = stretches(k, p, m);
        (stretched(u, both, g, m), odd_powers(theta, m.dot(&u, &g), m))
    };
    vjp(a, "points", "distorted", f, |terms| m.sum(terms))
}

/// The ideal point, by a dozen steps of Newton's method.
fn inverse(k: [f64; 4], target: Pair, m: &Machine) -> Pair {
    let theta_d = length(target, m);
    if theta_d == 0.0 {
        return target;
    }
    let step = |theta: f64, _| {
        let residual = m.sub(bent(k, theta, m), theta_d);
        m.sub(theta, m.div(residual, slope(k, theta, m)))
    };
    let theta = (0..12).fold(theta_d, step);
    scaled(target, m.elementary(libm::tan(theta)), theta_d, m)
}

/// Ideal points.
pub(crate) fn fisheye_undistort(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let k = coefficients(a);
    forward(a, "distorted", "points", |target| inverse(k, target, m))
}

/// Their gradient, at the points that this machine finds.
pub(crate) fn fisheye_undistort_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let k = coefficients(a);
    let f = |target: Pair, g: Pair| {
        if target == [0.0; 2] {
            return (g, [0.0; 4]);
        }
        let (u, both, theta) = stretches(k, inverse(k, target, m), m);
        let [along, across] = both.map(|stretch| m.div(1.0, stretch));
        let h = m.mul(along, m.dot(&u, &g));
        (stretched(u, [along, across], g, m), odd_powers(theta, -h, m))
    };
    vjp(a, "distorted", "points", f, |terms| m.sum(terms))
}
