//! The judge: answers in, verdicts and diagnoses out.

use std::any::Any;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::answer::{Answers, given};
use super::asking::{Reply, examine};
use super::assignment::{self, Found, partial};
use super::declared::Declared;
use super::diagnose::diagnose;
use super::evidence::{Explanation, difference};
use super::exam::{Exam, Question};
use super::imprecise::lost_bits;
use super::mark::{MarkOptions, Marks, mark};
use super::report::{Report, Row, Verdict};
use super::{layout, statistics};
use crate::contract::arithmetic::{Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::check::Kind;
use crate::convention::Conventions;
use crate::convention::profiles::{self, Profile};
use crate::error::{Error, Result};
use crate::parallel;

/// The contract's accuracy of exp, log, sin and cos, in ULP.
pub const EXP_ULP: f64 = 4.0;

/// A function under test.
type Closure<'a> = Box<dyn Fn(&Arrays) -> Arrays + Sync + 'a>;

/// Somebody's implementation: closures by component, forward or VJP.
///
/// Of any rows at once, over the contract's own arrays; a kernel of one row has a typed front door in its component ([`super::Door`]).
///
/// ```
/// use nerf_oracle::contract::arrays::{array, arrays, input};
/// use nerf_oracle::judge::{Candidate, Verdict, judge};
/// use nerf_oracle::contract::Dtype;
///
/// // C' = C + (1 - A) b, as somebody might write it.
/// let candidate = Candidate::new().forward("composite_background", |inputs| {
///     let (colors, opacity) = (input(inputs, "colors"), input(inputs, "opacity"));
///     let b = input(inputs, "background");
///     let out = colors.indexed_iter().map(|(i, c)| c + (1.0 - opacity[[i[0]]]) * b[[i[1]]]).collect();
///     arrays([("colors_out", array(colors.shape(), out))])
/// });
/// let report = judge(&candidate, Dtype::F64).unwrap();
/// assert_eq!(report.of("composite_background", "forward").unwrap().verdict, Verdict::Pass);
/// ```
#[derive(Default)]
pub struct Candidate<'a> {
    functions: BTreeMap<(String, Kind), Closure<'a>>,
    declared: BTreeMap<(String, Kind), Declared>,
    profile: Option<&'static Profile>,
}

impl std::fmt::Debug for Candidate<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Candidate")
            .field("rows", &self.functions.keys())
            .field("profile", &self.profile.map(|p| p.name))
            .finish_non_exhaustive()
    }
}

impl<'a> Candidate<'a> {
    /// A candidate that implements nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a component's forward function (its trace, for `render_trace`): inputs by name -> outputs by name.
    pub fn forward(mut self, component: &str, f: impl Fn(&Arrays) -> Arrays + Sync + 'a) -> Self {
        self.functions.insert((component.into(), Kind::Forward), Box::new(f));
        self
    }

    /// Adds a component's vector-Jacobian product: inputs and `grad_<output>` by name -> `grad_<input>` by name.
    pub fn vjp(mut self, component: &str, f: impl Fn(&Arrays) -> Arrays + Sync + 'a) -> Self {
        self.functions.insert((component.into(), Kind::Vjp), Box::new(f));
        self
    }

    /// Says which inputs a component's functions take: cases that need others are left out and told (a center off the middle for rays of
    /// `height`, `width`, `focal` and `c2w`).
    pub fn takes(self, component: &str, inputs: &[&str]) -> Self {
        let inputs = inputs.iter().map(ToString::to_string).collect();
        self.declaring(component, Some(&inputs), None)
    }

    /// Says which outputs a component's gradient goes through: the cotangents of the others are 0.
    pub fn returns(self, component: &str, outputs: &[&str]) -> Self {
        let outputs = outputs.iter().map(ToString::to_string).collect();
        self.declaring(component, None, Some(&outputs))
    }

    /// Both at once, as far as they are said.
    pub(crate) fn declaring(
        mut self,
        component: &str,
        takes: Option<&Vec<String>>,
        returns: Option<&Vec<String>>,
    ) -> Self {
        for kind in [Kind::Forward, Kind::Vjp] {
            let declared = self.declared.entry((component.into(), kind)).or_default();
            declared.takes = takes.cloned().or(declared.takes.take());
            declared.returns = returns.cloned().or(declared.returns.take());
        }
        self
    }

    /// Pins the conventions: deviating from them fails.
    ///
    /// # Errors
    /// An unknown profile.
    pub fn profile(mut self, name: &str) -> Result<Self> {
        self.profile = Some(profiles::find(name)?);
        Ok(self)
    }
}

