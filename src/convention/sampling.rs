//! Choices of where samples lie on a ray, and how long their steps are.

use serde::{Deserialize, Serialize};

/// How N samples are laid on [near, far], and what their `u` in [0, 1) scales. D = (far - near) / N, S = (far - near) / (N - 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grid {
    /// t_i = near + (i + u_i) D: one sample in each of N equal intervals.
    Intervals,
    /// t_i = near + i S + u_i D: both ends, jittered over D (the commonest CS180 pattern; t can pass far).
    EndsPlusWidth,
    /// t_i = near + (i + u_i) S: both ends, jittered over their spacing.
    EndsPlusSpacing,
    /// Both ends, bins between the midpoints of neighbors, half-width bins at the ends (bmild/nerf).
    EndsBetweenMidpoints,
}

/// The position of a sample in its interval when nothing is drawn (evaluation).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rest {
    /// u = 0.
    Left,
    /// u = 0.5.
    Mid,
    /// u = 1.
    Right,
}

/// The step length that belongs to sample i.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Delta {
    /// D = (far - near) / N for every sample.
    Width,
    /// t_{i+1} - t_i; the last one is [`LastDelta`].
    Differences,
    /// The same times the direction's length, the last one too: a length where directions aren't unit (bmild/nerf). This is done where the
    /// direction is known: in a rendering, not in the steps of `t` alone.
    DifferencesTimesNorm,
    /// The sample's cell: from the middle between it and the one before, or near, to the middle between it and the next, or far
    /// (Point-E, Shap-E).
    Midpoints,
    /// The same, but the outer cells reach as far beyond the first and the last sample as to the other side: whole gaps, as `numpy.gradient`
    /// has them.
    Central,
}

/// The step of the last sample, where the others are differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LastDelta {
    /// D = (far - near) / N.
    Width,
    /// The one before.
    Repeated,
    /// The mean of the others.
    Mean,
    /// 1e10: the last sample is opaque if it has any density.
    #[serde(rename = "1e10")]
    TenToTen,
    /// 1e9.
    #[serde(rename = "1e9")]
    TenToNine,
    /// 1e-3.
    #[serde(rename = "1e-3")]
    Thousandth,
    /// far - t_{N-1}.
    ToFar,
}
