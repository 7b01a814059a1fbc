//! Positional encoding, wrong on purpose. Without a mistake every function equals the oracle.
//!
//! Two mistakes of the catalogue have no row here: the same number of bands for positions and directions shows in the shapes
//! (63 columns for 27), and a pixel grid that differs between training and rendering is a mistake of the caller.

pub(crate) mod laws;
mod waves;

use waves::OF_WAVES;

use super::arrays::{self, dims, settings};
use super::{Encoding, factor, wave};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::component::{Mistake, joined};
use crate::convention::Conventions;
use crate::math::{cos, exp, pow, sin};

/// The factor of the angle, forgotten in the gradient; of the integrated encoding too.
pub(crate) const CHAIN_FACTOR_FORGOTTEN: Mistake = Mistake::new(
    "chain_factor_forgotten",
    "the gradient of sin(a x) is cos(a x), without a = 2^k pi",
    "gradients of camera poses too small, most of all in the high bands",
    "multiply by 2^k pi",
    "hand-written backward passes",
    0,
)
.of_gradient();

/// The sign of the cosine's slope; of the integrated encoding too.
pub(crate) const COSINE_GRADIENT_SIGN: Mistake = Mistake::new(
    "cosine_gradient_sign",
    "the gradient of cos(a x) is a sin(a x), without the minus",
    "gradients of camera poses point elsewhere",
    "-a sin(a x)",
    "hand-written backward passes",
    0,
)
.of_gradient();

/// Powers of another base.
const ANOTHER_BASE: Mistake = Mistake::new(
    "another_base",
    "b^k for 2^k, with another base b: 1 / 2^k where powers are divided by",
    "bands that are too close together or too far apart",
    "2^k",
    "1 public implementation: x / 2^k",
    1,
)
.with("base", 0.5, [0.01, 16.0]);

/// All bands higher or lower, in one ratio.
const ANOTHER_FIRST_BAND: Mistake = Mistake::new(
    "another_first_band",
    "c 2^k pi for 2^k pi: the ladder begins at another octave, or x is scaled beforehand",
    "the slowest wave is missing, or the finest detail",
    "2^k pi x from k = 0",
    "never; loops that count from 1 would",
    0,
)
.with("c", 2.0, [0.05, 20.0]);

/// Mistakes of the encoding.
pub(crate) const POSITIONAL_ENCODING: &[Mistake] =
    &joined::<{ OF_BANDS.len() + OF_WAVES.len() }>(&[OF_BANDS, OF_WAVES]);

