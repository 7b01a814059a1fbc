//! A proposal's distribution, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{Ray, forward, oracle, rays};
use super::counted;
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::{AnnealPadding, Conventions};
use crate::importance_sampling::mistakes::NOTHING_OVER_NOTHING;
use crate::math::{exp, pow};

const OWN_PADDING: Mistake = Mistake::new(
    "padding_of_its_own",
    "anneal log(w + padding + eps): a padding of one's own beside the one that is handed over",
    "bins without weight are sampled more often than they should be",
    "the padding that is handed over",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-3, [1e-10, 1.0]);

/// Mistakes of a proposal's distribution.
pub(crate) const PROPOSAL_PDF: &[Mistake] = &[
    Mistake::new(
        "anneal_forgotten",
        "the exponent 1 all along",
        "the first proposals, which know nothing, draw all samples to where they happen to be high",
        "raise the weights to the power of anneal",
        "2 ports of multinerf",
        2,
    ),
    Mistake::new(
        "anneal_inverted",
        "weights to the power of 1 / anneal",
        "the first proposals are sharpened where they should be flattened",
        "to the power of anneal, which is below 1",
        "temperatures, by which logits are divided; never seen here",
        0,
    ),
    Mistake::new(
        "times_anneal",
        "anneal (w + padding), a factor for a power",
        "no annealing: a factor is lost in the division",
        "raise the weights to the power of anneal",
        "anneal log(w), without the exponential; never seen",
        0,
    ),
    Mistake::new(
        "softmax_of_weights",
        "a softmax of anneal w, without the logarithm",
        "nearly even: weights are below 1, and e^w with them between 1 and e",
        "a softmax of anneal log(w + padding)",
        "weights where stepfun.sample of multinerf takes logits; never seen",
        0,
    ),
    Mistake::new(
        "padding_unused",
        "nothing is added",
        "bins without weight are never looked at again",
        "add the padding to every bin",
        "ports of multinerf, whose resample_padding is 0 unless it is set; never seen",
        0,
    ),
    Mistake::new(
        "padding_shared",
        "each bin gets padding / N",
        "the more bins, the fewer samples in empty ones",
        "add all of the padding to each of them",
        "beside it in nerfstudio's PDFSampler, where a floor is shared; never seen",
        0,
    ),
    Mistake::new(
        "padding_of_the_share",
        "the padding is added to the shares, after the division",
        "they add up to more than 1: the last samples fall on the last edge",
        "add it before the division",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sum_not_divided",
        "powers that aren't divided by their sum",
        "where they add up to less than 1 the rest of the samples falls on the last edge",
        "divide by the sum",
        "ports of sample_pdf",
        1,
    ),
    Mistake::new(
        "divided_before_the_power",
        "(w / sum w)^anneal, and not divided again",
        "the powers of shares add up to more than 1: samples crowd in front",
        "divide after the power",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sum_of_all_rays",
        "divided by the sum over the batch",
        "rays get the share of the batch that they happen to have",
        "a sum for each ray",
        "sums without their axis; never seen here",
        0,
    ),
    Mistake::new(
        "width_over",
        "weights over the widths of their bins",
        "narrow bins are sampled too often, and their pieces yet more",
        "a weight is a bin's whole share already",
        "between multinerf's weight_to_pdf, whose densities are dilated, and its way back; never seen",
        0,
    ),
    Mistake::new(
        "width_times",
        "weights times the widths of their bins",
        "wide bins are sampled too often",
        "a weight is a bin's whole share already",
        "the same; never seen",
        0,
    ),
    OWN_PADDING,
    NOTHING_OVER_NOTHING,
    Mistake::new(
        "logarithm_of_nothing",
        "a softmax of anneal log w, where no bin weighs, or anneal is 0 and a bin doesn't weigh: 0 times minus infinity",
        "not a number on rays through empty space, and from there in all parameters",
        "a padding inside of the logarithm, or even shares where the sum is 0",
        "9 public implementations: multinerf, whose padding isn't 0 where it is used, and ports",
        9,
    ),
    Mistake::new(
        "share_raised",
        "((w + padding) / sum)^anneal, and not divided again",
        "the powers of shares add up to more than 1: samples crowd in front",
        "divide after the power",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mixed_with_even",
        "(1 - anneal) + anneal (w + padding): a mean of even and not",
        "weights, which are far below 1, come through in the very end alone",
        "raise the weights to the power of anneal",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "anneal_from_one",
        "weights to the power of 1 - anneal",
        "sharp in the beginning, even in the end",
        "to the power of anneal",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_by_the_largest",
        "divided by the largest power",
        "they add up to more than 1: the last samples fall on the last edge",
        "divide by the sum",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "density_for_share",
        "shares are divided by their bins' widths",
        "narrow bins get too many samples, and shares don't add up to 1",
        "shares, of which widths are no part",
        "never; cheap to keep",
        0,
    ),
];

