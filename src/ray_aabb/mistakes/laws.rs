//! Laws of rays and boxes: what becomes of a direction of 0, where the ray begins and ends, and what counts as a hit.

use super::super::arrays::{RayAndBox, forward, outputs};
use super::super::{Hit, between};
use crate::contract::laws::Laws;

/// What the distance to a plane is divided by.
const DIVIDED: [&str; 24] = [
    "d, and a case of its own where that is 0",
    "d, whatever it is",
    "d, whatever it is, and a miss where that gives NaN",
    "d, and a ray in a face misses where that is 0",
    "d, and no slab is missed where that is 0",
    "d, and every slab is missed where that is 0",
    "d + 1e-6",
    "d + 1e-7",
    "d + 1e-8",
    "d + 1e-9",
    "d + 1e-10",
    "d + 1e-12",
    "1e-5 where d is small",
    "1e-6 where d is small",
    "1e-8 where d is small",
    "1e-10 where d is small",
    "1e-12 where d is small",
    "1e-30 where d is small",
    "1e-6 with the sign of d where d is small",
    "1e-8 with the sign of d where d is small",
    "1e-10 with the sign of d where d is small",
    "1e-12 with the sign of d where d is small",
    "1e-30 with the sign of d where d is small",
    "1e-30 with the sign of d where d is small, infinity where it is 0",
];

/// The numbers in its place, from the first of them on.
const REPLACED: usize = 12;
const TINY: [f64; 12] = [1e-5, 1e-6, 1e-8, 1e-10, 1e-12, 1e-30, 1e-6, 1e-8, 1e-10, 1e-12, 1e-30, 1e-30];

/// Those that have its sign.
const SIGNED: usize = 18;

/// What is small, or 0: the cases tell no limits apart between which no direction of theirs lies.
const SMALL: [(f64, &str); 5] = [
    (0.0, "|d| up to what is divided by"),
    (0.0, "d = 0 alone"),
    (1e-12, "|d| up to 1e-12 or 1e-10"),
    (1e-8, "|d| up to 1e-9, 1e-8 or 1e-7"),
    (1e-6, "|d| up to 1e-6 or 1e-5"),
];

/// Which plane comes first.
const ORDER: [&str; 7] = [
    "the nearer plane",
    "the lower plane, whatever the sign of d,",
    "z's planes left out, and the lower plane, whatever the sign of d,",
    "from the least entry to the greatest exit, the nearer plane",
    "from the least entry to the greatest exit, the lower plane, whatever the sign of d,",
    "from the least entry to the least exit, the nearer plane",
    "from the greatest entry to the greatest exit, the nearer plane",
];

/// Where the part inside begins.
const BEGIN: [&str; 5] =
    ["max(near, t)", "t, near ignored", "max(0, t)", "t where it is ahead, else the exit", "near, always"];

/// Where it ends.
const END: [&str; 4] =
    ["min(far, t)", "t, far ignored", "min(1, t)", "the nearest of all planes that are ahead"];

/// What counts as a hit.
const HIT: [&str; 14] = [
    "t_near <= t_far",
    "t_near < t_far",
    "t_near <= t_far and t_far > 0",
    "t_near < t_far and t_far > 0",
    "t_near <= t_far and t_near > 0",
    "t_near < t_far and t_near > 0",
    "t_far >= max(t_near, 0)",
    "1, for every ray",
    "t_far > 0",
    "t_near <= t_far before they are cut",
    "t_near < t_far before they are cut",
    "t_near <= t_far and t_far > 0 before they are cut",
    "t_near < t_far and t_far > 0 before they are cut",
    "t_near <= t_far and t_near > 0 before they are cut",
];

/// How much longer it is taken for.
const WIDER: [&str; 5] =
    ["nothing", "0.05 at either end", "1e-3 at either end", "-1e-4 at its beginning", "1e-6 at its end"];

/// Those of a ray and a box.
pub(crate) const OF_BOXES: Laws = Laws {
    choices: &[DIVIDED.len(), SMALL.len(), ORDER.len(), BEGIN.len(), END.len(), HIT.len(), WIDER.len()],
    says: |part, choice| match part {
        0 => format!("distances over {}", DIVIDED[choice]),
        1 => format!("{} taken for small, or for 0", SMALL[choice].1),
        2 => format!("{} first", ORDER[choice]),
        3 => format!("t_near = {}", BEGIN[choice]),
        4 => format!("t_far = {}", END[choice]),
        5 => format!("hit = {}", HIT[choice]),
        _ => format!("longer by {}", WIDER[choice]),
    },
    of: |a, _, law| forward(a, |q| of(q, law)),
    rounding: &[],
};

