//! What is wrong with one of the two means alone.

use crate::contract::component::Mistake;

pub(super) const SQUARE_NOT_CORRECTED: Mistake = Mistake::new(
    "square_not_corrected",
    "m / (1 - b1^t) / (sqrt(v) + eps): v as it is",
    "the first steps are up to 30 times too long",
    "v / (1 - b2^t)",
    "never; cheap to keep",
    0,
);
pub(super) const MEAN_NOT_CORRECTED: Mistake = Mistake::new(
    "mean_not_corrected",
    "m / (sqrt(v / (1 - b2^t)) + eps): m as it is",
    "the first steps are up to 10 times too short",
    "m / (1 - b1^t)",
    "never; cheap to keep",
    0,
);
pub(super) const OLD_SQUARE: Mistake = Mistake::new(
    "square_of_before",
    "the parameter moves by the v of before this gradient",
    "the first step is divided by eps",
    "v after the gradient",
    "never; cheap to keep",
    0,
);
pub(super) const OLD_MEAN: Mistake = Mistake::new(
    "mean_of_before",
    "the parameter moves by the m of before this gradient",
    "every step is one late",
    "m after the gradient",
    "never; cheap to keep",
    0,
);
