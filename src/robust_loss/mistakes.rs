//! Robust losses, wrong on purpose. Without a mistake every function equals the oracle.

pub(crate) mod charbonnier_laws;
mod differences;
pub(crate) mod huber_laws;

use super::arrays::{forward, pair, vjp};
use super::{backward, charbonnier as charbonnier_oracle, huber as huber_oracle, reduced, smooth};
use crate::contract::arrays::{Arrays, input, number};
use crate::contract::component::Mistake;
use crate::convention::{CharbonnierEps, Conventions, HuberSlope};
use crate::loss::mistakes::{PREDICTION_CLIPPED, compared};
use crate::math::pow;

const OVER_RAYS: Mistake = Mistake::new(
    "mean_over_rays",
    "the sum over channels is divided by the number of rays",
    "a loss three times too large",
    "divide by all entries, channels too",
    "never; cheap to keep",
    0,
);

/// Mistakes of Huber's loss.
pub(crate) const HUBER: &[Mistake] = &[
    OVER_RAYS,
    PREDICTION_CLIPPED,
    Mistake::new(
        "half_forgotten",
        "d^2 inside, for half of it",
        "a step at delta: entries there are pushed to the outside",
        "d^2 / 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "offset_forgotten",
        "delta |d| beyond, without - delta^2 / 2",
        "a step at delta: entries there are pulled inside",
        "delta (|d| - delta / 2)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "slope_one_beyond",
        "|d| - delta / 2 beyond, d^2 / 2 inside: the pieces of two losses",
        "a step at delta, and a kink",
        "both pieces of Huber's, or both of smooth L1: d^2 / (2 delta), |d| - delta / 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sign_kept",
        "d for |d| in the comparison: d <= delta",
        "large negative errors count as squares: outliers rule after all",
        "|d| <= delta",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "square_compared",
        "d^2 <= delta in the place of |d| <= delta",
        "squares up to sqrt(delta), and a step there",
        "compare |d|",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "slope_not_limited",
        "the gradient d everywhere",
        "outliers pull as in the squared loss",
        "limit d to [-delta, delta]",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "sign_forgotten",
        "the gradient delta beyond, whatever the sign of d",
        "dark outliers are made darker",
        "delta sign(d)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "no_slope_beyond",
        "the gradient 0 beyond delta, as that of a limited number is",
        "entries that are far off stay there",
        "delta sign(d)",
        "losses written with clamp and differentiated",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "pieces_exchanged",
        "the straight piece inside, the square beyond",
        "outliers rule, and small errors never vanish",
        "squares inside",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "smooth_for_pieces",
        "delta^2 (sqrt(1 + (d / delta)^2) - 1): the pseudo-Huber loss",
        "another loss: too small about delta by up to a sixth",
        "squares inside, straight beyond",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "smaller_piece",
        "min(d^2 / 2, delta |d|)",
        "squares up to 2 delta, and a kink there",
        "delta (|d| - delta / 2) beyond delta",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "of_the_mean",
        "the loss of the mean |d|",
        "outliers rule: it is the mean that is compared",
        "the loss of each, then the mean",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "large_negative_ones_dropped",
        "beyond delta d > delta is asked, not |d| > delta: 0 for large negative differences",
        "predictions that are far too small are never corrected",
        "|d| > delta",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "beyond_as_of_one",
        "|d| - 1/2 beyond delta, as where delta is 1",
        "a jump at delta, and outliers weigh too much or too little",
        "delta (|d| - delta / 2)",
        "1 public implementation",
        1,
    ),
];

const OWN_EPS: Mistake = Mistake::new(
    "eps_of_its_own",
    "sqrt(d^2 + eps^2) with an eps of one's own",
    "figures that can't be compared where errors are small",
    "the eps that is handed over",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-3, [1e-10, 1.0]);
const OWN_POWER: Mistake = Mistake::new(
    "another_power",
    "(d^2 + eps^2)^k with k other than 1/2",
    "outliers weigh less, or more: another loss",
    "the root",
    "0.45, of optical flow's generalized Charbonnier loss; never seen here",
    0,
)
.with("k", 0.45, [0.1, 2.0]);

