//! Laws of undistortion: how often a point is corrected and by what, and which coefficients are asked.

use glam::DVec2;

use super::super::Distortion;
use super::super::arrays::{forward, lens, undistorted};
use crate::contract::arrays::Arrays;
use crate::contract::laws::Laws;
use crate::convention::Conventions;

/// What a step is.
const STEP: [&str; 7] = [
    "p = (target - tangential(p)) / radial(p)",
    "p + target - distort(p)",
    "p + (target - distort(p)) / 2",
    "x = (target_x - tangential(p)_x) / radial(p), then y with the new x",
    "p - J^-1 (distort(p) - target)",
    "target / radial(p)",
    "target - tangential(p)",
];

/// How many of them.
const STEPS: [usize; 16] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 15, 20, 25, 50, 100];

/// How near is near enough: no more steps then.
const ENOUGH: [f64; 8] = [0.0, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12];

/// Which coefficients.
const KEPT: [&str; 9] = [
    "all",
    "k1, k2, p1, p2, k3 alone",
    "k1, k2, p1, p2 alone",
    "k1, k2, k3 alone",
    "k1, k2 alone",
    "k1 alone",
    "all but k5 and k6",
    "p1 and p2 exchanged",
    "k1, k2, k3, p1, p2 in this order",
];

/// Those of undistortion.
pub(crate) const OF_UNDISTORTION: Laws = Laws {
    choices: &[1 + STEP.len() * STEPS.len(), KEPT.len(), ENOUGH.len()],
    says: |part, choice| match part {
        0 => {
            let (step, times) = (STEP[(choice - 1) / STEPS.len()], STEPS[(choice - 1) % STEPS.len()]);
            format!("{step}, {times} times from the target on")
        }
        1 => format!("coefficients: {}", KEPT[choice]),
        _ => format!("no step where |distort(p) - target| < {:e}", ENOUGH[choice]),
    },
    of,
    rounding: &[],
};

fn kept(lens: Distortion, choice: usize) -> Distortion {
    let none = Distortion::default();
    let Distortion { k1, k2, p1, p2, k3, k4, .. } = lens;
    match choice {
        0 => lens,
        1 => Distortion { k4: 0.0, k5: 0.0, k6: 0.0, ..lens },
        2 => Distortion { k1, k2, p1, p2, ..none },
        3 => Distortion { k1, k2, k3, ..none },
        4 => Distortion { k1, k2, ..none },
        5 => Distortion { k1, ..none },
        6 => Distortion { k1, k2, p1, p2, k3, k4, ..none },
        7 => Distortion { p1: p2, p2: p1, ..lens },
        _ => Distortion { k1, k2, k3: p1, p1: p2, p2: k3, ..lens },
    }
}

/// The tangential part at p.
fn tangential(lens: &Distortion, p: DVec2) -> DVec2 {
    lens.distort(p) - p * lens.radial(p).value
}

fn stepped(lens: &Distortion, p: DVec2, target: DVec2, step: usize) -> DVec2 {
    let by_radial = |p: DVec2| (target - tangential(lens, p)) / lens.radial(p).value;
    match step {
        0 => by_radial(p),
        1 => p + target - lens.distort(p),
        2 => p + 0.5 * (target - lens.distort(p)),
        3 => {
            // The radial factor is the old point's.
            let (x, radial) = (by_radial(p).x, lens.radial(p));
            let y = target.y - lens.p1 * (radial.r2 + 2.0 * p.y * p.y) - 2.0 * lens.p2 * x * p.y;
            DVec2::new(x, y / radial.value)
        }
        4 => p - lens.jacobian(p).inverse() * (lens.distort(p) - target),
        5 => target / lens.radial(p).value,
        _ => target - tangential(lens, p),
    }
}

fn of(a: &Arrays, _: &Conventions, law: &[usize]) -> Arrays {
    let lens = kept(lens(a), law[1]);
    forward(a, "distorted", "points", |target| {
        let Some(way) = law[0].checked_sub(1) else { return undistorted(&lens, target).to_array() };
        let (target, mut p) = (DVec2::from(target), DVec2::from(target));
        for _ in 0..STEPS[way % STEPS.len()] {
            if (lens.distort(p) - target).length() < ENOUGH[law[2]] {
                break;
            }
            p = stepped(&lens, p, target, way / STEPS.len());
        }
        p.to_array()
    })
}