const OF_BANDS: &[Mistake] = &[
    Mistake::new(
        "linear_ladder",
        "bands k pi for 2^k pi, k from 0",
        "no fine detail: the highest band of ten is 9 pi instead of 512 pi, band 0 is constant",
        "2^k",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "bands_one_by_one",
        "bands 1, 2, 3, ... for 2^k: (k + 1) pi",
        "no fine detail: the highest band of ten is 10 pi instead of 512 pi",
        "2^k; bands that are even in frequency run from 1 to 2^(L - 1)",
        "a student's log_sampling=False",
        1,
    ),
    Mistake::new(
        "powers_exchanged",
        "bands k^2 pi for 2^k pi: pow's arguments are exchanged",
        "band 0 is constant, and the highest of ten is 81 pi instead of 512 pi",
        "2^k",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "input_normalized",
        "x / |x| is encoded, as a direction would be",
        "all points of a ray from the origin look alike",
        "normalize directions alone",
        "1 public implementation",
        1,
    )
    .open_where_nan(),
    Mistake::new(
        "input_through_tanh",
        "tanh(x) is encoded",
        "everything outside of the unit cube is squeezed into its rim",
        "x as it is, or a contraction with a name",
        "a trainer in C++",
        1,
    ),
    Mistake::new(
        "degrees_for_radians",
        "2^k pi x in degrees: times pi / 180 once more",
        "bands too low by a factor of 57: a blurred picture",
        "sine and cosine take radians",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "identity_in_half_turns",
        "pi x in the place of x",
        "an input that is larger than the sines beside it",
        "x as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sine_of_half_turns_for_identity",
        "sin(pi x) in the place of x",
        "positions a whole period apart are the same",
        "x as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "amplitudes_over_bands",
        "sin(2^k pi x) / 2^k and cos(2^k pi x) / 2^k",
        "fine detail that learns too slowly",
        "amplitudes of 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "first_band_twice",
        "the band in front of the loop is one octave too high: 2, 2, 4, ...",
        "the slowest wave is missing: points a period apart look alike",
        "2^k from k = 0",
        "a student's 2D fit",
        1,
    ),
    Mistake::new(
        "last_band_missing",
        "the last band's columns are never written",
        "the finest detail is lost",
        "k runs to L - 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cosine_missing",
        "sine is written into the cosine's columns",
        "the network can't tell which way a wave goes",
        "cos in the second half",
        "never; cheap to keep",
        0,
    ),
    CHAIN_FACTOR_FORGOTTEN,
    COSINE_GRADIENT_SIGN,
    Mistake::new(
        "identity_gradient_forgotten",
        "the gradient through x itself is left out",
        "gradients of camera poses slightly off",
        "add the first D columns' gradient",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "natural_base",
        "e^k for 2^k: exp taken for exp2",
        "bands that other programs' networks don't know, and no period",
        "2^k",
        "never; cheap to keep",
        0,
    ),
    ANOTHER_BASE,
    ANOTHER_FIRST_BAND,
    Mistake::new(
        "transformers_bands",
        "10000^(-k/L) for 2^k pi: the frequencies of words' places in a sentence",
        "no detail finer than the scene",
        "2^k",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "powers_of_x",
        "sin(pi x^(k+1)) for sin(2^k pi x)",
        "no fine detail near 0, and no period",
        "2^k x",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_by_bands",
        "everything divided by L",
        "faint inputs: the first layer's weights, drawn for numbers of about 1, are too small",
        "sines as they are",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "half_faded_in",
        "bands are faded in by the cosine's window of coarse-to-fine training, half of them here",
        "no fine detail, where no window is asked",
        "all bands",
        "BARF's and nerfies' window with alpha = L / 2; never seen here",
        0,
    ),
    Mistake::new(
        "bands_up_to_two",
        "frequencies 2^(k / (L - 1)): logspace from 0 to 1 in the place of 0 to L - 1",
        "hardly any detail: all bands within one octave",
        "2^k",
        "2 public implementations",
        2,
    ),
    Mistake::new(
        "even_ladder",
        "2 k for 2^k: the frequencies 0, 2, 4, 6, ...",
        "the finest band of ten is 28 times too coarse, and the first says nothing",
        "2^k of band k",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "last_band_everywhere",
        "every band has the last one's frequency",
        "noise, and no large shapes",
        "2^k of band k",
        "1 public implementation: a loop's variable read after the loop, or by closures made in it",
        1,
    ),
    Mistake::new(
        "identity_through_sine",
        "sin x in the place of x itself",
        "positions beyond a quarter turn aren't told apart",
        "x as it is",
        "1 public implementation",
        1,
    ),
];