/// Asks a candidate that computes in `dtype` every question on the rows that it has, and no others, and judges its answers. Every
/// question comes four times, so that answers that depend on chance or on the question before show. Where it panics, that case has no
/// answer but what it said.
///
/// # Errors
/// A component that isn't in the contract, or an input or output that the component doesn't have.
pub fn judge(candidate: &Candidate, dtype: Dtype) -> Result<Report> {
    let rows: Vec<(&str, Kind)> = candidate.functions.keys().map(|(name, kind)| (&name[..], *kind)).collect();
    let exam = Exam::of(&rows, dtype, candidate.profile)?;
    let declared = exam.questions.iter().filter_map(|question| {
        let of = (question.component.name.to_string(), question.kind);
        Some((question.row(), candidate.declared.get(&of)?.clone()))
    });
    let declared = declared.collect();
    let exam = exam
        .narrowed(&declared)
        .map_err(|what| Error::usage("takes, returns", what, "the contract's names"))?;
    let asked = examine(exam, true, |question, case| {
        let function = candidate.functions.get(&(question.component.name.to_string(), question.kind));
        let Some(f) = function else { return Ok(Reply::Nothing) };
        Ok(match catch_unwind(AssertUnwindSafe(|| f(&case.inputs))) {
            Ok(outputs) => Reply::Answer(given(outputs)),
            Err(panic) => Reply::Crash(said(&*panic)),
        })
    });
    asked.map_err(|never: Infallible| match never {})
}

/// What a panic said.
fn said(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic".into())
}

/// Judges answers to an exam, a list per question.
pub fn judge_answers(exam: &Exam, answers: &[Answers], exp_ulp: f64) -> Report {
    let options = MarkOptions { dtype: exam.dtype, exp_ulp };
    let first = Round::new(exam, answers, &options);
    // A failure may be due to the layout alone: then it is judged again in the contract's layout.
    let failing = |n: &usize| first.marked[*n].as_ref().is_some_and(|(marks, _)| marks.budget_used > 1.0);
    let failing: Vec<usize> = (0..answers.len()).filter(|n| failing(n)).collect();
    let base = first.found.conventions;
    let laid = parallel::map(failing.len(), |n| {
        let (question, answers) = (&exam.questions[failing[n]], &answers[failing[n]]);
        layout::normalized(question, answers, &base, exam.profile.is_some(), &options)
    });
    let laid: BTreeMap<usize, (Answers, String)> =
        failing.into_iter().zip(laid).filter_map(|(n, laid)| Some((n, laid?))).collect();
    if laid.is_empty() {
        return first.report(exam, answers, &options, &laid);
    }
    let same = |n: usize| laid.get(&n).map_or_else(|| answers[n].clone(), |(answers, _)| answers.clone());
    let ordered: Vec<Answers> = (0..answers.len()).map(same).collect();
    Round::new(exam, &ordered, &options).report(exam, &ordered, &options, &laid)
}

/// Answers marked in the conventions of the run.
struct Round {
    found: Found,
    /// Marks of each question; `None` where nothing was answered.
    marked: Vec<Option<(Marks, Option<Grade>)>>,
}

impl Round {
    fn new(exam: &Exam, answers: &[Answers], options: &MarkOptions) -> Round {
        // A row that crashed on every case has an answer: that.
        let crashed = |n: usize| !exam.questions[n].crashed.is_empty();
        let answered = |n: &usize| answers[*n].iter().any(Option::is_some) || crashed(*n);
        let answered_questions: Vec<usize> = (0..answers.len()).filter(answered).collect();
        let questions: Vec<_> =
            answered_questions.iter().map(|&n| (&exam.questions[n], &answers[n])).collect();
        let mut found = match exam.profile {
            Some(profile) => Found { conventions: profile.conventions, contradicting: vec![] },
            None => assignment::find(&questions, options),
        };
        found.contradicting.iter_mut().for_each(|(n, _)| *n = answered_questions[*n]);
        let marked = parallel::map(answers.len(), |n| {
            let answered = answered_questions.contains(&n);
            answered.then(|| marks(&exam.questions[n], &answers[n], &found.conventions, options))
        });
        Round { found, marked }
    }

