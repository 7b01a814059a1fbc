//! The large tier: real sizes, full precision. A candidate is asked whole cases; truth and bounds are computed block by block. Of a failure
//! the first rays or points that are off are cut out, and judged as a small case by everything that knows about small ones.

use std::collections::BTreeMap;
use std::ops::Range;

use super::answer::{Answer, Answers, Given, reshaped};
use super::asking::Reply;
use super::assignment::apply;
use super::declared::Declared;
use super::exam::{Exam, Question};
use super::judging::{EXP_ULP, judge_answers, marks};
use super::layout;
use super::mark::{MarkOptions, Marks};
use super::report::{Report, Row, Verdict};
use crate::contract::arithmetic::{Dtype, Grade};
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::large::Laid;
use crate::convention::Conventions;
use crate::convention::profiles::Profile;
use crate::error::{Error, Result};
use crate::parallel;
use crate::registry::all_rows;

#[cfg(feature = "files")]
pub mod files;

/// Items at the head of a case, which the conventions of a run are found by.
const HEAD: usize = 24;

/// Items that a failure is cut down to.
const CUT: usize = 3;

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

/// A question of some items alone.
fn question_of(question: &Question, case: Case) -> Question {
    let (left_out, crashed) = Default::default();
    Question { component: question.component, kind: question.kind, cases: vec![case], left_out, crashed }
}

/// The exam of these cases, one or none for each large one, and their answers.
type Small = (Exam, Vec<Answers>);

/// An answer to a large case: its arrays are as long as the case is.
struct Whole {
    answer: Answer,
    faults: Vec<String>,
}

impl Whole {
    fn new(laid: &Laid, answer: Answer) -> Whole {
        let mut whole = Whole { answer: Answer::new(), faults: vec![] };
        for (name, given) in answer {
            let Some((_, expected)) = laid.outputs.iter().find(|(output, _)| *output == name) else {
                continue;
            };
            if laid.fits(&name, &given.values) && given.values.ndim() == expected.len() {
                whole.answer.insert(name, given);
            } else if let Some((values, _)) = reshaped(&given.values, expected) {
                whole.answer.insert(name, Given { values, ..given });
            } else {
                let found = given.values.shape();
                whole
                    .faults
                    .push(format!("{}: {name}: wrong shape {found:?}, expected {expected:?}", laid.large.id));
            }
        }
        whole
    }

    fn cut(&self, laid: &Laid, items: Range<usize>) -> Answer {
        let one = |(name, given): (&String, &Given)| {
            (name.clone(), Given { values: laid.cut(name, &given.values, items.clone()), dtype: given.dtype })
        };
        self.answer.iter().map(one).collect()
    }

