//! Registry row of rays and boxes.

use ndarray::{ArrayD, Zip};

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{Arrays, number};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Form, Special, Unread};

/// Where rays enter and leave a box.
pub(crate) const RAY_AABB: Component = Component {
    name: "ray_aabb",
    folder: "ray_aabb",
    code: include_str!("honest.rs"),
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
        Port::plain("hit", "R", "1 where a part of the ray lies in the closed box, a face included, else 0")
            .of(Entries::Bit),
    ],
    conventions: &[],
    forward: Direction {
        oracle: arrays::rays_and_box,
        bound: bound::ray_aabb,
        honest: honest::ray_aabb,
        wrong: mistakes::ray_aabb,
    },
    vjp: Some(Direction {
        oracle: arrays::rays_and_box_vjp,
        bound: bound::ray_aabb_vjp,
        honest: honest::ray_aabb_vjp,
        wrong: mistakes::ray_aabb_vjp,
    }),
    cases: cases::ray_aabb,
    mistakes: mistakes::RAY_AABB,
    special: Special {
        forms: &[Form {
            without: &["near", "far"],
            takes: None,
            meaning: "rays begin at 0 and have no end: nothing is cut at far",
            holds: without_range,
        }],
        unread: Some(Unread { outputs: &["t_near", "t_far"], by: "hit", told: hit }),
        large: cases::large,
        laws: Some(mistakes::laws::OF_BOXES),
        ..Special::NONE
    },
};

/// hit = max(near, t_near) <= min(far, t_far), for who answers both t alone.
fn hit(inputs: &Arrays, t: &[ArrayD<f64>]) -> ArrayD<f64> {
    let (near, far) = (number(inputs, "near"), number(inputs, "far"));
    let one = |enter: &f64, leave: &f64| f64::from(u8::from(enter.max(near) <= leave.min(far)));
    Zip::from(&t[0]).and(&t[1]).map_collect(one)
}

/// Whether near is 0, and far beyond every box that a ray's line meets.
fn without_range(inputs: &Arrays, _: Dtype) -> bool {
    let beyond = |q: &arrays::RayAndBox| {
        let line = super::intersect(q.o, q.d, q.low, q.high);
        line.is_none_or(|line| 1.125 * line.leave < q.far)
    };
    let rays = arrays::rays_and_boxes(inputs);
    rays.iter().all(|q| q.near == 0.0 && beyond(q))
}
