//! Cases of poses: turned any way, by half and third turns, not at all; cameras far away.
//!
//! Quaternions have length 1 as far as a type holds them: codes that normalize them, that take them for unit and that invert the matrix
//! then mean the same pose.

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, signed};

/// A case from its quaternions and translations.
fn case(id: &str, comment: &'static str, q: &[[f64; 4]], t: &[[f64; 3]]) -> Case {
    let inputs = vec![("q", array(&[q.len(), 4], q.concat())), ("t", array(&[t.len(), 3], t.concat()))];
    Case::new(id, comment, inputs)
}

/// `n` translations up to `size`.
fn moves(draw: &mut Draw, n: usize, size: f64) -> Vec<[f64; 3]> {
    (0..n).map(|_| [0; 3].map(|_| draw.between(-size, size))).collect()
}

/// Pictures turned any way, in numbers that use every bit of a type.
fn any_way(dtype: Dtype, comment: &'static str) -> Case {
    let id = format!("usual_{dtype}");
    let mut draw = Draw::new(&id, 0);
    let mut number = || 2.0 * draw.unit() - 1.0;
    let (mut turns, mut moves) = (vec![], vec![]);
    for _ in 0..6 {
        let q = [0; 4].map(|_| number());
        let size = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
        turns.push(q.map(|x| dtype.round(x / size)));
        moves.push([0; 3].map(|_| dtype.round(4.0 * number())));
    }
    Case { full: Some(dtype), ..case(&id, comment, &turns, &moves) }
}

/// Pictures of a structure from motion.
pub(crate) fn pose_from_colmap() -> Vec<Case> {
    let mut draw = Draw::new("pose_from_colmap", 0);
    let axes = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let thirds =
        [[0.5, 0.5, 0.5, 0.5], [0.5, -0.5, 0.5, -0.5], [-0.5, 0.5, 0.5, 0.5], [0.5, 0.5, -0.5, -0.5]];
    vec![
        any_way(Dtype::F64, "turned any way, numbers that use every bit of f64"),
        any_way(Dtype::F32, "turned any way, numbers that use every bit of f32"),
        case("half_turns", "no turn, and half a turn about each axis", &axes, &moves(&mut draw, 4, 4.0)),
        case("third_turns", "axes exchanged in a ring", &thirds, &moves(&mut draw, 4, 4.0)),
        case("at_the_origin", "cameras that only turn", &thirds[..3], &[[0.0; 3]; 3]),
        case("CG9_far_away", "cameras thousands away", &thirds[1..], &moves(&mut draw, 3, 4096.0)),
    ]
}

/// More pictures than 16 bits count. A word makes no quaternion of length 1: seven of them take turns.
pub(crate) fn large() -> Vec<Large> {
    const TURNS: Recipe = Recipe::Cycle(&constants([
        0.5, 0.5, 0.5, 0.5, 1.0, 0.0, 0.0, 0.0, 0.5, -0.5, 0.5, -0.5, 0.0, 0.0, 1.0, 0.0, -0.5, 0.5, 0.5,
        0.5, 0.0, -1.0, 0.0, 0.0, 0.5, 0.5, -0.5, -0.5,
    ]));
    let n = 70_001;
    let large = Large::new("poses_70001", "70,001 poses", n, 1024).with("q", &[n, 4], TURNS);
    vec![large.with("t", &[n, 3], signed(-2, 4))]
}
