//! What is wrong with Adam's and AdamW's steps, what it does, and where it was seen.

use super::one_mean::{MEAN_NOT_CORRECTED, OLD_MEAN, OLD_SQUARE, SQUARE_NOT_CORRECTED};
use crate::contract::component::Mistake;

const NO_BIAS_CORRECTION: Mistake = Mistake::new(
    "no_bias_correction",
    "m and v are used as they are",
    "the first steps are about 3 times too long (0.1 / sqrt(0.001))",
    "divide by 1 - beta^step",
    "hand-written optimizers",
    0,
);

const EPS_INSIDE_ROOT: Mistake = Mistake::new(
    "eps_inside_root",
    "sqrt(v + eps)",
    "small gradients take steps that are far too short: eps acts as its root, 1e-4",
    "sqrt(v) + eps",
    "hand-written optimizers",
    0,
);

const STEP_FROM_ZERO: Mistake = Mistake::new(
    "step_from_zero",
    "the corrections use step - 1 (with the first clamped to 1)",
    "early steps too long",
    "count steps from 1",
    "hand-written optimizers",
    0,
);

const CORRECTED_AS_IN_FIRST_STEP: Mistake = Mistake::new(
    "corrected_as_in_first_step",
    "1 - beta for 1 - beta^step in every step",
    "steps that grow up to 10 times too long (and 1 / sqrt(1000) of it): the corrections never fade",
    "raise beta to the number of the step",
    "a teaching library",
    1,
);

const CORRECTED_TWICE: Mistake = Mistake::new(
    "corrected_twice",
    "corrected moments, and sqrt(1 - beta2^step) / (1 - beta1^step) in the rate besides",
    "first steps wrong by that factor",
    "either of the two",
    "an algorithm collection in Python",
    1,
);

const STEP_FROM_TWO: Mistake = Mistake::new(
    "step_from_two",
    "the corrections use step + 1",
    "early steps too short",
    "count steps from 1: add 1 before, or in the power, not in both",
    "never; cheap to keep",
    0,
);

const BETAS_EXCHANGED: Mistake = Mistake::new(
    "betas_exchanged",
    "beta2 for the mean, beta1 for the squares",
    "steps that jump with every gradient's size, in a direction that is long out of date",
    "beta1 = 0.9 for the mean, beta2 = 0.999 for the squares",
    "never; cheap to keep",
    0,
);

const MEAN_WEIGHTS_EXCHANGED: Mistake = Mistake::new(
    "mean_weights_exchanged",
    "(1 - beta1) m + beta1 g",
    "no momentum",
    "beta1 m + (1 - beta1) g",
    "never; cheap to keep",
    0,
);

const SQUARE_WEIGHTS_EXCHANGED: Mistake = Mistake::new(
    "square_weights_exchanged",
    "(1 - beta2) v + beta2 g^2",
    "every step is lr long",
    "beta2 v + (1 - beta2) g^2",
    "never; cheap to keep",
    0,
);

const SQUARE_OF_MEAN: Mistake = Mistake::new(
    "square_of_mean",
    "v' of the new mean's square for that of the gradient",
    "noise isn't noticed: steps are long where gradients disagree",
    "beta2 v + (1 - beta2) g^2",
    "never; cheap to keep",
    0,
);

const CORRECTION_MULTIPLIED: Mistake = Mistake::new(
    "correction_multiplied",
    "m (1 - beta1^step) and v (1 - beta2^step)",
    "first steps wrong by the corrections' squares",
    "divide by 1 - beta^step",
    "never; cheap to keep",
    0,
);

const BETA1_IN_BOTH: Mistake = Mistake::new(
    "beta1_in_both_corrections",
    "v / (1 - beta1^step)",
    "early steps too long: the mean of squares is too small for a thousand steps",
    "v / (1 - beta2^step)",
    "never; cheap to keep",
    0,
);

const BETA2_IN_BOTH: Mistake = Mistake::new(
    "beta2_in_both_corrections",
    "m / (1 - beta2^step)",
    "early steps far too long",
    "m / (1 - beta1^step)",
    "never; cheap to keep",
    0,
);

const BETA_TIMES_STEP: Mistake = Mistake::new(
    "beta_times_step",
    "1 - beta step for 1 - beta^step",
    "the second step is negative already",
    "raise beta to the number of the step",
    "* for ** in Python; never seen",
    0,
);