/// The encoding of one point with mistakes in it.
pub(crate) fn encode(x: &[f64], encoding: &Encoding, wrong: &[&str]) -> Vec<f64> {
    let dims = x.len();
    let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let normalized: Vec<f64> = x.iter().map(|x| x / length).collect();
    let squashed: Vec<f64> = x.iter().map(|x| libm::tanh(*x)).collect();
    let x = match () {
        () if wrong.contains(&"input_normalized") => &normalized,
        () if wrong.contains(&"input_through_tanh") => &squashed,
        () => x,
    };
    let mapped: Vec<f64> = x.iter().map(|x| waves::mapped(*x, wrong)).collect();
    let x = &mapped[..];
    let mut out = super::positional_encoding(x, encoding);
    for k in 0..encoding.levels {
        for (d, all, x) in x.iter().enumerate().map(|(d, own)| (d, x, *own)) {
            let (sine, cosine) = (encoding.column(dims, k, d, 0), encoding.column(dims, k, d, 1));
            if let Some(other) = waves::other_wave(all, d, k, encoding, wrong) {
                (out[sine], out[cosine]) = other;
            }
            if wrong.contains(&"degrees_for_radians") {
                (out[sine], out[cosine]) =
                    wave(encoding.frequency, encoding.band(k) / 180.0, std::f64::consts::PI * x);
            }
            if wrong.contains(&"amplitudes_over_bands") {
                let over = encoding.band(k);
                (out[sine], out[cosine]) = (out[sine] / over, out[cosine] / over);
            }
            if wrong.contains(&"linear_ladder") {
                (out[sine], out[cosine]) = wave(encoding.frequency, k as f64, x);
            }
            if wrong.contains(&"bands_one_by_one") {
                (out[sine], out[cosine]) = wave(encoding.frequency, (k + 1) as f64, x);
            }
            if wrong.contains(&"even_ladder") {
                (out[sine], out[cosine]) = wave(encoding.frequency, (2 * k) as f64, x);
            }
            if wrong.contains(&"powers_exchanged") {
                (out[sine], out[cosine]) = wave(encoding.frequency, (k * k) as f64, x);
            }
            if wrong.contains(&"bands_up_to_two") {
                let power = k as f64 / (encoding.levels - 1).max(1) as f64;
                (out[sine], out[cosine]) = wave(encoding.frequency, pow(2.0, power), x);
            }
            if wrong.contains(&"last_band_everywhere") {
                (out[sine], out[cosine]) = wave(encoding.frequency, encoding.band(encoding.levels - 1), x);
            }
            if wrong.contains(&"natural_base") {
                (out[sine], out[cosine]) = wave(encoding.frequency, exp(k as f64), x);
            }
            if let Some(base) = ANOTHER_BASE.among(wrong) {
                (out[sine], out[cosine]) = wave(encoding.frequency, pow(base, k as f64), x);
            }
            if let Some(c) = ANOTHER_FIRST_BAND.among(wrong) {
                (out[sine], out[cosine]) = wave(encoding.frequency, c * encoding.band(k), x);
            }
            if wrong.contains(&"transformers_bands") {
                let turns = pow(10_000.0, -(k as f64) / encoding.levels as f64) * x;
                (out[sine], out[cosine]) = (sin(turns), cos(turns));
            }
            if wrong.contains(&"powers_of_x") {
                let power = (0..k).fold(x, |power, _| power * x);
                (out[sine], out[cosine]) = wave(encoding.frequency, 1.0, power);
            }
            if wrong.contains(&"half_faded_in") {
                let open = (0.5 * encoding.levels as f64 - k as f64).clamp(0.0, 1.0);
                let shown = 0.5 * (1.0 - cos(std::f64::consts::PI * open));
                (out[sine], out[cosine]) = (shown * out[sine], shown * out[cosine]);
            }
            if wrong.contains(&"first_band_twice") && k == 0 {
                (out[sine], out[cosine]) = wave(encoding.frequency, 2.0, x);
            }
            if wrong.contains(&"cosine_missing") {
                out[cosine] = out[sine];
            }
            if wrong.contains(&"last_band_missing") && k + 1 == encoding.levels {
                (out[sine], out[cosine]) = (0.0, 0.0);
            }
        }
    }
    if wrong.contains(&"identity_through_sine") && encoding.identity {
        (0..dims).for_each(|d| out[encoding.identity_column(dims, d)] = sin(x[d]));
    }
    if encoding.identity {
        for d in 0..dims {
            let own = &mut out[encoding.identity_column(dims, d)];
            match () {
                () if wrong.contains(&"identity_in_half_turns") => *own *= std::f64::consts::PI,
                () if wrong.contains(&"sine_of_half_turns_for_identity") => {
                    *own = sin(std::f64::consts::PI * x[d])
                }
                () => {}
            }
        }
    }
    if wrong.contains(&"divided_by_bands") && encoding.levels > 0 {
        out.iter_mut().for_each(|x| *x /= encoding.levels as f64);
    }
    out
}

/// Positional encoding.
pub(crate) fn positional_encoding(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut encoding = settings(a, c);
    encoding.levels = waves::counted(encoding.levels, wrong);
    let out: Vec<Vec<f64>> = rows(a, "x").iter().map(|x| encode(x, &encoding, wrong)).collect();
    arrays([("encoding", from_rows(&out, encoding.width(dims(a))))])
}

/// Its gradient.
pub(crate) fn positional_encoding_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (encoding, dims) = (settings(a, c), dims(a));
    let mut a = a.clone();
    let mut g = rows(&a, "grad_encoding");
    for g in &mut g {
        if wrong.contains(&"identity_gradient_forgotten") && encoding.identity {
            (0..dims).for_each(|d| g[encoding.identity_column(dims, d)] = 0.0);
        }
        for k in 0..encoding.levels {
            let a = factor(encoding.frequency) * encoding.band(k);
            for d in 0..dims {
                if wrong.contains(&"cosine_gradient_sign") {
                    g[encoding.column(dims, k, d, 1)] *= -1.0;
                }
                if wrong.contains(&"chain_factor_forgotten") {
                    (0..2).for_each(|cosine| g[encoding.column(dims, k, d, cosine)] /= a);
                }
            }
        }
    }
    if OF_WAVES.iter().any(|m| m.gradient && wrong.contains(&m.name)) {
        return waves::slopes(&a, &g, &encoding, wrong);
    }
    a.insert("grad_encoding".into(), from_rows(&g, encoding.width(dims)));
    arrays::encoding_vjp(&a, c)
}
