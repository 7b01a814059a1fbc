//! Registry row of rays and boxes.

use super::{Hit, backward, between, bound, cases, honest, mistakes};
use crate::camera::component::threes;
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, number, values};
use crate::convention::Conventions;

/// Where rays enter and leave a box.
pub const RAY_AABB: Component = Component {
    name: "ray_aabb",
    folder: "ray_aabb",
    formula: "t_near = max(near, max_a min(t_a)), t_far = min(far, min_a max(t_a)) with t_a = (low_a - o_a) / d_a, (high_a - o_a) / d_a; hit = t_near <= t_far",
    source: "Kay and Kajiya 1986, slabs; the closed box, d_a = 0 as a case of its own",
    inputs: &[
        Port::smooth("rays_o", "R,3", "origins"),
        Port::smooth("rays_d", "R,3", "directions, as they come; t counts in their lengths"),
        Port::plain("low", "3", "the box's corner of least coordinates"),
        Port::plain("high", "3", "the opposite corner"),
        Port::plain("near", "", "where rays begin"),
        Port::plain("far", "", "where they end"),
    ],
    outputs: &[
        Port::smooth("t_near", "R", "where the ray enters the box; anything on a miss (here far)"),
        Port::smooth("t_far", "R", "where it leaves the box; anything on a miss (here far)"),
        Port::plain("hit", "R", "1 where a part of the ray lies in the closed box, a face included, else 0"),
    ],
    conventions: &[],
    forward: Pass {
        oracle: rays_and_box,
        bound: bound::ray_aabb,
        honest: honest::ray_aabb,
        wrong: mistakes::ray_aabb,
    },
    vjp: Some(Pass {
        oracle: rays_and_box_vjp,
        bound: bound::ray_aabb_vjp,
        honest: honest::ray_aabb_vjp,
        wrong: mistakes::ray_aabb_vjp,
    }),
    cases: cases::ray_aabb,
    mistakes: mistakes::RAY_AABB,
};

/// One ray with the box and the range that all share.
#[derive(Clone, Copy)]
pub(crate) struct Question {
    pub o: [f64; 3],
    pub d: [f64; 3],
    pub low: [f64; 3],
    pub high: [f64; 3],
    pub near: f64,
    pub far: f64,
}

/// Every ray of the arrays.
pub(crate) fn questions(a: &Arrays) -> Vec<Question> {
    let corner = |name| {
        let v = values(a, name);
        [v[0], v[1], v[2]]
    };
    let (low, high, near, far) = (corner("low"), corner("high"), number(a, "near"), number(a, "far"));
    let rays = threes(a, "rays_o").into_iter().zip(threes(a, "rays_d"));
    rays.map(|(o, d)| Question { o, d, low, high, near, far }).collect()
}

/// `f(ray)` = t_near, t_far, hit, or how far off each may be, as the outputs.
pub(crate) fn forward(a: &Arrays, f: impl Fn(&Question) -> [f64; 3]) -> Arrays {
    let out: Vec<[f64; 3]> = questions(a).iter().map(f).collect();
    let column = |k: usize| array(&[out.len()], out.iter().map(|row| row[k]).collect());
    arrays([("t_near", column(0)), ("t_far", column(1)), ("hit", column(2))])
}

/// `f(ray, cotangent)` = gradients of o and d, as the gradient.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(&Question, Hit) -> [[f64; 3]; 2]) -> Arrays {
    let (enter, leave) = (values(a, "grad_t_near"), values(a, "grad_t_far"));
    let one = |(r, q): (usize, &Question)| f(q, Hit { enter: enter[r], leave: leave[r] });
    let out: Vec<[[f64; 3]; 2]> = questions(a).iter().enumerate().map(one).collect();
    let side = |k: usize| array(&[out.len(), 3], out.iter().flat_map(|g| g[k]).collect());
    arrays([("grad_rays_o", side(0)), ("grad_rays_d", side(1))])
}

/// A hit, or a miss, as the three outputs.
pub(crate) fn outputs(hit: Option<Hit>, far: f64) -> [f64; 3] {
    hit.map_or([far, far, 0.0], |hit| [hit.enter, hit.leave, 1.0])
}

fn rays_and_box(a: &Arrays, _: &Conventions) -> Arrays {
    forward(a, |q| outputs(between(q.o, q.d, q.low, q.high, q.near, q.far), q.far))
}

fn rays_and_box_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    vjp(a, |q, g| backward::between(q.o, q.d, q.low, q.high, [q.near, q.far], g).into())
}
