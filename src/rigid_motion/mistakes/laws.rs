//! Laws of rigid motions: how the axis and the angle are found, what happens near an angle of 0, and which factors stand before K and K^2 in R and in V.

use glam::{DMat3, DMat4, DVec3};

use super::super::arrays::{form, rows, se3, so3};
use super::super::{Twist, halves, laid, se3_exp, so3_exp};
use crate::camera::arrays::flat;
use crate::contract::laws::{Guard, Laws};
use crate::convention::{RotationClamp, TwistTranslation};
use crate::math::{cos, sin};

/// What w is divided by for the axis u; behind these, 1 and |w|^2.
const AXIS: [Guard; 13] = [
    Guard::Nothing,
    Guard::Plus(1e-10),
    Guard::Plus(1e-8),
    Guard::Plus(1e-7),
    Guard::Plus(1e-6),
    Guard::Plus(1e-4),
    Guard::AtLeast(1e-7),
    Guard::AtLeast(1e-6),
    Guard::AtLeast(1e-4),
    Guard::UnderRoot(1e-8),
    Guard::UnderRoot(1e-12),
    Guard::UnderRoot(1e-16),
    Guard::Plus(1e-5),
];

/// How many choices there are.
const AXES: usize = AXIS.len() + 2;

/// The angle.
const ANGLE: [&str; 9] =
    ["|w|", "|w| / 2", "2 |w|", "|w| pi / 180", "|w| 180 / pi", "|w|^2", "|w| mod pi", "-|w|", "sqrt(|w|)"];

/// What a matrix is for small angles.
const SMALL: [&str; 5] = [
    "I",
    "its first order",
    "its second order",
    "its first order with U for K",
    "I and twice its first order",
];

/// Below which angle, and as one would say it: the cases tell no limits apart between which no angle of theirs lies.
const LIMIT: [(f64, &str); 3] = [(1e-6, "1e-7 or 1e-6"), (1e-4, "1e-5, 1e-4 or 1e-3"), (1e-2, "1e-2")];

/// Before U = [u]_x in R, before U^2, and in the place of I.
const FIRST: [&str; 8] = [
    "sin(theta)",
    "theta",
    "sin(theta) / theta",
    "cos(theta)",
    "1 - cos(theta)",
    "-sin(theta)",
    "0",
    "theta sin(theta)",
];
const SECOND: [&str; 10] = [
    "1 - cos(theta)",
    "sin(theta)",
    "(1 - cos(theta)) / theta",
    "(1 - cos(theta)) / theta^2",
    "theta^2 / 2",
    "0",
    "-(1 - cos(theta))",
    "1 + cos(theta)",
    "cos(theta)",
    "theta^2 (1 - cos(theta))",
];
const WHOLE: [&str; 6] = [
    "I",
    "I, with u u^T for U^2",
    "cos(theta) I, with u u^T for U^2",
    "cos(theta) I",
    "R = the matrix of the quaternion (cos(theta / 2), sin(theta / 2) u) read as x, y, z, w",
    "R = the matrix of the quaternion (sin(theta / 2) u, cos(theta / 2)) read as w, x, y, z",
];

/// The same in V.
const FIRST_OF_V: [&str; 8] = [
    "(1 - cos(theta)) / theta",
    "1 - cos(theta)",
    "sin(theta) / theta",
    "sin(theta)",
    "(1 - cos(theta)) / theta^2",
    "theta / 2",
    "0",
    "-(1 - cos(theta)) / theta",
];
const SECOND_OF_V: [&str; 10] = [
    "1 - sin(theta) / theta",
    "theta - sin(theta)",
    "(theta - sin(theta)) / theta^2",
    "(theta - sin(theta)) / theta^3",
    "(1 - cos(theta)) / theta^2",
    "1 - cos(theta)",
    "theta^2 / 6",
    "0",
    "-(1 - sin(theta) / theta)",
    "1 + sin(theta) / theta",
];
const WHOLE_OF_V: [&str; 8] = [
    "I",
    "I, with u u^T for U^2",
    "sin(theta) / theta I",
    "theta I",
    "sin(theta) / theta I, with u u^T for U^2",
    "theta I, and theta times the rest",
    "t = R rho",
    "t = R^T rho",
];

/// The right one, none, and each of those below each limit.
const SMALLS: usize = 2 + SMALL.len() * LIMIT.len();

