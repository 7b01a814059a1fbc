//! The contraction of Gaussians, wrong on purpose. Without a mistake every function equals the oracle.
//!
//! Means alone are contracted by the row of points, which has the mistakes of that.

use super::arrays::{gaussians, named, vjp};
use super::backward::bend;
use super::{Gaussian, backward, between, beyond, jacobian, product, scale, transposed};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::contraction::mistakes::{by_length_of_all, length_of_all};
use crate::contraction::{backward::contract as point_vjp, contract, length};
use crate::convention::{ContractionNorm, ContractionRange, Conventions};

/// Mistakes of contracted Gaussians.
pub(crate) const CONTRACT_GAUSSIANS: &[Mistake] = &[
    Mistake::new(
        "covariance_kept",
        "the mean contracted, Sigma left as it is",
        "what is far is blurred to nothing: its Gaussians are wider than all of the contracted space",
        "J Sigma J^T",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "one_side_alone",
        "J Sigma",
        "variances shrink by half as many powers of the distance, and aren't symmetric",
        "J Sigma J^T: one product from each side",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "jacobian_for_covariance",
        "J itself for J Sigma J^T where |x| > 1",
        "what is far is as wide as its contraction says, whatever it was",
        "J Sigma J^T",
        "a port of mip-NeRF 360 and three copies of it",
        4,
    ),
    Mistake::new(
        "jacobian_everywhere",
        "J itself for J Sigma J^T",
        "Gaussians are as wide as their contraction says, whatever they were",
        "J Sigma J^T",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "product_by_element",
        "J * Sigma * J, entry by entry",
        "Gaussians turn away from their rays",
        "products of matrices",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "diagonal_kept",
        "the diagonal of J Sigma J^T alone",
        "Gaussians off the axes are round where they should be slanted",
        "all nine entries",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "covariance_contracted_as_points",
        "the rows of Sigma contracted as points, and no J",
        "what is far is blurred to nothing",
        "J Sigma J^T",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "squared_jacobian",
        "J J^T, without Sigma",
        "Gaussians are as wide as their contraction says, whatever they were",
        "J Sigma J^T",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "far_jacobian_everywhere",
        "the far piece's Jacobian inside, too",
        "near the middle of the scene, where nothing moves, everything is blurred",
        "the identity where |x| <= 1",
        "never; ports of mip-NeRF 360 have code of the far piece alone, which they ask of a background alone",
        0,
    ),
    Mistake::new(
        "shrunk_as_a_ball",
        "((2 - 1/r) / r)^2 Sigma: |x| isn't differentiated",
        "what is far is too long along its ray, by r and more",
        "1 / r^2 along the ray",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "jacobian_at_contracted_point",
        "J at f(mean): the mean overwritten before it is used again",
        "what is far is blurred as if it lay at 2",
        "J at the mean that was given",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "jacobian_of_another_norm",
        "points contracted in one norm, J of the other",
        "Gaussians point along the axes in place of their rays, or the other way around",
        "one norm for both",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "branch_by_another_norm",
        "J chosen by |x| >= 1 in another norm than its own",
        "between ball and cube covariances belong to the other piece",
        "one norm for both",
        "nerfstudio's SceneContraction, which tests the length whatever its order (and asks for order=None of Gaussians)",
        1,
    ),
    Mistake::new(
        "batch_axis_last",
        "the Jacobians of N means as an array (3, 3, N), read as (N, 3, 3)",
        "each Gaussian is bent by entries of the others' Jacobians; a single one is right",
        "move the axis, don't reshape: movedim(-1, 0)",
        "a port of mip-NeRF 360: torch.diagonal(jacobian(f, means), dim1=0, dim2=2), which puts the batch last, then reshape",
        1,
    ),
    Mistake::new(
        "covariance_taken_for_points",
        "J f(Sigma) J^T: the matrix' rows contracted as points",
        "wide Gaussians are too narrow; others are right",
        "J Sigma J^T",
        "a draft of mip-NeRF 360 for street scenes",
        1,
    ),
    Mistake::new(
        "diagonal_contracted",
        "J diag(Sigma) J^T, as mip-NeRF has diagonals at hand",
        "Gaussians off the axes are round where they should be slanted",
        "the full covariance: t_variance d d^T + r_variance (I - d d^T / |d|^2)",
        "what multinerf's track_linearize refuses by its shape",
        0,
    ),
    Mistake::new(
        "covariance_not_a_number_at_origin",
        "both pieces differentiated, one selected: 0 times the slope of 1/|x| at 0",
        "a Gaussian at the origin makes the picture NaN",
        "clamp |x| from below, inside of the selection (multinerf)",
        "automatic Jacobians of torch.where without such a clamp",
        0,
    ),
    Mistake::new(
        "norm_of_all_means",
        "one norm for the means of the whole batch: without its axis",
        "where a Gaussian comes to lie depends on the others in the batch",
        "the norm along the last axis",
        "a port of mip-NeRF 360 to PyTorch: torch.norm(x)",
        1,
    ),
    Mistake::new(
        "jacobian_detached",
        "J taken for a constant: the gradient of the mean without f's second derivative",
        "poses and sample distances aren't told that what moves away gets narrower",
        "J depends on the mean",
        "Jacobians made under no_grad",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "one_factor_differentiated",
        "G J Sigma^T for the gradient of J: one of the two J's",
        "half of what the covariance tells the mean",
        "G J Sigma^T + G^T J Sigma",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_of_covariance_kept",
        "G for J^T G J",
        "distant Gaussians are pulled by r^4 and more",
        "J^T G J",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// The norm that is taken for this one.
fn other(norm: ContractionNorm) -> ContractionNorm {
    if norm == ContractionNorm::L2 { ContractionNorm::Linf } else { ContractionNorm::L2 }
}

/// The Jacobian of the far piece, whatever the length.
fn far(x: [f64; 3], norm: ContractionNorm, range: ContractionRange) -> [[f64; 3]; 3] {
    beyond(x, length(x, norm), norm).map(|row| row.map(|slope| scale(range) * slope))
}

/// A contracted mean with mistakes in it; `of_all` is the length of all means together.
fn wrong_mean(
    x: [f64; 3],
    of_all: f64,
    range: ContractionRange,
    c: &Conventions,
    wrong: &[&str],
) -> [f64; 3] {
    if !wrong.contains(&"norm_of_all_means") {
        return contract(x, c.contraction_norm, range);
    }
    let folded = by_length_of_all(x, of_all);
    let middle = contract([0.0; 3], c.contraction_norm, range);
    [0, 1, 2].map(|a| middle[a] + scale(range) * folded[a])
}

/// The Jacobian with mistakes in it.
fn wrong_jacobian(x: [f64; 3], of_all: f64, c: &Conventions, wrong: &[&str]) -> [[f64; 3]; 3] {
    let has = |name: &str| wrong.contains(&name);
    let (norm, range) = (c.contraction_norm, c.contraction_range);
    let right = |x| jacobian(x, norm, range);
    let inside = right([0.0; 3]);
    let r = length(x, norm);
    match () {
        () if has("far_jacobian_everywhere") => far(x, norm, range),
        () if has("shrunk_as_a_ball") && r > 1.0 => {
            inside.map(|row| row.map(|slope| slope * (2.0 - 1.0 / r) / r))
        }
        () if has("jacobian_at_contracted_point") => {
            right(wrong_mean(x, of_all, ContractionRange::Two, c, wrong))
        }
        () if has("jacobian_of_another_norm") => jacobian(x, other(norm), range),
        () if has("branch_by_another_norm") => {
            if length(x, other(norm)) < 1.0 {
                inside
            } else {
                far(x, norm, range)
            }
        }
        () if has("covariance_not_a_number_at_origin") && r == 0.0 => [[f64::NAN; 3]; 3],
        () => right(x),
    }
}

/// The Jacobians of all means with mistakes in them.
fn wrong_jacobians(all: &[Gaussian], of_all: f64, c: &Conventions, wrong: &[&str]) -> Vec<[[f64; 3]; 3]> {
    let each: Vec<_> = all.iter().map(|x| wrong_jacobian(x.mean, of_all, c, wrong)).collect();
    if !wrong.contains(&"batch_axis_last") {
        return each;
    }
    let n = each.len();
    // Number `at` of the array that has the batch last.
    let number = |at: usize| each[at % n][at / n / 3][at / n % 3];
    (0..n).map(|m| [0, 1, 2].map(|i| [0, 1, 2].map(|k| number(9 * m + 3 * i + k)))).collect()
}

/// A matrix, entry by entry.
fn by_entry(entry: impl Fn(usize, usize) -> f64) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|k| entry(i, k)))
}

