//! Laws of a splat's projection: which mean, which covariance goes through which Jacobian, what is added to it, and what comes of that.

use glam::{DMat3, DVec3};

use super::super::arrays::{form, forward, view};
use super::super::{Form, Splat, View, in_camera, limits, project};
use super::choices::{
    ADDED, AT, CAMERA, CONIC, DEPTH, DIVISOR, FOCAL, HELD, JACOBIAN, MEAN, MIXED, RADIUS, TURNED,
};
use crate::contract::laws::Laws;
use crate::convention::{SplatCenter, SplatClamp};

/// Those of a splat.
pub(crate) const OF_SPLATS: Laws = Laws {
    choices: &[
        MEAN.len(),
        TURNED.len(),
        FOCAL.len(),
        JACOBIAN.len(),
        HELD.len(),
        ADDED.len(),
        MIXED.len(),
        CONIC.len(),
        RADIUS.len(),
        DEPTH.len(),
        AT.len(),
        DIVISOR.len(),
        CAMERA.len(),
    ],
    says: |part, choice| match part {
        0 => format!("mean = {}", MEAN[choice]),
        1 => format!("J {} J^T", TURNED[choice]),
        2 => format!("focal lengths {} in J", FOCAL[choice]),
        3 => format!("J {}", JACOBIAN[choice]),
        4 if choice == 9 => HELD[choice].into(),
        4 => format!("x/z and y/z of J held to {}", HELD[choice]),
        5 => format!("{} added to the variances", ADDED[choice]),
        6 => format!("{} in the covariance's place off the diagonal", MIXED[choice]),
        7 => format!("conic = {}", CONIC[choice]),
        8 => format!("radius = {}", RADIUS[choice]),
        9 => format!("depth = {}", DEPTH[choice]),
        10 => format!("J at {}", AT[choice]),
        11 => format!("divided by {} in the mean and in J", DIVISOR[choice]),
        _ => format!("{} in the camera", CAMERA[choice]),
    },
    of: |a, c, law| {
        let view = view(a);
        forward(a, c, |mean, sigma| splat(mean, sigma, &view, form(c), law))
    },
    rounding: &[(0, 5), (0, 6), (0, 15)],
};

/// The mean in the camera's axes.
fn seen(m: [f64; 3], view: &View, choice: usize) -> [f64; 3] {
    let (r, t) = (view.rotation, view.translation);
    let turned = |m: [f64; 3]| [0, 1, 2].map(|i| r[i][0] * m[0] + r[i][1] * m[1] + r[i][2] * m[2]);
    let back = |m: [f64; 3]| [0, 1, 2].map(|i| r[0][i] * m[0] + r[1][i] * m[1] + r[2][i] * m[2]);
    let less = |m: [f64; 3]| [0, 1, 2].map(|i| m[i] - t[i]);
    let more = |m: [f64; 3]| [0, 1, 2].map(|i| m[i] + t[i]);
    match choice {
        0 => in_camera(m, view),
        1 => back(less(m)),
        2 => more(back(m)),
        3 => m,
        4 => turned(less(m)),
        5 => less(turned(m)),
        6 => turned(m),
        _ => turned(more(m)),
    }
}

/// The covariance in the camera's axes.
fn turned([xx, xy, xz, yy, yz, zz]: [f64; 6], view: &View, choice: usize) -> DMat3 {
    let sigma = DMat3::from_cols_array_2d(&[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
    let back = DMat3::from_cols_array_2d(&view.rotation);
    let (r, other_way) = (back.transpose(), DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)));
    match choice {
        0 => r * sigma * back,
        1 => sigma,
        2 => back * sigma * r,
        3 => other_way * r * sigma * back * other_way,
        4 => other_way * sigma * other_way,
        _ => r * sigma * r,
    }
}

