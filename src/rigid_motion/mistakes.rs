//! Rigid motions, wrong on purpose. Without a mistake every function equals the oracle.

mod catalogue;
pub(crate) mod laws;
mod of_twists;

use std::f64::consts::PI;

use glam::{DMat3, DMat4, DVec3};

pub(crate) use catalogue::SO3_EXP;
pub(crate) use of_twists::SE3_EXP;

use catalogue::{EPS_IN_AXIS, EPS_IN_VECTOR, FIRST_ORDER_WHEN_SMALL, IDENTITY_WHEN_SMALL, POWER_SERIES};
use of_twists::V_IDENTITY_WHEN_SMALL;

use super::arrays::{form, matrix, rows, se3, se3_vjp, so3, so3_vjp};
use super::{
    Twist, along, backward, coefficients, halves, laid, rotation, se3_exp as motion, so3_exp as right,
};
use crate::camera::arrays::{flat, pose};
use crate::contract::arrays::{Arrays, values};
use crate::contract::component::Mistake;
use crate::convention::{Conventions, RotationClamp, TwistOrder, TwistTranslation};
use crate::math::{cos, sin};

/// The squared length of w.
fn squared([x, y, z]: [f64; 3]) -> f64 {
    x * x + y * y + z * z
}

/// The angle below which Cayley's map is taken.
const CAYLEY: f64 = 0.01;

/// sum_j (-x)^j / (k + 2 j)!, from the first term to the one with the tenth power of x.
fn cut_series(k: u32, x: f64) -> f64 {
    let (mut sum, mut term) = (0.0, 1.0 / (1..=k).map(f64::from).product::<f64>());
    for j in 0..=10 {
        sum += term;
        let n = f64::from(k + 2 * j);
        term *= -x / ((n + 1.0) * (n + 2.0));
    }
    sum
}

/// a, b and c with a mistake in them.
fn factors(w: [f64; 3], wrong: &[&str]) -> Option<[f64; 3]> {
    let has = |name: &str| wrong.contains(&name);
    let x = squared(w);
    let theta = x.sqrt();
    let [a, b, c, ..] = coefficients(x);
    let eps_in_axis = EPS_IN_AXIS.among(wrong).map(|eps| theta / (theta + eps));
    let found = match () {
        () if eps_in_axis.is_some() => eps_in_axis.map(|part| [a * part, b * part * part, c])?,
        () if has("square_not_divided") => [a, 1.0 - cos(theta), c],
        () if has("root_forgotten") => coefficients(x * x)[..3].try_into().expect("three of five"),
        () if has("axis_not_normalized") => [sin(theta), 1.0 - cos(theta), c],
        () if has("divided_by_angle_once") => [a, theta * b, c],
        () if has("square_forgotten") => [a, 0.0, c],
        () if has("first_order") => [1.0, 0.0, c],
        () if has("series_cut_short") => [1, 2, 3].map(|k| cut_series(k, x)),
        () if has("third_factor_negative") => [a, b, -c],
        () if has("third_divided_by_square") => [a, b, theta * c],
        () => return None,
    };
    Some(found)
}

/// Rx Ry Rz of three angles.
fn of_euler_angles([x, y, z]: [f64; 3]) -> DMat3 {
    let about = |w| right(w, RotationClamp::None);
    about([x, 0.0, 0.0]) * about([0.0, y, 0.0]) * about([0.0, 0.0, z])
}

/// (4 - theta^2) / (4 + theta^2) for the cosine, and what follows from it: an angle of 2 atan(theta / 2).
fn of_cayley(w: [f64; 3]) -> DMat3 {
    let x = squared(w);
    rotation(w, 4.0 / (4.0 + x), 2.0 / (4.0 + x))
}

/// Whether an angle is below the limit of a mistake that is made there.
fn below(theta: f64, mistake: &Mistake, wrong: &[&str]) -> bool {
    mistake.among(wrong).is_some_and(|limit| theta < limit)
}