/// Those of rotation vectors.
pub(crate) const OF_ROTATIONS: Laws = Laws {
    choices: &[AXES, ANGLE.len(), SMALLS, FIRST.len(), SECOND.len(), WHOLE.len()],
    says,
    of: |a, c, law| so3(a, |w| rows(&rotation(w, c.rotation_clamp, law))),
    rounding: &[],
};

/// Those of twists.
pub(crate) const OF_TWISTS: Laws = Laws {
    choices: &[
        AXES,
        ANGLE.len(),
        SMALLS,
        FIRST.len(),
        SECOND.len(),
        WHOLE.len(),
        SMALLS,
        FIRST_OF_V.len(),
        SECOND_OF_V.len(),
        WHOLE_OF_V.len(),
    ],
    says,
    of: |a, c, law| se3(a, |twist| flat(&motion(twist, &form(c), law))),
    rounding: &[],
};

fn says(part: usize, choice: usize) -> String {
    let small = |of: &str| match choice.checked_sub(2) {
        None => format!("{of} without a case of its own at w = 0"),
        Some(n) => {
            format!("{of} = {} below an angle of {}", SMALL[n / LIMIT.len()], LIMIT[n % LIMIT.len()].1)
        }
    };
    match part {
        0 => {
            let other = || if choice == AXIS.len() { "1".into() } else { "|w|^2".into() };
            format!("u = w / ({})", AXIS.get(choice).map_or_else(other, |guard| guard.said("|w|")))
        }
        1 => format!("theta = {}", ANGLE[choice]),
        2 => small("R"),
        3 => format!("({}) U in R, U = [u]_x", FIRST[choice]),
        4 => format!("({}) U^2 in R, U = [u]_x", SECOND[choice]),
        5 if choice > 3 => WHOLE[choice].into(),
        5 => format!("{} in R, U = [u]_x", WHOLE[choice]),
        6 => small("V"),
        7 => format!("({}) U in V, U = [u]_x", FIRST_OF_V[choice]),
        8 => format!("({}) U^2 in V, U = [u]_x", SECOND_OF_V[choice]),
        _ if choice > 5 => WHOLE_OF_V[choice].into(),
        _ => format!("{} in V, U = [u]_x", WHOLE_OF_V[choice]),
    }
}

/// [v]_x.
fn cross(v: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, v.z, -v.y), DVec3::new(-v.z, 0.0, v.x), DVec3::new(v.y, -v.x, 0.0))
}

/// v v^T.
fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

fn divisor(length: f64, choice: usize) -> f64 {
    match AXIS.get(choice) {
        Some(guard) => guard.of(length),
        None if choice == AXIS.len() => 1.0,
        None => length * length,
    }
}

fn angle(length: f64, choice: usize) -> f64 {
    match choice {
        1 => 0.5 * length,
        2 => 2.0 * length,
        3 => length.to_radians(),
        4 => length.to_degrees(),
        5 => length * length,
        6 => length % std::f64::consts::PI,
        7 => -length,
        8 => length.sqrt(),
        _ => length,
    }
}

/// What a matrix is near 0, where it is something of its own: I + K + K^2 / 2 of R, I + K / 2 + K^2 / 6 of V.
fn near(w: DVec3, u: DVec3, choice: usize, of: [f64; 2]) -> Option<DMat3> {
    let (k, one) = (cross(w), DMat3::IDENTITY);
    if choice == 0 && w.length() == 0.0 {
        return Some(one);
    }
    let choice = choice.checked_sub(2)?;
    let small = w.length() < LIMIT[choice % LIMIT.len()].0;
    let matrix = match choice / LIMIT.len() {
        0 => one,
        1 => one + k * of[0],
        2 => one + k * of[0] + k * k * of[1],
        3 => one + cross(u) * of[0],
        _ => one + k * (2.0 * of[0]),
    };
    small.then_some(matrix)
}

/// 1 - cos(theta).
fn versed(theta: f64) -> f64 {
    2.0 * sin(0.5 * theta) * sin(0.5 * theta)
}