/// A contracted covariance with mistakes in it, given the Jacobian.
fn wrong_covariance(x: &Gaussian, j: [[f64; 3]; 3], c: &Conventions, wrong: &[&str]) -> [[f64; 3]; 3] {
    let has = |name: &str| wrong.contains(&name);
    let (norm, range) = (c.contraction_norm, c.contraction_range);
    let mut sigma = x.covariance;
    if has("covariance_taken_for_points") && length(x.mean, norm) > 1.0 {
        sigma = sigma.map(|row| contract(row, norm, ContractionRange::Two));
    }
    if has("diagonal_contracted") {
        sigma = by_entry(|i, k| if i == k { sigma[i][i] } else { 0.0 });
    }
    match () {
        () if has("covariance_kept") => x.covariance,
        () if has("one_side_alone") => product(j, sigma),
        () if has("jacobian_everywhere") => j,
        () if has("jacobian_for_covariance") && length(x.mean, norm) > 1.0 => j,
        () if has("jacobian_for_covariance") => x.covariance,
        () if has("product_by_element") => by_entry(|i, k| j[i][k] * sigma[i][k] * j[i][k]),
        () if has("diagonal_kept") => {
            let whole = between(j, sigma);
            by_entry(|i, k| if i == k { whole[i][i] } else { 0.0 })
        }
        () if has("covariance_contracted_as_points") => sigma.map(|row| contract(row, norm, range)),
        () if has("squared_jacobian") => product(j, transposed(j)),
        () => between(j, sigma),
    }
}

