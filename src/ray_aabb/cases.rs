//! Cases of rays and boxes: random hits among misses, origins inside and beyond, rays in faces, directions of nearly 0.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, signed};
use crate::math::power_of_two;

/// Rows of (o, d), a box, a range.
fn case(
    id: &str,
    comment: &'static str,
    rays: &[[f64; 6]],
    [low, high]: [[f64; 3]; 2],
    range: [f64; 2],
) -> Case {
    let part = |from: usize| {
        let rows = rays.iter().flat_map(|ray| [ray[from], ray[from + 1], ray[from + 2]]).collect();
        array(&[rays.len(), 3], rows)
    };
    let inputs = vec![
        ("rays_o", part(0)),
        ("rays_d", part(3)),
        ("low", array(&[3], low.to_vec())),
        ("high", array(&[3], high.to_vec())),
        ("near", scalar(range[0])),
        ("far", scalar(range[1])),
    ];
    Case::new(id, comment, inputs)
}

/// A ray from far outside toward a point of the box (whose corners are given), away from its faces.
fn toward(draw: &mut Draw, [low, high]: [[f64; 3]; 2], scale: f64) -> [f64; 6] {
    let inside: Vec<f64> = (0..3).map(|a| low[a] + (high[a] - low[a]) * (0.25 + 0.5 * draw.unit())).collect();
    let away: Vec<f64> = (0..3).map(|_| draw.between(-1.0, 1.0)).collect();
    let o: Vec<f64> = (0..3).map(|a| crate::contract::case::short(inside[a] + scale * away[a])).collect();
    let speed = 0.25 + draw.unit();
    std::array::from_fn(|n| match n {
        0..3 => o[n],
        _ => crate::contract::case::short((inside[n - 3] - o[n - 3]) / scale * speed),
    })
}

