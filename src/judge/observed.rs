//! What is known of answers that nothing explains: in which cases which output is off, and whether one simple thing makes it right.

use std::collections::BTreeSet;

use ndarray::{ArrayD, Axis, Slice, concatenate};

use super::answer::{Answers, Given, reshaped};
use super::assignment::small_cases;
use super::exam::Question;
use super::mark::MarkOptions;
use crate::contract::arithmetic::{Dtype, Grade};
use crate::contract::check::budget_used;
use crate::convention::Conventions;

/// By how much wrong code may be less accurate than the right formula.
const GENEROUS: f64 = 16.0;

/// Cases that are named.
const NAMED: usize = 4;

/// An output that is off in a case.
struct Off {
    id: String,
    got: ArrayD<f64>,
    expected: ArrayD<f64>,
    bound: ArrayD<f64>,
}

impl Off {
    fn right(&self) -> bool {
        self.moved(Clone::clone)
    }

    /// Whether the answer is the right one with its elements in other places.
    fn moved(&self, change: impl Fn(&ArrayD<f64>) -> ArrayD<f64>) -> bool {
        self.is(&change(&self.expected), &change(&self.bound))
    }

    /// Whether each element of the answer is `change` of the right one, whose error grows `factor` times.
    fn changed(&self, change: impl Fn(f64) -> f64, factor: f64) -> bool {
        let factor = factor.abs().max(1.0);
        self.is(&self.expected.mapv(change), &self.bound.mapv(|b| factor * b))
    }

    fn is(&self, predicted: &ArrayD<f64>, bound: &ArrayD<f64>) -> bool {
        let fits = |((&g, &p), &b): ((&f64, &f64), &f64)| budget_used(g, p, GENEROUS * b.abs()) <= 1.0;
        predicted.shape() == self.got.shape() && self.got.iter().zip(predicted).zip(bound).all(fits)
    }

    /// The expected element that is largest of those that say something, and what was answered for it.
    fn largest(&self) -> Option<(f64, f64)> {
        let elements = self.expected.iter().zip(&self.got).zip(&self.bound);
        // One that is no larger than its bound says nothing.
        let telling =
            elements.filter(|((e, g), b)| e.is_finite() && g.is_finite() && e.abs() > GENEROUS * **b);
        telling.map(|((e, g), _)| (*e, *g)).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
    }
}

/// A sentence for each output that is off in these conventions, in the order in which they are computed.
pub(crate) fn observed(
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
) -> Vec<String> {
    let cases = small_cases(question, answers);
    let mut off: Vec<(String, Vec<Off>, usize)> = vec![];
    for (case, answer) in &cases {
        let truth = options.truth(question, case, c, Grade::B);
        let (expected, bound) = (&truth.expected, &truth.bound);
        for name in question.ordered(expected.keys()) {
            let Some(found) = compared(&case.id, answer.get(name), &expected[name], &bound[name]) else {
                continue;
            };
            let n = off.iter().position(|(known, ..)| known == name).unwrap_or_else(|| {
                off.push((name.clone(), vec![], 0));
                off.len() - 1
            });
            off[n].2 += 1;
            off[n].1.extend((!found.right()).then_some(found));
        }
    }
    off.retain(|(_, off, _)| !off.is_empty());
    let narrow = off.iter().filter_map(|(name, off, _)| narrower(name, off, options.dtype));
    off.iter().map(|(name, off, asked)| sentence(name, off, *asked)).chain(narrow).collect()
}

/// Different numbers that a sentence about their type needs.
const ENOUGH: usize = 16;

/// What it says where all numbers of an output are of a shorter type, and those that were expected aren't.
fn narrower(name: &str, off: &[Off], dtype: Dtype) -> Option<String> {
    let short = [(Dtype::F16, "float16"), (Dtype::Bf16, "bfloat16")];
    let numbers = |of: fn(&Off) -> &ArrayD<f64>| -> Vec<f64> {
        off.iter().flat_map(of).copied().filter(|x| x.is_finite() && x.fract() != 0.0).collect()
    };
    let (got, expected) = (numbers(|off| &off.got), numbers(|off| &off.expected));
    let all = |short: Dtype| got.iter().all(|x| short.holds(*x));
    let few = |short: Dtype| 2 * expected.iter().filter(|x| short.holds(**x)).count() < expected.len();
    let found = short.into_iter().find(|(short, _)| all(*short) && few(*short));
    let different: BTreeSet<u64> = got.iter().map(|x| x.to_bits()).collect();
    let (_, said) = found.filter(|_| dtype.bits() >= 24 && different.len() >= ENOUGH)?;
    Some(format!(
        "what is off in {name} are numbers of {said} alone: something is computed in half precision"
    ))
}

