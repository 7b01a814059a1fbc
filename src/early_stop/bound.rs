//! Error bounds of packed rendering with early stop.
//!
//! Where a transmittance is closer to eps than its own error, an honest implementation may stop there or not. The bound covers
//! every number of samples that it may use, each by the bound of `volume_render` and by what the oracle itself answers for that
//! number. A ray that is made opaque is divided by an opacity that has an error of its own.

use super::arrays::{becomes_opaque, one_ray, packed, spans, stopped};
use super::{backward, made_opaque, used_samples};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, array, arrays, number, rows3, values, values_of};
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{CS180, Conventions, ProductEps, Stop, Stopped};
use crate::math::{expm1, ln};
use crate::volume_rendering::Rendering;
use crate::volume_rendering::arrays::{cotangent, renderings};
use crate::volume_rendering::bound::{Arriving, Ray, transmittance};
use crate::volume_rendering::component::VOLUME_RENDER;
use crate::volume_rendering::volume_render;

/// The numbers of samples of a ray that an honest implementation may use, and whether it takes T behind them to be below eps.
fn candidates(a: &Arrays, (first, length): (usize, usize), stop: Stop, m: &Arithmetic) -> Vec<(usize, bool)> {
    let eps = number(a, "eps");
    // eps itself rounded, or its logarithm compared with the optical depth.
    let slack =
        eps * (m.u + expm1(2.0 * m.u * m.elementary_ulp * if eps > 0.0 { ln(eps).abs() } else { 0.0 }));
    let mut found = vec![];
    let [sigmas, deltas] = ["sigmas", "deltas"].map(|name| values_of(a, name, first..first + length));
    let light = volume_render(&sigmas, &vec![[0.0; 3]; length], &deltas, ProductEps::None).transmittance;
    let errors = transmittance(&sigmas, &deltas, m);
    for n in 1..=length {
        let (t, off) = (light[n], errors[n]);
        if (t - off).max(0.0) < eps + slack {
            found.push(match stop {
                Stop::Behind => (n, true),
                Stop::InFront => (n - 1, false),
                Stop::OneMore => ((n + 1).min(length), true),
            });
        }
        if t + off < eps - slack {
            return found;
        }
    }
    found.push((length, false));
    found
}

/// One ray's answer and its bound.
struct Way {
    oracle: fn(&Arrays) -> Arrays,
    bound: fn(&Arrays, &Arithmetic) -> Arrays,
}

const LEFT: Way = Way {
    oracle: |ray| (VOLUME_RENDER.forward.oracle)(ray, &CS180),
    bound: |ray, m| (VOLUME_RENDER.forward.bound)(ray, &CS180, m),
};
const LEFT_VJP: Way = Way {
    oracle: |ray| (VOLUME_RENDER.vjp.expect("it has a gradient").oracle)(ray, &CS180),
    bound: |ray, m| (VOLUME_RENDER.vjp.expect("it has a gradient").bound)(ray, &CS180, m),
};
const OPAQUE: Way = Way {
    oracle: |ray| renderings(values(ray, "sigmas").len(), &[made_opaque(&rendered(ray))]),
    bound: opaque,
};
const OPAQUE_VJP: Way = Way {
    oracle: |ray| {
        let g = backward::made_opaque(&rendered(ray), &cotangent(ray, 0));
        let of_rendering = arrays([
            ("grad_colors", array(&[1, 3], g.color.to_vec())),
            ("grad_weights", array(&[1, g.weights.len()], g.weights)),
            ("grad_opacity", array(&[1], vec![g.opacity])),
            ("grad_transmittance", array(&[1], vec![g.transmittance])),
        ]);
        (LEFT_VJP.oracle)(&ray.clone().into_iter().chain(of_rendering).collect())
    },
    bound: opaque_vjp,
};

/// All samples of a ray, by the oracle.
fn rendered(ray: &Arrays) -> Rendering {
    let (sigmas, deltas) = (values(ray, "sigmas"), values(ray, "deltas"));
    volume_render(&sigmas, &rows3(ray, "rgbs", 0), &deltas, ProductEps::None)
}

