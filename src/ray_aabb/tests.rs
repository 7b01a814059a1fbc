//! Closed forms and properties of the box intersection.

use approx::assert_abs_diff_eq;

use super::{Hit, backward, between, intersect};
use crate::random::{Key, Purpose};

const LOW: [f64; 3] = [-1.0, -2.0, 0.5];
const HIGH: [f64; 3] = [1.0, 0.5, 3.0];

fn random(n: u64, ray: u64) -> f64 {
    8.0 * Key::new(3, Purpose::Cases).uniform(0, ray, n) - 4.0
}

fn ray(i: u64) -> ([f64; 3], [f64; 3]) {
    (std::array::from_fn(|a| random(a as u64, i)), std::array::from_fn(|a| random(a as u64 + 3, i)))
}

fn at(o: [f64; 3], d: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|a| o[a] + t * d[a])
}

fn inside(p: [f64; 3], slack: f64) -> bool {
    (0..3).all(|a| LOW[a] - slack <= p[a] && p[a] <= HIGH[a] + slack)
}

/// Points between enter and leave are inside, points before and after are outside; a miss has no point inside.
#[test]
fn agrees_with_points_on_the_ray() {
    let mut hits = 0;
    for i in 0..2000 {
        let (o, d) = ray(i);
        match intersect(o, d, LOW, HIGH) {
            Some(Hit { enter, leave }) => {
                hits += 1;
                assert!(inside(at(o, d, 0.5 * (enter + leave)), 1e-9));
                assert!(!inside(at(o, d, enter - 1e-6), 0.0) && !inside(at(o, d, leave + 1e-6), 0.0));
            }
            None => assert!((-1000..1000).all(|k| !inside(at(o, d, f64::from(k) * 0.01), 0.0))),
        }
    }
    assert!((200..1800).contains(&hits), "{hits} of 2000 rays hit: the test must see both");
}

/// CG1: rays in a face, along an edge, and just beside it.
#[test]
fn rays_in_slab_planes() {
    let unit = |o, d| intersect(o, d, [0.0; 3], [1.0; 3]);
    for x in [0.0, 1.0] {
        let through = Some(Hit { enter: 1.0, leave: 2.0 });
        assert_eq!(unit([x, 0.5, -1.0], [0.0, 0.0, 1.0]), through);
        assert_eq!(unit([x, x, -1.0], [-0.0, 0.0, 1.0]), through);
    }
    // The textbook form multiplies by 1 / d: 0 times infinity.
    assert!((0.0 * (1.0 / 0.0f64)).is_nan());
    assert_eq!(unit([-f64::MIN_POSITIVE, 0.5, -1.0], [0.0, 0.0, 1.0]), None);
    assert_eq!(unit([1.0 + f64::EPSILON, 0.5, -1.0], [0.0, 0.0, 1.0]), None);
}

/// CG2: a direction that a small epsilon would turn into 0 or into infinity.
#[test]
fn tiny_directions() {
    let hit = intersect([0.5, 0.5, -1.0], [-1e-6, 0.0, 1.0], [0.0; 3], [1.0; 3]);
    assert_eq!(hit, Some(Hit { enter: 1.0, leave: 2.0 }));
    assert_eq!(1.0 / (-1e-6 + 1e-6), f64::INFINITY, "the textbook's");
    // From x = 2 along -2^-20: t = 2^20 to the face at 1 and 2^21 to the one at 0. dt / do = -1 / d, dt / dd = -t / d.
    let (o, d) = ([2.0, 0.5, 0.5], [-(2f64.powi(-20)), 0.0, 0.0]);
    let (g_o, g_d) = backward::intersect(o, d, [0.0; 3], [1.0; 3], Hit { enter: 1.0, leave: 0.25 });
    assert_eq!((g_o[0], g_d[0]), (1.25 * 2f64.powi(20), 1.5 * 2f64.powi(40)));
}

#[test]
fn origin_inside_and_box_behind() {
    let hit = |o| intersect(o, [1.0, 0.0, 0.0], [0.0; 3], [1.0; 3]).unwrap();
    assert_eq!(hit([0.25, 0.5, 0.5]), Hit { enter: -0.25, leave: 0.75 });
    assert_eq!(hit([3.0, 0.5, 0.5]), Hit { enter: -3.0, leave: -2.0 });
}

