//! A quaternion's matrix with one sign wrong, as poses and splats have it alike.

use crate::contract::component::Mistake;

/// 2 (x y + w z) where 2 (x y - w z) belongs, or the reverse: the entry of its mirror image.
const fn one(name: &'static str, what: &'static str, to_fix: &'static str, sources: u32) -> Mistake {
    let (effect, seen) =
        ("not a rotation: what it turns is sheared", "a transcription of the matrix by hand");
    Mistake::new(
        name,
        what,
        effect,
        to_fix,
        if sources == 0 { "never; cheap to keep" } else { seen },
        sources,
    )
}

/// One for each entry off the diagonal.
pub(crate) const SIGNS: [Mistake; 6] = [
    one("sign_of_w_z_above", "2 (x y + w z) in R_xy, as in R_yx", "2 (x y - w z) in R_xy", 1),
    one("sign_of_w_y_above", "2 (x z - w y) in R_xz, as in R_zx", "2 (x z + w y) in R_xz", 0),
    one("sign_of_w_x_above", "2 (y z + w x) in R_yz, as in R_zy", "2 (y z - w x) in R_yz", 0),
    one("sign_of_w_z_below", "2 (x y - w z) in R_yx, as in R_xy", "2 (x y + w z) in R_yx", 0),
    one("sign_of_w_y_below", "2 (x z + w y) in R_zx, as in R_xz", "2 (x z - w y) in R_zx", 0),
    one("sign_of_w_x_below", "2 (y z - w x) in R_zy, as in R_yz", "2 (y z + w x) in R_zy", 0),
];

/// The rows of a rotation with the wrong signs among `wrong`.
pub(crate) fn signed(rows: [[f64; 3]; 3], wrong: &[&str]) -> [[f64; 3]; 3] {
    let places = [[0, 1], [0, 2], [1, 2], [1, 0], [2, 0], [2, 1]];
    let mut out = rows;
    for (mistake, [i, j]) in SIGNS.iter().zip(places) {
        if wrong.contains(&mistake.name) {
            out[i][j] = rows[j][i];
        }
    }
    out
}
