//! Lenses, wrong on purpose. Without a mistake every function equals the oracle.

mod catalogue;
pub(crate) mod laws;
mod wrong_lens;

use super::Distortion;
use super::arrays::{Pair, forward, in_order, lens, undistorted, vjp};
use super::backward;
use crate::contract::arrays::{Arrays, values};
use crate::convention::Conventions;
use catalogue::{FEW_STEPS, FEW_STEPS_OF_DIFFERENCES, FEW_STEPS_OF_NEWTON};
pub(crate) use catalogue::{LENS_DISTORT, LENS_UNDISTORT};
use wrong_lens::{MISREAD, WrongLens};

/// A lens of these coefficients as wrong code reads it; `None` where the mistakes are others.
fn misread(a: &Arrays, wrong: &[&str]) -> Option<WrongLens> {
    let reads = MISREAD.iter().any(|name| wrong.contains(name));
    reads.then(|| WrongLens::new(&values(a, "coefficients"), wrong))
}

/// Distorted points.
pub(crate) fn lens_distort(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (lens, misread) = (lens(a), misread(a, wrong));
    forward(a, "points", "distorted", |p| match &misread {
        _ if wrong.contains(&"undone_instead") => undistorted(&lens, p).to_array(),
        Some(lens) => lens.distort(p.into()).to_array(),
        None => lens.distort(p.into()).to_array(),
    })
}

/// Their gradient.
pub(crate) fn lens_distort_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (lens, misread) = (lens(a), misread(a, wrong));
    let f = |p: Pair, g: Pair| {
        let (mut g_p, mut g_k) = match &misread {
            Some(lens) => lens.backward(p.into(), g.into()),
            None => backward::distort(&lens, p.into(), g.into()),
        };
        if wrong.contains(&"radius_not_differentiated") {
            g_p = glam::DVec2::from(g) * lens.radial(p.into()).value;
        }
        if wrong.contains(&"lens_held_constant") {
            g_k = [0.0; 8];
        }
        (g_p.to_array(), g_k)
    };
    vjp(a, "points", "distorted", f, in_order)
}

/// So many steps from the target on; a part of the last one where the number isn't whole.
fn stepped(target: Pair, steps: f64, step: impl Fn(Pair) -> Pair) -> Pair {
    let mut p = target;
    let mut left = steps;
    while left > 0.0 {
        let next = step(p);
        p = [0, 1].map(|j| p[j] + left.min(1.0) * (next[j] - p[j]));
        left -= 1.0;
    }
    p
}

/// x = (x' - tangential) / radial, so many times.
fn fixed_point(lens: &Distortion, target: Pair, steps: f64) -> Pair {
    stepped(target, steps, |p| {
        let radial = lens.radial(p.into()).value;
        let bent = lens.distort(p.into()).to_array();
        [0, 1].map(|j| (target[j] - (bent[j] - p[j] * radial)) / radial)
    })
}

/// x += x' - distort(x), so many times.
fn by_differences(lens: &Distortion, target: Pair, steps: f64) -> Pair {
    stepped(target, steps, |p| {
        let bent = lens.distort(p.into()).to_array();
        [0, 1].map(|j| p[j] + target[j] - bent[j])
    })
}

/// So many steps of Newton's method.
fn by_newton(lens: &Distortion, target: Pair, steps: f64) -> Pair {
    stepped(target, steps, |p| {
        let off = lens.distort(p.into()) - glam::DVec2::from(target);
        (glam::DVec2::from(p) - lens.jacobian(p.into()).inverse() * off).to_array()
    })
}

/// Ideal points.
pub(crate) fn lens_undistort(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (lens, misread) = (lens(a), misread(a, wrong));
    let has = |name: &str| wrong.contains(&name);
    let negative = Distortion::from_opencv(&values(a, "coefficients").iter().map(|k| -k).collect::<Vec<_>>());
    let few = [FEW_STEPS, FEW_STEPS_OF_DIFFERENCES, FEW_STEPS_OF_NEWTON].map(|mistake| mistake.among(wrong));
    forward(a, "distorted", "points", |target| match (few, &misread) {
        ([Some(steps), ..], _) => fixed_point(&lens, target, steps),
        ([_, Some(steps), _], _) => by_differences(&lens, target, steps),
        ([.., Some(steps)], _) => by_newton(&lens, target, steps),
        _ if has("one_step") => fixed_point(&lens, target, 1.0),
        (_, Some(lens)) if has("distorted_again") => lens.distort(target.into()).to_array(),
        _ if has("distorted_again") => lens.distort(target.into()).to_array(),
        _ if has("signs_flipped") => negative.distort(target.into()).to_array(),
        (_, Some(lens)) => lens.undistort(target.into()).to_array(),
        (_, None) => undistorted(&lens, target).to_array(),
    })
}

/// Their gradient.
pub(crate) fn lens_undistort_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (lens, misread) = (lens(a), misread(a, wrong));
    let f = |target: Pair, g: Pair| {
        let p = undistorted(&lens, target);
        let (mut h, mut g_k) = match &misread {
            Some(lens) => lens.inverse_backward(lens.undistort(target.into()), g.into()),
            None => backward::undistort(&lens, p, g.into()),
        };
        match () {
            () if wrong.contains(&"handed_through") => h = g.into(),
            () if wrong.contains(&"jacobian_not_inverted") => h = lens.jacobian(p) * glam::DVec2::from(g),
            () => {}
        }
        if wrong.contains(&"lens_held_constant") {
            g_k = [0.0; 8];
        }
        (h.to_array(), g_k)
    };
    vjp(a, "distorted", "points", f, in_order)
}