const BETAS_SQUARED: Mistake = Mistake::new(
    "betas_squared",
    "1 - beta^2 corrects both moments at every step",
    "steps of another length than Adam's, and never the right one but at the second",
    "1 - beta^step",
    "1 public implementation",
    1,
);
const BETA2_SQUARED: Mistake = Mistake::new(
    "beta2_squared",
    "1 - beta2^2 corrects the second moment at every step",
    "steps too long at first, later too short by far",
    "1 - beta2^step",
    "a course's slide",
    1,
);

const MEANS_BEFORE: Mistake = Mistake::new(
    "means_before",
    "the parameter moves by the means as they were before the step",
    "the first step is none, all others are one late",
    "the means first, then the parameter",
    "never; cheap to keep",
    0,
);

const CORRECTED_MEANS_KEPT: Mistake = Mistake::new(
    "corrected_means_kept",
    "the corrected means are stored as m' and v'",
    "what was corrected is corrected again in every step: steps grow",
    "keep m' and v' as they are, correct copies",
    "never; cheap to keep",
    0,
);

const GRADIENT_FOR_MEAN: Mistake = Mistake::new(
    "gradient_for_mean",
    "g / (sqrt(v') + eps): RMSProp's step",
    "no momentum",
    "m' in the numerator",
    "never; cheap to keep",
    0,
);

const EPS_FORGOTTEN: Mistake = Mistake::new(
    "eps_forgotten",
    "m' / sqrt(v')",
    "0 / 0 where a parameter has had no gradient yet",
    "sqrt(v') + eps",
    "never; cheap to keep",
    0,
);

const RATE_OVER_ROOT_OF_STEP: Mistake = Mistake::new(
    "rate_over_root_of_step",
    "lr / sqrt(step)",
    "steps that fade, on top of what the schedule does",
    "lr as it is; the paper's theorem alone has that",
    "never; cheap to keep",
    0,
);

const UPHILL: Mistake = Mistake::new(
    "uphill",
    "p + lr m' / (...)",
    "the loss grows",
    "p - lr m' / (...)",
    "never; cheap to keep",
    0,
);

const BETAS_OF_ITS_OWN: Mistake = Mistake::new(
    "betas_of_its_own",
    "0.9 and 0.999 are written in, whatever beta1 and beta2 are",
    "means longer or shorter than what was asked for: nothing shows where betas are the usual ones",
    "the betas that are handed over",
    "1 public implementation",
    1,
);

pub(super) const EPS_OF_ITS_OWN: Mistake = Mistake::new(
    "eps_of_its_own",
    "an eps that is written in, whatever eps is",
    "steps of parameters with small gradients are too long or too short",
    "the eps that is handed over",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-7, [1e-12, 1e-2]);

pub(super) const GRADIENT_CLIPPED: Mistake = Mistake::new(
    "gradient_clipped_first",
    "the gradient is cut at [-k, k] before it is used",
    "large gradients count as k: another direction, and moments that know nothing of them",
    "the gradient as it comes; whoever clips does so outside, and says so",
    "1 public implementation",
    1,
)
.with("k", 1.0, [1e-3, 1e3]);

pub(super) const GRADIENT_NORM_CLIPPED: Mistake = Mistake::new(
    "gradient_norm_clipped_first",
    "the gradient is cut to a norm of k before it is used",
    "moments that know nothing of large gradients; what is clipped outside is clipped twice",
    "the gradient as it comes; whoever clips does so outside, and says so",
    "training loops whose step clips by itself, by k / norm as optax does",
    1,
)
.with("k", 1.0, [1e-3, 1e3]);

pub(super) const MEANS_BEGIN_AT_EPS: Mistake = Mistake::new(
    "means_begin_at_eps",
    "m and v begin at an eps in the place of 0",
    "parameters without a gradient move, those with small ones too far",
    "zeros; eps stands beside the root",
    "a quantum optimizer in numpy: 1e-8",
    1,
)
.with("begin", 1e-8, [1e-12, 1e-2]);

const EPS_IN_BOTH: Mistake = Mistake::new(
    "eps_inside_root_too",
    "sqrt(v' + eps) + eps",
    "a thousand times the eps where the mean of squares is small: parameters hardly move",
    "sqrt(v') + eps",
    "optax with eps and eps_root",
    1,
);