/// The box is entered at 1.5 and left at 2, clipped to `near` and `far`; a single point is a hit too.
#[test]
fn near_and_far_cut_the_stretch() {
    let (o, d) = ([0.25, 0.5, -3.0], [0.0, 0.0, 2.0]);
    let hit = |near, far| between(o, d, [0.0; 3], [1.0; 3], near, far).map(|h| [h.enter, h.leave]);
    assert_eq!(
        [hit(0.0, 9.0), hit(1.75, 9.0), hit(0.0, 1.625)].map(Option::unwrap),
        [[1.5, 2.0], [1.75, 2.0], [1.5, 1.625]]
    );
    assert_eq!([hit(2.0, 9.0), hit(0.0, 1.5)].map(Option::unwrap), [[2.0, 2.0], [1.5, 1.5]]);
    assert_eq!([hit(2.5, 9.0), hit(0.0, 1.25)], [None, None]);
    assert_eq!(between([1.5, 0.5, -3.0], d, [0.0; 3], [1.0; 3], 0.0, 9.0), None, "beside the box");
    // t = (face - o) / d: dt / do = -1 / d, dt / dd = -t / d; an end that near or far determines is a constant, at a tie too.
    let gradient = |near, far| {
        let (g_o, g_d) =
            backward::between(o, d, [0.0; 3], [1.0; 3], [near, far], Hit { enter: 1.0, leave: 4.0 });
        assert_eq!([g_o[0], g_o[1], g_d[0], g_d[1]], [0.0; 4]);
        [g_o[2], g_d[2]]
    };
    let (enter, leave) = ([-0.5, -0.75], [-2.0, -4.0]);
    assert_eq!(gradient(0.0, 9.0), [enter[0] + leave[0], enter[1] + leave[1]]);
    assert_eq!([gradient(1.75, 9.0), gradient(1.5, 9.0)], [leave; 2]);
    assert_eq!([gradient(0.0, 1.75), gradient(0.0, 2.0)], [enter; 2]);
    assert_eq!([gradient(1.5, 2.0), gradient(2.5, 9.0), gradient(0.0, 1.25)], [[0.0; 2]; 3]);
}

/// Where the direction is 0 along every axis, no axis decides: all of the line is inside, and nothing is divided by 0.
#[test]
fn a_direction_of_zero_has_no_gradient() {
    let all = Hit { enter: f64::NEG_INFINITY, leave: f64::INFINITY };
    assert_eq!(intersect([0.5; 3], [0.0; 3], [0.0; 3], [1.0; 3]), Some(all));
    let g = Hit { enter: 1.0, leave: 1.0 };
    assert_eq!(backward::intersect([0.5; 3], [0.0; 3], [0.0; 3], [1.0; 3], g), ([0.0; 3], [0.0; 3]));
}

#[test]
fn gradient_is_finite_differences() {
    let g = Hit { enter: 0.7, leave: -1.3 };
    let loss = |o, d| intersect(o, d, LOW, HIGH).map(|h| g.enter * h.enter + g.leave * h.leave);
    for i in 0..200 {
        let (o, d) = ray(i);
        let (g_o, g_d) = backward::intersect(o, d, LOW, HIGH, g);
        let Some(value) = loss(o, d) else {
            assert_eq!((g_o, g_d), ([0.0; 3], [0.0; 3]));
            continue;
        };
        for a in 0..3 {
            let h = 1e-7;
            let moved = |v: [f64; 3], h: f64| std::array::from_fn(|b| if a == b { v[b] + h } else { v[b] });
            let slopes = [
                (loss(moved(o, h), d).zip(loss(moved(o, -h), d)), g_o[a]),
                (loss(o, moved(d, h)).zip(loss(o, moved(d, -h))), g_d[a]),
            ];
            for (pair, got) in slopes {
                let Some((up, down)) = pair else { continue };
                // t grows like 1 / d, its second derivative like 1 / d^3.
                let scale = 1.0 + value.abs() + got.abs();
                assert_abs_diff_eq!(got, (up - down) / (2.0 * h), epsilon = 1e-4 * scale * scale);
            }
        }
    }
}