    /// A fingerprint of all bits.
    fn bits(&self) -> u64 {
        let all = self.answer.values().flat_map(|given| given.values.iter());
        all.fold(0xcbf2_9ce4_8422_2325, |hash, x| (hash ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3))
    }
}

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
    let (mut picks, mut bits, mut faults) = (vec![], vec![], vec![]);
    for (question, laid) in large.exam.questions.iter_mut().zip(&large.laid) {
        let (mut small, mut prints, mut wrong): (Vec<(Case, Option<Answer>)>, Vec<u64>, Vec<String>) =
            Default::default();
        for laid in laid {
            let whole = match ask(question, Asked::Whole(laid))? {
                Reply::Answer(answer) => Some(Whole::new(laid, answer)),
                Reply::Nothing => None,
                Reply::Crash(said) => {
                    question.crashed.insert(laid.large.id.into(), said);
                    None
                }
            };
            let items = 0..head(laid);
            small.push((laid.part(items.clone()), whole.as_ref().map(|whole| whole.cut(laid, items))));
            prints.push(whole.as_ref().map_or(0, Whole::bits));
            wrong.extend(whole.into_iter().flat_map(|whole| whole.faults));
        }
        picks.push(small);
        bits.push(prints);
        faults.push(wrong);
    }
    let (exam, answers) = small(&large.exam, &picks);
    let mut report = judge_answers(&exam, &answers, exp_ulp);
    let options = MarkOptions { dtype: exam.dtype, exp_ulp };
    let mut marked = vec![];
    for (n, question) in large.exam.questions.iter().enumerate() {
        let row = &report.rows[n];
        if row.verdict == Verdict::Unsupported || row.verdict == Verdict::Fail {
            marked.push(None);
            continue;
        }
        let c = apply(&row.conventions, &exam.conventions());
        let mut sum = Sum { c, ..Sum::default() };
        for (k, laid) in large.laid[n].iter().enumerate() {
            let Reply::Answer(answer) = ask(question, Asked::Whole(laid))? else { continue };
            let whole = Whole::new(laid, answer);
            sum.changed |= whole.bits() != bits[n][k];
            let seen = blocks(question, laid, &whole, &sum.c, !row.layouts.is_empty(), &options);
            if let Some(items) = &seen.first {
                let case = laid.part(items.clone());
                let alone = ask(question, Asked::Alone(&case))?;
                sum.observed.push(seen.told(laid, alone_is_right(question, &case, alone, &sum.c, &options)));
                picks[n][k] = (case, Some(whole.cut(laid, items.clone())));
            }
            sum.add(laid, seen);
        }
        marked.push(Some(sum));
    }
    if marked.iter().flatten().any(|sum| !sum.marks.right()) {
        let (exam, answers) = small(&large.exam, &picks);
        report = judge_answers(&exam, &answers, exp_ulp);
    }
    for (n, sum) in marked.into_iter().enumerate() {
        let row = &mut report.rows[n];
        if let Some(sum) = sum {
            sum.settle(row, &large.exam.questions[n], &picks[n]);
        }
        (row.left_out, row.crashed) =
            (large.exam.questions[n].left_out.clone(), large.exam.questions[n].crashed.clone());
        if !faults[n].is_empty() {
            row.verdict = Verdict::Fail;
            row.faults.append(&mut faults[n]);
        }
    }
    Ok(report)
}

/// The exam of some items alone.
fn small(exam: &Exam, picks: &[Vec<(Case, Option<Answer>)>]) -> Small {
    let mut exam = exam.clone();
    for (question, picks) in exam.questions.iter_mut().zip(picks) {
        question.cases = picks.iter().map(|(case, _)| case.clone()).collect();
    }
    let answers =
        picks.iter().map(|picks| picks.iter().map(|(_, answer)| answer.clone()).collect()).collect();
    (exam, answers)
}

/// What the blocks of one case showed.
struct Seen {
    marks: Marks,
    grade: Option<Grade>,
    /// The first items that are off.
    first: Option<Range<usize>>,
    blocks: usize,
    off: usize,
}

/// Marks a case block by block.
fn blocks(
    question: &Question,
    laid: &Laid,
    whole: &Whole,
    c: &Conventions,
    arranged: bool,
    options: &MarkOptions,
) -> Seen {
    let mark = |items: Range<usize>| {
        let (alone, mut answers) =
            (question_of(question, laid.part(items.clone())), vec![Some(whole.cut(laid, items))]);
        let (marks, grade) = marks(&alone, &answers, c, options);
        if marks.right() || !arranged {
            return (marks, grade);
        }
        // In the layout that the first items have, too.
        if let Some((laid, _)) = layout::normalized(&alone, &answers, c, true, options) {
            answers = laid;
        }
        self::marks(&alone, &answers, c, options)
    };
    let ranges = laid.blocks();
    let marked = parallel::map(ranges.len(), |n| mark(ranges[n].clone()));
    let off: Vec<usize> = (0..ranges.len()).filter(|&n| !marked[n].0.right()).collect();
    let first = off.first().map(|&n| {
        let block = ranges[n].clone();
        let one = block
            .clone()
            .find(|&item| laid.large.block < laid.large.items && !mark(item..item + 1).0.right());
        one.map_or(block.clone(), |item| item..block.end.min(item + CUT))
    });
    let (blocks, off) = (ranges.len(), off.len());
    let mut sum = Seen { marks: Marks::default(), grade: None, first, blocks, off };
    for (n, (marks, grade)) in marked.into_iter().enumerate() {
        sum.grade = sum.grade.max(grade);
        merge(&mut sum.marks, shifted(marks, laid, ranges[n].start), n == 0);
    }
    sum
}