/// x/z and y/z as the Jacobian has them.
fn slopes(t: [f64; 3], view: &View, form: Form, choice: usize) -> [f64; 2] {
    let axis = |n: usize, f: f64, center: f64, size: f64| {
        let half = 0.5 * size / f;
        let [low, high] = match choice {
            0 => limits(f, center, size, form.clamp),
            1 => limits(f, center, size, SplatClamp::None),
            2 => limits(f, center, size, SplatClamp::Centered),
            3 => limits(f, center, size, SplatClamp::Picture),
            4 => [-2.6 * libm::atan(half), 2.6 * libm::atan(half)],
            5 => [-1.3, 1.3],
            6 => [-1.3 * libm::tan(0.5), 1.3 * libm::tan(0.5)],
            7 => [(-0.15 * size - center) / f, (1.15 * size - center) / f],
            8 => [-0.65 * view.width / f, 0.65 * view.width / f],
            10 => [-1.3 * center.max(size - center) / f, 1.3 * center.max(size - center) / f],
            11 => [-2.6 * half / (1.0 - half * half), 2.6 * half / (1.0 - half * half)],
            12 => [-1.3 * f / t[2], 1.3 * f / t[2]],
            _ => [-1.3 * half, 1.3 * half],
        };
        if choice == 9 { t[n] / t[2].max(low).min(high) } else { (t[n] / t[2]).max(low).min(high) }
    };
    [axis(0, view.k.fx, view.k.cx, view.width), axis(1, view.k.fy, view.k.cy, view.height)]
}

