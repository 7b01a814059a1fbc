//! Honest packed rendering with early stop in emulated arithmetic: `volume_render`'s honest forms, ray by ray.

use super::arrays::{one_ray, packed, spans, stopped};
use crate::contract::arrays::{Arrays, number, values};
use crate::contract::machine::Machine;
use crate::convention::{CS180, Conventions, Stop, Stopped};
use crate::math::ln;
use crate::volume_rendering::honest;

/// How many samples this machine uses, and whether one of them takes T below eps: T behind a sample is compared with eps, or (every
/// fourth form) the optical depth with -ln eps.
fn live(a: &Arrays, r: usize, (first, length): (usize, usize), stop: Stop, m: &Machine) -> (usize, bool) {
    let eps = number(a, "eps");
    let passed = |n: &usize| {
        let ray = one_ray(a, r, first, *n);
        if m.form % 4 == 2 && eps > 0.0 {
            let x: Vec<f64> = ray["sigmas"].iter().zip(&ray["deltas"]).map(|(s, d)| m.mul(*s, *d)).collect();
            return m.sum(&x) > -m.elementary(ln(eps));
        }
        number(&honest::volume_render(&ray, &CS180, m), "transmittance") < m.round(eps)
    };
    (1..=length).find(passed).map_or((length, false), |n| match stop {
        Stop::Behind => (n, true),
        Stop::InFront => (n - 1, false),
        Stop::OneMore => ((n + 1).min(length), true),
    })
}

/// x / A, or x times 1 / A.
fn divided(x: f64, whole: f64, m: &Machine) -> f64 {
    if m.form % 2 == 0 { m.div(x, whole) } else { m.mul(x, m.div(1.0, whole)) }
}

/// Packed rendering with early stop.
pub(crate) fn early_stop(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let one = |(r, span): (usize, (usize, usize))| {
        let (n, below) = live(a, r, span, c.stop, m);
        let mut ray = honest::volume_render(&one_ray(a, r, span.0, n), &CS180, m);
        if below && c.stopped == Stopped::MadeOpaque {
            let whole = number(&ray, "opacity");
            for name in ["colors", "weights", "opacity"] {
                ray.get_mut(name).expect("an output").mapv_inplace(|x| divided(x, whole, m));
            }
            ray.insert("transmittance".into(), ray["opacity"].mapv(|opacity| m.sub(1.0, opacity)));
        }
        stopped(n, span.1, ray)
    };
    packed(spans(a).into_iter().enumerate().map(one).collect())
}

/// A ray's cotangents from those of the same ray made opaque.
fn before_division(ray: &mut Arrays, of: &Arrays, m: &Machine) {
    let whole = number(of, "opacity");
    let worth = |g: &str, name: &str| {
        let shares: Vec<f64> = values(of, name).into_iter().map(|x| divided(x, whole, m)).collect();
        m.dot(&values(ray, g), &shares)
    };
    let worth = m.add(worth("grad_colors", "colors"), worth("grad_weights", "weights"));
    ray.get_mut("grad_colors").expect("a cotangent").mapv_inplace(|g| divided(g, whole, m));
    ray.get_mut("grad_weights").expect("a cotangent").mapv_inplace(|g| divided(m.sub(g, worth), whole, m));
    for name in ["grad_opacity", "grad_transmittance"] {
        let none = ray[name].mapv(|_| 0.0);
        ray.insert(name.into(), none);
    }
}

/// Its gradient.
pub(crate) fn early_stop_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let one = |(r, span): (usize, (usize, usize))| {
        let (n, below) = live(a, r, span, c.stop, m);
        let mut ray = one_ray(a, r, span.0, n);
        if below && c.stopped == Stopped::MadeOpaque {
            let of = honest::volume_render(&ray, &CS180, m);
            before_division(&mut ray, &of, m);
        }
        stopped(n, span.1, honest::volume_render_vjp(&ray, &CS180, m))
    };
    packed(spans(a).into_iter().enumerate().map(one).collect())
}
