//! Cases of a loss scale: overflows early and late, steps before, at and after an interval, scales at their limits.
//!
//! Factors aren't inverses of one another but where a case says so: code that takes one for both shows.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};

/// A case from scale, tracker, overflow, growth and backoff factor, and interval.
fn case(id: &str, comment: &'static str, numbers: [f64; 6]) -> Case {
    let names =
        ["scale", "growth_tracker", "found_inf", "growth_factor", "backoff_factor", "growth_interval"];
    Case::new(id, comment, names.into_iter().zip(numbers.map(scalar)).collect())
}

/// Updates.
pub(crate) fn loss_scale_update() -> Vec<Case> {
    vec![
        case("usual", "a step without an overflow", [1000.3, 3.0, 0.0, 1.9, 0.3, 8.0]),
        case("first", "the first step", [65536.0, 0.0, 0.0, 2.0, 0.5, 2000.0]),
        case("last_but_one", "one step before the interval is over", [1000.3, 6.0, 0.0, 1.9, 0.3, 8.0]),
        case("grown", "the interval is over", [1000.3, 7.0, 0.0, 1.9, 0.3, 8.0]),
        case(
            "grown_twice_as_large",
            "the interval is over, by powers of two",
            [512.0, 1999.0, 0.0, 2.0, 0.5, 2000.0],
        ),
        case("each_step", "an interval of one step", [300.7, 0.0, 0.0, 1.1, 0.7, 1.0]),
        case("overflow", "an overflow on the way", [1000.3, 3.0, 1.0, 1.9, 0.3, 8.0]),
        case("overflow_first", "an overflow in the first step", [65536.0, 0.0, 1.0, 2.0, 0.5, 2000.0]),
        case("overflow_last", "an overflow in the step that would grow", [1000.3, 7.0, 1.0, 1.9, 0.3, 8.0]),
        case("small", "an overflow of a scale close to 1", [1.3, 2.0, 1.0, 1.9, 0.3, 8.0]),
        case("beyond_16_bits", "a scale that grows beyond 2^16", [40_000.3, 7.0, 0.0, 1.9, 0.3, 8.0]),
        case("large", "a scale that grows beyond 2^24", [1.2e7, 7.0, 0.0, 1.9, 0.3, 8.0]),
    ]
}

/// Gradients of scaled losses: of powers of two and of others, small ones, and steps that overflowed in one place or in all.
pub(crate) fn unscale_gradients() -> Vec<Case> {
    let case = |id, comment, scale, g: Vec<f64>| {
        Case::new(id, comment, vec![("gradients", array(&[g.len()], g)), ("scale", scalar(scale))])
    };
    let drawn = |stream, n: usize, low, high| {
        let mut draw = Draw::new("unscale_gradients", stream);
        (0..n)
            .map(|_| draw.decades(low, high) * if draw.unit() < 0.5 { -1.0 } else { 1.0 })
            .collect::<Vec<f64>>()
    };
    let with = |stream, places: &[(usize, f64)]| {
        let mut g = drawn(stream, 8, -1.0, 2.0);
        places.iter().for_each(|&(n, x)| g[n] = x);
        g
    };
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    let cases = vec![
        case("usual", "a power of two", 1024.0, drawn(0, 12, -1.0, 3.0)),
        case(
            "odd",
            "no power of two: a quotient, or a product with a rounded inverse",
            1000.3,
            drawn(1, 12, -1.0, 3.0),
        ),
        case("first", "torch's first scale", 65536.0, drawn(2, 8, 2.0, 4.5)),
        case("below_one", "a scale that has shrunk below 1", 0.37, drawn(3, 6, -2.0, 2.0)),
        case("zeros", "nothing flows back to most of a grid", 1024.0, vec![0.0, -0.0, 512.0, 0.0, -3.0]),
        case(
            "nearly_infinite",
            "the largest numbers that f16 has are finite",
            1024.0,
            vec![65504.0, -65504.0, 1.0],
        ),
        case(
            "beyond_half",
            "what is infinite in f16 alone is finite",
            1024.0,
            vec![131_072.0, -70_000.0, 1.0],
        ),
        case(
            "sum_beyond_single",
            "finite numbers whose sum is infinite in f32",
            1024.0,
            vec![1.5 * libm::ldexp(1.0, 127), 1.25 * libm::ldexp(1.0, 127), -3.0],
        ),
        case("one_infinity", "an overflow in one place", 1024.0, with(4, &[(5, inf)])),
        case(
            "a_negative_infinity",
            "-inf alone: who looks at the largest number doesn't see it",
            1024.0,
            with(5, &[(2, -inf)]),
        ),
        case(
            "not_a_number",
            "NaN alone, as inf - inf leaves it: who compares sizes doesn't see it",
            1024.0,
            with(6, &[(3, nan)]),
        ),
        case("two_infinities", "of both signs: their sum is NaN", 1024.0, with(7, &[(0, inf), (7, -inf)])),
        case(
            "last_of_all",
            "the last number alone: who looks at the first doesn't see it, as fairscale did (#890)",
            1024.0,
            with(8, &[(7, nan)]),
        ),
    ];
    in_full(cases, "usual")
}
