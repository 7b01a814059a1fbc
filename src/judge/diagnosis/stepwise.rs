//! Numbers at which a formula changes over: thresholds, limits, the least that counts. Answers change by steps with them, so that an
//! element shows no more than between which two numbers its own lies; all of them together leave few.

use ndarray::ArrayD;

use super::super::answer::{Answer, reshaped};
use crate::contract::arrays::Arrays;
use crate::contract::component::Number;

/// How near a prediction is to what was answered, of all that the range changes, or of its size: what is found is held against its
/// bounds afterward.
const NEAR: f64 = 1e-3;
const ROUNDED: f64 = 1e-5;

/// Halvings of a range: to four digits.
const HALVINGS: usize = 24;

/// Digits that people write.
const DIGITS: usize = 6;

/// Which way a number has to go.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Up,
    Down,
}

/// What one case would be answered with a number, beside what it was.
pub(super) struct Asked<'a> {
    pub at: Box<dyn Fn(f64) -> Arrays + 'a>,
    pub answer: &'a Answer,
}

/// The number with the fewest digits between those two where the elements change over; `None` where none shows anything, or where they
/// contradict each other.
pub(super) fn read_off(number: &Number, cases: &[Asked]) -> Option<f64> {
    let [least, most] = number.range;
    let ends: Vec<(Arrays, Arrays)> = cases.iter().map(|case| ((case.at)(least), (case.at)(most))).collect();
    // Most of them decide: not every element goes one way all along.
    let way = |x: f64| {
        let all: Vec<Way> = cases.iter().zip(&ends).flat_map(|(case, ends)| ways(case, ends, x)).collect();
        let up = all.iter().filter(|way| **way == Way::Up).count();
        (!all.is_empty()).then_some(if 2 * up > all.len() { Way::Up } else { Way::Down })
    };
    let (mut low, mut high, mut inside) = (least, most, None);
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        match way(middle) {
            Some(Way::Up) => low = middle,
            Some(Way::Down) => high = middle,
            None => {
                inside = Some(middle);
                break;
            }
        }
    }
    let inside = inside?;
    // Where the elements stop agreeing, on either side.
    let edge = |end: f64, wrong: Way| {
        let (mut fits, mut end) = (inside, end);
        for _ in 0..HALVINGS {
            let middle = (fits * end).sqrt();
            if way(middle) == Some(wrong) { end = middle } else { fits = middle }
        }
        fits
    };
    let (low, high) = (edge(least, Way::Up), edge(most, Way::Down));
    // Both ends of the range agree: nothing was shown.
    (low > 1.001 * least || high < most / 1.001).then(|| simplest(low, high))
}

/// Where the elements of a case want a number to go.
fn ways(case: &Asked, (low, high): &(Arrays, Arrays), x: f64) -> Vec<Way> {
    let now = (case.at)(x);
    let of_output = |(name, low): (&String, &ArrayD<f64>)| {
        let (high, now) = (high.get(name)?, now.get(name)?);
        let (got, _) = reshaped(&case.answer.get(name)?.values, low.shape())?;
        if high.shape() != low.shape() || now.shape() != low.shape() {
            return None;
        }
        let all = got.iter().zip(low).zip(high).zip(now);
        Some(all.filter_map(|(((&g, &l), &h), &now)| wanted(g, l, h, now)).collect::<Vec<_>>())
    };
    low.iter().filter_map(of_output).flatten().collect()
}

/// Where an element wants the number to go that was answered `g`, and would be `l` and `h` at the ends of the range, and `now`.
fn wanted(g: f64, l: f64, h: f64, now: f64) -> Option<Way> {
    let least = (NEAR * (h - l).abs()).max(ROUNDED * h.abs().min(l.abs()));
    let near = |a: f64, b: f64| a == b || a.is_nan() && b.is_nan() || (a - b).abs() <= least;
    match () {
        () if near(l, h) || near(g, now) => None,
        () if (g - now) * (h - l) > 0.0 || near(now, l) => Some(Way::Up),
        () => Some(Way::Down),
    }
}

/// The number between two with the fewest digits; what is nearest to their middle of these.
fn simplest(low: f64, high: f64) -> f64 {
    let middle = (low * high).sqrt();
    let written = |digits: usize| format!("{middle:.*e}", digits - 1).parse().unwrap_or(middle);
    let power = format!("1e{}", high.log10().floor()).parse().unwrap_or(middle);
    let mut few = std::iter::once(power).chain((1..=DIGITS).map(written));
    few.find(|x| (low..=high).contains(x)).unwrap_or(middle)
}

#[cfg(test)]
mod tests {
    use super::super::fitted::tests::found;
    use super::*;
    use crate::contract::arithmetic::Dtype;

    /// Numbers that are no powers of ten: the answers show between which two they lie, or nearly.
    #[test]
    fn thresholds_are_read_off_where_answers_change_over() {
        for (component, mistake, number, by) in [
            ("volume_render", "weights_cut", 0.0063, 2.0),
            ("volume_render", "given_up_early", 0.017, 2.0),
            ("volume_render", "density_capped", 63.0, 1.1),
            ("render_trace", "given_up_early", 0.017, 2.0),
            ("early_stop", "eps_of_its_own", 0.0037, 2.0),
            ("linear_to_srgb", "another_threshold", 0.0197, 1.1),
            ("linear_to_srgb", "another_threshold", 0.00031308, 1.5),
            ("gaussian_alpha", "cut_at_other_sigmas", 3.4, 1.2),
        ] {
            for dtype in [Dtype::F64, Dtype::F32] {
                let found = found(component, dtype, &format!("{mistake}={number}"));
                let near = |fitted: f64| (number / by..=number * by).contains(&fitted);
                let this = |(names, fitted): &(Vec<&str>, Vec<f64>)| {
                    *names == [mistake] && fitted.first().copied().is_some_and(near)
                };
                assert!(found.iter().any(this), "{component} {dtype} {mistake} = {number}: {found:?}");
            }
        }
    }

    #[test]
    fn the_fewest_digits_between_two_numbers() {
        assert_eq!(simplest(9e-5, 2e-4), 1e-4);
        assert_eq!(simplest(0.21, 0.34), 0.3);
        assert_eq!(simplest(0.00391, 0.00393), 0.00392);
    }

    #[test]
    fn an_element_says_which_way() {
        assert!(wanted(1.0, 1.0, 2.0, 1.0).is_none());
        assert!(wanted(1.0, 1.0, 2.0, 2.0) == Some(Way::Down));
        assert!(wanted(1.5, 1.0, 2.0, 1.2) == Some(Way::Up));
        assert!(wanted(1.5, 2.0, 1.0, 1.2) == Some(Way::Down));
        assert!(wanted(7.0, 1.0, 1.0, 1.0).is_none());
    }
}
