//! Error bounds of rays in normalized device coordinates, in running error analysis.
//!
//! The widest honest form moves the origin to the near plane and then divides by the z that it finds there: n but for rounding, which is
//! that of the largest of o_z and n. The gradient by way of that z cancels, and leaves the rounding of its terms.

use super::View;
use super::arrays::{Ray, forward, view, vjp};
use crate::camera::bound::{any_order, hyper};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::Conventions;

/// A ray moved to the near plane.
struct Moved {
    d: [Bounded; 3],
    t: Bounded,
    p: [Bounded; 3],
    /// 2f/W and 2f/H with the sign of the scene's z.
    scales: [Bounded; 2],
    /// z of the near plane.
    plane: Bounded,
}

impl Moved {
    fn new(o: [f64; 3], d: [f64; 3], view: &View, m: &Arithmetic) -> Moved {
        let sign = exact(view.sign());
        let plane = m.mul(sign, hyper(view.near, m));
        let (o, d) = (o.map(exact), d.map(exact));
        let t = m.div(m.sub(plane, o[2]), d[2]);
        let p = [0, 1, 2].map(|j| m.add(o[j], m.mul(t, d[j])));
        let twice = m.mul(exact(2.0), hyper(view.focal, m));
        let scale = |size: f64| {
            let size = hyper(size, m);
            // 2 f / W, or 1 / (W / (2 f)).
            m.div(twice, size).or(m.div(exact(1.0), m.div(size, twice)))
        };
        let scales = [scale(view.width), scale(view.height)].map(|scale| m.mul(sign, scale));
        Moved { d, t, p, scales, plane }
    }

    /// Origin and direction.
    fn outputs(&self, m: &Arithmetic) -> ([Bounded; 3], [Bounded; 3]) {
        let z = self.p[2];
        let depth = m.div(m.mul(exact(2.0), self.plane), z);
        let first = m.sub(exact(1.0), depth);
        let (mut o, mut d) = ([first; 3], [depth.or(m.sub(exact(1.0), first)); 3]);
        for j in 0..2 {
            let (start, slope) = (m.div(self.p[j], z), m.div(self.d[j], self.d[2]));
            o[j] = m.mul(self.scales[j], start).or(m.div(m.mul(self.scales[j], self.p[j]), z));
            let far = m.mul(self.scales[j], slope);
            d[j] = m.mul(self.scales[j], m.sub(slope, start)).or(m.sub(far, o[j]));
        }
        (o, d)
    }

    /// Gradients of o and d, as automatic differentiation has them.
    fn gradients(&self, (g_o, g_d): Ray, m: &Arithmetic) -> ([Bounded; 3], [Bounded; 3]) {
        let (z, d, t) = (self.p[2], &self.d, self.t);
        let over_z = m.div(exact(1.0), m.mul(z, z));
        let both = |j: usize| m.sub(exact(g_o[j]), exact(g_d[j]));
        // Of x/z, y/z: factored, or the gradients of o' and d' one after the other.
        let g_start = [0, 1].map(|j| {
            let (first, second) =
                (m.mul(self.scales[j], exact(g_o[j])), m.mul(self.scales[j], exact(g_d[j])));
            m.mul(self.scales[j], both(j)).or(m.sub(first, second))
        });
        let g_slope = [0, 1].map(|j| m.mul(self.scales[j], exact(g_d[j])));
        let through_start = [0, 1].map(|j| m.mul(m.mul(g_start[j], self.p[j]), over_z).neg());
        let through_depth = m.mul(m.mul(m.mul(exact(2.0), self.plane), both(2)), over_z);
        let g_z = any_order(&[through_start[0], through_start[1], through_depth], m);
        let g_p = [m.div(g_start[0], z), m.div(g_start[1], z), g_z];
        let g_t = any_order(&[0, 1, 2].map(|j| m.mul(g_p[j], d[j])), m);
        let shared = m.div(g_t, d[2]);
        let of_slope = [0, 1].map(|j| m.div(g_slope[j], d[2]));
        let back = [0, 1].map(|j| m.div(m.mul(of_slope[j], d[j]), d[2]).neg());
        let along = [0, 1, 2].map(|j| m.mul(g_p[j], t));
        let last = any_order(&[along[2], m.mul(shared, t).neg(), back[0], back[1]], m);
        (
            [g_p[0], g_p[1], m.sub(g_z, shared)],
            [m.add(along[0], of_slope[0]), m.add(along[1], of_slope[1]), last],
        )
    }
}

fn errors((o, d): ([Bounded; 3], [Bounded; 3])) -> Ray {
    (o.map(|x| x.e), d.map(|x| x.e))
}

/// Bound of [`super::ndc_ray`].
pub(crate) fn ndc_rays(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |o, d| errors(Moved::new(o, d, &view(a, c), m).outputs(m)))
}

/// Bound of [`super::backward::ndc_ray`].
pub(crate) fn ndc_rays_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |(o, d), g| errors(Moved::new(o, d, &view(a, c), m).gradients(g, m)))
}
