//! Honest packed rendering with early stop in emulated arithmetic: `volume_render`'s honest forms, ray by ray.

use super::arrays::{one_ray, packed, spans, stopped};
use crate::contract::arrays::{Arrays, number};
use crate::contract::machine::Machine;
use crate::convention::{CS180, Conventions, Stop};
use crate::math::ln;
use crate::volume_rendering::honest;

/// Where this machine stops: T behind a sample against eps, or (every fourth form) the optical depth against -ln eps.
fn live(a: &Arrays, r: usize, (first, length): (usize, usize), stop: Stop, m: &Machine) -> usize {
    let eps = number(a, "eps");
    let passed = |n: &usize| {
        let ray = one_ray(a, r, first, *n);
        if m.form % 4 == 2 && eps > 0.0 {
            let x: Vec<f64> = ray["sigmas"].iter().zip(&ray["deltas"]).map(|(s, d)| m.mul(*s, *d)).collect();
            return m.sum(&x) > -m.elementary(ln(eps));
        }
        number(&honest::volume_render(&ray, &CS180, m), "transmittance") < m.round(eps)
    };
    (1..=length).find(passed).map_or(length, |n| match stop {
        Stop::Behind => n,
        Stop::InFront => n - 1,
        Stop::OneMore => (n + 1).min(length),
    })
}

/// Packed rendering with early stop.
pub(crate) fn early_stop(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let one = |(r, span): (usize, (usize, usize))| {
        let n = live(a, r, span, c.stop, m);
        stopped(n, span.1, honest::volume_render(&one_ray(a, r, span.0, n), &CS180, m))
    };
    packed(spans(a).into_iter().enumerate().map(one).collect())
}

/// Its gradient.
pub(crate) fn early_stop_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let one = |(r, span): (usize, (usize, usize))| {
        let n = live(a, r, span, c.stop, m);
        stopped(n, span.1, honest::volume_render_vjp(&one_ray(a, r, span.0, n), &CS180, m))
    };
    packed(spans(a).into_iter().enumerate().map(one).collect())
}
