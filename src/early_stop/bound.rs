//! Error bounds of packed rendering with early stop.
//!
//! Where a transmittance is closer to eps than its own error, an honest implementation may stop there or not. The bound covers
//! every number of samples that it may use, each by the bound of `volume_render` and by what the oracle itself answers for that
//! number.

use super::arrays::{one_ray, packed, spans, stopped};
use super::used_samples;
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, number, values};
use crate::contract::component::Direction;
use crate::convention::{CS180, Conventions, ProductEps, Stop};
use crate::math::{expm1, ln};
use crate::volume_rendering::bound::transmittance;
use crate::volume_rendering::component::VOLUME_RENDER;
use crate::volume_rendering::volume_render;

/// The numbers of samples of a ray that an honest implementation may use.
fn candidates(a: &Arrays, (first, length): (usize, usize), stop: Stop, m: &Arithmetic) -> Vec<usize> {
    let eps = number(a, "eps");
    // eps itself rounded, or its logarithm compared with the optical depth.
    let slack =
        eps * (m.u + expm1(2.0 * m.u * m.elementary_ulp * if eps > 0.0 { ln(eps).abs() } else { 0.0 }));
    let mut found = vec![];
    let (sigmas, deltas) =
        (&values(a, "sigmas")[first..first + length], &values(a, "deltas")[first..first + length]);
    let light = volume_render(sigmas, &vec![[0.0; 3]; length], deltas, ProductEps::None).transmittance;
    let errors = transmittance(sigmas, deltas, m);
    for n in 1..=length {
        let (t, off) = (light[n], errors[n]);
        if (t - off).max(0.0) < eps + slack {
            found.push(match stop {
                Stop::Behind => n,
                Stop::InFront => n - 1,
                Stop::OneMore => (n + 1).min(length),
            });
        }
        if t + off < eps - slack {
            return found;
        }
    }
    if found.last() != Some(&length) {
        found.push(length);
    }
    found
}

/// The bound of one direction: over all candidate numbers, the distance of their exact answer from the oracle's, plus their own bound.
fn covering(a: &Arrays, direction: &Direction, stop: Stop, m: &Arithmetic) -> Arrays {
    let mut rays = vec![];
    for (r, (first, length)) in spans(a).into_iter().enumerate() {
        let answer = |n: usize| stopped(n, length, (direction.oracle)(&one_ray(a, r, first, n), &CS180));
        let (sigmas, deltas) = (values(a, "sigmas"), values(a, "deltas"));
        let span = first..first + length;
        let right = answer(used_samples(&sigmas[span.clone()], &deltas[span], number(a, "eps"), stop));
        let mut bound: Arrays = right.iter().map(|(name, y)| (name.clone(), y.mapv(|_| 0.0))).collect();
        for n in candidates(a, (first, length), stop, m) {
            let own = stopped(0, length, (direction.bound)(&one_ray(a, r, first, n), &CS180, m));
            let other = answer(n);
            for (name, bound) in &mut bound {
                let far = (&other[name] - &right[name]).mapv(f64::abs) + &own[name];
                bound.zip_mut_with(&far, |bound, &far| *bound = bound.max(far));
            }
        }
        rays.push(bound);
    }
    packed(rays)
}

/// Bound of [`super::render_packed`].
pub(crate) fn early_stop(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    covering(a, &VOLUME_RENDER.forward, c.stop, m)
}

/// Bound of [`super::backward::render_packed`].
pub(crate) fn early_stop_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    covering(a, &VOLUME_RENDER.vjp.expect("it has a gradient"), c.stop, m)
}