/// What is divided by, by the choices of that and of what is small.
fn divisor(d: f64, law: &[usize]) -> f64 {
    if let Some(tiny) = law[0].checked_sub(REPLACED).map(|n| TINY[n]) {
        let limit = if law[1] == 0 { tiny } else { SMALL[law[1]].0 };
        return match () {
            () if d.abs() > limit => d,
            () if law[0] < SIGNED => tiny,
            () if d == 0.0 && law[0] + 1 == DIVIDED.len() => f64::INFINITY,
            () => tiny.copysign(d),
        };
    }
    d + match law[0] {
        6 => 1e-6,
        7 => 1e-7,
        8 => 1e-8,
        9 => 1e-9,
        10 => 1e-10,
        11 => 1e-12,
        _ => 0.0,
    }
}

/// Whether a ray along a slab is in it, where it is asked.
fn alongside(q: &RayAndBox, a: usize, law: &[usize]) -> Option<bool> {
    let (o, low, high) = (q.o[a], q.low[a], q.high[a]);
    let inside = match law[0] {
        0 => low <= o && o <= high,
        3 => low < o && o < high,
        4 => true,
        5 => false,
        _ => return None,
    };
    (q.d[a].abs() <= SMALL[law[1]].0).then_some(inside)
}

/// Where the line is inside of the box, by these planes.
fn line(q: &RayAndBox, law: &[usize]) -> Option<Hit> {
    let [least_entry, most_exit] = [[3, 4, 5], [3, 4, 6]].map(|those| those.contains(&law[2]));
    let end = |low: bool| if low { f64::NEG_INFINITY } else { f64::INFINITY };
    let mut hit = Hit { enter: end(!least_entry), leave: end(most_exit) };
    for a in 0..if law[2] == 2 { 2 } else { 3 } {
        match alongside(q, a, law) {
            Some(true) => continue,
            Some(false) => return None,
            None => {}
        }
        let by = divisor(q.d[a], law);
        let (first, second) = ((q.low[a] - q.o[a]) / by, (q.high[a] - q.o[a]) / by);
        if law[0] == 2 && (first.is_nan() || second.is_nan()) {
            return None;
        }
        let as_they_are = [1, 2, 4].contains(&law[2]);
        let (enter, leave) =
            if as_they_are { (first, second) } else { (first.min(second), first.max(second)) };
        hit = Hit {
            enter: if least_entry { hit.enter.min(enter) } else { hit.enter.max(enter) },
            leave: if most_exit { hit.leave.max(leave) } else { hit.leave.min(leave) },
        };
    }
    Some(hit)
}

/// How far the nearest plane ahead is, of all six.
fn nearest(q: &RayAndBox, law: &[usize]) -> f64 {
    let to = |a: usize, plane: f64| (plane - q.o[a]) / divisor(q.d[a], law);
    let planes = (0..3).flat_map(|a| [to(a, q.low[a]), to(a, q.high[a])]);
    planes.filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min)
}

fn of(q: &RayAndBox, law: &[usize]) -> [f64; 3] {
    if law.iter().all(|choice| *choice == 0) {
        return outputs(between(q.o, q.d, q.low, q.high, q.near, q.far), q.far);
    }
    let Some(line) = line(q, law) else { return outputs(None, q.far) };
    let (enter, leave) = match law[6] {
        0 => (line.enter, line.leave),
        1 => (line.enter - 0.05, line.leave + 0.05),
        2 => (line.enter - 1e-3, line.leave + 1e-3),
        3 => (line.enter + 1e-4, line.leave),
        _ => (line.enter, line.leave + 1e-6),
    };
    let (first, last) = (enter, leave);
    let enter = match law[3] {
        0 => enter.max(q.near),
        1 => enter,
        2 => enter.max(0.0),
        3 if enter >= 0.0 => enter,
        3 => leave,
        _ => q.near,
    };
    let leave = match law[4] {
        0 => leave.min(q.far),
        1 => leave,
        2 => leave.min(1.0),
        _ => nearest(q, law),
    };
    // Whether the line hits is asked of the box where the beginning is another one.
    let begin = if law[3] >= 3 { first } else { enter };
    let hit = match law[5] {
        0 => begin <= leave && (law[3] != 3 || last >= 0.0),
        1 => begin < leave,
        2 => begin <= leave && leave > 0.0,
        3 => begin < leave && leave > 0.0,
        4 => begin <= leave && begin > 0.0,
        5 => begin < leave && begin > 0.0,
        6 => leave >= begin.max(0.0),
        8 => leave > 0.0,
        9 => first <= last,
        10 => first < last,
        11 => first <= last && last > 0.0,
        12 => first < last && last > 0.0,
        13 => first <= last && first > 0.0,
        _ => true,
    };
    [enter, leave, f64::from(u8::from(hit))]
}
