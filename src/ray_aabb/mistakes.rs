//! Rays and boxes, wrong on purpose. Without a mistake every function equals the oracle.

mod boxes;
mod catalogue;
pub(crate) mod laws;

use boxes::SHRUNK;
pub(crate) use catalogue::RAY_AABB;
use catalogue::{
    ENTERED_LATE, EPS_IN_DIRECTION, NEAR_OF_ITS_OWN, TINY_PARALLEL, TINY_POSITIVE, TINY_REPLACED,
    ZERO_REPLACED,
};

use super::arrays::{RayAndBox, forward, outputs, vjp};
use super::{Hit, backward, between};
use crate::contract::arrays::Arrays;
use crate::convention::Conventions;

/// A component of a direction as the mistakes have it.
fn wrong_component(d: f64, wrong: &[&str]) -> f64 {
    if TINY_PARALLEL.among(wrong).is_some_and(|eps| d.abs() < eps) {
        return 0.0;
    }
    let d = d + EPS_IN_DIRECTION.among(wrong).unwrap_or(0.0);
    let replaced = TINY_REPLACED.among(wrong).filter(|eps| d.abs() < *eps);
    let positive = TINY_POSITIVE.among(wrong).filter(|eps| d.abs() < *eps);
    let of_zero = ZERO_REPLACED.among(wrong).filter(|_| d == 0.0);
    match (replaced, positive.or(of_zero)) {
        (Some(eps), _) if d < 0.0 => -eps,
        (Some(eps), _) | (None, Some(eps)) => eps,
        (None, None) => d,
    }
}

/// Whether a ray lies in a face's plane, where 0 * inf decides.
fn in_a_face(q: &RayAndBox) -> bool {
    (0..3).any(|a| q.d[a] == 0.0 && (q.o[a] == q.low[a] || q.o[a] == q.high[a]))
}

fn wrong_hit(q: &RayAndBox, wrong: &[&str]) -> Option<Hit> {
    let is = |name: &str| wrong.contains(&name);
    let moved = |k: f64| [0, 1, 2].map(|a| q.low[a] + k * q.high[a]);
    let (low, high) = match () {
        () if is("center_and_size") => (moved(-0.5), moved(0.5)),
        () if is("high_taken_for_size") => (q.low, moved(1.0)),
        () if is("cube_of_the_first_axis") => ([q.low[0]; 3], [q.high[0]; 3]),
        () if is("box_about_the_origin") => (q.high.map(|x| -x), q.high),
        () if is("half_size_of_y_for_z") => {
            let (middle, half) = (0.5 * (q.low[2] + q.high[2]), 0.5 * (q.high[1] - q.low[1]));
            ([q.low[0], q.low[1], middle - half], [q.high[0], q.high[1], middle + half])
        }
        () if is("axes_of_the_box_exchanged") => {
            ([q.low[0], q.low[2], q.low[1]], [q.high[0], q.high[2], q.high[1]])
        }
        () if is("size_for_half_size") => {
            let ends = |k: f64| [0, 1, 2].map(|a| 0.5 * (q.low[a] + q.high[a]) + k * (q.high[a] - q.low[a]));
            (ends(-1.0), ends(1.0))
        }
        () if is("unit_box") => ([0.0; 3], [1.0; 3]),
        () => match SHRUNK.among(wrong) {
            Some(k) => (q.low.map(|x| x + k), q.high.map(|x| x - k)),
            None => (q.low, q.high),
        },
    };
    let mut line = Hit { enter: f64::NEG_INFINITY, leave: f64::INFINITY };
    let mut any = Hit { enter: f64::INFINITY, leave: f64::NEG_INFINITY };
    for a in 0..if is("two_axes_alone") { 2 } else { 3 } {
        let d = wrong_component(q.d[a], wrong);
        if d == 0.0 {
            let face = q.o[a] == low[a] || q.o[a] == high[a];
            let outside = q.o[a] < low[a] || q.o[a] > high[a];
            // Infinities: both above, or both below.
            if outside && is("ahead_is_a_hit") {
                let end = if q.o[a] < low[a] { f64::INFINITY } else { f64::NEG_INFINITY };
                line = Hit { enter: line.enter.max(end), leave: line.leave.min(end) };
                continue;
            }
            if outside && !is("parallel_outside_is_a_hit")
                || is("parallel_is_a_miss")
                || face && is("face_is_a_miss")
                || q.o[a] == high[a] && low[a] < high[a] && is("one_face_is_a_miss")
                || face && low[a] < high[a] && is("face_at_infinity")
            {
                return None;
            }
            continue;
        }
        let (x, y) = ((low[a] - q.o[a]) / d, (high[a] - q.o[a]) / d);
        let (first, last) = if d > 0.0 || is("sign_ignored") { (x, y) } else { (y, x) };
        let first = if a == 2 && is("entry_of_z_forgotten") { f64::NEG_INFINITY } else { first };
        let last = if a == 1 && is("exit_of_y_forgotten") { f64::INFINITY } else { last };
        line = Hit { enter: line.enter.max(first), leave: line.leave.min(last) };
        any = Hit { enter: any.enter.min(first), leave: any.leave.max(last) };
    }
    if is("first_slab") && any.enter < any.leave {
        line = any;
    }
    if is("first_entry") {
        line.enter = any.enter.min(line.enter);
    }
    if is("last_exit") {
        line.leave = any.leave.max(line.leave);
    }
    if is("range_never_asked") {
        return (line.enter <= line.leave).then_some(line);
    }
    if is("range_ignored") {
        return (line.enter.max(0.0) <= line.leave).then_some(line);
    }
    let inside = line.enter < 0.0 && line.leave > 0.0;
    if inside && is("inside_is_a_miss") {
        return None;
    }
    if inside && is("exit_where_inside") {
        line.enter = line.leave;
    }
    let own = is("ends_of_its_own");
    let near = if own || is("zero_for_near") { 0.0 } else { NEAR_OF_ITS_OWN.among(wrong).unwrap_or(q.near) };
    let cut = Hit {
        enter: if is("near_ignored") { line.enter } else { line.enter.max(near) },
        leave: if own || is("far_ignored") { line.leave } else { line.leave.min(q.far) },
    };
    let hit = match () {
        () if is("range_cut_not_asked") => line.enter <= line.leave && line.leave > 0.0,
        () if is("ahead_is_a_hit") => cut.leave > 0.0,
        () if is("behind_is_a_hit") => line.enter <= line.leave,
        () if is("beyond_far_is_a_hit") => cut.enter <= line.leave,
        () => cut.enter <= cut.leave,
    };
    let uncut = is("range_asked_not_cut");
    hit.then_some(Hit {
        enter: if uncut || is("near_asked_not_cut") { line.enter } else { cut.enter }
            + ENTERED_LATE.among(wrong).unwrap_or(0.0),
        leave: match () {
            () if uncut => line.leave,
            () if is("length_for_exit") => cut.leave - cut.enter,
            () => cut.leave,
        },
    })
}