/// The squares of K's entries.
fn squares(w: [f64; 3]) -> DMat3 {
    let [x, y, z] = w.map(|w| w * w);
    DMat3::from_cols(DVec3::new(0.0, z, y), DVec3::new(z, 0.0, x), DVec3::new(y, x, 0.0))
}

/// sum K^n / (n + more)! of so many terms after the first; of a part of the last one where the number isn't whole.
fn of_powers(w: [f64; 3], terms: f64, more: f64) -> DMat3 {
    let k = rotation(w, 1.0, 0.0) - DMat3::IDENTITY;
    let (mut sum, mut term) = (DMat3::IDENTITY, DMat3::IDENTITY);
    let mut n = 1.0;
    while n < terms + 1.0 {
        term = k * term * (1.0 / (n + more));
        sum += (terms + 1.0 - n).min(1.0) * term;
        n += 1.0;
    }
    sum
}

/// R with a mistake in it.
fn wrong_rotation(w: [f64; 3], clamp: RotationClamp, wrong: &[&str]) -> DMat3 {
    let has = |name: &str| wrong.contains(&name);
    let theta = squared(w).sqrt();
    if let Some([a, b, _]) = factors(w, wrong) {
        return rotation(w, a, b);
    }
    if let Some(terms) = POWER_SERIES.among(wrong) {
        return of_powers(w, terms, 0.0);
    }
    if let Some(eps) = EPS_IN_VECTOR.among(wrong) {
        let x = squared(w.map(|w| w + eps));
        return rotation(w, coefficients(x)[0], coefficients(x)[1]);
    }
    let [a, b, ..] = coefficients(squared(w));
    // cos(theta) I for I.
    let less = DMat3::from_diagonal(DVec3::splat(cos(theta) - 1.0));
    match () {
        () if has("not_a_number_at_zero") && theta == 0.0 => DMat3::NAN,
        () if below(theta, &IDENTITY_WHEN_SMALL, wrong) => DMat3::IDENTITY,
        () if below(theta, &FIRST_ORDER_WHEN_SMALL, wrong) => rotation(w, 1.0, 0.0),
        () if has("cayley_when_small") && theta < CAYLEY => of_cayley(w),
        () if has("turned_backward") => right(w.map(|x| -x), clamp),
        () if has("angle_doubled") => right(w.map(|x| 2.0 * x), clamp),
        () if has("degrees") => right(w.map(|x| x * PI / 180.0), clamp),
        () if has("euler_angles") => of_euler_angles(w),
        () if has("cayley_map") => of_cayley(w),
        () if has("square_by_element") => rotation(w, a, 0.0) + b * squares(w),
        () if has("outer_product_forgotten") => rotation(w, a, 0.0) + less,
        () if has("cosine_with_square") => rotation(w, a, b) + less,
        () if has("euler_angles_reversed") => of_euler_angles(w.map(|x| -x)).transpose(),
        () => right(w, clamp),
    }
}

/// Rotations.
pub(crate) fn so3_exp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let of_all = values(a, "w").iter().map(|w| w * w).sum::<f64>().sqrt();
    so3(a, |w| {
        let r = if wrong.contains(&"norm_of_all_vectors") && of_all > 0.0 {
            rotation(w, sin(of_all) / of_all, (1.0 - cos(of_all)) / (of_all * of_all))
        } else {
            wrong_rotation(w, c.rotation_clamp, wrong)
        };
        rows(&r)
    })
}

/// The gradient of a rotation vector, with a mistake in it.
fn wrong_gradient(w: [f64; 3], clamp: RotationClamp, g: &DMat3, wrong: &[&str]) -> [f64; 3] {
    let gradient = |w| backward::so3_exp(w, clamp, g);
    match wrong.first() {
        Some(&"gradient_not_a_number_at_zero") if squared(w) == 0.0 => [f64::NAN; 3],
        Some(&"no_gradient_at_zero") if squared(w) == 0.0 => [0.0; 3],
        Some(&"factors_held_constant") => held_constant(w, g, [0, 1]),
        Some(&"as_if_at_zero") => gradient([0.0; 3]),
        _ => gradient(w),
    }
}

