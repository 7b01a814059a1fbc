//! Cases of the interlevel loss: coarser and finer proposals, edges in common, intervals without length, covered and empty rays.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats};

/// Rays of as many intervals: weights and edges, and those of the proposal.
fn case(id: &str, comment: &'static str, rays: &[[Vec<f64>; 4]], eps: f64) -> Case {
    let of = |k: usize| {
        let rows: Vec<f64> = rays.iter().flat_map(|ray| ray[k].clone()).collect();
        array(&[rays.len(), rays[0][k].len()], rows)
    };
    let names = ["weights", "t", "proposal_weights", "proposal_t"];
    let mut inputs: Vec<_> = names.into_iter().enumerate().map(|(k, name)| (name, of(k))).collect();
    inputs.push(("eps", scalar(eps)));
    Case::new(id, comment, inputs)
}

/// `n` intervals from 0 to 1 with weights that add up to about `total`.
fn histogram(draw: &mut Draw, n: usize, total: f64) -> [Vec<f64>; 2] {
    let mut t = vec![0.0];
    (1..n).for_each(|i| t.push(short((i as f64 + draw.between(-0.4, 0.4)) / n as f64)));
    t.push(1.0);
    [(0..n).map(|_| draw.between(0.0, 2.0 * total / n as f64)).collect(), t]
}

/// Edges of the field 2^`last` in front of one of the proposal, and one of the proposal as much behind one of the field: they coincide in
/// numbers of fewer bits, and then touch.
fn beside_edges(id: &str, last: i32) -> Case {
    let little = libm::ldexp(1.0, last);
    let ray = [
        vec![0.25, 0.5, 0.125, 0.375],
        vec![0.0, 0.25 * (1.0 - little), 0.5, 0.75, 1.0],
        vec![0.0625, 0.25, 0.03125, 0.125],
        vec![0.0, 0.25, 0.5 * (1.0 + little), 0.75, 1.0],
    ];
    case(id, "edges next to each other", &[ray], 1.0 / 1024.0)
}

/// The loss of a proposal.
pub(crate) fn interlevel_loss() -> Vec<Case> {
    const EPS: f64 = 1.0 / 1024.0;
    let seeded =
        |id: &str, comment, stream: u64, rays: usize, [n, m]: [usize; 2], totals: [f64; 2], eps: f64| {
            let mut draw = Draw::new("interlevel_loss", stream);
            let ray = |_| {
                let [weights, t] = histogram(&mut draw, n, totals[0]);
                let [v, s] = histogram(&mut draw, m, totals[1]);
                [weights, t, v, s]
            };
            case(id, comment, &(0..rays).map(ray).collect::<Vec<_>>(), eps)
        };
    let quarters = vec![0.0, 0.25, 0.5, 0.75, 1.0];
    let cases = vec![
        seeded("usual", "a proposal of six intervals for eight", 0, 4, [8, 6], [0.9, 0.375], EPS),
        seeded("finer_proposal", "several intervals of the proposal in one", 1, 3, [4, 16], [0.9, 0.25], EPS),
        seeded(
            "coarse_proposal",
            "several intervals in one of the proposal",
            2,
            3,
            [16, 4],
            [0.9, 0.0625],
            1e-7,
        ),
        seeded("covered", "a proposal that is a bound: no loss, or nearly", 3, 2, [6, 6], [0.5, 0.9], EPS),
        case(
            "same_edges",
            "edges in common: an interval touches the next",
            &[
                [
                    vec![0.25, 0.5, 0.125, 0.0625],
                    quarters.clone(),
                    vec![0.125, 0.0625, 0.03125, 0.25],
                    quarters.clone(),
                ],
                [vec![0.0, 0.75, 0.0, 0.125], quarters.clone(), vec![0.0, 0.5, 0.0, 0.0], quarters.clone()],
            ],
            EPS,
        ),
        case(
            "no_length",
            "intervals without length in both, in one place",
            &[[
                vec![0.25, 0.5, 0.125, 0.125],
                vec![0.0, 0.5, 0.5, 0.75, 1.0],
                vec![0.125, 0.0625, 0.25, 0.03125],
                vec![0.0, 0.25, 0.5, 0.5, 1.0],
            ]],
            EPS,
        ),
        case(
            "empty",
            "no weights on one ray, none of the proposal on another",
            &[
                [vec![0.0; 4], quarters.clone(), vec![0.25, 0.0, 0.5, 0.0], quarters.clone()],
                [vec![0.25, 0.0, 0.5, 0.0], quarters.clone(), vec![0.0; 4], quarters.clone()],
            ],
            EPS,
        ),
        case(
            "about_eps",
            "weights of about eps",
            &[[
                vec![0.0009765625, 0.001953125, 0.00048828125, 0.00390625],
                quarters.clone(),
                vec![0.00048828125, 0.0, 0.000244140625, 0.0],
                vec![0.0, 0.125, 0.375, 0.875, 1.0],
            ]],
            EPS,
        ),
        case(
            "one_interval",
            "one interval in each",
            &[[vec![0.75], vec![0.0, 1.0], vec![0.25], vec![0.0, 1.0]]],
            EPS,
        )
        .edge("one sample"),
    ];
    let mut cases = in_full(cases, "usual");
    cases.extend([beside_edges("beside_edges_f32", -20), beside_edges("beside_edges_f64", -40)]);
    cases
}

/// More rays than threads, more intervals than a warp has lanes, two for each of the proposal.
pub(crate) fn large() -> Vec<Large> {
    let case = |id, comment, [rays, m, block]: [usize; 3], cells| {
        let large = Large::new(id, comment, rays, block);
        let large = large.with("weights", &[rays, 2 * m], floats(-8, 3));
        let large = large.with("t", &[rays, 2 * m + 1], Recipe::Ascending { cells: cells + 1 });
        let large = large.with("proposal_weights", &[rays, m], floats(-11, 4));
        let large = large.with("proposal_t", &[rays, m + 1], Recipe::Ascending { cells });
        large.with("eps", &[], Recipe::Constant(0.0009765625))
    };
    vec![
        case("rays_4099", "4,099 rays of 6 intervals, 3 of the proposal", [4099, 3, 512], 2),
        case("rays_1025", "1,025 rays of 98 intervals, 49 of the proposal", [1025, 49, 64], 6),
    ]
}
