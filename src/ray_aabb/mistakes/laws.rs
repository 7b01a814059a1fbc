//! Laws of rays and boxes: what becomes of a direction of 0, where the ray begins and ends, and what counts as a hit.

use super::super::arrays::{RayAndBox, forward, outputs};
use super::super::{Hit, between};
use crate::contract::laws::Laws;

/// What the distance to a plane is divided by.
const DIVIDED: [&str; 12] = [
    "d, and a case of its own where that is 0",
    "d, whatever it is",
    "d + 1e-6",
    "d + 1e-7",
    "d + 1e-8",
    "d + 1e-10",
    "d + 1e-12",
    "1e-5 where |d| is below that",
    "1e-6 where |d| is below that",
    "1e-8 where |d| is below that",
    "1e-6 with the sign of d where |d| is below that",
    "1e-8 with the sign of d where |d| is below that",
];

/// Which plane comes first.
const ORDER: [&str; 5] = [
    "the nearer plane",
    "the lower plane, whatever the sign of d,",
    "z's planes left out, and the lower plane, whatever the sign of d,",
    "from the least entry to the greatest exit, the nearer plane",
    "from the least entry to the greatest exit, the lower plane, whatever the sign of d,",
];

/// Where the part inside begins.
const BEGIN: [&str; 5] =
    ["max(near, t)", "t, near ignored", "max(0, t)", "t where it is ahead, else the exit", "near, always"];

/// Where it ends.
const END: [&str; 4] =
    ["min(far, t)", "t, far ignored", "min(1, t)", "the nearest of all planes that are ahead"];

/// What counts as a hit.
const HIT: [&str; 8] = [
    "t_near <= t_far",
    "t_near < t_far",
    "t_near <= t_far and t_far > 0",
    "t_near < t_far and t_far > 0",
    "t_near <= t_far and t_near > 0",
    "t_near < t_far and t_near > 0",
    "t_far >= max(t_near, 0)",
    "1, for every ray",
];

/// How much longer it is taken for.
const WIDER: [&str; 5] =
    ["nothing", "0.05 at either end", "1e-3 at either end", "-1e-4 at its beginning", "1e-6 at its end"];

/// Those of a ray and a box.
pub(crate) const OF_BOXES: Laws = Laws {
    choices: &[DIVIDED.len(), ORDER.len(), BEGIN.len(), END.len(), HIT.len(), WIDER.len()],
    says: |part, choice| match part {
        0 => format!("distances over {}", DIVIDED[choice]),
        1 => format!("{} first", ORDER[choice]),
        2 => format!("t_near = {}", BEGIN[choice]),
        3 => format!("t_far = {}", END[choice]),
        4 => format!("hit = {}", HIT[choice]),
        _ => format!("longer by {}", WIDER[choice]),
    },
    of: |a, _, law| forward(a, |q| of(q, law)),
    rounding: &[],
};

fn divisor(d: f64, choice: usize) -> f64 {
    let at_least = |least: f64| if d.abs() < least { least } else { d };
    let signed = |least: f64| if d.abs() < least { least.copysign(d) } else { d };
    match choice {
        2 => d + 1e-6,
        3 => d + 1e-7,
        4 => d + 1e-8,
        5 => d + 1e-10,
        6 => d + 1e-12,
        7 => at_least(1e-5),
        8 => at_least(1e-6),
        9 => at_least(1e-8),
        10 => signed(1e-6),
        11 => signed(1e-8),
        _ => d,
    }
}

/// Where the line is inside of the box, by these planes.
fn line(q: &RayAndBox, law: &[usize]) -> Option<Hit> {
    let widest = law[1] >= 3;
    let ends = if widest { f64::INFINITY } else { f64::NEG_INFINITY };
    let mut hit = Hit { enter: ends, leave: -ends };
    for a in 0..if law[1] == 2 { 2 } else { 3 } {
        if law[0] == 0 && q.d[a] == 0.0 {
            let inside = (q.low[a]..=q.high[a]).contains(&q.o[a]);
            if inside {
                continue;
            }
            return None;
        }
        let by = divisor(q.d[a], law[0]);
        let (first, second) = ((q.low[a] - q.o[a]) / by, (q.high[a] - q.o[a]) / by);
        let sorted = [0, 3].contains(&law[1]);
        let (enter, leave) = if sorted { (first.min(second), first.max(second)) } else { (first, second) };
        hit = if widest {
            Hit { enter: hit.enter.min(enter), leave: hit.leave.max(leave) }
        } else {
            Hit { enter: hit.enter.max(enter), leave: hit.leave.min(leave) }
        };
    }
    Some(hit)
}

/// How far the nearest plane ahead is, of all six.
fn nearest(q: &RayAndBox, divided: usize) -> f64 {
    let to = |a: usize, plane: f64| (plane - q.o[a]) / divisor(q.d[a], divided);
    let planes = (0..3).flat_map(|a| [to(a, q.low[a]), to(a, q.high[a])]);
    planes.filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min)
}

fn of(q: &RayAndBox, law: &[usize]) -> [f64; 3] {
    if law.iter().all(|choice| *choice == 0) {
        return outputs(between(q.o, q.d, q.low, q.high, q.near, q.far), q.far);
    }
    let Some(line) = line(q, law) else { return outputs(None, q.far) };
    let (enter, leave) = match law[5] {
        0 => (line.enter, line.leave),
        1 => (line.enter - 0.05, line.leave + 0.05),
        2 => (line.enter - 1e-3, line.leave + 1e-3),
        3 => (line.enter + 1e-4, line.leave),
        _ => (line.enter, line.leave + 1e-6),
    };
    let (first, last) = (enter, leave);
    let enter = match law[2] {
        0 => enter.max(q.near),
        1 => enter,
        2 => enter.max(0.0),
        3 if enter >= 0.0 => enter,
        3 => leave,
        _ => q.near,
    };
    let leave = match law[3] {
        0 => leave.min(q.far),
        1 => leave,
        2 => leave.min(1.0),
        _ => nearest(q, law[0]),
    };
    // Whether the line hits is asked of the box where the beginning is another one.
    let begin = if law[2] >= 3 { first } else { enter };
    let hit = match law[4] {
        0 => begin <= leave && (law[2] != 3 || last >= 0.0),
        1 => begin < leave,
        2 => begin <= leave && leave > 0.0,
        3 => begin < leave && leave > 0.0,
        4 => begin <= leave && begin > 0.0,
        5 => begin < leave && begin > 0.0,
        6 => leave >= begin.max(0.0),
        _ => true,
    };
    [enter, leave, f64::from(u8::from(hit))]
}