/// The gradient of g : (I + p K + q K^2) with p and q, two of a, b and c, not differentiated: its two parts, by two points of a line.
fn held_constant(w: [f64; 3], g: &DMat3, of: [usize; 2]) -> [f64; 3] {
    let all = coefficients(squared(w));
    let [p, q] = of.map(|n| all[n]);
    // s (I + p K + q K^2) is of second degree in w where p and q are constant: central differences over a whole step are exact.
    let value = |w: [f64; 3]| {
        let (r, mut sum) = (rotation(w, p, q), 0.0);
        for j in 0..3 {
            for i in 0..3 {
                sum += g.col(j)[i] * r.col(j)[i];
            }
        }
        sum
    };
    [0, 1, 2].map(|n| {
        let moved = |by: f64| {
            let mut w = w;
            w[n] += by;
            value(w)
        };
        0.5 * (moved(1.0) - moved(-1.0))
    })
}

/// Their gradient.
pub(crate) fn so3_exp_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    so3_vjp(a, |w, g| wrong_gradient(w, c.rotation_clamp, &matrix(&g), wrong))
}

/// The factors of I, K and K^2 in V with a mistake in them, which leaves R as it is.
fn wrong_v(w: [f64; 3], wrong: &[&str]) -> Option<[f64; 3]> {
    let has = |name: &str| wrong.contains(&name);
    let x = squared(w);
    let theta = x.sqrt();
    let [a, b, c, ..] = coefficients(x);
    // Without an angle there is no axis, and codes have another branch.
    let per = if theta > 0.0 { 1.0 / theta } else { 0.0 };
    Some(match () {
        () if has("factors_of_rotation_in_v") => [1.0, a * per, b * per * per],
        () if has("unit_axis_in_v") => [1.0, b * per, c * per * per],
        () if has("unit_factors_in_v") => [1.0, theta * b, x * c],
        () if has("sine_on_the_identity") => [a, b, c],
        () if has("sine_for_second_factor") => [1.0, a, c],
        () if has("one_factor_twice") => [1.0, b, b],
        () if has("second_divided_by_angle") => [1.0, theta * b, c],
        () if has("third_not_divided") => [1.0, b, x * c],
        () if has("third_added") => [1.0, b, (1.0 + a) * per * per],
        () if has("v_of_second_order") => [1.0, 0.5, 1.0 / 6.0],
        () => return None,
    })
}

/// V^-1.
fn inverse_of_v(w: [f64; 3]) -> DMat3 {
    let [_, b, c, ..] = coefficients(squared(w));
    rotation(w, b, c).inverse()
}

/// t = V rho with a mistake in it.
fn wrong_place(rho: [f64; 3], w: [f64; 3], form: &Twist, wrong: &[&str]) -> Option<DVec3> {
    let has = |name: &str| wrong.contains(&name);
    if form.translation == TwistTranslation::Plain {
        return None;
    }
    let [_, b, c, ..] = coefficients(squared(w));
    if let Some([_, b, c]) = factors(w, wrong) {
        return Some(along(w, rho, b, c));
    }
    if let Some([i, b, c]) = wrong_v(w, wrong) {
        return Some(along(w, rho, b, c) + (i - 1.0) * DVec3::from(rho));
    }
    // One power less than R has, as the matrix of the twist has them.
    if let Some(terms) = POWER_SERIES.among(wrong) {
        return Some(of_powers(w, terms - 1.0, 1.0) * DVec3::from(rho));
    }
    let theta = squared(w).sqrt();
    Some(match () {
        () if has("turned_after") => right(w, form.clamp) * DVec3::from(rho),
        () if has("v_transposed") => along(w, rho, -b, c),
        () if has("v_of_first_order") => along(w, rho, 0.5, 0.0),
        () if has("v_without_square") => along(w, rho, b, 0.0),
        () if has("moved_by_the_angle") => theta * along(w, rho, b, c),
        () if has("v_inverted") => inverse_of_v(w) * DVec3::from(rho),
        () if below(theta, &IDENTITY_WHEN_SMALL, wrong) => DVec3::from(rho),
        () if below(theta, &V_IDENTITY_WHEN_SMALL, wrong) => DVec3::from(rho),
        () => return None,
    })
}

