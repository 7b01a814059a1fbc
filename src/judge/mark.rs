//! Marking: the answers to one question against the truth in given conventions.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use ndarray::ArrayD;

use super::answer::{Answer, Answers, reshaped, wide_enough};
use super::exam::{Question, hard};
use super::truths::Truth;
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::case::Case;
use crate::contract::check::budget_used;
use crate::contract::component::Entries;
use crate::convention::Conventions;

/// The element that used most of its bound.
#[derive(Clone, Debug)]
pub struct Worst {
    /// Case.
    pub id: String,
    /// Output.
    pub output: String,
    /// Position in the array.
    pub index: Vec<usize>,
    /// What was answered.
    pub got: f64,
    /// What is true.
    pub expected: f64,
    /// How far off an honest answer may be.
    pub bound: f64,
    /// The error in units of the last place of the type, at the expected size.
    pub ulp: f64,
}

/// What marking found.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    /// Largest error over bound among the elements that prove something: at most 1 where everything is right.
    pub budget_used: f64,
    /// Where.
    pub worst: Option<Worst>,
    /// Elements whose bound reaches their size: they prove nothing.
    pub vacuous: usize,
    /// Answered outputs without an element that proves something: one that isn't 0, with a bound smaller than itself.
    pub unproved: BTreeSet<String>,
    /// Problems of the answers as files: absent, of a wrong shape, of a type too narrow, NaN.
    pub faults: Vec<String>,
    /// Outputs that no case answers.
    pub missing: BTreeSet<String>,
    /// Layouts found and accepted.
    pub layouts: BTreeSet<String>,
    /// Choices that are neither a mistake nor a value of a convention.
    pub findings: Vec<String>,
    /// The outputs that are off, in the order in which the component computes them.
    pub off: Vec<String>,
    /// The cases of which something is wrong.
    pub wrong_cases: Vec<String>,
    /// Which formula's bound holds of each case of which two differ, where all that is answered is right.
    pub grades: BTreeMap<String, Grade>,
}

impl Marks {
    /// Everything answered, nothing wrong.
    pub fn right(&self) -> bool {
        self.budget_used <= 1.0 && self.faults.is_empty()
    }

    /// The same, and every output that was answered is proved.
    pub fn pass(&self) -> bool {
        self.right() && self.unproved.is_empty()
    }
}

/// How to mark: the type under test, and the accuracy of elementary functions.
#[derive(Clone, Copy, Debug)]
pub struct MarkOptions {
    /// What the candidate computes in.
    pub dtype: Dtype,
    /// Error of exp, log, sin, cos in ULP.
    pub exp_ulp: f64,
}

impl MarkOptions {
    /// The arithmetic of a grade.
    pub fn arithmetic(&self, grade: Grade) -> Arithmetic {
        Arithmetic { elementary_ulp: self.exp_ulp, ..Arithmetic::new(self.dtype, grade) }
    }

    /// The true outputs of a case, and the bound of an answer.
    pub fn truth(&self, question: &Question, case: &Case, c: &Conventions, grade: Grade) -> Arc<Truth> {
        let row = (question.component, question.kind);
        question.truths.truth(row, case, c, (self.dtype, &self.arithmetic(grade)))
    }

    /// Whether an answer that is far off can be rejected without its bound: true in f32 and f64, except for hard cases, where a textbook
    /// formula may have no digits left, and where infinities and NaN go in: what comes out may be open.
    pub fn may_reject_early(&self, case: &Case) -> bool {
        self.dtype.bits() >= 24 && !hard(case) && case.finite()
    }
}

/// Marks all answers to a question.
pub fn mark(
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
    grade: Grade,
) -> Marks {
    let answered: BTreeSet<&String> = answers.iter().flatten().flat_map(|answer| answer.keys()).collect();
    let (mut marks, mut proved) = (Marks::default(), BTreeSet::new());
    for (case, answer) in question.cases.iter().zip(answers) {
        let Some(answer) = answer else {
            let crash = question.crashed.get(&case.id).map(|said| format!("crashed: {said}"));
            if crash.is_some() && asks_for_nothing(question, case, c) {
                marks.findings.push(format!("{}, where there is nothing to answer: crashed", case.id));
                continue;
            }
            marks.faults.push(format!("{}: {}", case.id, crash.unwrap_or("no answer".into())));
            marks.wrong_cases.push(case.id.clone());
            continue;
        };
        let before = (marks.faults.len(), marks.off.len());
        let truth = options.truth(question, case, c, grade);
        let (expected, bound) = (&truth.expected, &truth.bound);
        let names = question.ordered(expected.keys());
        if names.iter().all(|name| !answer.contains_key(*name)) {
            marks.faults.push(format!("{}: none of the outputs is there", case.id));
        }
        for name in names {
            if !answered.contains(name) {
                marks.missing.insert(name.clone());
            } else {
                let entries = question.component.output_entries(name);
                marks.output(case, (name, entries), answer, (&expected[name], &bound[name]), options.dtype);
                marks.unproved.insert(name.clone());
                if proves(&expected[name], &bound[name]) {
                    proved.insert(name.clone());
                }
            }
        }
        if before != (marks.faults.len(), marks.off.len()) {
            marks.wrong_cases.push(case.id.clone());
        }
    }
    let nothing = nothing_to_show(question, c);
    marks.unproved.retain(|name| !proved.contains(name) && !nothing.contains(name));
    marks.off = question
        .ordered(marks.off.iter().collect::<BTreeSet<_>>().into_iter())
        .into_iter()
        .cloned()
        .collect();
    marks
}