/// Mistakes of Charbonnier's loss.
pub(crate) const CHARBONNIER: &[Mistake] = &[
    OVER_RAYS,
    PREDICTION_CLIPPED,
    Mistake::new(
        "root_of_mean",
        "sqrt(mean(d^2) + eps^2)",
        "outliers rule as in the squared loss; gradients don't shrink as it is fitted",
        "the root of each entry, then the mean",
        "NeRF-Factory's mip-NeRF 360",
        1,
    ),
    Mistake::new(
        "eps_outside",
        "sqrt(d^2) + eps",
        "the kink of |d| is back: its gradient is NaN at d = 0",
        "eps^2 under the root",
        "never; cheap to keep",
        0,
    ),
    Mistake::new("root_forgotten", "d^2 + eps^2", "the squared loss", "the root", "never; cheap to keep", 0),
    Mistake::new(
        "square_forgotten",
        "sqrt(|d| + eps^2)",
        "small errors weigh more than large ones",
        "d^2 under the root",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "eps_forgotten",
        "the gradient sign(d), as of |d|",
        "no rest where the error is below eps",
        "d / sqrt(d^2 + eps^2)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "slope_halved",
        "d / (2 sqrt(d^2 + eps^2)): the root's 1/2 without the square's 2",
        "steps half as long",
        "the chain rule's 2 d",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "not_a_number_at_zero",
        "the gradient of sqrt(d^2) at d = 0: 0 / 0",
        "the first exact entry ends the training",
        "eps^2 under the root",
        "losses written as a norm and differentiated",
        0,
    )
    .of_gradient(),
    OWN_EPS,
    OWN_POWER,
    Mistake::new(
        "least_subtracted",
        "sqrt(d^2 + eps^2) - eps",
        "figures that are smaller by eps; the gradient is right",
        "the root as it is",
        "Barron's general loss, which is 0 at 0; never seen here",
        0,
    ),
    Mistake::new(
        "root_over_channels",
        "sqrt(sum over colors of d^2 + eps^2): the length of a color's error",
        "a color's channels share one root: another loss",
        "the root of each entry",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "in_units_of_eps",
        "sqrt(1 + (d / eps)^2)",
        "a loss 1 / eps times too large",
        "sqrt(d^2 + eps^2)",
        "never; cheap to keep",
        0,
    ),
];

/// One entry of Huber's loss, not yet divided by delta.
fn wrong_piece(d: f64, delta: f64, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let inside = match () {
        () if has("sign_kept") => d <= delta,
        () if has("square_compared") => d * d <= delta,
        () => d.abs() <= delta,
    };
    let inside = inside != has("pieces_exchanged");
    match () {
        () if has("large_negative_ones_dropped") && d < -delta => 0.0,
        () if has("beyond_as_of_one") && !inside => d.abs() - 0.5,
        () if has("smooth_for_pieces") => delta * delta * ((1.0 + (d / delta) * (d / delta)).sqrt() - 1.0),
        () if has("smaller_piece") => (0.5 * d * d).min(delta * d.abs()),
        () if inside => d * d * if has("half_forgotten") { 1.0 } else { 0.5 },
        () if has("offset_forgotten") => delta * d.abs(),
        () if has("slope_one_beyond") => d.abs() - 0.5 * delta,
        () => delta * (d.abs() - 0.5 * delta),
    }
}

/// Huber's loss.
pub(crate) fn huber(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    over_rays(a, wrong, of_huber(&compared(a, wrong), c, wrong))
}

/// A loss, or as many times that as there are channels.
fn over_rays(a: &Arrays, wrong: &[&str], mut out: Arrays) -> Arrays {
    if wrong.contains(&"mean_over_rays") {
        let channels = input(a, "prediction").shape().last().copied().unwrap_or(1) as f64;
        out.get_mut("value").expect("an output").mapv_inplace(|value| channels * value);
    }
    out
}