/// J's rows.
fn jacobian(t: [f64; 3], slopes: [f64; 2], view: &View, focal: usize, choice: usize) -> [[f64; 3]; 2] {
    let (fx, fy, r) = (view.k.fx, view.k.fy, view.rotation);
    let focal = match focal {
        1 => [1.0; 2],
        2 => [fx; 2],
        3 => [fy; 2],
        4 => [2.0 * fx / view.width, 2.0 * fy / view.height],
        5 => [2.0 * fx / view.width; 2],
        6 => [fx * r[0][0] + view.k.cx * r[2][0], fy * r[1][1] + view.k.cy * r[2][1]],
        7 => [r[0][0], r[1][1]],
        8 => [2.0 * fx / view.width, -2.0 * fy / view.height],
        _ => [fx, fy],
    };
    let far = (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt();
    [0, 1].map(|n| {
        let z = if choice == 5 { far } else { t[2] };
        let slope = if choice == 5 { slopes[n] * t[2] / far } else { slopes[n] };
        let plus = matches!((choice, n), (2, _) | (3, 1) | (4, 0));
        let along = match choice {
            1 => 0.0,
            8 => -slopes[1 - n],
            _ if plus => slope,
            _ => -slope,
        };
        let (own, along) = match choice {
            6 => (focal[n], focal[n] * along),
            7 => (focal[n] / z, focal[n] * along),
            9 => (1.0, 0.0),
            _ => (focal[n] / z, focal[n] / z * along),
        };
        let mut row = [0.0, 0.0, along];
        row[n] = own;
        row
    })
}

fn placed(mean: [f64; 3], t: [f64; 3], view: &View, form: Form, law: &[usize]) -> [f64; 2] {
    let (k, shift) = (view.k, if form.center == SplatCenter::Integer { 0.5 } else { 0.0 });
    let z = divisor(t[2], law[11]);
    let [x, y] = [t[0] / z, t[1] / z];
    let center = [k.cx - shift, k.cy - shift];
    let right = [k.fx * x + center[0], k.fy * y + center[1]];
    match law[0] {
        0 => right,
        1 => [t[0], t[1]],
        2 => [center[0] - k.fx * x, right[1]],
        3 => [right[0], center[1] - k.fy * y],
        4 => [center[0] - k.fx * x, center[1] - k.fy * y],
        5 => right.map(f64::floor),
        6 => right.map(f64::round),
        7 => [right[0], k.fx * y + center[1]],
        8 => [k.fy * x + center[0], right[1]],
        9 => [2.0 * k.fx * x / view.width, 2.0 * k.fy * y / view.height],
        10 => [k.fx * x + 0.5 * view.width - shift, k.fy * y + 0.5 * view.height - shift],
        11 => [k.fx * x, k.fy * y],
        12 => [x, y],
        14 => [k.fx * mean[0] / mean[2] + center[0], k.fy * mean[1] / mean[2] + center[1]],
        16 => [k.fx * x + 0.5 * view.width - shift, k.fx * y + 0.5 * view.height - shift],
        _ => {
            let of = |u: f64, size: f64| u * (size - 1.0) / size;
            let [u, v] = [of(k.fx * x + k.cx, view.width), of(k.fy * y + k.cy, view.height)];
            if law[0] == 15 { [u.trunc(), v.trunc()] } else { [u, v] }
        }
    }
}

/// The radius of splats that are dropped where their means lie outside of the picture.
const DROPPED: usize = RADIUS.len() - 1;

/// The radius of a covariance, before and after something is added to it.
fn reach([a, b, c]: [f64; 3], before: [f64; 3], form: Form, choice: usize) -> f64 {
    let above = |[a, b, c]: [f64; 3], least: f64| {
        0.5 * (a + c) + (0.25 * (a - c) * (a - c) + b * b).max(least).sqrt()
    };
    let lambda = |covariance| above(covariance, form.radius.value());
    let exact = above([a, b, c], 0.0);
    let (three, det) = (3.0 * lambda([a, b, c]).max(0.0).sqrt(), a * c - b * b);
    let widest = 3.0 * a.max(c).max(0.0).sqrt();
    let mean = 3.0 * det.max(0.0).sqrt().sqrt();
    let least = (a.min(c) / det).max(0.0);
    match choice {
        0 => three.ceil(),
        1 => three,
        2 => widest.ceil(),
        3 => widest,
        4 => mean.ceil(),
        5 => mean,
        6 => (three * 2.0 / 3.0).ceil(),
        7 => (three * 3.33 / 3.0).ceil(),
        8 => three.ceil() + 1.0,
        9 => three.round(),
        10 => three.floor(),
        11 => three / 3.0,
        12 => 3.0 * lambda([a, b, c]),
        13 => (3.0 * lambda(before).max(0.0).sqrt()).ceil(),
        14 => (3.0 * (a + c).max(0.0).sqrt()).ceil(),
        15 => 3.0 * (a + c).max(0.0).sqrt(),
        16 => three.ceil().min(64.0),
        17 => three.min(64.0),
        18 => widest.ceil().min(64.0),
        19 => 0.0,
        20 => 3.0 * (three / 3.0).ceil(),
        21 => 3.0 / least.sqrt(),
        23 => three.ceil().clamp(1.0, 64.0),
        24 => (3.0 * exact.max(0.0).sqrt()).ceil(),
        25 => 3.0 * exact.max(0.0).sqrt(),
        26 => (three * 2.5 / 3.0).ceil(),
        27 => (three.ceil() + 1.0).min(50.0),
        DROPPED => three.ceil(),
        _ => 3.0 / (least.sqrt() + 1e-4),
    }
}

fn inverse([a, b, c]: [f64; 3], before: [f64; 3], choice: usize) -> [f64; 3] {
    let det = a * c - b * b;
    let over = |by: f64| [c / by, -b / by, a / by];
    match choice {
        0 => over(det),
        1 => over(det + 1e-6),
        2 => over(det + 1e-7),
        3 => over(det.max(1e-6)),
        4 => over(1.0),
        5 => [c / det, b / det, a / det],
        6 => [a / det, -b / det, c / det],
        7 => inverse([a + 1e-6, b, c + 1e-6], before, 0),
        8 => inverse(before, before, 0),
        9 => [a, b, c],
        10 => over(a * c + b * b),
        11 => over(det.max(1e-8)),
        12 => over(det.max(1e-10)),
        _ => over(det.max(1e-12)),
    }
}

/// z as it divides.
fn divisor(z: f64, choice: usize) -> f64 {
    if choice == 0 { z } else { z.max([0.01, 0.1, 0.2, 0.3, 1.0][choice - 1]) }
}

/// The covariance, before and after something is added to it.
fn covariances(
    mean: [f64; 3],
    sigma: [f64; 6],
    view: &View,
    form: Form,
    law: &[usize],
) -> ([f64; 3], [f64; 3]) {
    let t = seen(mean, view, law[12]);
    let [x, y] = placed(mean, t, view, form, law);
    let k = view.k;
    let clipped =
        |x: f64, f: f64, center: f64, size: f64| (2.0 * f * x + (2.0 * center - size) * t[2]) / size;
    let in_clip_space = [clipped(t[0], k.fx, k.cx, view.width), clipped(t[1], k.fy, k.cy, view.height), t[2]];
    let [x, y, z] = [t, mean, [x, y, t[2]], in_clip_space][law[10]];
    let at = [x, y, divisor(z, law[11])];
    let sigma = turned(sigma, view, law[1]);
    let j = jacobian(at, slopes(at, view, form, law[4]), view, law[2], law[3]);
    let entry = |n: usize, m: usize| DVec3::from(j[n]).dot(sigma * DVec3::from(j[m]));
    let mixed = match law[6] {
        0 => entry(0, 1),
        1 => -entry(0, 1),
        2 => 0.0,
        _ => 0.5 * entry(0, 1),
    };
    let before = [entry(0, 0), mixed, entry(1, 1)];
    let [on_a, on_b, on_c] = added(before, view, form, law[5]);
    (before, [before[0] + on_a, before[1] + on_b, before[2] + on_c])
}

/// What is added to the covariance.
fn added([a, b, c]: [f64; 3], view: &View, form: Form, choice: usize) -> [f64; 3] {
    let (middle, apart) = (0.5 * (a + c), (0.25 * (a - c) * (a - c) + b * b).sqrt());
    let both = |h: f64| [h, 0.0, h];
    match choice {
        0 => both(form.dilation.value()),
        11 => [0.3; 3],
        12 => [1e-4 * 0.25 * view.width * view.width, 0.0, 1e-4 * 0.25 * view.height * view.height],
        13 => both((0.1 * (middle + apart) - (middle - apart)).max(0.0)),
        _ => both([0.0, 1e-6, 1e-4, 0.01, 0.1, 0.3, 0.5, 1.0, 1.5, 1e-3][choice - 1]),
    }
}

fn splat(mean: [f64; 3], sigma: [f64; 6], view: &View, form: Form, law: &[usize]) -> Splat {
    let (t, right) = (seen(mean, view, law[12]), project(mean, sigma, view, form));
    let is_right = |parts: &[usize]| parts.iter().all(|part| law[*part] == 0);
    let shape_is_right = is_right(&[1, 2, 3, 4, 5, 6, 10, 11, 12]);
    let (before, covariance) = if shape_is_right {
        let ([a, b, c], h) = (right.covariance, form.dilation.value());
        ([a - h, b, c - h], right.covariance)
    } else {
        covariances(mean, sigma, view, form, law)
    };
    let place = placed(mean, t, view, form, law);
    let corner = if form.center == SplatCenter::Integer { -0.5 } else { 0.0 };
    let inside = [(place[0], view.width), (place[1], view.height)]
        .iter()
        .all(|(u, size)| (0.0..*size).contains(&(u - corner)));
    let radius = match law[8] {
        0 if shape_is_right => right.radius,
        DROPPED if !inside => 0.0,
        choice => reach(covariance, before, form, choice),
    };
    let conic = if shape_is_right && law[7] == 0 { right.conic } else { inverse(covariance, before, law[7]) };
    let distance = (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt();
    let [a, b, c] = covariance;
    let least = form.compensation.determinant();
    let ratio = (before[0] * before[2] - before[1] * before[1]).max(least) / (a * c - b * b).max(least);
    let z = t[2];
    Splat {
        mean: place,
        covariance,
        conic,
        depth: [
            z,
            distance,
            -z,
            1.0 / z,
            z.max(0.01),
            z.max(0.1),
            z.max(0.2),
            z.max(1.0),
            z.max(0.3),
            mean[2],
        ][law[9]],
        radius,
        compensation: if shape_is_right {
            right.compensation
        } else {
            ratio.max(0.0).sqrt().max(form.compensation.value())
        },
    }
}