fn rotation(w: [f64; 3], clamp: RotationClamp, law: &[usize]) -> DMat3 {
    if law[..6] == [0; 6] {
        return so3_exp(w, clamp);
    }
    let w = DVec3::from(w);
    let theta = angle(w.length(), law[1]);
    let u = w / divisor(w.length(), law[0]);
    if let Some(order) = law[5].checked_sub(4) {
        let u = if w.length() > 0.0 { u } else { DVec3::ZERO };
        let (real, v) = (cos(0.5 * theta), u * sin(0.5 * theta));
        let [x, y, z, w] = [[real, v.x, v.y, v.z], [v.y, v.z, real, v.x]][order];
        return DMat3::from_quat(glam::DQuat::from_xyzw(x, y, z, w));
    }
    if let Some(matrix) = near(w, u, law[2], [1.0, 0.5]) {
        return matrix;
    }
    let first = match law[3] {
        0 => sin(theta),
        1 => theta,
        2 => sin(theta) / theta,
        3 => cos(theta),
        4 => versed(theta),
        5 => -sin(theta),
        6 => 0.0,
        _ => theta * sin(theta),
    };
    let second = match law[4] {
        0 => versed(theta),
        1 => sin(theta),
        2 => versed(theta) / theta,
        3 => versed(theta) / (theta * theta),
        4 => 0.5 * theta * theta,
        5 => 0.0,
        6 => -versed(theta),
        7 => 1.0 + cos(theta),
        8 => cos(theta),
        _ => theta * theta * versed(theta),
    };
    let (whole, square) = match law[5] {
        0 => (1.0, cross(u) * cross(u)),
        1 => (1.0, outer(u)),
        2 => (cos(theta), outer(u)),
        _ => (cos(theta), cross(u) * cross(u)),
    };
    DMat3::IDENTITY * whole + cross(u) * first + square * second
}

/// theta - sin(theta), over theta.
fn late(theta: f64) -> f64 {
    if theta.abs() < 0.1 {
        let x = theta * theta;
        return x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0)));
    }
    1.0 - sin(theta) / theta
}

/// Where the twist (rho, w) goes, whose rotation is r.
fn moved(w: DVec3, rho: DVec3, r: DMat3, law: &[usize]) -> DVec3 {
    let theta = angle(w.length(), law[1]);
    let u = w / divisor(w.length(), law[0]);
    if let Some(matrix) = near(w, u, law[6], [0.5, 1.0 / 6.0]) {
        return matrix * rho;
    }
    let first = match law[7] {
        0 => versed(theta) / theta,
        1 => versed(theta),
        2 => sin(theta) / theta,
        3 => sin(theta),
        4 => versed(theta) / (theta * theta),
        5 => 0.5 * theta,
        6 => 0.0,
        _ => -versed(theta) / theta,
    };
    let second = match law[8] {
        0 => late(theta),
        1 => theta * late(theta),
        2 => late(theta) / theta,
        3 => late(theta) / (theta * theta),
        4 => versed(theta) / (theta * theta),
        5 => versed(theta),
        6 => theta * theta / 6.0,
        7 => 0.0,
        8 => -late(theta),
        _ => 1.0 + sin(theta) / theta,
    };
    let (whole, square) = match law[9] {
        1 => (1.0, outer(u)),
        2 => (sin(theta) / theta, cross(u) * cross(u)),
        3 => (theta, cross(u) * cross(u)),
        4 => (sin(theta) / theta, outer(u)),
        6 => return r * rho,
        7 => return r.transpose() * rho,
        _ => (1.0, cross(u) * cross(u)),
    };
    let v = DMat3::IDENTITY * whole + cross(u) * first + square * second;
    v * rho * if law[9] == 5 { theta } else { 1.0 }
}

fn motion(twist: [f64; 6], form: &Twist, law: &[usize]) -> DMat4 {
    if law.iter().all(|choice| *choice == 0) {
        return se3_exp(twist, form);
    }
    let (rho, w) = halves(twist, form.order);
    let r = rotation(w, form.clamp, law);
    let plain = Twist { layout: crate::convention::MotionLayout::ForColumns, ..*form };
    let v_is_right = law[..2] == [0; 2] && law[6..].iter().all(|choice| *choice == 0);
    let t = match form.translation {
        TwistTranslation::Plain => DVec3::from(rho),
        _ if v_is_right => se3_exp(twist, &plain).w_axis.truncate(),
        _ => moved(DVec3::from(w), DVec3::from(rho), r, law),
    };
    let motion =
        DMat4::from_cols(r.x_axis.extend(0.0), r.y_axis.extend(0.0), r.z_axis.extend(0.0), t.extend(1.0));
    laid(motion, form.layout)
}