fn of_huber(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let ([p, t], delta) = (pair(a), number(a, "delta"));
    if wrong.is_empty() {
        return forward(huber_oracle(&p, &t, delta, c.huber_slope, c.loss_reduction));
    }
    let differences = p.iter().zip(&t).map(|(p, t)| p - t);
    let sum: f64 = if wrong.contains(&"of_the_mean") {
        let n = p.len() as f64;
        n * wrong_piece(differences.map(f64::abs).sum::<f64>() / n, delta, wrong)
    } else {
        differences.map(|d| wrong_piece(d, delta, wrong)).sum()
    };
    let sum = if c.huber_slope == HuberSlope::One { sum / delta } else { sum };
    forward(reduced(sum, p.len(), c.loss_reduction))
}

/// Its gradient.
pub(crate) fn huber_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let ([p, t], delta, g) = (pair(a), number(a, "delta"), number(a, "grad_value"));
    let right = backward::huber(&p, &t, delta, c.huber_slope, c.loss_reduction, g);
    let one = |(n, right): (usize, f64)| {
        let d = p[n] - t[n];
        match wrong.first() {
            Some(_) if d.abs() <= delta => right,
            Some(&"slope_not_limited") => right * d.abs() / delta,
            Some(&"sign_forgotten") => right * d.signum(),
            Some(&"no_slope_beyond") => 0.0,
            _ => right,
        }
    };
    vjp(a, right.into_iter().enumerate().map(one).collect())
}

/// Charbonnier's loss.
pub(crate) fn charbonnier(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    over_rays(a, wrong, of_charbonnier(&compared(a, wrong), c, wrong))
}

fn of_charbonnier(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let ([p, t], eps) = (pair(a), number(a, "eps"));
    if wrong.is_empty() {
        return forward(charbonnier_oracle(&p, &t, eps, c.charbonnier_eps, c.loss_reduction));
    }
    let has = |name: &str| wrong.contains(&name);
    let eps = OWN_EPS.among(wrong).unwrap_or(eps);
    let square = if c.charbonnier_eps == CharbonnierEps::Square { eps * eps } else { eps };
    let differences = || p.iter().zip(&t).map(|(p, t)| p - t);
    if has("root_of_mean") {
        let under = reduced(differences().map(|d| d * d).sum(), p.len(), c.loss_reduction) + square;
        return forward(under.sqrt());
    }
    if has("root_over_channels") {
        let all: Vec<f64> = differences().collect();
        let channels = input(a, "prediction").shape().last().copied().unwrap_or(1).max(1);
        let roots = all.chunks(channels).map(|d| (d.iter().map(|d| d * d).sum::<f64>() + square).sqrt());
        return forward(reduced(roots.sum(), all.len() / channels, c.loss_reduction));
    }
    let other = |d: f64| match () {
        () if has("least_subtracted") => smooth(d, eps, c.charbonnier_eps) - eps,
        () if has("in_units_of_eps") => smooth(d, eps, c.charbonnier_eps) / eps,
        () if has("eps_outside") => d.abs() + eps,
        () if has("root_forgotten") => d * d + square,
        () if has("square_forgotten") => (d.abs() + square).sqrt(),
        () => smooth(d, eps, c.charbonnier_eps),
    };
    let power = OWN_POWER.among(wrong);
    let one = |d: f64| match power {
        Some(power) => pow(d * d + square, power),
        None => other(d),
    };
    forward(reduced(differences().map(one).sum(), p.len(), c.loss_reduction))
}

/// Its gradient.
pub(crate) fn charbonnier_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let ([p, t], eps, g) = (pair(a), number(a, "eps"), number(a, "grad_value"));
    let right = backward::charbonnier(&p, &t, eps, c.charbonnier_eps, c.loss_reduction, g);
    let one = |(n, right): (usize, f64)| {
        let d = p[n] - t[n];
        match wrong.first() {
            Some(&"eps_forgotten") if d == 0.0 => 0.0,
            Some(&"eps_forgotten") => reduced(g * d.signum(), p.len(), c.loss_reduction),
            Some(&"slope_halved") => 0.5 * right,
            Some(&"not_a_number_at_zero") if d == 0.0 => f64::NAN,
            _ => right,
        }
    };
    vjp(a, right.into_iter().enumerate().map(one).collect())
}