/// An answer beside the truth, where there is one of its shape.
fn compared(id: &str, given: Option<&Given>, expected: &ArrayD<f64>, bound: &ArrayD<f64>) -> Option<Off> {
    let (got, _) = reshaped(&given?.values, expected.shape())?;
    Some(Off { id: id.into(), got, expected: expected.clone(), bound: bound.clone() })
}

fn sentence(name: &str, off: &[Off], asked: usize) -> String {
    let ids: Vec<&str> = off.iter().map(|off| off.id.as_str()).collect();
    let more = if ids.len() > NAMED { ", ..." } else { "" };
    let which = match off.len() {
        n if n == asked => format!("in all {asked} cases"),
        n => format!("in {n} of {asked} cases ({}{more})", ids[..n.min(NAMED)].join(", ")),
    };
    format!("{name} is off {which}{}", pattern(off).map_or(String::new(), |what| format!(": {what}")))
}

/// What all of them have in common.
fn pattern(off: &[Off]) -> Option<String> {
    let all = |change: &dyn Fn(f64) -> f64, factor: f64| off.iter().all(|off| off.changed(change, factor));
    if off.iter().all(|off| off.got.iter().all(|x| x.is_nan())) {
        return Some("nothing but NaN".into());
    }
    if off.iter().all(|off| off.got.iter().all(|x| *x == 0.0)) {
        return Some("nothing but 0".into());
    }
    if all(&|x| -x, 1.0) {
        return Some("the sign is wrong".into());
    }
    if all(&|x| 1.0 - x, 1.0) {
        return Some("1 minus what it should be".into());
    }
    if let Some(found) = of_axes(off) {
        return Some(found);
    }
    // A constant is only seen where it is asked for more than once.
    let elements: usize = off.iter().map(|off| off.got.len()).sum();
    let largest = off.iter().filter_map(Off::largest).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let Some((expected, got)) = largest.filter(|_| elements > 2) else { return beginnings(off) };
    let (ratio, difference) = (got / expected, got - expected);
    if ratio.abs() < 1e6 && all(&|x| x * ratio, ratio) {
        return Some(format!("{} times what it should be, everywhere", short(ratio)));
    }
    if all(&|x| x + difference, 1.0) {
        return Some(format!("what it should be {difference:+.6e}, everywhere"));
    }
    beginnings(off)
}

/// A number in six digits.
fn short(x: f64) -> String {
    if (1e-3..1e6).contains(&x.abs()) { format!("{x:.6}") } else { format!("{x:.5e}") }
}

/// Axes that are exchanged, reversed or shifted.
fn of_axes(off: &[Off]) -> Option<String> {
    let rank = off[0].expected.ndim();
    if off.iter().any(|off| off.expected.ndim() != rank) {
        return None;
    }
    let all = |change: &dyn Fn(&ArrayD<f64>) -> ArrayD<f64>| off.iter().all(|off| off.moved(change));
    for a in 0..rank {
        if all(&|e| e.slice_axis(Axis(a), Slice::new(0, None, -1)).to_owned())
            && off.iter().any(|off| off.expected.len_of(Axis(a)) > 1)
        {
            return Some(format!("its axis {a} is reversed"));
        }
        for (by, word) in [(1, "late"), (-1, "early")] {
            if all(&|e| rolled(e, a, by)) {
                return Some(format!("along its axis {a} every element comes one {word}, around the end"));
            }
        }
        for b in a + 1..rank {
            let exchanged = |e: &ArrayD<f64>| {
                let mut e = e.clone();
                e.swap_axes(a, b);
                e
            };
            if all(&exchanged) {
                return Some(format!("its axes {a} and {b} are exchanged"));
            }
        }
        let length = off[0].expected.len_of(Axis(a));
        if length > 4 || off.iter().any(|off| off.expected.len_of(Axis(a)) != length) {
            continue;
        }
        for (i, j) in (0..length).flat_map(|i| (i + 1..length).map(move |j| (i, j))) {
            let mut order: Vec<usize> = (0..length).collect();
            order.swap(i, j);
            if all(&|e| e.select(Axis(a), &order)) {
                return Some(format!("along its axis {a}, elements {i} and {j} are exchanged"));
            }
        }
        // The sign of one element: of two, or of all alike, another thing is said.
        for i in 0..length {
            let negated = |e: &ArrayD<f64>| {
                let mut e = e.clone();
                e.index_axis_mut(Axis(a), i).mapv_inplace(|x| -x);
                e
            };
            if all(&negated) {
                return Some(format!("along its axis {a}, element {i} has the wrong sign"));
            }
        }
    }
    None
}

