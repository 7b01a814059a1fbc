//! The large tier: real sizes, full precision. A candidate is asked whole cases; truth and bounds are computed block by block. Of a failure
//! the first rays or points that are off are cut out, and judged as a small case by everything that knows about small ones.

use std::collections::BTreeMap;

use self::blocks::{Marking, Whole, alone_is_right, blocks, merge};
use super::answer::{Answer, Answers, Reply};
use super::declared::Declared;
use super::exam::{Exam, Question};
use super::judging::{EXP_ULP, judge_answers};
use super::mark::{MarkOptions, Marks};
use super::partial::apply;
use super::report::{Report, Row, Verdict};
use crate::contract::arithmetic::{Dtype, Grade};
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::laid::Laid;
use crate::convention::Conventions;
use crate::convention::profiles::Profile;
use crate::error::{Error, Result};
use crate::parallel;
use crate::registry::all_rows;

mod blocks;
#[cfg(feature = "files")]
pub mod files;

/// Items at the head of a case, which the conventions of a run are found by.
const HEAD: usize = 8;

/// An exam whose questions are large cases.
#[derive(Clone, Debug)]
pub struct LargeExam {
    /// The rows that have such cases; the cases of its questions are names without inputs.
    pub exam: Exam,
    /// The cases of each question.
    pub laid: Vec<Vec<Laid>>,
}

