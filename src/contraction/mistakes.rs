//! The contraction, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{forward, vjp};
use super::{backward, contract, length, scaled};
use crate::contract::arrays::{Arrays, values};
use crate::contract::component::Mistake;
use crate::convention::{ContractionNorm, ContractionRange, Conventions};

const EPS_IN_NORM: Mistake = Mistake::new(
    "eps_in_norm",
    "|x| + eps for |x|",
    "a jump at the surface: what is far lies a bit too near",
    "|x| as it is beyond 1, where it isn't 0",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-6, [1e-9, 1e-1]);

/// Mistakes of the contraction.
pub(crate) const CONTRACTION: &[Mistake] = &[
    Mistake::new(
        "not_divided_by_norm",
        "(2 - 1/|x|) x",
        "what is far isn't contracted but pushed out to twice its distance",
        "(2 - 1/|x|) x/|x|",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "contracted_inside_too",
        "(2 - 1/|x|) x/|x| for every x",
        "the middle of the scene is mirrored and thrown out of the ball; NaN at the origin",
        "x where |x| <= 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "pieces_exchanged",
        "x where |x| > 1, contracted inside",
        "what is far isn't contracted, what is near is mirrored",
        "the other branch",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "norm_of_all_points",
        "one norm for the whole batch: without its axis",
        "where a point comes to lie depends on the others in the batch; nearly all are contracted",
        "the norm along the last axis",
        "never in this row; as norm_of_all_rays of directions",
        0,
    ),
    Mistake::new(
        "norm_squared",
        "(2 - 1/|x|^2) x/|x|^2: the root is missing",
        "space is contracted toward the origin: what is far comes to lie in its middle",
        "the root of the sum of squares",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "coordinate_by_coordinate",
        "each coordinate contracted by its own size, as if along a line",
        "points beyond the corners of the cube are bent away from their rays",
        "one norm for all three",
        "never; cheap to keep",
        0,
    ),
    Mistake::new("branch_by_coordinate","each coordinate with |x_i| > 1 contracted, by the norm of all three","points beyond a face are bent away from their rays","one condition for all three, |x| > 1","never; cheap to keep",0),
    Mistake::new("branch_by_another_norm","|x| > 1 asked in another norm than the one that contracts","between ball and cube points jump","one norm for both","nerfstudio's SceneContraction, which tests the length whatever its order",1),
    Mistake::new("norms_mixed","(2 - 1/|x|) in one norm, x/|x| in the other","a jump at the surface, and points beyond 2","one norm for both","never; cheap to keep",0),
    Mistake::new("norm_along_points","the norm over the points, one for each coordinate","where a point comes to lie depends on the others in the batch","the norm along the last axis","never; cheap to keep",0),
    EPS_IN_NORM,
    Mistake::new(
        "ends_at_one",
        "(1 - 1/|x|) x/|x|",
        "everything beyond the surface lands inside of it, on top of what is near",
        "2 - 1/|x|",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "box_mapped_twice",
        "2 x - 1 of what lies in [-1, 1] already",
        "the scene is off its middle and twice as large: a part of what should stay is contracted",
        "2 x - 1 of what lies in [0, 1] alone",
        "a text-to-3D code's triplanes, where the box was mapped to [-1, 1] before a copied line that expects [0, 1]",
        1,
    ),
    Mistake::new(
        "half_of_the_range",
        "y/2 + 1/2: the scale of what lies in [-1, 1]",
        "what is far leaves [0, 1]: a grid clamps it to its edge, or wraps it around",
        "y/4 + 1/2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "not_a_number_at_origin",
        "both pieces, each times its mask: 0 times NaN at the origin",
        "a sample at the origin is NaN, and the picture with it",
        "select, don't multiply; and 1/|x| of what can't be 0",
        "a dynamic splatting code's voxel planes",
        1,
    ),
    Mistake::new(
        "gradient_not_a_number_at_origin",
        "both pieces differentiated, one selected: 0 times the slope of 1/|x| at 0",
        "a sample at the origin makes every parameter NaN",
        "clamp |x| from below, inside of the selection (multinerf)",
        "torch.where without such a clamp: nerfstudio and what copied it (eight read), where no sample ever lies at the origin exactly",
        8,
    )
    .of_gradient(),
    Mistake::new(
        "norm_held_constant",
        "the gradient (2 - 1/r) g / r: r isn't differentiated",
        "poses and deformations are pulled along the ray as if space weren't contracted along it",
        "and the slope of (2 - 1/r) / r, times g . x",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "diagonal_alone",
        "the diagonal of the Jacobian in place of all of it",
        "gradients off the axes turn toward them",
        "the coordinates depend on one another by way of |x|",
        "nerfacc's contract_to_unisphere with derivative=True, which calls the diagonal the derivative (in a dozen copies)",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "jacobian_dropped",
        "the gradient handed through, scaled alone",
        "what is far moves too fast: by r times and more",
        "times the Jacobian",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// The norm that is taken for this one.
fn other(norm: ContractionNorm) -> ContractionNorm {
    if norm == ContractionNorm::L2 { ContractionNorm::Linf } else { ContractionNorm::L2 }
}

/// (limit - 1/r) x/r.
fn beyond(x: [f64; 3], r: f64, limit: f64) -> [f64; 3] {
    x.map(|x| (limit - 1.0 / r) * (x / r))
}

/// A point by the length of all points together.
pub(crate) fn by_length_of_all(x: [f64; 3], of_all: f64) -> [f64; 3] {
    if of_all <= 1.0 { x } else { beyond(x, of_all, 2.0) }
}

/// The root of the sum of all squares, or the largest of all sizes.
pub(crate) fn length_of_all(all: &[f64], norm: ContractionNorm) -> f64 {
    match norm {
        ContractionNorm::L2 => all.iter().map(|x| x * x).sum::<f64>().sqrt(),
        _ => all.iter().fold(0.0, |size, x| size.max(x.abs())),
    }
}

/// The norm of each coordinate over the points.
fn lengths_along_points(a: &Arrays, norm: ContractionNorm) -> [f64; 3] {
    let all = values(a, "x");
    [0, 1, 2].map(|i| {
        let own = all.iter().skip(i).step_by(3);
        match norm {
            ContractionNorm::L2 => own.map(|x| x * x).sum::<f64>().sqrt(),
            _ => own.fold(0.0, |size: f64, x| size.max(x.abs())),
        }
    })
}

/// A point contracted into the ball or cube of radius 2, with a mistake in it; `None` without one of these.
fn folded(x: [f64; 3], of_all: f64, norm: ContractionNorm, wrong: &[&str]) -> Option<[f64; 3]> {
    let has = |name: &str| wrong.contains(&name);
    let right = |x: [f64; 3]| contract(x, norm, ContractionRange::Two);
    let r = length(x, norm);
    let inside = r <= 1.0;
    let eps = EPS_IN_NORM.among(wrong);
    Some(match () {
        () if has("not_divided_by_norm") => {
            if inside {
                x
            } else {
                x.map(|x| (2.0 - 1.0 / r) * x)
            }
        }
        () if has("contracted_inside_too") => {
            if inside {
                beyond(x, r, 2.0)
            } else {
                right(x)
            }
        }
        () if has("pieces_exchanged") => {
            if inside {
                beyond(x, r, 2.0)
            } else {
                x
            }
        }
        () if has("norm_of_all_points") => by_length_of_all(x, of_all),
        () if has("norm_squared") => {
            if inside {
                x
            } else {
                beyond(x, r * r, 2.0)
            }
        }
        () if has("branch_by_coordinate") => {
            x.map(|x| if x.abs() <= 1.0 { x } else { beyond([x; 3], r, 2.0)[0] })
        }
        () if has("branch_by_another_norm") => {
            if length(x, other(norm)) <= 1.0 {
                x
            } else {
                beyond(x, r, 2.0)
            }
        }
        () if has("norms_mixed") => {
            let direction = length(x, other(norm));
            if inside { x } else { x.map(|x| (2.0 - 1.0 / r) * (x / direction)) }
        }
        () if eps.is_some() && !inside => beyond(x, r + eps.expect("asked"), 2.0),
        () if has("coordinate_by_coordinate") => x.map(|x| right([x, 0.0, 0.0])[0]),
        () if has("ends_at_one") => {
            if inside {
                x
            } else {
                beyond(x, r, 1.0)
            }
        }
        () if has("box_mapped_twice") => right(x.map(|x| 2.0 * x - 1.0)),
        () if has("not_a_number_at_origin") && r == 0.0 => [f64::NAN; 3],
        () => return None,
    })
}

/// The contraction.
pub(crate) fn contraction(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (norm, range) = (c.contraction_norm, c.contraction_range);
    let of_all = length_of_all(&values(a, "x"), norm);
    let along = lengths_along_points(a, norm);
    forward(a, |x| {
        let y = if wrong.contains(&"norm_along_points") {
            Some([0, 1, 2].map(|i| if along[i] <= 1.0 { x[i] } else { beyond(x, along[i], 2.0)[i] }))
        } else {
            folded(x, of_all, norm, wrong)
        };
        if wrong.contains(&"half_of_the_range") {
            return y.unwrap_or_else(|| contract(x, norm, ContractionRange::Two)).map(|y| 0.5 * y + 0.5);
        }
        y.map_or_else(|| contract(x, norm, range), |y| scaled(y, range))
    })
}

/// Its gradient.
pub(crate) fn contraction_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (norm, range) = (c.contraction_norm, c.contraction_range);
    vjp(a, |x, g| {
        let right = |g| backward::contract(x, g, norm, range);
        let r = length(x, norm);
        match wrong.first() {
            Some(&"gradient_not_a_number_at_origin") if r == 0.0 => [f64::NAN; 3],
            Some(&"norm_held_constant") if r > 1.0 => {
                let inside = backward::contract([0.0; 3], g, norm, range);
                inside.map(|g| (2.0 - 1.0 / r) * g / r)
            }
            Some(&"diagonal_alone") => [0, 1, 2].map(|j| {
                let mut alone = [0.0; 3];
                alone[j] = g[j];
                right(alone)[j]
            }),
            Some(&"jacobian_dropped") => backward::contract([0.0; 3], g, norm, range),
            _ => right(g),
        }
    })
}
