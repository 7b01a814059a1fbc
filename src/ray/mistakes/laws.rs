//! Laws of a picture's rays: how far from the axis a pixel is, what is made of that, and what turns it.

use glam::{DMat4, DVec3};

use super::super::Ray;
use super::super::arrays::{bundle, image_rays, picture, positions};
use crate::camera::rotate;
use crate::contract::arrays::Arrays;
use crate::contract::laws::Laws;
use crate::convention::{Axes, Conventions, Directions};
use crate::math::{cos, sin};

/// Across, with W; down, with H for W and j for i.
const PLACE: [&str; 17] = [
    "(u - cx) / f",
    "(i + 1/2 - W/2) / f",
    "(i - W/2) / f",
    "(i - (W - 1)/2) / f",
    "2 i / W - 1",
    "2 (i + 1/2) / W - 1",
    "2 i / (W - 1) - 1",
    "(2 i / (W - 1) - 1) W / (2 f)",
    "(2 i / W - 1) W / (2 f)",
    "the angle (2 i / (W - 1) - 1) atan(W / (2 f))",
    "the angle (2 i / W - 1) atan(W / (2 f))",
    "the angle (2 (i + 1/2) / W - 1) atan(W / (2 f))",
    "i / W - 1/2",
    "(u - cx) / W",
    "(i + 1 - W/2) / f",
    "2 (i + 1) / W - 1",
    "i - W/2 / f",
];

/// Whose length the lens is taken from.
const LENS: [&str; 5] = [
    "each axis' own length",
    "W for H in the lens of y",
    "H for W in the lens of x",
    "the lens of y times W / H for that of x",
    "the lens of x times H / W for that of y",
];

/// Signs in the camera's axes.
const SIGNS: [&str; 8] = ["", "x", "y", "x and y", "z", "x and z", "y and z", "x, y and z"];

/// What is made of x and y.
const FORM: [&str; 4] = [
    "(x, y, 1)",
    "(sin x cos y, sin y, cos x cos y)",
    "(tan x, tan y, 1)",
    "(sin x, sin y cos x, cos x cos y)",
];

/// What turns it.
const TURN: [&str; 4] = ["R d", "R^T d", "d, not turned", "R d + o"];

/// Those of a picture.
pub(crate) const OF_PICTURES: Laws = Laws {
    choices: &[PLACE.len(), LENS.len(), SIGNS.len(), 2, FORM.len(), TURN.len()],
    says,
    of,
    rounding: &[],
};

fn says(part: usize, choice: usize) -> String {
    match part {
        0 => format!("x = {} for pixel i of W, and y like that", PLACE[choice]),
        1 => LENS[choice].into(),
        2 => format!("the other sign of {}", SIGNS[choice]),
        3 => "x and y exchanged".into(),
        4 => format!("d = {}", FORM[choice]),
        _ => format!("{} for the direction", TURN[choice]),
    }
}

/// x of pixel `i` of `n`; `lens` has the length that the lens is taken from.
fn place(i: f64, at: f64, n: f64, center: f64, f: f64, lens: f64, choice: usize) -> f64 {
    let to_the_edges = |i: f64, n: f64| if n > 0.0 { 2.0 * i / n - 1.0 } else { -1.0 };
    let (half, angle) = (0.5 * lens / f, libm::atan(0.5 * lens / f));
    match choice {
        0 => (at - center) / f,
        1 => (i + 0.5 - 0.5 * n) / f,
        2 => (i - 0.5 * n) / f,
        3 => (i - 0.5 * (n - 1.0)) / f,
        4 => to_the_edges(i, n),
        5 => to_the_edges(i + 0.5, n),
        6 => to_the_edges(i, n - 1.0),
        7 => to_the_edges(i, n - 1.0) * half,
        8 => to_the_edges(i, n) * half,
        9 => to_the_edges(i, n - 1.0) * angle,
        10 => to_the_edges(i, n) * angle,
        11 => to_the_edges(i + 0.5, n) * angle,
        12 => i / n - 0.5,
        13 => (at - center) / n,
        14 => (i + 1.0 - 0.5 * n) / f,
        15 => to_the_edges(i + 1.0, n),
        _ => i - 0.5 * n / f,
    }
}

fn formed(x: f64, y: f64, choice: usize) -> DVec3 {
    match choice {
        0 => DVec3::new(x, y, 1.0),
        1 => DVec3::new(sin(x) * cos(y), sin(y), cos(x) * cos(y)),
        2 => DVec3::new(libm::tan(x), libm::tan(y), 1.0),
        _ => DVec3::new(sin(x), sin(y) * cos(x), cos(x) * cos(y)),
    }
}

fn turned(c2w: &DMat4, d: DVec3, choice: usize) -> DVec3 {
    match choice {
        1 => rotate(&c2w.transpose(), d),
        2 => d,
        _ => rotate(c2w, d),
    }
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let (height, width, k, c2w) = picture(a);
    let (w, h, f) = (width as f64, height as f64, k.fx);
    let lens = match law[1] {
        0 => [w, h],
        1 => [w, w],
        2 => [h, h],
        3 => [h, h],
        _ => [w, w],
    };
    let aspect = match law[1] {
        3 => [w / h, 1.0],
        4 => [1.0, h / w],
        _ => [1.0, 1.0],
    };
    let ray = |(n, at): (usize, glam::DVec2)| {
        let (i, j) = ((n % width) as f64, (n / width) as f64);
        let x = aspect[0] * place(i, at.x, w, k.cx, f, lens[0], law[0]);
        let y = aspect[1] * place(j, at.y, h, k.cy, f, lens[1], law[0]);
        let [x, y] = if law[3] == 1 { [y, x] } else { [x, y] };
        let mut d = formed(x, y, law[4]);
        if c.axes == Axes::Opengl {
            (d.y, d.z) = (-d.y, -d.z);
        }
        let sign = |bit: usize| if law[2] >> bit & 1 == 1 { -1.0 } else { 1.0 };
        d *= DVec3::new(sign(0), sign(1), sign(2));
        let o = c2w.w_axis.truncate();
        let more = if law[5] == 3 { o } else { DVec3::ZERO };
        let d = match c.directions {
            Directions::Unit => {
                let d = turned(&c2w, d, law[5]) + more;
                d / d.length()
            }
            Directions::UnitInCamera => turned(&c2w, d / d.length(), law[5]) + more,
            Directions::Depth => turned(&c2w, d, law[5]) + more,
        };
        Ray { o, d }
    };
    let rays: Vec<Ray> = positions(a, c).into_iter().enumerate().map(ray).collect();
    let mut out = bundle(&rays, &[height, width, 3]);
    out.insert("uv".into(), image_rays(a, c)["uv"].clone());
    out
}