/// Marks whose worst element lies where it does in the whole case.
fn shifted(mut marks: Marks, laid: &Laid, first: usize) -> Marks {
    if let Some(worst) = marks.worst.as_mut().filter(|worst| !worst.index.is_empty()) {
        worst.index[0] += laid.shift(&worst.output, first);
    }
    marks
}

/// Adds the marks of more items. What is proved by some is proved.
fn merge(sum: &mut Marks, more: Marks, first: bool) {
    if sum.worst.is_none() || more.budget_used > sum.budget_used {
        sum.worst = more.worst.or(sum.worst.take());
    }
    sum.budget_used = sum.budget_used.max(more.budget_used);
    sum.vacuous += more.vacuous;
    if first {
        sum.unproved = more.unproved;
    } else {
        sum.unproved.retain(|name| more.unproved.contains(name));
    }
    for fault in more.faults {
        if !sum.faults.contains(&fault) {
            sum.faults.push(fault);
        }
    }
    sum.missing.extend(more.missing);
    sum.layouts.extend(more.layouts);
    sum.off.extend(more.off.into_iter().filter(|_| sum.off.is_empty()).collect::<Vec<_>>());
}

impl Seen {
    fn told(&self, laid: &Laid, alone: Option<bool>) -> String {
        let first = self.first.as_ref().map_or(0, |items| items.start);
        let (Seen { blocks, off, .. }, large) = (self, &laid.large);
        let alone = match alone {
            Some(true) => "; the same few, asked alone, are right: the fault comes with the size",
            Some(false) => "; so they are when asked alone",
            None => "",
        };
        format!(
            "{}: number {first} of {} is the first that is off, and {off} of {blocks} blocks are{alone}",
            large.id, large.items
        )
    }
}

/// Whether the items that a failure was cut down to are right when they are asked alone; `None` where they weren't answered.
fn alone_is_right(
    question: &Question,
    case: &Case,
    reply: Reply,
    c: &Conventions,
    options: &MarkOptions,
) -> Option<bool> {
    let Reply::Answer(answer) = reply else { return None };
    Some(marks(&question_of(question, case.clone()), &vec![Some(answer)], c, options).0.right())
}

/// The marks of all cases of a question.
#[derive(Default)]
struct Sum {
    c: Conventions,
    marks: Marks,
    grade: Option<Grade>,
    cases: usize,
    changed: bool,
    observed: Vec<String>,
}

impl Sum {
    fn add(&mut self, _: &Laid, seen: Seen) {
        self.grade = self.grade.max(seen.grade);
        merge(&mut self.marks, seen.marks, self.cases == 0);
        self.cases += 1;
    }

    /// Puts what was seen of whole cases into the row of the few items that it was cut down to.
    fn settle(self, row: &mut Row, question: &Question, picks: &[(Case, Option<Answer>)]) {
        let answers: Answers = picks.iter().map(|(_, answer)| answer.clone()).collect();
        let whole = Row::marked(question, &answers, &self.marks, self.grade, &self.c);
        if whole.verdict == Verdict::Fail {
            // What the few show is a part of it: the verdict may be `imprecise`, but never better.
            if row.verdict != Verdict::Imprecise {
                row.verdict = Verdict::Fail;
            }
            (row.budget_used, row.vacuous, row.worst_case) =
                (whole.budget_used, whole.vacuous, whole.worst_case);
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