/// The powers of one ray, before they are divided.
fn powers(ray: &Ray, wrong: &[&str]) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let n = ray.weights.len() as f64;
    let padding = match () {
        () if has("padding_unused") || has("padding_of_the_share") => 0.0,
        () if has("padding_shared") => ray.padding / n,
        () => ray.padding + OWN_PADDING.among(wrong).unwrap_or(0.0),
    };
    let risen = |x: f64| match () {
        () if has("anneal_forgotten") => x,
        () if has("times_anneal") => ray.anneal * x,
        () if has("mixed_with_even") => 1.0 - ray.anneal + ray.anneal * x,
        () if has("anneal_from_one") => pow(x, 1.0 - ray.anneal),
        () if has("anneal_inverted") && ray.anneal > 0.0 => pow(x, 1.0 / ray.anneal),
        () if has("softmax_of_weights") => exp(ray.anneal * x),
        () => pow(x, ray.anneal),
    };
    let whole: f64 = if has("divided_before_the_power") { ray.weights.iter().sum() } else { 1.0 };
    let whole = if whole > 0.0 { whole } else { 1.0 };
    // What is raised is the share of all bins, those without a width too.
    let share = if has("share_raised") { ray.weights.iter().map(|w| w + padding).sum() } else { 1.0 };
    let share: f64 = if share > 0.0 { share } else { 1.0 };
    let one = |(i, w): (usize, &f64)| {
        let width = ray.edges[i + 1] - ray.edges[i];
        let w = match () {
            () if has("width_over") && width > 0.0 => w / width,
            () if has("width_times") => w * width,
            () => w / whole,
        };
        if ray.form.padding == AnnealPadding::Before {
            risen((w + padding) / share)
        } else {
            risen(w) + padding
        }
    };
    let counts = counted(&ray.edges, ray.form.flat);
    ray.weights.iter().enumerate().map(|pair| if counts[pair.0] { one(pair) } else { 0.0 }).collect()
}

/// One ray's shares, of powers that add up to `total`, or over the whole batch to it.
fn shares(ray: &Ray, powers: &[f64], total: f64, wrong: &[&str]) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let counts = counted(&ray.edges, ray.form.flat);
    let bins = counts.iter().filter(|&&counts| counts).count() as f64;
    let missing = (ray.form.floor.value() - total).max(0.0);
    let undivided = has("sum_not_divided") || has("divided_before_the_power") || has("share_raised");
    let faint = |w: &f64| w + ray.padding == 0.0;
    let unlogged = ray.weights.iter().all(faint) || ray.anneal == 0.0 && ray.weights.iter().any(faint);
    let one = |(power, &counts): (&f64, &bool)| {
        let even = if counts { 1.0 / bins } else { 0.0 };
        let share = match () {
            () if undivided => *power,
            () if has("nothing_over_nothing") && total == 0.0 => f64::NAN,
            () if has("logarithm_of_nothing") && unlogged => f64::NAN,
            () if total > 0.0 => (power + missing * even) / (total + missing),
            () => even,
        };
        if has("padding_of_the_share") && counts { share + ray.padding } else { share }
    };
    let shares = powers.iter().zip(&counts).map(one);
    let widths = ray.edges.windows(2).map(|e| e[1] - e[0]);
    let over = |(share, width): (f64, f64)| if width > 0.0 { share / width } else { share };
    if has("density_for_share") { shares.zip(widths).map(over).collect() } else { shares.collect() }
}

/// The shares of all rays.
pub(crate) fn proposal_pdf(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let rays = rays(a, c);
    if wrong.is_empty() {
        return forward(&rays.iter().map(oracle).collect::<Vec<_>>());
    }
    let powers: Vec<Vec<f64>> = rays.iter().map(|ray| powers(ray, wrong)).collect();
    let batch: f64 = powers.iter().flatten().sum();
    let one = |(ray, powers): (&Ray, &Vec<f64>)| {
        let total = match () {
            () if wrong.contains(&"sum_of_all_rays") => batch,
            () if wrong.contains(&"divided_by_the_largest") => powers.iter().copied().fold(0.0, f64::max),
            () => powers.iter().sum(),
        };
        shares(ray, powers, total, wrong)
    };
    forward(&rays.iter().zip(&powers).map(one).collect::<Vec<_>>())
}