/// A motion with a mistake in it.
fn wrong_motion(twist: [f64; 6], form: &Twist, wrong: &[&str]) -> DMat4 {
    let has = |name: &str| wrong.contains(&name);
    let (rho, w) = halves(twist, form.order);
    if has("inverted") {
        return motion(twist.map(|x| -x), form);
    }
    if has("degrees") {
        let w = w.map(|x| x * PI / 180.0);
        return motion(joined(rho, w, form.order), form);
    }
    if has("angle_of_the_whole_twist") {
        let [a, b, c, ..] = coefficients(squared(rho) + squared(w));
        let t =
            if form.translation == TwistTranslation::Plain { DVec3::from(rho) } else { along(w, rho, b, c) };
        return moved(rotation(w, a, b), t, form);
    }
    let plain = laid(motion(twist, form), form.layout);
    // Mistakes in V's factors alone leave R as it is.
    let of_v = ["third_factor_negative", "third_divided_by_square"].iter().any(|name| has(name));
    let r = if of_v { right(w, form.clamp) } else { wrong_rotation(w, form.clamp, wrong) };
    let mut t = wrong_place(rho, w, form, wrong).unwrap_or(plain.w_axis.truncate());
    if has("not_a_number_at_zero") && squared(w) == 0.0 {
        t = DVec3::NAN;
    }
    moved(r, t, form)
}

/// The motion of a rotation and a place.
fn moved(r: DMat3, t: DVec3, form: &Twist) -> DMat4 {
    let columns =
        DMat4::from_cols(r.x_axis.extend(0.0), r.y_axis.extend(0.0), r.z_axis.extend(0.0), t.extend(1.0));
    laid(columns, form.layout)
}

/// A twist from its halves.
fn joined(rho: [f64; 3], w: [f64; 3], order: TwistOrder) -> [f64; 6] {
    let [a, b] = if order == TwistOrder::TranslationFirst { [rho, w] } else { [w, rho] };
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

/// Motions.
pub(crate) fn se3_exp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    se3(a, |twist| {
        if wrong.is_empty() {
            return flat(&motion(twist, &form(c)));
        }
        flat(&wrong_motion(twist, &form(c), wrong))
    })
}

/// Their gradient.
pub(crate) fn se3_exp_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let form = form(c);
    se3_vjp(a, |twist, g| {
        let g = pose(&g, 0);
        let gradient = backward::se3_exp(twist, &form, &g);
        let (g_rho, _) = halves(gradient, form.order);
        let (rho, w) = halves(twist, form.order);
        let columns = laid(g, form.layout);
        let (g_r, g_t) = (DMat3::from_mat4(columns), columns.w_axis.truncate());
        let of_rotation = || backward::so3_exp(w, form.clamp, &g_r);
        let g_w = match wrong.first() {
            Some(&"gradient_not_a_number_at_zero") if squared(w) == 0.0 => [f64::NAN; 3],
            Some(&"no_gradient_at_zero") if squared(w) == 0.0 => [0.0; 3],
            Some(&"v_held_constant") => of_rotation(),
            Some(&"factors_held_constant") => {
                let g_v = DMat3::from_cols(rho[0] * g_t, rho[1] * g_t, rho[2] * g_t);
                let (of_r, of_v) = (held_constant(w, &g_r, [0, 1]), held_constant(w, &g_v, [1, 2]));
                [0, 1, 2].map(|n| of_r[n] + of_v[n])
            }
            _ => return gradient,
        };
        joined(g_rho, g_w, form.order)
    })
}