fn rolled(e: &ArrayD<f64>, axis: usize, by: isize) -> ArrayD<f64> {
    let n = e.len_of(Axis(axis));
    if n == 0 {
        return e.clone();
    }
    let at = by.rem_euclid(n as isize) as usize;
    let (first, last) = e.view().split_at(Axis(axis), n - at);
    concatenate(Axis(axis), &[last, first]).expect("parts of one array")
}

/// Whether the first or the last elements along the last axis are right, and the others aren't.
fn beginnings(off: &[Off]) -> Option<String> {
    off.iter().map(|off| off.expected.ndim()).min().filter(|axes| *axes > 0)?;
    let right_at = |off: &Off, n: usize| {
        let part = |a: &ArrayD<f64>| a.index_axis(Axis(off.expected.ndim() - 1), n).to_owned().into_dyn();
        let here = Off {
            id: String::new(),
            got: part(&off.got),
            expected: part(&off.expected),
            bound: part(&off.bound),
        };
        here.right()
    };
    let lengths: Vec<usize> = off.iter().map(|off| *off.expected.shape().last().unwrap_or(&0)).collect();
    let shortest = *lengths.iter().min()?;
    if shortest < 2 {
        return None;
    }
    let first = (0..shortest).take_while(|&n| off.iter().all(|off| right_at(off, n))).count();
    if first > 0 {
        return Some(format!("right up to element {} of its last axis", first - 1));
    }
    let from_end = |n: &usize| off.iter().zip(&lengths).all(|(off, length)| right_at(off, length - 1 - n));
    let last = (0..shortest).take_while(from_end).count();
    (last > 0).then(|| match last {
        1 => "right in the last element of its last axis alone".into(),
        n => format!("right in the last {n} elements of its last axis"),
    })
}

#[cfg(test)]
mod tests {
    use ndarray::Axis;

    use super::super::answer::{Answer, given};
    use super::super::exam::Exam;
    use super::*;
    use crate::convention::CS180;

    /// What is seen of the right answers to a row after a change.
    fn seen(component: &str, change: impl Fn(&str, &mut Answer)) -> Vec<String> {
        let exam = Exam::new(component, Dtype::F64, None).unwrap();
        let question = &exam.questions[0];
        let answer = |case: &crate::contract::Case| {
            let mut answer = given((question.component.forward.oracle)(&case.inputs, &CS180));
            change(&case.id, &mut answer);
            Some(answer)
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        observed(question, &answers, &CS180, &MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 })
    }

    fn on<'a>(name: &'a str, f: impl Fn(&mut ArrayD<f64>) + 'a) -> impl Fn(&str, &mut Answer) + 'a {
        move |_, answer| f(&mut answer.get_mut(name).expect("an output").values)
    }

    #[test]
    fn what_is_right_is_not_mentioned() {
        assert_eq!(seen("volume_render", |_, _| ()), [""; 0]);
    }

    #[test]
    fn simple_changes_are_seen() {
        for (change, said) in [
            (
                &(|a: &mut ArrayD<f64>| a.mapv_inplace(|x| 1.07 * x)) as &dyn Fn(&mut ArrayD<f64>),
                "1.070000 times",
            ),
            (&|a| a.mapv_inplace(|x| x + 0.25), "+2.5"),
            (&|a| a.mapv_inplace(|x| -x), "the sign is wrong"),
            (&|a| a.fill(0.0), "nothing but 0"),
            (&|a| a.invert_axis(Axis(1)), "its axis 1 is reversed"),
            (&|a| *a = a.select(Axis(1), &[0, 2, 1]), "elements 1 and 2 are exchanged"),
            (&|a| a.index_axis_mut(Axis(1), 1).mapv_inplace(|x| -x), "element 1 has the wrong sign"),
            (&|a| *a = a.select(Axis(1), &[2, 0, 1]), "every element comes one late"),
        ] {
            let seen = seen("transform", on("x_w", change));
            assert!(seen.len() == 1 && seen[0].contains(said), "{said}: {seen:?}");
        }
    }

    #[test]
    fn half_precision_is_seen() {
        let seen = seen("spherical_harmonics", on("harmonics", |a| a.mapv_inplace(|x| Dtype::F16.round(x))));
        assert!(seen.iter().any(|said| said.contains("float16")), "{seen:?}");
    }

    #[test]
    fn the_case_that_is_off_is_named() {
        let one = |id: &str, answer: &mut Answer| {
            if id == "opaque_0" {
                answer.get_mut("opacity").expect("an output").values.mapv_inplace(|x| (7.0 * x).sin());
            }
        };
        let seen = seen("volume_render", one);
        assert!(
            seen.len() == 1
                && seen[0].starts_with("opacity is off in 1 of")
                && seen[0].contains("(opaque_0)"),
            "{seen:?}"
        );
    }
}
