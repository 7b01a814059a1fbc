//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{View, backward};
use crate::contract::arrays::{Arrays, array, arrays, number, threes};
use crate::convention::Conventions;

/// A ray: origin and direction.
pub(crate) type Ray = ([f64; 3], [f64; 3]);

/// The view of a case.
pub(crate) fn view(a: &Arrays, c: &Conventions) -> View {
    View {
        width: number(a, "width"),
        height: number(a, "height"),
        focal: number(a, "focal"),
        near: number(a, "near"),
        depth: c.ndc_depth,
    }
}

/// Pairs of rows of two (R, 3) arrays.
fn pairs(a: &Arrays, first: &str, second: &str) -> Vec<Ray> {
    threes(a, first).into_iter().zip(threes(a, second)).collect()
}

/// Pairs as two (R, 3) arrays.
fn unpaired(names: [&str; 2], rays: &[Ray]) -> Arrays {
    let side = |f: fn(&Ray) -> [f64; 3]| array(&[rays.len(), 3], rays.iter().flat_map(f).collect());
    arrays([(names[0], side(|ray| ray.0)), (names[1], side(|ray| ray.1))])
}

/// `f(o, d)` of each ray, as the outputs.
pub(crate) fn forward(a: &Arrays, f: impl Fn([f64; 3], [f64; 3]) -> Ray) -> Arrays {
    let rays: Vec<Ray> = pairs(a, "rays_o", "rays_d").into_iter().map(|(o, d)| f(o, d)).collect();
    unpaired(["rays_o_ndc", "rays_d_ndc"], &rays)
}

/// `f(ray, cotangent)` of each ray, as the gradients.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(Ray, Ray) -> Ray) -> Arrays {
    let cotangents = pairs(a, "grad_rays_o_ndc", "grad_rays_d_ndc");
    let rays = pairs(a, "rays_o", "rays_d").into_iter().zip(cotangents);
    let gradients: Vec<Ray> = rays.map(|(ray, g)| f(ray, g)).collect();
    unpaired(["grad_rays_o", "grad_rays_d"], &gradients)
}

pub(super) fn ndc_rays(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |o, d| super::ndc_ray(o, d, &view(a, c)))
}

pub(super) fn ndc_rays_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |(o, d), (g_o, g_d)| backward::ndc_ray(o, d, &view(a, c), g_o, g_d))
}
