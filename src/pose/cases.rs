//! Cases of poses: turned any way, by half turns, not at all; quaternions of other lengths, cameras far away.

use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full, short};

/// A case from its quaternions and translations.
fn case(id: &str, comment: &'static str, q: &[[f64; 4]], t: &[[f64; 3]]) -> Case {
    Case::new(
        id,
        comment,
        vec![("q", array(&[q.len(), 4], q.concat())), ("t", array(&[t.len(), 3], t.concat()))],
    )
}

/// `n` quaternions of about this length.
fn turns(draw: &mut Draw, n: usize, length: f64) -> Vec<[f64; 4]> {
    let turn = |_| {
        let q = [0; 4].map(|_| draw.between(-1.0, 1.0));
        let size = q.iter().map(|x| x * x).fold(0.0, |sum: f64, x| sum + x).sqrt();
        q.map(|x| short(length * x / size))
    };
    (0..n).map(turn).collect()
}

/// `n` translations up to `size`.
fn moves(draw: &mut Draw, n: usize, size: f64) -> Vec<[f64; 3]> {
    (0..n).map(|_| [0; 3].map(|_| draw.between(-size, size))).collect()
}

/// Pictures of a structure from motion.
pub(crate) fn pose_from_colmap() -> Vec<Case> {
    let mut draw = Draw::new("pose_from_colmap", 0);
    let axes = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let thirds = [[0.5, 0.5, 0.5, 0.5], [0.5, -0.5, 0.5, -0.5], [-0.5, 0.5, 0.5, 0.5]];
    let step = libm::ldexp(1.0, -9);
    let cases = vec![
        case(
            "usual",
            "turned any way, of length 1 as far as short numbers have it",
            &turns(&mut draw, 6, 1.0),
            &moves(&mut draw, 6, 4.0),
        ),
        case("half_turns", "no turn, and half a turn about each axis", &axes, &moves(&mut draw, 4, 4.0)),
        case(
            "third_turns",
            "axes exchanged in a ring: quaternions of length exactly 1",
            &thirds,
            &moves(&mut draw, 3, 4.0),
        ),
        case(
            "small_turns",
            "nearly none: what is off the diagonal is small",
            &[[1.0, step, 0.0, -step], [1.0, 0.0, 2.0 * step, step]],
            &moves(&mut draw, 2, 4.0),
        ),
        case("at_the_origin", "cameras that only turn", &turns(&mut draw, 3, 1.0), &[[0.0; 3]; 3]),
        case(
            "long_quaternions",
            "four times and a quarter as long",
            &[turns(&mut draw, 2, 4.0), turns(&mut draw, 2, 0.25)].concat(),
            &moves(&mut draw, 4, 2.0),
        ),
        case(
            "CG9_far_away",
            "cameras thousands away",
            &turns(&mut draw, 3, 1.0),
            &moves(&mut draw, 3, 4096.0),
        ),
    ];
    in_full(cases, "usual")
}