/// Whether there are inputs, and no output has any element: an encoding of bands alone, and no bands.
fn asks_for_nothing(question: &Question, case: &Case, c: &Conventions) -> bool {
    let given = case.inputs.iter().filter(|(name, _)| !name.starts_with("grad_")).all(|(_, a)| !a.is_empty());
    given && (question.component.forward.oracle)(&case.inputs, c).values().all(|array| array.is_empty())
}

/// Gradients that are 0 in every case because an output isn't answered, whose cotangent is 0 then: there is nothing to prove.
pub(crate) fn nothing_to_show(question: &Question, c: &Conventions) -> BTreeSet<String> {
    let zero = |array: &ArrayD<f64>| array.iter().all(|x| *x == 0.0);
    let cotangents = |case: &Case| -> BTreeSet<String> {
        let silent = |(name, array): &(&String, &ArrayD<f64>)| name.starts_with("grad_") && zero(array);
        case.inputs.iter().filter(silent).map(|(name, _)| name.clone()).collect()
    };
    if in_all(question.cases.iter().map(cotangents)).is_empty() {
        return BTreeSet::new();
    }
    let gradients = |case: &Case| -> BTreeSet<String> {
        let expected = question.expected(case, c);
        expected.iter().filter(|(_, array)| zero(array)).map(|(name, _)| name.clone()).collect()
    };
    in_all(question.cases.iter().map(gradients))
}

/// What is in all of the sets.
fn in_all(sets: impl Iterator<Item = BTreeSet<String>>) -> BTreeSet<String> {
    sets.reduce(|a, b| a.intersection(&b).cloned().collect()).unwrap_or_default()
}

/// Whether some element is evidence: it isn't 0, and its bound is smaller than itself, so that an answer of 0 would have failed.
pub fn proves(expected: &ArrayD<f64>, bound: &ArrayD<f64>) -> bool {
    expected.iter().zip(bound).any(|(expected, bound)| *bound < expected.abs())
}

impl Marks {
    fn fault(&mut self, case: &Case, name: &str, what: String) {
        self.faults.push(format!("{}: {name}: {what}", case.id));
        self.budget_used = f64::INFINITY;
        self.off.push(name.to_string());
    }

    fn output(
        &mut self,
        case: &Case,
        (name, entries): (&String, Entries),
        answer: &Answer,
        (expected, bound): (&ArrayD<f64>, &ArrayD<f64>),
        dtype: Dtype,
    ) {
        let Some(given) = answer.get(name) else {
            return self.fault(case, name, "absent here, but not in other cases".into());
        };
        if !wide_enough(entries, given.dtype, dtype) {
            self.fault(case, name, format!("{} is too narrow for {dtype}", given.dtype));
        }
        let Some((got, layout)) = reshaped(&given.values, expected.shape()) else {
            let (found, wanted) = (given.values.shape(), expected.shape());
            return self.fault(case, name, format!("wrong shape {found:?}, expected {wanted:?}"));
        };
        self.layouts.extend(layout.map(|layout| format!("{name}: {layout}")));
        // Where the bound is infinite (a textbook formula that overflows in a short type) not even a NaN is ruled out.
        if got.iter().zip(bound).any(|(g, b)| g.is_nan() && *b < f64::INFINITY) {
            self.fault(case, name, "NaN".into());
        }
        for (((index, &got), &expected), &bound) in got.indexed_iter().zip(expected).zip(bound) {
            let used = budget_used(got, expected, bound);
            let vacuous = expected.is_finite() && bound >= expected.abs() && bound > 0.0;
            self.vacuous += usize::from(vacuous);
            if used > 1.0 {
                self.off.push(name.clone());
            }
            // A vacuous element says nothing about how much of the budget was used, unless it exceeds its bound.
            if vacuous && used <= 1.0 {
                continue;
            }
            if used > self.worst.as_ref().map_or(-1.0, |w| budget_used(w.got, w.expected, w.bound)) {
                self.budget_used = self.budget_used.max(used);
                let ulp = (got - expected).abs() / dtype.ulp(expected);
                let index = ndarray::Dimension::slice(&index).to_vec();
                let (id, output) = (case.id.clone(), name.clone());
                self.worst = Some(Worst { id, output, index, got, expected, bound, ulp });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::exam::Exam;
    use super::*;
    use crate::convention::CS180;

    #[test]
    fn what_was_asked_before_is_remembered_and_nothing_else() {
        let exam = Exam::new("positional_encoding", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: 2.0 });
        let case = &question.cases[0];
        let truth =
            |case: &Case, c: &Conventions, options: MarkOptions| options.truth(question, case, c, Grade::B);
        let first = truth(case, &CS180, options);
        assert!(Arc::ptr_eq(&first, &truth(case, &CS180, options)));
        let other = CS180.with("frequency", "one").unwrap();
        assert_ne!(truth(case, &other, options).expected, first.expected);
        let doubled = MarkOptions { exp_ulp: 4.0, ..options };
        assert_ne!(truth(case, &CS180, doubled).bound, first.bound);
        // The same name for other inputs.
        let mut moved = case.clone();
        moved.inputs.get_mut("x").unwrap().mapv_inplace(|x| x + 0.25);
        assert_ne!(truth(&moved, &CS180, options).expected, first.expected);
        assert!(question.clone().truths.is_empty());
    }
}
