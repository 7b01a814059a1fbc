//! The integrated encoding, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{forward, settings, vjp};
use super::{backward, integrated_encoding as oracle};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::encoding::backward::positional_encoding as of_points;
use crate::encoding::mistakes::{CHAIN_FACTOR_FORGOTTEN, COSINE_GRADIENT_SIGN};
use crate::encoding::{Encoding, factor, wave};
use crate::math::exp;

/// Mistakes of the integrated encoding.
pub(crate) const INTEGRATED_ENCODING: &[Mistake] = &[
    Mistake::new(
        "factor_forgotten_in_variance",
        "means are multiplied by pi or 2 pi, variances by 4^k alone",
        "waves fade a band or three too late: aliasing is back",
        "(2^k pi)^2 v",
        "nerfstudio's NeRFEncoding (covs times freqs^2, the input times 2 pi) and what copied it, three read",
        4,
    ),
    Mistake::new(
        "variance_scaled_once",
        "the variance times 2^k pi for (2^k pi)^2",
        "high bands hardly fade: aliasing is back",
        "a variance grows with the square",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "variance_not_scaled",
        "exp(-v / 2) in all bands",
        "no band fades before the others do: aliasing is back",
        "(2^k pi)^2 v",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "half_forgotten",
        "exp(-variance)",
        "detail fades half a band too early",
        "exp(-variance / 2)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "attenuation_forgotten",
        "the plain encoding of the mean",
        "NeRF's aliasing, at the cost of cones",
        "times exp(-variance / 2)",
        "code that has covariances and doesn't hand them over",
        0,
    ),
    Mistake::new(
        "variances_added",
        "all coordinates fade by the sum of their variances",
        "what is slanted fades too early",
        "each by its own",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "attenuated_angle",
        "sin(e x) for e sin(x)",
        "waves are stretched where they should fade",
        "times exp(-variance / 2), outside of the wave",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cosine_not_attenuated",
        "sines fade, cosines don't",
        "half of the columns alias",
        "both times exp(-variance / 2)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "variance_taken_for_deviation",
        "the variance squared once more: exp(-(2^k pi v)^2 / 2)",
        "narrow Gaussians never fade, wide ones at once",
        "v is a variance as it comes",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "deviation_for_variance",
        "the standard deviation in the exponent: exp(-(2^k pi)^2 sqrt(v) / 2)",
        "narrow Gaussians fade as if they were wide: pictures are blurred",
        "v as it comes, without the root",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "variances_detached",
        "no gradient reaches the variances",
        "poses and sample distances aren't told that sharper is better",
        "-(2^k pi)^2 / 2 times each column's own value",
        "covariances made under no_grad",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "attenuation_forgotten_in_gradient",
        "the means' gradient of the plain encoding",
        "poses follow waves that have faded",
        "times exp(-variance / 2)",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "variance_slope_scaled_once",
        "-2^k pi / 2 for -(2^k pi)^2 / 2",
        "high bands hardly reach the variances",
        "the exponent's slope is -(2^k pi)^2 / 2",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "variance_slope_sign",
        "the variances' gradient without its minus",
        "Gaussians grow where they should shrink",
        "-(2^k pi)^2 / 2",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "variance_slope_doubled",
        "-(2^k pi)^2 for half of it",
        "variances follow twice as fast",
        "-(2^k pi)^2 / 2",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    COSINE_GRADIENT_SIGN,
    CHAIN_FACTOR_FORGOTTEN,
];

/// What is left of band k's sine and cosine, with mistakes in it.
fn left(encoding: &Encoding, k: usize, v: f64, wrong: &[&str]) -> [f64; 2] {
    let has = |name: &str| wrong.contains(&name);
    let f = encoding.band(k);
    let a = factor(encoding.frequency) * f;
    let variance = match () {
        () if has("factor_forgotten_in_variance") => f * f * v,
        () if has("variance_scaled_once") => a * v,
        () if has("variance_not_scaled") => v,
        () if has("half_forgotten") => 2.0 * (a * a * v),
        () if has("attenuation_forgotten") => 0.0,
        () if has("variance_taken_for_deviation") => (a * v) * (a * v),
        () if has("deviation_for_variance") => a * a * v.sqrt(),
        () => a * a * v,
    };
    let left = exp(-0.5 * variance);
    [left, if has("cosine_not_attenuated") { 1.0 } else { left }]
}

/// Integrated encoding.
pub(crate) fn integrated_encoding(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let encoding = settings(a, c);
    forward(a, c, |x, v| {
        let (mut out, dims) = (oracle(x, v, &encoding), x.len());
        for d in 0..dims {
            for k in 0..encoding.levels {
                let (sin, cos) = wave(encoding.frequency, encoding.band(k), x[d]);
                let own = if wrong.contains(&"variances_added") { v.iter().sum() } else { v[d] };
                let [of_sin, of_cos] = left(&encoding, k, own, wrong);
                if wrong.contains(&"attenuated_angle") {
                    let (sin, cos) = wave(encoding.frequency, encoding.band(k), of_sin * x[d]);
                    out[encoding.column(dims, k, d, 0)] = sin;
                    out[encoding.column(dims, k, d, 1)] = cos;
                    continue;
                }
                out[encoding.column(dims, k, d, 0)] = of_sin * sin;
                out[encoding.column(dims, k, d, 1)] = of_cos * cos;
            }
        }
        out
    })
}

/// Its gradient: of cotangents that the mistake has changed.
pub(crate) fn integrated_encoding_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let encoding = settings(a, c);
    let has = |name: &str| wrong.contains(&name);
    vjp(a, |x, v, g| {
        let dims = x.len();
        let (mut of_mean, mut of_variance) = (g.to_vec(), g.to_vec());
        for d in 0..dims {
            for k in 0..encoding.levels {
                let scale = factor(encoding.frequency) * encoding.band(k);
                let [sine, cosine] = [0, 1].map(|cosine| encoding.column(dims, k, d, cosine));
                if has("cosine_gradient_sign") {
                    of_mean[cosine] *= -1.0;
                }
                for column in [sine, cosine] {
                    if has("chain_factor_forgotten") {
                        of_mean[column] /= scale;
                    }
                    of_variance[column] *= match () {
                        () if has("variances_detached") => 0.0,
                        () if has("variance_slope_scaled_once") => 1.0 / scale,
                        () if has("variance_slope_sign") => -1.0,
                        () if has("variance_slope_doubled") => 2.0,
                        () => 1.0,
                    };
                }
            }
        }
        let means = if has("attenuation_forgotten_in_gradient") {
            of_points(x, &encoding, &of_mean)
        } else {
            backward::integrated_encoding(x, v, &encoding, &of_mean).0
        };
        (means, backward::integrated_encoding(x, v, &encoding, &of_variance).1)
    })
}
