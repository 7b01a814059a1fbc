//! Laws of undistortion: how often a point is corrected and by what, when that ends, and which coefficients are asked.

use glam::DVec2;

use super::super::Distortion;
use super::super::arrays::{forward, lens, undistorted};
use crate::contract::arrays::Arrays;
use crate::contract::laws::Laws;
use crate::convention::Conventions;

/// What a step is, with R the radial factor and T the tangential part.
const STEP: [&str; 18] = [
    "p - J^-1 (distort(p) - target)",
    "(target - T) / R",
    "(p - T) / R",
    "target / R",
    "p / R",
    "(target - T) R",
    "(p - T) R",
    "target R",
    "target - T",
    "p + target - distort(p)",
    "p + (target - distort(p)) / 2",
    "p - (target - distort(p))",
    "x = (target_x - T_x) / R, then y with the new x in T",
    "target / R - T",
    "(p + (target - T) / R) / 2",
    "p - (distort(p) - target) over J's diagonal",
    "p - J^-1 (distort(p) - target), with J at the target",
    "p - J (distort(p) - target)",
];

/// How many of them: as many as it takes first.
const STEPS: [usize; 18] = [100, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 15, 19, 20, 25, 50, 99];

/// When there is no further step.
const END: [(When, f64); 20] = [
    (When::Never, 0.0),
    (When::Near, 1e-3),
    (When::Near, 1e-4),
    (When::Near, 1e-5),
    (When::Near, 1e-6),
    (When::Near, 1e-8),
    (When::Near, 1e-10),
    (When::Near, 1e-12),
    (When::Left, 1e-3),
    (When::Left, 1e-4),
    (When::Left, 1e-5),
    (When::Left, 1e-6),
    (When::Left, 1e-8),
    (When::Left, 1e-10),
    (When::Taken, 1e-3),
    (When::Taken, 1e-4),
    (When::Taken, 1e-5),
    (When::Taken, 1e-6),
    (When::Taken, 1e-8),
    (When::Taken, 1e-10),
];

/// What is asked whether there is a further step.
#[derive(Clone, Copy, PartialEq)]
enum When {
    /// Nothing.
    Never,
    /// How near the target is.
    Near,
    /// How short a step is, which isn't taken then.
    Left,
    /// How short a step is, which is the last one.
    Taken,
}

/// Which coefficients.
const KEPT: [&str; 8] = [
    "all",
    "k1, k2, p1, p2, k3 alone",
    "k1, k2, p1, p2 alone",
    "k1, k2, k3, p1, p2 in this order",
    "k1 and the tangential ones alone",
    "k2 and the tangential ones alone",
    "all but k5 and k6",
    "negated",
];

/// What R is.
const RADIAL: [&str; 5] =
    ["R of p", "R of the target", "1 + k1 r + k2 r^2 + k3 r^3", "1 + k1 r^2 + k2 r^3 + k3 r^4", "1"];

/// What T is.
const TANGENTIAL: [&str; 8] = [
    "T of p",
    "0",
    "T of the target",
    "T with p1 and p2 exchanged",
    "T with p1 and p2 exchanged in y",
    "-T",
    "T without r^2",
    "T with r^2 for r^2 + 2 x^2 and r^2 + 2 y^2",
];

/// Those of undistortion.
pub(crate) const OF_UNDISTORTION: Laws = Laws {
    choices: &[KEPT.len(), END.len(), RADIAL.len(), TANGENTIAL.len(), STEPS.len(), STEP.len()],
    says: |part, choice| match part {
        0 => format!("coefficients: {}", KEPT[choice]),
        1 => match END[choice] {
            (When::Left, eps) => format!("a step below {eps:e} ends the search and isn't taken"),
            (When::Taken, eps) => format!("a step below {eps:e} is the last one"),
            (_, eps) => format!("no step where |distort(p) - target| < {eps:e}"),
        },
        2 => format!("R = {}", RADIAL[choice]),
        3 => format!("T = {}", TANGENTIAL[choice]),
        4 => format!("steps from the target on: {}", STEPS[choice]),
        _ => format!("each step gives {}, with R radial and T tangential", STEP[choice]),
    },
    of,
    rounding: &[],
};