    fn report(
        &self,
        exam: &Exam,
        answers: &[Answers],
        options: &MarkOptions,
        laid: &BTreeMap<usize, (Answers, String)>,
    ) -> Report {
        let c = &self.found.conventions;
        let mut report = Report::new(exam, c);
        // Forward explanations are suspects for the gradient of the same component.
        let mut suspects: BTreeMap<&str, Vec<Vec<&'static str>>> = BTreeMap::new();
        for (n, question) in exam.questions.iter().enumerate() {
            let Some((marks, grade)) = &self.marked[n] else {
                report.rows.push(Row::unsupported(question));
                continue;
            };
            let mut row = Row::marked(question, &answers[n], marks, *grade, c);
            row.layouts.extend(laid.get(&n).map(|(_, layout)| layout.clone()));
            if let Some((_, own)) = self.found.contradicting.iter().find(|(m, _)| *m == n) {
                row.contradiction = partial(question.component, own);
            }
            if row.verdict == Verdict::Fail && marks.budget_used > 1.0 {
                let known = suspects.get(question.component.name).map_or(&[][..], Vec::as_slice);
                row.diagnosis = diagnose(question, &answers[n], c, known, options);
                let sets = row.diagnosis.iter().map(names).filter(|set| !set.is_empty()).collect::<Vec<_>>();
                suspects.entry(question.component.name).or_default().extend(sets);
                if row.diagnosis.iter().all(|e| e.inaccurate || !e.unexplained.is_empty())
                    && row.faults.is_empty()
                {
                    imprecise(&mut row, exam, question, &answers[n], c, options);
                }
                if exam.profile.is_none() && row.verdict == Verdict::Fail {
                    nearest(&mut row, question, &answers[n], c, options);
                }
            }
            report.rows.push(row);
        }
        report.settle();
        report
    }
}

/// Where no mistake explains the answers: whether they are right but for lost digits, in the run's conventions or those next to them.
fn imprecise(
    row: &mut Row,
    exam: &Exam,
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) {
    if question.statistics() {
        return;
    }
    let c = if exam.profile.is_some() { *base } else { assignment::nearest(question, answers, base) };
    if let Some(bits) = lost_bits(question, answers, &c, options) {
        let marks = mark(question, answers, &c, options, Grade::B);
        *row = Row { layouts: row.layouts.clone(), ..Row::marked(question, answers, &marks, None, &c) };
        (row.verdict, row.lost_bits) = (Verdict::Imprecise, Some(bits));
        row.shown_in = difference(&partial(question.component, &c), &partial(question.component, base));
    }
}

/// Shows the expected values of a failing row in the conventions that it probably follows, where nothing else in the run shows them:
/// those of the best explanation, or those in which most elements agree. People compare with what they meant to write.
fn nearest(row: &mut Row, question: &Question, answers: &Answers, base: &Conventions, options: &MarkOptions) {
    let near = match row.diagnosis.first() {
        // Right in other conventions: it only disagrees with the rest of the run.
        Some(best) if best.mistakes.is_empty() => return,
        Some(best) => assignment::apply(&best.conventions, base),
        None => assignment::nearest(question, answers, base),
    };
    if question.statistics() || near == *base {
        return;
    }
    let marks = mark(question, answers, &near, options, Grade::B);
    if marks.budget_used > 1.0 {
        let shown = Row::marked(question, answers, &marks, None, &near);
        *row = Row { layouts: row.layouts.clone(), diagnosis: std::mem::take(&mut row.diagnosis), ..shown };
        row.shown_in = difference(&partial(question.component, &near), &partial(question.component, base));
    }
}

fn names(explanation: &Explanation) -> Vec<&'static str> {
    explanation.mistakes.iter().map(|mistake| mistake.name).collect()
}

/// Marks by the stable formula's bound, then by the textbook's where the two differ. The grade is null where they don't.
fn marks(
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
) -> (Marks, Option<Grade>) {
    if question.statistics() {
        return (statistics::mark(question, answers, c), None);
    }
    if !question.admits(c) {
        let fault = "its questions have the shapes of other conventions than the run's: pin the profile";
        return (Marks { faults: vec![fault.into()], ..Marks::default() }, None);
    }
    let graded = question.cases.iter().any(|case| {
        let direction = question.component.direction(question.kind).expect("a question has its direction");
        let bound = |grade| (direction.bound)(&case.inputs, c, &options.arithmetic(grade));
        bound(Grade::A) != bound(Grade::B)
    });
    // The wider bound first: what exceeds it exceeds the other too.
    let textbook = mark(question, answers, c, options, if graded { Grade::B } else { Grade::A });
    if !graded || !textbook.right() {
        return (textbook, None);
    }
    let stable = mark(question, answers, c, options, Grade::A);
    if stable.right() { (stable, Some(Grade::A)) } else { (textbook, Some(Grade::B)) }
}