/// Contracted Gaussians.
pub(crate) fn contract_gaussians(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let all = gaussians(a, "means", "covariances");
    let of_all = length_of_all(&all.iter().flat_map(|x| x.mean).collect::<Vec<_>>(), c.contraction_norm);
    let each = all.iter().zip(wrong_jacobians(&all, of_all, c, wrong));
    let one = |(x, j): (&Gaussian, _)| Gaussian {
        mean: wrong_mean(x.mean, of_all, c.contraction_range, c, wrong),
        covariance: wrong_covariance(x, j, c, wrong),
    };
    let out: Vec<Gaussian> = each.map(one).collect();
    named(&out, "contracted_means", "contracted_covariances")
}

/// The gradient with a mistake in it.
fn wrong_gradient(x: &Gaussian, g: &Gaussian, c: &Conventions, wrong: &[&str]) -> Gaussian {
    let (norm, range) = (c.contraction_norm, c.contraction_range);
    let right = backward::contract_gaussian(x, g, norm, range);
    let by_point = point_vjp(x.mean, g.mean, norm, range);
    match wrong.first() {
        Some(&"jacobian_detached") => Gaussian { mean: by_point, ..right },
        Some(&"one_factor_differentiated") => {
            let j = jacobian(x.mean, norm, range);
            let once = product(product(g.covariance, j), transposed(x.covariance));
            let by_slope = bend(x.mean, once.map(|row| row.map(|g| scale(range) * g)), norm);
            Gaussian { mean: [0, 1, 2].map(|a| by_point[a] + by_slope[a]), ..right }
        }
        Some(&"gradient_of_covariance_kept") => Gaussian { covariance: g.covariance, ..right },
        _ => right,
    }
}

/// Their gradient.
pub(crate) fn contract_gaussians_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, |x, g| wrong_gradient(x, g, c, wrong))
}