/// Over all candidates, the distance of their exact answer from the oracle's, plus their own bound.
fn covering(a: &Arrays, left: &Way, opaque: &Way, c: &Conventions, m: &Arithmetic) -> Arrays {
    let mut rays = vec![];
    for (r, (first, length)) in spans(a).into_iter().enumerate() {
        let way = |below: bool| if below && c.stopped == Stopped::MadeOpaque { opaque } else { left };
        let answer = |n: usize, way: &Way| stopped(n, length, (way.oracle)(&one_ray(a, r, first, n)));
        let [sigmas, deltas] = ["sigmas", "deltas"].map(|name| values_of(a, name, first..first + length));
        let live = used_samples(&sigmas, &deltas, number(a, "eps"), c.stop);
        let below = becomes_opaque(&rendered(&one_ray(a, r, first, live)), number(a, "eps"), c);
        let right = answer(live, way(below));
        let mut bound: Arrays = right.iter().map(|(name, y)| (name.clone(), y.mapv(|_| 0.0))).collect();
        for (n, below) in candidates(a, (first, length), c.stop, m) {
            let own = stopped(0, length, (way(below).bound)(&one_ray(a, r, first, n), m));
            let other = answer(n, way(below));
            for (name, bound) in &mut bound {
                let far = (&other[name] - &right[name]).mapv(f64::abs) + &own[name];
                bound.zip_mut_with(&far, |bound, &far| *bound = bound.max(far));
            }
        }
        rays.push(bound);
    }
    packed(rays)
}

/// A ray divided by its opacity, as a quotient or as a product with the inverse.
fn opaque(ray: &Arrays, m: &Arithmetic) -> Arrays {
    let ray = Ray::of_case(ray, 0, ProductEps::None, m);
    let (color, whole, _) = ray.outputs(ProductEps::None, m);
    let weights = ray.weights.iter().map(|&w| divided(w, whole, m).e).collect();
    // A / A, where A is what it is.
    let one = divided(exact(1.0), exact(1.0), m);
    arrays([
        ("colors", array(&[1, 3], color.map(|color| divided(color, whole, m).e).to_vec())),
        ("weights", array(&[1, ray.weights.len()], weights)),
        ("opacity", array(&[1], vec![one.e])),
        ("transmittance", array(&[1], vec![m.sub(exact(1.0), one).e])),
    ])
}

fn divided(x: Bounded, whole: Bounded, m: &Arithmetic) -> Bounded {
    m.div(x, whole).or(m.mul(x, m.div(exact(1.0), whole)))
}

/// Its gradient. The opacity becomes A / A = 1, whose gradient is what two terms leave that cancel.
fn opaque_vjp(of: &Arrays, m: &Arithmetic) -> Arrays {
    let ray = Ray::of_case(of, 0, ProductEps::None, m);
    let (color, whole, _) = ray.outputs(ProductEps::None, m);
    let g = cotangent(of, 0);
    let shares = |of: &[Bounded]| of.iter().map(|&x| divided(x, whole, m)).collect::<Vec<_>>();
    let (g_color, g_weights) = (g.color.map(exact), g.weights.iter().copied().map(exact).collect::<Vec<_>>());
    let worth = m.add(m.dot(&g_color, &shares(&color)), m.dot(&g_weights, &shares(&ray.weights)));
    let less_worth = |g: Bounded| {
        let apart = m.sub(divided(g, whole, m), divided(worth, whole, m));
        divided(m.sub(g, worth), whole, m).or(apart)
    };
    let inverse = m.div(exact(1.0), exact(whole.y));
    let through_opacity = m.mul(exact(g.opacity.abs() + g.transmittance.abs()), inverse);
    let cancels = m.sub(through_opacity, m.mul(m.mul(through_opacity, exact(whole.y)), inverse));
    let arriving = Arriving {
        color: g_color.map(|g| divided(g, whole, m)),
        weights: g_weights.into_iter().map(less_worth).collect(),
        opacity: exact(0.0).widened(cancels.e),
        transmittance: exact(0.0),
    };
    let (g_x, g_rgbs) = ray.gradients_from(&arriving, ProductEps::None, m);
    let times = |name: &str| -> Vec<f64> {
        values(of, name).iter().zip(&g_x).map(|(&x, &g)| m.mul(exact(x), g).e).collect()
    };
    let n = g_x.len();
    arrays([
        ("grad_sigmas", array(&[1, n], times("deltas"))),
        ("grad_rgbs", array(&[1, n, 3], g_rgbs.iter().flat_map(|g| g.map(|g| g.e)).collect())),
        ("grad_deltas", array(&[1, n], times("sigmas"))),
    ])
}

/// Bound of [`super::render_packed`].
pub(crate) fn early_stop(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    covering(a, &LEFT, &OPAQUE, c, m)
}

/// Bound of [`super::backward::render_packed`].
pub(crate) fn early_stop_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    covering(a, &LEFT_VJP, &OPAQUE_VJP, c, m)
}
