//! What is wrong with the waves of an encoding and with their gradients, and what it does.

use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::component::Mistake;
use crate::encoding::arrays::dims;
use crate::encoding::{Encoding, factor, wave};

/// Of waves and of the gradient.
pub(super) const OF_WAVES: &[Mistake] = &[
    Mistake::new(
        "pi_forgotten_in_the_cosine",
        "sin(2^k pi x), cos(2^k x)",
        "sines and cosines of different bands",
        "one angle for both",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "pi_forgotten_in_the_sine",
        "sin(2^k x), cos(2^k pi x)",
        "sines and cosines of different bands",
        "one angle for both",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "twice_the_bands",
        "2 L bands: a sine and a cosine for each of a loop over both",
        "twice the columns, and waves that no pixel can show",
        "L bands of a sine and a cosine each",
        "1 public implementation: range(2 * L)",
        1,
    ),
    Mistake::new(
        "one_band_more",
        "L + 1 bands: a loop from 0 to L",
        "a sine and a cosine more than other programs' networks know",
        "k from 0 to L - 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "one_band_less",
        "L - 1 bands: a loop from 1 or up to L - 1",
        "the finest detail is missing",
        "k from 0 to L - 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "fraction_alone",
        "x - floor(x) for x",
        "the first band has the other sign wherever floor(x) is odd, and positions repeat",
        "x as it is; a period of 2 at least",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "bands_of_the_doubled_less_one",
        "bands of 2 x - 1, beside x itself",
        "the first band has the other sign, and all have an octave more",
        "one mapping of positions, in front of the encoding",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mapped_from_the_unit_ball",
        "(x + 1) / 2 for x",
        "all bands are an octave lower",
        "x as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "frequencies_repeated",
        "x repeated beside frequencies repeated: column n has coordinate n mod D and band n mod L",
        "some coordinates lack some bands, others have them twice",
        "each coordinate with each band",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "band_by_coordinate",
        "the frequency of coordinate d is 2^d, in all bands",
        "no fine detail, and other coordinates at other scales",
        "2^k of band k",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "first_coordinate_alone",
        "every band of the first coordinate",
        "a scene that varies along x alone",
        "each coordinate's own",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "bands_to_the_count",
        "even bands from 1 to 2^L",
        "the finest detail is an octave too fine",
        "bands from 1 to 2^(L - 1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "even_bands_from_zero",
        "even bands from 0 to 2^(L - 1)",
        "the first band is constant",
        "bands from 1",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "sine_overwritten",
        "double angles: s = 2 s c, then 1 - 2 s^2 with the new s",
        "cosines of another octave",
        "both of the old s and c",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cosine_without_sign",
        "sqrt(1 - sin^2) for the cosine",
        "half of all positions look like the other half",
        "cos",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sine_missing",
        "the cosine twice",
        "positions and their mirror images look alike",
        "sin and cos",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_band_alone",
        "= for +=: the last band's gradient is left",
        "the gradient of the finest detail alone",
        "add up all bands",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "sine_for_cosine",
        "sin and cos exchanged in the derivative",
        "a gradient that has nothing to do with the encoding",
        "d sin = cos, d cos = -sin",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "coordinates_added",
        "the sum over all coordinates for each",
        "all coordinates move alike",
        "each coordinate's own columns",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "factor_of_the_first_band",
        "pi for 2^k pi in each band",
        "fine detail has hardly any gradient",
        "2^k pi",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "mean_over_bands",
        "the sum over bands is divided by their number",
        "a gradient that is too small",
        "a sum",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "cosine_read_first",
        "the gradient's columns read as cosine, sine",
        "a gradient that has nothing to do with the encoding",
        "the columns' own order",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// The input of all that is encoded, as the mistakes have it.
pub(super) fn mapped(x: f64, wrong: &[&str]) -> f64 {
    match () {
        () if wrong.contains(&"fraction_alone") => x - libm::floor(x),
        () if wrong.contains(&"mapped_from_the_unit_ball") => 0.5 * (x + 1.0),
        () => x,
    }
}

/// Sine and cosine of coordinate d in band k, as the mistakes have them; `None` where they are right.
pub(super) fn other_wave(
    x: &[f64],
    d: usize,
    k: usize,
    encoding: &Encoding,
    wrong: &[&str],
) -> Option<(f64, f64)> {
    let at = |band: f64, x: f64| wave(encoding.frequency, band, x);
    let (band, levels, dims) = (encoding.band(k), encoding.levels, x.len());
    let (sine, cosine) = at(band, x[d]);
    let without_pi = || (libm::sin(band * x[d]), libm::cos(band * x[d]));
    let doubled = || {
        (0..k).fold(at(1.0, x[d]), |(s, c), _| {
            let s = 2.0 * s * c;
            (s, 1.0 - 2.0 * s * s)
        })
    };
    Some(match () {
        () if wrong.contains(&"pi_forgotten_in_the_cosine") => (sine, without_pi().1),
        () if wrong.contains(&"pi_forgotten_in_the_sine") => (without_pi().0, cosine),
        () if wrong.contains(&"bands_of_the_doubled_less_one") => at(band, 2.0 * x[d] - 1.0),
        () if wrong.contains(&"frequencies_repeated") => {
            let n = k * dims + d;
            at(encoding.band(n % levels), x[n % dims])
        }
        () if wrong.contains(&"band_by_coordinate") => at(libm::ldexp(1.0, d as i32), x[d]),
        () if wrong.contains(&"first_coordinate_alone") => at(band, x[0]),
        () if wrong.contains(&"bands_to_the_count") => {
            let share = k as f64 / (levels - 1).max(1) as f64;
            at(1.0 + share * (libm::ldexp(1.0, levels as i32) - 1.0), x[d])
        }
        () if wrong.contains(&"even_bands_from_zero") => {
            let share = k as f64 / (levels - 1).max(1) as f64;
            at(share * libm::ldexp(1.0, levels as i32 - 1), x[d])
        }
        () if wrong.contains(&"sine_overwritten") => doubled(),
        () if wrong.contains(&"cosine_without_sign") => (sine, cosine.abs()),
        () if wrong.contains(&"sine_missing") => (cosine, cosine),
        () => return None,
    })
}

/// How many bands there are.
pub(super) fn counted(levels: usize, wrong: &[&str]) -> usize {
    match () {
        () if wrong.contains(&"twice_the_bands") => 2 * levels,
        () if wrong.contains(&"one_band_more") => levels + 1,
        () if wrong.contains(&"one_band_less") => levels.saturating_sub(1),
        () => levels,
    }
}

/// The gradient of coordinate d in band k for these cotangents of sine and cosine, over the band's factor, as the mistakes have it.
pub(super) fn other_slope(
    (sine, cosine): (f64, f64),
    g: [f64; 2],
    k: usize,
    factor: f64,
    encoding: &Encoding,
    wrong: &[&str],
) -> f64 {
    match () {
        () if wrong.contains(&"last_band_alone") && k + 1 < encoding.levels => 0.0,
        () if wrong.contains(&"sine_for_cosine") => factor * (g[0] * sine - g[1] * cosine),
        () if wrong.contains(&"cosine_read_first") => factor * (g[1] * cosine - g[0] * sine),
        () if wrong.contains(&"factor_of_the_first_band") => {
            factor / encoding.band(k) * (g[0] * cosine - g[1] * sine)
        }
        () if wrong.contains(&"mean_over_bands") => {
            factor / encoding.levels as f64 * (g[0] * cosine - g[1] * sine)
        }
        () => factor * (g[0] * cosine - g[1] * sine),
    }
}

/// The gradient as hand-written backward passes have it.
pub(super) fn slopes(a: &Arrays, g: &[Vec<f64>], encoding: &Encoding, wrong: &[&str]) -> Arrays {
    let dims = dims(a);
    let mut all = vec![];
    for (x, g) in rows(a, "x").iter().zip(g) {
        let of = |d: usize| {
            let band = |k: usize| {
                let f = factor(encoding.frequency) * encoding.band(k);
                let own = [0, 1].map(|cosine| g[encoding.column(dims, k, d, cosine)]);
                let wave = wave(encoding.frequency, encoding.band(k), x[d]);
                other_slope(wave, own, k, f, encoding, wrong)
            };
            let identity = if encoding.identity { g[encoding.identity_column(dims, d)] } else { 0.0 };
            (0..encoding.levels).map(band).sum::<f64>() + identity
        };
        let mut own: Vec<f64> = (0..dims).map(of).collect();
        if wrong.contains(&"coordinates_added") {
            own = vec![own.iter().sum(); dims];
        }
        all.push(own);
    }
    arrays([("grad_x", from_rows(&all, dims))])
}