/// Where rays enter and leave a box.
pub(crate) fn ray_aabb() -> Vec<Case> {
    let mut draw = Draw::new("ray_aabb", 0);
    let uneven = [[-1.0, -2.0, 0.5], [1.0, 0.5, 3.0]];
    let unit = [[0.0; 3], [1.0; 3]];
    let hits: Vec<[f64; 6]> = (0..6).map(|_| toward(&mut draw, uneven, 8.0)).collect();
    let mut mixed = hits.clone();
    // The same rays pointing away from the box, and one that passes it.
    mixed.extend(hits[..2].iter().map(|r| [r[0], r[1], r[2], -r[3], -r[4], -r[5]]));
    mixed.push([4.0, 4.0, 4.0, 0.5, -1.0, 0.25]);
    let inside: Vec<[f64; 6]> = (0..4)
        .map(|_| {
            let o = [0, 1, 2].map(|a| draw.between(unit[0][a] + 0.125, unit[1][a] - 0.125));
            let d = [0, 1, 2].map(|_| draw.between(0.25, 1.0) * if draw.below(2) == 0 { 1.0 } else { -1.0 });
            [o[0], o[1], o[2], d[0], d[1], d[2]]
        })
        .collect();
    let far_away: Vec<[f64; 6]> = (0..3).map(|_| toward(&mut draw, unit, 1024.0)).collect();
    let up = |x: f64, y: f64| [x, y, -1.0, 0.0, 0.0, 1.0];
    let cases = vec![
        case("mixed", "six hits, two boxes behind, one passed by", &mixed, uneven, [0.0, 64.0]),
        case("inside", "origins inside: entered at near", &inside, unit, [0.0, 64.0]),
        case(
            "cut",
            "near and far inside the box; a box beyond far",
            &[
                [-1.0, 0.5, 0.375, 1.0, 0.125, 0.0625],
                [-1.0, 0.25, 0.5, 2.0, 0.0625, 0.125],
                [-4.0, 0.25, 0.5, 1.0, 0.03125, 0.0],
            ],
            unit,
            [1.25, 1.75],
        ),
        case(
            "line",
            "near far behind the origin: the whole line, negative t too",
            &hits[..3],
            uneven,
            [-64.0, 64.0],
        ),
        case(
            "slow_and_fast",
            "directions of length 1/4 and 4: t counts in them",
            &[[0.5, 0.25, -1.0, 0.03125, 0.015625, 0.25], [0.5, 0.25, -1.0, 0.5, 0.25, 4.0]],
            unit,
            [0.0, 64.0],
        ),
        case(
            "CG1_in_a_face",
            "rays that lie in faces and edges of the closed box hit; a hundredth beside it they miss",
            &[
                up(0.0, 0.5),
                up(1.0, 0.5),
                up(0.25, 0.0),
                up(1.0, 1.0),
                [0.0, 0.0, -1.0, -0.0, 0.0, 1.0],
                [0.0, 2.0, 0.25, 0.0, -0.5, 0.0],
                up(-0.0078125, 0.5),
                up(0.25, 1.0078125),
            ],
            unit,
            [0.0, 8.0],
        ),
        case(
            "CG1_flat_box",
            "a box without thickness: rays in its plane hit, others along it miss",
            &[[-1.0, 0.25, 0.5, 1.0, 0.125, 0.0], [-1.0, 0.25, 0.625, 1.0, 0.125, 0.0]],
            [[0.0, 0.0, 0.5], [1.0, 1.0, 0.5]],
            [0.0, 8.0],
        )
        // A step out of the plane misses.
        .forward_only(),
        case(
            "CG1_resting",
            "a direction of 0: all of [near, far] inside, nothing outside",
            &[[0.5, 0.5, 0.5, 0.0, 0.0, 0.0], [0.5, 1.0, 0.5, 0.0, 0.0, 0.0], [0.5, 1.5, 0.5, 0.0, 0.0, 0.0]],
            unit,
            [0.25, 8.0],
        ),
        case(
            "CG2_tiny_direction",
            "components of -2^-20: 1 / (d + 1e-6) would turn the ray around",
            &[
                [2.0, 0.5, 0.5, -0.00000095367431640625, 0.0, 0.0],
                [0.5, 0.25, -1.0, -0.00000095367431640625, 0.0, 1.0],
                [0.5, 0.25, 2.0, -0.00000095367431640625, 0.00000095367431640625, -1.0],
            ],
            unit,
            [0.0, 4194304.0],
        )
        // No difference step is short enough beside 2^-20: tests.rs has this gradient in closed form.
        .forward_only(),
        case(
            "CG2_drifting",
            "a component of -2^-30 takes a ray out of the face beside it after a quarter of its length",
            &[[power_of_two(-32), 0.5, 0.25, -power_of_two(-30), 0.0, 1.0]],
            unit,
            [0.0, 8.0],
        )
        .forward_only()
        .edge("a component of a billionth"),
        case(
            "CG2_hardly_moving",
            "components of 2^-31 and 2^-42, either way, inside a box as long as such rays need",
            &[
                [0.75, 0.5, 0.25, power_of_two(-31), 0.0, 0.0],
                [0.75, 0.5, 0.25, -power_of_two(-31), 0.0, 0.0],
                [0.75, 0.5, 0.25, power_of_two(-42), 0.0, 0.0],
                [0.75, 0.5, 0.25, -power_of_two(-42), 0.0, 0.0],
            ],
            [[0.0, -64.0, -64.0], [1.0, 64.0, 64.0]],
            [0.0, power_of_two(44)],
        )
        .forward_only()
        .edge("a component of a billionth"),
        case("CG9_far_away", "origins at 1,000 sizes of the box", &far_away, unit, [0.0, 65536.0]),
    ];
    in_full(cases, "mixed")
}

/// More rays than 16 bits count, some of which meet the box.
pub(crate) fn large() -> Vec<Large> {
    let n = 100_003;
    let large = Large::new("rays_100003", "100,003 rays", n, 1024);
    let large = large.with("rays_o", &[n, 3], signed(-2, 3)).with("rays_d", &[n, 3], signed(-2, 3));
    let large = large.with("low", &[3], Recipe::Cycle(&const { constants([-1.0, -0.75, -1.25]) }));
    let large = large.with("high", &[3], Recipe::Cycle(&const { constants([1.0, 0.5, 1.5]) }));
    vec![large.with("near", &[], Recipe::Constant(0.0)).with("far", &[], Recipe::Constant(64.0))]
}