/// What a candidate is asked.
#[derive(Clone, Copy, Debug)]
pub enum Asked<'a> {
    /// A large case.
    Whole(&'a Laid),
    /// A few items of one, by themselves.
    Alone(&'a Case),
}

impl LargeExam {
    /// The large cases of the components whose name or folder contains `filter`.
    ///
    /// # Errors
    /// A filter that no component with large cases matches.
    pub fn new(filter: &str, dtype: Dtype, profile: Option<&'static Profile>) -> Result<LargeExam> {
        LargeExam::asking(Exam::new(filter, dtype, profile)?)
    }

    /// Those of these rows alone, by their exact names.
    ///
    /// # Errors
    /// Rows of which none has large cases.
    pub fn of(rows: &[(&str, Kind)], dtype: Dtype, profile: Option<&'static Profile>) -> Result<LargeExam> {
        LargeExam::asking(Exam::of(rows, dtype, profile)?)
    }

    fn asking(mut exam: Exam) -> Result<LargeExam> {
        let (c, dtype, filter) = (exam.conventions(), exam.dtype, exam.filter.clone());
        let cases = |question: &Question| {
            let all = (question.component.special.large)().into_iter();
            let asked = all.filter(|large| large.types.contains(&dtype));
            asked.filter(|large| question.kind == Kind::Forward || !large.forward_only).collect::<Vec<_>>()
        };
        exam.questions.retain(|question| !cases(question).is_empty());
        exam.left_out.clear();
        let laid = parallel::map(exam.questions.len(), |n| {
            let question = &exam.questions[n];
            let laid = |large| Laid::new(question.component, question.kind, large, dtype, &c);
            cases(question).into_iter().map(laid).collect::<Vec<_>>()
        });
        for (question, laid) in exam.questions.iter_mut().zip(&laid) {
            question.cases = laid.iter().map(named).collect();
        }
        if exam.questions.is_empty() {
            let rows: Vec<&str> =
                all_rows().filter(|row| !(row.special.large)().is_empty()).map(|row| row.name).collect();
            return Err(Error::usage(
                "filter",
                filter,
                format!("a row with large cases: {}", rows.join(", ")),
            ));
        }
        Ok(LargeExam { exam, laid })
    }

    /// The same exam for a candidate that declares what it takes and returns.
    ///
    /// # Errors
    /// What is no row, input, output or case of this exam, in words.
    pub fn narrowed(mut self, declared: &BTreeMap<String, Declared>) -> Result<LargeExam, String> {
        // What is small is narrowed as it always is, with the first items of each case for its inputs.
        for (question, laid) in self.exam.questions.iter_mut().zip(&self.laid) {
            question.cases = laid.iter().map(|laid| laid.part(0..head(laid))).collect();
        }
        self.exam = self.exam.narrowed(declared)?;
        for (question, laid) in self.exam.questions.iter_mut().zip(&mut self.laid) {
            laid.retain(|laid| question.cases.iter().any(|case| case.id == laid.large.id));
            let returns = declared.get(&question.row()).and_then(|declared| declared.returns.as_ref());
            if let Some(returns) = returns.filter(|_| question.kind == Kind::Vjp) {
                laid.iter_mut()
                    .for_each(|laid| laid.without_cotangents(|name| returns.iter().any(|r| r == name)));
            }
            question.cases = laid.iter().map(named).collect();
        }
        Ok(self)
    }
}

/// A case that stands for a large one: its name.
fn named(laid: &Laid) -> Case {
    Case::new(laid.large.id, laid.large.comment, vec![])
}

fn head(laid: &Laid) -> usize {
    if laid.large.block == laid.large.items { laid.large.items } else { laid.large.items.min(HEAD) }
}

/// The exam of these cases, one or none for each large one, and their answers.
type Small = (Exam, Vec<Answers>);

/// A few items of a large case, with the answer to them.
type Pick = (Case, Option<Answer>);

/// Asks every large case twice and judges the answers: first for the conventions that the first items follow, then for the verdict, so
/// that no more than one case and its answer are in memory. Then the items that a failure is cut down to are asked alone, where that can
/// be asked.
///
/// # Errors
/// What `ask` ends the exam with.
pub fn examine<E>(
    mut large: LargeExam,
    exp_ulp: f64,
    mut ask: impl FnMut(&Question, Asked) -> Result<Reply, E>,
) -> Result<Report, E> {
    let heads =
        (0..large.laid.len()).map(|n| Heads::new(&mut large, n, &mut ask)).collect::<Result<Vec<_>, E>>()?;
    let picks: Vec<&Vec<Pick>> = heads.iter().map(|heads| &heads.picks).collect();
    let (exam, answers) = small(&large.exam, &picks);
    let options = MarkOptions { dtype: exam.dtype, exp_ulp };
    let mut report = judge_answers(&exam, &answers, exp_ulp);
    let mut sums = vec![];
    for (n, row) in report.rows.iter().enumerate() {
        let judged = ![Verdict::Unsupported, Verdict::Fail].contains(&row.verdict);
        sums.push(if judged {
            Sum::new(&large, n, row, &heads[n], &options, &mut ask)?
        } else {
            Sum::default()
        });
    }
    if sums.iter().any(|sum| !sum.cut.is_empty()) {
        let cut = |n: usize| if sums[n].cut.is_empty() { &heads[n].picks } else { &sums[n].cut };
        let (exam, answers) = small(&large.exam, &(0..sums.len()).map(cut).collect::<Vec<_>>());
        report = judge_answers(&exam, &answers, exp_ulp);
    }
    for (((row, sum), heads), question) in
        report.rows.iter_mut().zip(sums).zip(heads).zip(&large.exam.questions)
    {
        sum.settle(row, question, &heads.picks);
        (row.left_out, row.crashed) = (question.left_out.clone(), question.crashed.clone());
        if !heads.faults.is_empty() {
            row.verdict = Verdict::Fail;
            row.faults.extend(heads.faults);
        }
    }
    Ok(report)
}

/// What the first time of asking shows of a question.
struct Heads {
    /// The first items of each case.
    picks: Vec<Pick>,
    /// A fingerprint of each answer.
    bits: Vec<u64>,
    faults: Vec<String>,
}

impl Heads {
    fn new<E>(
        large: &mut LargeExam,
        n: usize,
        mut ask: impl FnMut(&Question, Asked) -> Result<Reply, E>,
    ) -> Result<Heads, E> {
        let (question, mut heads) =
            (&mut large.exam.questions[n], Heads { picks: vec![], bits: vec![], faults: vec![] });
        for laid in &large.laid[n] {
            let whole = match ask(question, Asked::Whole(laid))? {
                Reply::Answer(answer) => Some(Whole::new(laid, answer)),
                Reply::Nothing => None,
                Reply::Crash(said) => {
                    question.crashed.insert(laid.large.id.into(), said);
                    None
                }
            };
            let items = 0..head(laid);
            heads.picks.push((laid.part(items.clone()), whole.as_ref().map(|whole| whole.cut(laid, items))));
            heads.bits.push(whole.as_ref().map_or(0, Whole::bits));
            heads.faults.extend(whole.into_iter().flat_map(|whole| whole.faults));
        }
        Ok(heads)
    }
}

/// The exam of some items alone.
fn small(exam: &Exam, picks: &[&Vec<Pick>]) -> Small {
    let mut exam = exam.clone();
    for (question, picks) in exam.questions.iter_mut().zip(picks) {
        question.cases = picks.iter().map(|(case, _)| case.clone()).collect();
    }
    let answers =
        picks.iter().map(|picks| picks.iter().map(|(_, answer)| answer.clone()).collect()).collect();
    (exam, answers)
}

/// What whole cases of a question showed.
#[derive(Default)]
struct Sum {
    c: Conventions,
    /// `None` where nothing was judged.
    marks: Option<Marks>,
    grade: Option<Grade>,
    /// Whether another time of asking got other bits.
    changed: bool,
    /// What each failing case was cut down to.
    cut: Vec<Pick>,
    observed: Vec<String>,
}

impl Sum {
    /// Asks a question's cases once more, and marks all of them in the conventions of their first items.
    fn new<E>(
        large: &LargeExam,
        n: usize,
        row: &Row,
        heads: &Heads,
        options: &MarkOptions,
        mut ask: impl FnMut(&Question, Asked) -> Result<Reply, E>,
    ) -> Result<Sum, E> {
        let question = &large.exam.questions[n];
        let mut sum = Sum { c: apply(&row.conventions, &large.exam.conventions()), ..Sum::default() };
        for (laid, bits) in large.laid[n].iter().zip(&heads.bits) {
            let Reply::Answer(answer) = ask(question, Asked::Whole(laid))? else { continue };
            let whole = Whole::new(laid, answer);
            sum.changed |= whole.bits() != *bits;
            let (arranged, graded) = (!row.layouts.is_empty(), row.grade.is_some());
            let marking = Marking { conventions: &sum.c, arranged, graded, options };
            let seen = blocks(question, laid, &whole, &marking);
            if let Some(items) = &seen.first {
                let case = laid.part(items.clone());
                let alone = ask(question, Asked::Alone(&case))?;
                sum.observed.push(seen.told(laid, alone_is_right(question, &case, alone, &sum.c, options)));
                sum.cut.push((case, Some(whole.cut(laid, items.clone()))));
            }
            sum.grade = sum.grade.max(seen.grade);
            let first = sum.marks.is_none();
            merge(sum.marks.get_or_insert_default(), seen.marks, first);
        }
        Ok(sum)
    }

    /// Puts what was seen of whole cases into the row of the few items that it was cut down to.
    fn settle(self, row: &mut Row, question: &Question, picks: &[Pick]) {
        let Some(marks) = self.marks else { return };
        let answers: Answers = picks.iter().map(|(_, answer)| answer.clone()).collect();
        let whole = Row::marked(question, &answers, &marks, self.grade, &self.c);
        if whole.verdict == Verdict::Fail {
            // What the few show is a part of it: the verdict may be `imprecise`, but never better.
            if row.verdict != Verdict::Imprecise {
                row.verdict = Verdict::Fail;
            }
            (row.cases, row.answered, row.vacuous) = (whole.cases, whole.answered, whole.vacuous);
            (row.budget_used, row.worst_case) = (whole.budget_used, whole.worst_case);
            row.observed.splice(0..0, self.observed);
        } else if row.verdict != Verdict::Imprecise {
            let (layouts, findings) = (std::mem::take(&mut row.layouts), std::mem::take(&mut row.findings));
            *row = Row { layouts, findings, ..whole };
        }
        if self.changed {
            row.findings.push("not deterministic: asked twice, it answers with other bits".into());
        }
    }
}

/// Judges a candidate's large cases in process; see [`examine`].
///
/// # Errors
/// What `ask` ends the exam with.
pub fn examine_in_process<E>(
    large: LargeExam,
    mut ask: impl FnMut(&Question, &Case) -> Result<Reply, E>,
) -> Result<Report, E> {
    examine(large, EXP_ULP, |question, asked| match asked {
        Asked::Whole(laid) => ask(question, &laid.whole()),
        Asked::Alone(case) => ask(question, case),
    })
}
