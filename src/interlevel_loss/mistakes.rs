//! The interlevel loss, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{form, forward, vjp};
use super::{Form, Histogram, backward, interlevel as oracle, outer, overlaps, reduced};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;

const EPS_OF_ITS_OWN: Mistake = Mistake::new(
    "eps_of_its_own",
    "max(0, w - bound)^2 / (w + an eps that is written in)",
    "what faint weights miss counts more, or less",
    "the eps that is handed over",
    "losses of photographs in the wild: 1e-6",
    1,
)
.with("eps", 1e-6, [1e-12, 0.5]);

/// Mistakes of the interlevel loss.
pub(crate) const INTERLEVEL_LOSS: &[Mistake] = &[
    Mistake::new(
        "inner_for_outer",
        "the proposal's intervals that lie inside of the interval alone",
        "a bound from below: a proposal that is coarser than the field is pulled up for ever",
        "every interval that overlaps",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "share_for_bound",
        "the share of the proposal's weight that lies in the interval, its density being even",
        "a proposal that covers is pushed on, until it is the field itself",
        "all weight of every interval that overlaps",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "end_left_out",
        "without the interval of the proposal that the interval ends in: a search that is one off",
        "the proposal is pulled up behind every surface",
        "up to the first edge beyond the interval's end",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "both_signs",
        "(w - bound)^2 without max(0, .)",
        "a proposal is pushed down where it is a bound, and stops being one",
        "max(0, w - bound)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "division_forgotten",
        "max(0, w - bound)^2",
        "small weights aren't covered: the gradient vanishes with them",
        "divide by w + eps",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_by_the_bound",
        "max(0, w - bound)^2 / (bound + eps)",
        "an empty proposal explodes",
        "divide by w + eps",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "square_forgotten",
        "max(0, w - bound) / (w + eps)",
        "the same pull however little is missing: the proposal overshoots",
        "square what is missing",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "factor_two_missing",
        "the gradient -missing / (w + eps)",
        "the proposal follows half as fast",
        "times 2",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_negated",
        "the gradient of w - bound with respect to w",
        "the proposal runs away from the field",
        "the proposal's is the negative",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "first_alone",
        "the gradient to the first interval that overlaps alone",
        "one interval of the proposal grows, its neighbors don't",
        "to every interval that overlaps",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "shared_among_overlaps",
        "the gradient divided by the number of intervals that overlap",
        "fine proposals follow slowly",
        "each has all of it: their sum is the bound",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "both_exchanged",
        "the proposal's weights held against the bound of the field's",
        "the field is pulled to the proposal, which learns nothing",
        "w of the field, the bound of the proposal",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sizes_for_squares",
        "the mean of |w - bound|",
        "another loss: the proposal is pulled down as well",
        "max(0, w - bound)^2 / (w + eps)",
        "never; cheap to keep",
        0,
    ),
    EPS_OF_ITS_OWN,
    Mistake::new(
        "paired_by_number",
        "interval i of the proposal for those that overlap interval i: as many as both have",
        "histograms are compared whose intervals lie elsewhere",
        "the sum over all that overlap, which t says",
        "1 port for a studio's template: weights[..., :min]",
        1,
    ),
    Mistake::new(
        "bound_at_the_middle",
        "the one interval of the proposal that the middle of interval i lies in",
        "the bound is too small where intervals overlap several",
        "the sum over all that overlap",
        "never; cheap to keep",
        0,
    ),
];

