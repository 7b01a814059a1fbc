//! What happens to a number by itself.

/// What happens to an element by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum By {
    /// As [`EACH`] has it in this place.
    Each(usize),
    /// It is multiplied by a number that the answers show.
    Times(f64),
    /// A number that the answers show is added.
    Plus(f64),
}

impl By {
    pub(crate) fn of(self, x: f64) -> f64 {
        match self {
            By::Each(n) => EACH[n].1(x),
            By::Times(k) => k * x,
            By::Plus(k) => x + k,
        }
    }

    /// Whether what it gives are whole numbers.
    pub(crate) fn rounds(self) -> bool {
        matches!(self, By::Each(n) if EACH[n].0.starts_with("rounded"))
    }

    pub(crate) fn says(self) -> String {
        match self {
            By::Each(n) => EACH[n].0.into(),
            By::Times(k) => format!("times {k:?}"),
            By::Plus(k) => format!("{} {:?}", if k < 0.0 { "minus" } else { "plus" }, k.abs()),
        }
    }
}

/// Elements, one by one. The likelier come first: of two that give the same numbers, that one is named.
pub(crate) const EACH: &[(&str, fn(f64) -> f64)] = &[
    ("left out: 0", |_| 0.0),
    ("with the other sign", |x| -x),
    ("through a ReLU", |x| x.max(0.0)),
    ("clamped to [0, 1]", |x| x.clamp(0.0, 1.0)),
    ("without its sign", f64::abs),
    ("halved", |x| 0.5 * x),
    ("doubled", |x| 2.0 * x),
    ("1 minus itself", |x| 1.0 - x),
    ("taken for 1", |_| 1.0),
    ("times pi", |x| std::f64::consts::PI * x),
    ("times 2 pi", |x| std::f64::consts::TAU * x),
    ("over pi", |x| x / std::f64::consts::PI),
    ("over 2 pi", |x| x / std::f64::consts::TAU),
    ("times 255", |x| 255.0 * x),
    ("over 255", |x| x / 255.0),
    ("mapped from [0, 1] to [-1, 1]", |x| 2.0 * x - 1.0),
    ("mapped from [-1, 1] to [0, 1]", |x| 0.5 * x + 0.5),
    ("squared", |x| x * x),
    ("taken for its square root", f64::sqrt),
    ("taken for its reciprocal", |x| 1.0 / x),
    ("taken for its exponential", crate::math::exp),
    ("taken for its logarithm", crate::math::ln),
    ("through a sigmoid", |x| 1.0 / (1.0 + crate::math::exp(-x))),
    ("plus 1", |x| x + 1.0),
    ("minus 1", |x| x - 1.0),
    ("plus 1/2", |x| x + 0.5),
    ("minus 1/2", |x| x - 0.5),
    ("rounded down", f64::floor),
    ("rounded to whole numbers", f64::round),
];

/// A number that answers show: in four digits, as people write it, and as it is.
pub(crate) fn rounded(x: f64) -> [f64; 2] {
    [format!("{x:.3e}").parse().unwrap_or(x), x]
}
