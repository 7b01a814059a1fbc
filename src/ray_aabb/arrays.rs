//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Hit, backward, between};
use crate::contract::arrays::{Arrays, array, arrays, number, threes, values};
use crate::convention::Conventions;

/// One ray, with the box, near and far that all share.
#[derive(Clone, Copy)]
pub(crate) struct RayAndBox {
    pub o: [f64; 3],
    pub d: [f64; 3],
    pub low: [f64; 3],
    pub high: [f64; 3],
    pub near: f64,
    pub far: f64,
}

/// Every ray of the arrays.
pub(crate) fn rays_and_boxes(a: &Arrays) -> Vec<RayAndBox> {
    let corner = |name| {
        let v = values(a, name);
        [v[0], v[1], v[2]]
    };
    let (low, high, near, far) = (corner("low"), corner("high"), number(a, "near"), number(a, "far"));
    let rays = threes(a, "rays_o").into_iter().zip(threes(a, "rays_d"));
    rays.map(|(o, d)| RayAndBox { o, d, low, high, near, far }).collect()
}

/// `f(ray)` = t_near, t_far, hit, or the error of each, as the outputs.
pub(crate) fn forward(a: &Arrays, f: impl Fn(&RayAndBox) -> [f64; 3]) -> Arrays {
    let out: Vec<[f64; 3]> = rays_and_boxes(a).iter().map(f).collect();
    let column = |k: usize| array(&[out.len()], out.iter().map(|row| row[k]).collect());
    arrays([("t_near", column(0)), ("t_far", column(1)), ("hit", column(2))])
}

/// `f(ray, cotangent)` = gradients of o and d, as the gradient.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(&RayAndBox, Hit) -> [[f64; 3]; 2]) -> Arrays {
    let (enter, leave) = (values(a, "grad_t_near"), values(a, "grad_t_far"));
    let one = |(r, q): (usize, &RayAndBox)| f(q, Hit { enter: enter[r], leave: leave[r] });
    let out: Vec<[[f64; 3]; 2]> = rays_and_boxes(a).iter().enumerate().map(one).collect();
    let side = |k: usize| array(&[out.len(), 3], out.iter().flat_map(|g| g[k]).collect());
    arrays([("grad_rays_o", side(0)), ("grad_rays_d", side(1))])
}

/// A hit, or a miss, as the three outputs.
pub(crate) fn outputs(hit: Option<Hit>, far: f64) -> [f64; 3] {
    hit.map_or([far, far, 0.0], |hit| [hit.enter, hit.leave, 1.0])
}

pub(super) fn rays_and_box(a: &Arrays, _: &Conventions) -> Arrays {
    forward(a, |q| outputs(between(q.o, q.d, q.low, q.high, q.near, q.far), q.far))
}

pub(super) fn rays_and_box_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    vjp(a, |q, g| backward::between(q.o, q.d, q.low, q.high, [q.near, q.far], g).into())
}