/// The bound with what is wrong about it.
fn wrong_bound(fine: Histogram, i: usize, proposal: Histogram, form: Form, wrong: &[&str]) -> f64 {
    let ([t, s], has) = ([fine.t, proposal.t], |name: &str| wrong.contains(&name));
    let over = (0..proposal.weights.len()).filter(|&j| overlaps(t, i, s, j, form.edges));
    let sum = |j: &mut dyn Iterator<Item = usize>| j.map(|j| proposal.weights[j]).sum::<f64>();
    if has("paired_by_number") {
        return proposal.weights[i];
    }
    if has("bound_at_the_middle") {
        let middle = 0.5 * (t[i] + t[i + 1]);
        return sum(&mut over.filter(|&j| s[j] <= middle && middle < s[j + 1]));
    }
    if has("inner_for_outer") {
        return sum(&mut over.filter(|&j| t[i] <= s[j] && s[j + 1] <= t[i + 1]));
    }
    if has("end_left_out") {
        let last = over.clone().next_back();
        return sum(&mut over.filter(|j| Some(*j) != last));
    }
    if has("share_for_bound") {
        let share = |j: usize| {
            let inside = (t[i + 1].min(s[j + 1]) - t[i].max(s[j])).max(0.0);
            proposal.weights[j] * if s[j + 1] > s[j] { inside / (s[j + 1] - s[j]) } else { 1.0 }
        };
        return over.map(share).sum();
    }
    outer(t, i, proposal, form.edges)
}

/// The loss of one ray.
fn wrong_loss(fine: Histogram, proposal: Histogram, form: Form, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let (fine, proposal) = if has("both_exchanged") { (proposal, fine) } else { (fine, proposal) };
    let one = |(i, w): (usize, &f64)| {
        let bound = wrong_bound(fine, i, proposal, form, wrong);
        let missing = if has("both_signs") { w - bound } else { (w - bound).max(0.0) };
        let square = if has("square_forgotten") { missing } else { missing * missing };
        match () {
            () if has("sizes_for_squares") => (w - bound).abs(),
            () if missing == 0.0 => 0.0,
            () if has("division_forgotten") => square,
            () if has("divided_by_the_bound") => square / (bound + form.eps),
            () => square / (w + form.eps),
        }
    };
    let all = fine.weights.len();
    let count = if has("paired_by_number") { all.min(proposal.weights.len()) } else { all };
    reduced(fine.weights.iter().enumerate().take(count).map(one).sum(), count, form.reduction)
}

/// The loss.
pub(crate) fn interlevel(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    forward(a, |fine, proposal| match wrong {
        [] => oracle(fine, proposal, form(a, c)),
        _ => {
            let form = form(a, c);
            let eps = EPS_OF_ITS_OWN.among(wrong).unwrap_or(form.eps);
            wrong_loss(fine, proposal, Form { eps, ..form }, wrong)
        }
    })
}

/// The gradient to some of the intervals that overlap.
fn wrong_gradient(fine: Histogram, proposal: Histogram, form: Form, g: f64, wrong: &str) -> Vec<f64> {
    let mut gradient = vec![0.0; proposal.weights.len()];
    for (i, w) in fine.weights.iter().enumerate() {
        let over: Vec<usize> =
            (0..gradient.len()).filter(|&j| overlaps(fine.t, i, proposal.t, j, form.edges)).collect();
        let missing = (w - outer(fine.t, i, proposal, form.edges)).max(0.0);
        if missing > 0.0 {
            let share = reduced(-2.0 * g * missing / (w + form.eps), fine.weights.len(), form.reduction);
            let (to, share) = match wrong {
                "first_alone" => (&over[..over.len().min(1)], share),
                _ => (&over[..], share / over.len() as f64),
            };
            to.iter().for_each(|&j| gradient[j] += share);
        }
    }
    gradient
}

/// Its gradient.
pub(crate) fn interlevel_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, |fine, proposal, g| {
        let form = form(a, c);
        let times = |k: f64| backward::interlevel(fine, proposal, form, k * g);
        match wrong.first() {
            Some(&"factor_two_missing") => times(0.5),
            Some(&"gradient_negated") => times(-1.0),
            Some(name @ (&"first_alone" | &"shared_among_overlaps")) => {
                wrong_gradient(fine, proposal, form, g, name)
            }
            _ => times(1.0),
        }
    })
}