fn kept(lens: Distortion, choice: usize) -> Distortion {
    let none = Distortion::default();
    let Distortion { k1, k2, p1, p2, k3, k4, k5, k6 } = lens;
    match choice {
        1 => Distortion { k4: 0.0, k5: 0.0, k6: 0.0, ..lens },
        2 => Distortion { k1, k2, p1, p2, ..none },
        3 => Distortion { k1, k2, k3: p1, p1: p2, p2: k3, ..lens },
        4 => Distortion { k1, p1, p2, ..none },
        5 => Distortion { k2, p1, p2, ..none },
        6 => Distortion { k1, k2, p1, p2, k3, k4, ..none },
        7 => Distortion { k1: -k1, k2: -k2, p1: -p1, p2: -p2, k3: -k3, k4: -k4, k5: -k5, k6: -k6 },
        _ => lens,
    }
}

/// A search for the point that lands at a target.
struct Search<'a> {
    lens: Distortion,
    target: DVec2,
    law: &'a [usize],
}

impl Search<'_> {
    fn radial(&self, p: DVec2) -> f64 {
        let Distortion { k1, k2, k3, .. } = self.lens;
        let r = p.length();
        match self.law[2] {
            1 => self.lens.radial(self.target).value,
            2 => 1.0 + r * (k1 + r * (k2 + r * k3)),
            3 => 1.0 + r * r * (k1 + r * (k2 + r * k3)),
            4 => 1.0,
            _ => self.lens.radial(p).value,
        }
    }

    fn tangential(&self, p: DVec2) -> DVec2 {
        let Distortion { p1, p2, .. } = self.lens;
        let of = |p: DVec2, [p1, p2]: [f64; 2], [r, twice]: [f64; 2]| {
            let square = r * p.length_squared();
            DVec2::new(
                2.0 * p1 * p.x * p.y + p2 * (square + twice * p.x * p.x),
                p1 * (square + twice * p.y * p.y) + 2.0 * p2 * p.x * p.y,
            )
        };
        let (both, usual) = ([p1, p2], [1.0, 2.0]);
        match self.law[3] {
            1 => DVec2::ZERO,
            2 => of(self.target, both, usual),
            3 => of(p, [p2, p1], usual),
            4 => DVec2::new(of(p, both, usual).x, of(p, [p2, p1], usual).y),
            5 => -of(p, both, usual),
            6 => of(p, both, [0.0, 2.0]),
            7 => of(p, both, [1.0, 0.0]),
            _ => of(p, both, usual),
        }
    }

    fn distort(&self, p: DVec2) -> DVec2 {
        p * self.radial(p) + self.tangential(p)
    }

    fn step(&self, p: DVec2) -> DVec2 {
        let (target, r, t) = (self.target, self.radial(p), self.tangential(p));
        let off = p * r + t - target;
        match self.law[5] {
            0 => p - self.lens.jacobian(p).inverse() * off,
            1 => (target - t) / r,
            2 => (p - t) / r,
            3 => target / r,
            4 => p / r,
            5 => (target - t) * r,
            6 => (p - t) * r,
            7 => target * r,
            8 => target - t,
            9 => p - off,
            10 => p - 0.5 * off,
            11 => p + off,
            12 => {
                // The radius is the old point's.
                let x = (target.x - t.x) / r;
                DVec2::new(x, (target.y - t.y - 2.0 * self.lens.p2 * (x - p.x) * p.y) / r)
            }
            13 => target / r - t,
            14 => 0.5 * (p + (target - t) / r),
            15 => {
                let jacobian = self.lens.jacobian(p);
                p - off / DVec2::new(jacobian.x_axis.x, jacobian.y_axis.y)
            }
            16 => p - self.lens.jacobian(target).inverse() * off,
            _ => p - self.lens.jacobian(p) * off,
        }
    }

    fn found(&self) -> DVec2 {
        let (mut p, (when, eps)) = (self.target, END[self.law[1]]);
        for _ in 0..STEPS[self.law[4]] {
            if when == When::Near && (self.distort(p) - self.target).length() < eps {
                break;
            }
            let next = self.step(p);
            let short = (next - p).length() < eps;
            if when == When::Left && short {
                break;
            }
            p = next;
            if when == When::Taken && short {
                break;
            }
        }
        p
    }
}

fn of(a: &Arrays, _: &Conventions, law: &[usize]) -> Arrays {
    let lens = kept(lens(a), law[0]);
    forward(a, "distorted", "points", |target| {
        if law[1..].iter().all(|choice| *choice == 0) {
            return undistorted(&lens, target).to_array();
        }
        Search { lens, target: target.into(), law }.found().to_array()
    })
}