/// Where rays enter and leave a box.
pub(crate) fn ray_aabb(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let length = |q: &RayAndBox| match q.d.iter().map(|d| d * d).sum::<f64>() {
        0.0 => 1.0,
        square => square.sqrt(),
    };
    forward(a, |q| {
        if wrong.is_empty() {
            return outputs(between(q.o, q.d, q.low, q.high, q.near, q.far), q.far);
        }
        let mut q = *q;
        if wrong.contains(&"unit_directions") {
            let length = length(&q);
            q.d = q.d.map(|d| d / length);
        }
        let mut hit = outputs(wrong_hit(&q, wrong), q.far);
        if wrong.contains(&"t_in_lengths") && hit[2] == 1.0 {
            (hit[0], hit[1]) = (hit[0] * length(&q), hit[1] * length(&q));
        }
        if wrong.contains(&"hit_negated") {
            hit[2] = 1.0 - hit[2];
        }
        if wrong.contains(&"nan_in_a_face") && in_a_face(&q) { hit.map(|_| f64::NAN) } else { hit }
    })
}

/// Their gradient.
pub(crate) fn ray_aabb_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, |q, g| {
        let hit = between(q.o, q.d, q.low, q.high, q.near, q.far).is_some();
        let (mut o, mut d) = match hit && wrong.contains(&"gradient_where_cut") {
            true => backward::intersect(q.o, q.d, q.low, q.high, g),
            false => backward::between(q.o, q.d, q.low, q.high, [q.near, q.far], g),
        };
        if wrong.contains(&"direction_forgotten") {
            d = [0.0; 3];
        }
        if hit && wrong.contains(&"not_a_number_along_axes") {
            // In a face t itself is 0 / 0, and nothing of it comes back.
            if in_a_face(q) {
                (o, d) = ([0.0; 3], [0.0; 3]);
            }
            (0..3).filter(|&a| q.d[a] == 0.0).for_each(|a| (o[a], d[a]) = (f64::NAN, f64::NAN));
        }
        [o, d]
    })
}