/// Mistakes of Adam.
pub(crate) const ADAM_STEP: &[Mistake] = &[
    SQUARE_NOT_CORRECTED,
    MEAN_NOT_CORRECTED,
    OLD_SQUARE,
    OLD_MEAN,
    NO_BIAS_CORRECTION,
    EPS_INSIDE_ROOT,
    Mistake::new(
        "decoupled_decay",
        "p is shrunk by lr * weight_decay (AdamW) where the penalty belongs to the gradient",
        "another optimizer: the decay isn't scaled by the root",
        "add weight_decay * p to the gradient, or compare with AdamW",
        "hand-written optimizers",
        0,
    ),
    STEP_FROM_ZERO,
    CORRECTED_AS_IN_FIRST_STEP,
    CORRECTED_TWICE,
    STEP_FROM_TWO,
    BETAS_EXCHANGED,
    MEAN_WEIGHTS_EXCHANGED,
    SQUARE_WEIGHTS_EXCHANGED,
    SQUARE_OF_MEAN,
    CORRECTION_MULTIPLIED,
    BETA1_IN_BOTH,
    BETA2_IN_BOTH,
    BETA_TIMES_STEP,
    BETA2_SQUARED,
    BETAS_SQUARED,
    MEANS_BEFORE,
    CORRECTED_MEANS_KEPT,
    GRADIENT_FOR_MEAN,
    EPS_FORGOTTEN,
    RATE_OVER_ROOT_OF_STEP,
    UPHILL,
    BETAS_OF_ITS_OWN,
    EPS_OF_ITS_OWN,
    GRADIENT_CLIPPED,
    GRADIENT_NORM_CLIPPED,
    MEANS_BEGIN_AT_EPS,
    EPS_IN_BOTH,
];

/// Mistakes of AdamW.
pub(crate) const ADAMW_STEP: &[Mistake] = &[
    SQUARE_NOT_CORRECTED,
    MEAN_NOT_CORRECTED,
    OLD_SQUARE,
    OLD_MEAN,
    Mistake::new(
        "coupled_decay",
        "weight_decay p is added to the gradient: Adam with an L2 penalty",
        "another optimizer: weights with large gradients hardly decay",
        "take lr weight_decay p off the parameter; torch: AdamW, not Adam(weight_decay=...)",
        "torch.optim.Adam with a weight_decay that was meant for AdamW",
        1,
    ),
    Mistake::new(
        "decay_without_rate",
        "weight_decay p, not times lr",
        "a thousand times the decay: weights vanish within some hundred steps",
        "lr weight_decay p",
        "the paper's lambda, which isn't times its alpha, taken for PyTorch's",
        0,
    ),
    Mistake::new(
        "gradient_decayed",
        "weight_decay g, the gradient for the parameter, and not times lr",
        "weights don't decay; a second step along the bare gradient comes on top of Adam's",
        "lr weight_decay p",
        "a collection of optimizers in numpy",
        1,
    ),
    Mistake::new(
        "decay_of_new_parameter",
        "(1 - lr weight_decay) (p - step): what the step has made decays",
        "steps that are shorter by that factor: nothing shows",
        "the parameter before the step: decay first",
        "hand-written optimizers",
        0,
    ),
    Mistake::new(
        "decay_corrected",
        "lr weight_decay p / (1 - beta1^step): with the step size of the first mean",
        "ten times the decay in the first step",
        "lr as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "decay_under_the_root",
        "lr (m' + weight_decay p) / (sqrt(v') + eps)",
        "weights with large gradients hardly decay, though the means don't know of it",
        "the decay beside the quotient",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "decay_negated",
        "(1 + lr weight_decay) p",
        "weights grow without bounds",
        "(1 - lr weight_decay) p",
        "never; cheap to keep",
        0,
    ),
    NO_BIAS_CORRECTION,
    EPS_INSIDE_ROOT,
    STEP_FROM_ZERO,
    CORRECTED_AS_IN_FIRST_STEP,
    CORRECTED_TWICE,
    STEP_FROM_TWO,
    BETAS_EXCHANGED,
    MEAN_WEIGHTS_EXCHANGED,
    SQUARE_WEIGHTS_EXCHANGED,
    SQUARE_OF_MEAN,
    CORRECTION_MULTIPLIED,
    BETA1_IN_BOTH,
    BETA2_IN_BOTH,
    BETA_TIMES_STEP,
    BETA2_SQUARED,
    BETAS_SQUARED,
    MEANS_BEFORE,
    CORRECTED_MEANS_KEPT,
    GRADIENT_FOR_MEAN,
    EPS_FORGOTTEN,
    RATE_OVER_ROOT_OF_STEP,
    UPHILL,
    BETAS_OF_ITS_OWN,
    EPS_OF_ITS_OWN,
    GRADIENT_CLIPPED,
    GRADIENT_NORM_CLIPPED,
    MEANS_BEGIN_AT_EPS,
    EPS_IN_BOTH,
];
