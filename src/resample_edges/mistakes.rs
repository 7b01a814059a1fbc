//! New edges, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{Ray, form, forward, oracle, rays, sampled};
use super::between;
use crate::contract::arrays::{Arrays, row};
use crate::contract::component::Mistake;
use crate::convention::{Conventions, EdgesFrom, OldEdges};
use crate::importance_sampling::mistakes::{
    EMPTY_AT_FAR, EMPTY_AT_NEAR, INTERIOR_ALONE, NO_LEADING_ZERO, NOT_NORMALIZED, NOTHING_OVER_NOTHING,
    SEARCHED_FROM_THE_LEFT, sample,
};
use crate::importance_sampling::{bin_of, cdf, union};

/// Mistakes of new edges; the first ones are those of the samples.
pub(crate) const RESAMPLE_EDGES: &[Mistake] = &[
    SEARCHED_FROM_THE_LEFT,
    NO_LEADING_ZERO,
    INTERIOR_ALONE,
    NOT_NORMALIZED,
    NOTHING_OVER_NOTHING,
    EMPTY_AT_FAR,
    EMPTY_AT_NEAR,
    Mistake::new(
        "left_edge",
        "the chosen bin's edge, without a place inside it",
        "intervals without length where several samples share a bin",
        "interpolate between the two edges",
        "ports of sample_pdf",
        1,
    ),
    Mistake::new(
        "last_edge_lost",
        "the bin's upper edge is looked up among N edges: clamp(k + 1, max = N - 1)",
        "all samples of the last bin lie where it begins",
        "there are N + 1 edges: clamp(k + 1, max = N)",
        "where shape[-1] - 1 of the weights is taken for that of the edges; never seen",
        0,
    ),
    Mistake::new(
        "ends_not_clamped",
        "mirrored edges may lie outside of the histogram",
        "samples in front of near, with negative t where it is 0, and behind far",
        "max(e_0, .) and min(e_N, .)",
        "sample_intervals of multinerf and its ports, whose domain is all numbers unless it is given",
        0,
    ),
    Mistake::new(
        "ends_at_samples",
        "the outermost samples are the outermost edges",
        "the first and the last interval are half as long as their samples' parts: space in front and behind isn't rendered",
        "mirror the outermost midpoints at the outermost samples",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "ends_of_the_histogram",
        "the first and the last edge are those of the histogram",
        "long intervals in front of a surface and behind it, whose middle is nowhere near",
        "mirror the outermost midpoints at the outermost samples",
        "midpoints padded by near and far; never seen",
        0,
    ),
    Mistake::new(
        "mirrored_backwards",
        "the outermost samples mirrored at the outermost midpoints: the second sample, and the last but one",
        "edges that fall: negative lengths",
        "2 c_0 - t_1, not 2 t_1 - c_0",
        "never; cheap to keep",
        0,
    ),
    OWN_PADDING,
    Mistake::new(
        "clamp_exchanged",
        "min(e_0, 2 c_0 - t_1) and max(e_N, ...): the clamps are exchanged",
        "intervals reach to the histogram's ends, or beyond",
        "max in front, min behind",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mirrored_at_full_step",
        "2 c_0 - c_1 for 2 c_0 - t_1: a whole gap beyond the outermost samples",
        "the outermost intervals are too long by half a gap",
        "half a gap: the mirror of the first midpoint",
        "never; cheap to keep",
        0,
    ),
];

/// A padding of one's own.
const OWN_PADDING: Mistake = Mistake::new(
    "padding_of_its_own",
    "eps is added to every weight, where there is no padding",
    "bins without weight are sampled",
    "weights as they are, or the padding in the distribution's row",
    "sample_pdf's 1e-5, nerfstudio's 0.01: never seen in this row",
    0,
)
.with("eps", 1e-2, [1e-10, 1.0]);

/// The mistakes that importance sampling has too.
const OF_SAMPLES: usize = 8;

/// One ray's samples where bins' upper edges are looked up among N.
fn without_the_last_edge(ray: &Ray) -> Vec<f64> {
    let (f, n) = (cdf(&ray.weights, 0.0), ray.weights.len());
    let one = |&u: &f64| {
        let k = bin_of(&f, u);
        let (a, b) = (ray.edges[k], ray.edges[(k + 1).min(n - 1)]);
        a + (u - f[k]) / (f[k + 1] - f[k]) * (b - a)
    };
    ray.u.iter().map(one).collect()
}

/// The edges around samples.
fn around(ray: &Ray, c: &[f64], wrong: &[&str]) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let (ends, last) = ([ray.edges[0], ray.edges[ray.edges.len() - 1]], c.len() - 1);
    let free = [f64::NEG_INFINITY, f64::INFINITY];
    let mut t = between(c, if has("ends_not_clamped") { free } else { ends });
    let [front, behind] = match () {
        () if has("ends_at_samples") => [c[0], c[last]],
        () if has("ends_of_the_histogram") => ends,
        () if has("mirrored_backwards") => [c[1], c[last - 1]],
        () if has("clamp_exchanged") => {
            [(2.0 * c[0] - t[1]).min(ends[0]), (2.0 * c[last] - t[last]).max(ends[1])]
        }
        () if has("mirrored_at_full_step") => {
            [(2.0 * c[0] - c[1]).max(ends[0]), (2.0 * c[last] - c[last - 1]).min(ends[1])]
        }
        () => [t[0], t[last + 1]],
    };
    (t[0], t[last + 1]) = (front, behind);
    t
}

/// The edges of all rays.
pub(crate) fn resample_edges(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return forward(&rays(a).iter().map(|ray| oracle(ray, form(c))).collect::<Vec<_>>());
    }
    let of_samples: Vec<&str> =
        RESAMPLE_EDGES[..OF_SAMPLES].iter().map(|m| m.name).filter(|name| wrong.contains(name)).collect();
    let (b, d) = sampled(a, c);
    let mut b = b;
    if let Some(eps) = OWN_PADDING.among(wrong) {
        b.get_mut("weights").expect("an input").mapv_inplace(|w| w + eps);
    }
    let drawn = sample(&b, &d, &of_samples);
    let one = |(r, ray): (usize, Ray)| {
        let lost = wrong.contains(&"last_edge_lost");
        let samples = if lost { without_the_last_edge(&ray) } else { row(&drawn, "t", r) };
        let new = if c.edges_from == EdgesFrom::Samples { samples } else { around(&ray, &samples, wrong) };
        if c.old_edges == OldEdges::Kept { union(&ray.edges, &new) } else { new }
    };
    forward(&rays(a).into_iter().enumerate().map(one).collect::<Vec<_>>())
}
