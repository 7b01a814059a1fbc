//! A round of judging: answers marked in the conventions of the run, and what explains those that are wrong.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::answer::Answers;
use super::assignment::{self, Found};
use super::best::best_honest;
use super::diagnosis::diagnose::{diagnose, diagnose_in};
use super::diagnosis::evidence::{Explanation, Suspect, difference};
use super::diagnosis::follows::{follows, follows_but_for_zeros, follows_usually};
use super::diagnosis::imprecise::{bits_beside, lost_bits};
use super::diagnosis::refuted::refuted;
use super::diagnosis::slips::misdone::slips_alone;
use super::exam::{Exam, Question};
use super::example::smallest;
use super::known::Known;
use super::layout::Orders;
use super::mark::{MarkOptions, Marks, mark};
use super::observed::observed;
use super::partial::{apply, partial, read};
use super::report::{Report, Row, Verdict};
use super::{layout, statistics};
use crate::contract::arithmetic::Grade;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::convention::Conventions;
use crate::parallel;

/// Marked answers, in the contract's layout where another explains a failure.
pub(super) struct Laid {
    round: Round,
    answers: Vec<Answers>,
    /// What was changed, by question.
    layouts: BTreeMap<usize, String>,
    /// Orders of columns that were found, by component.
    orders: BTreeMap<&'static str, Orders>,
    /// What is known of the answers as they came.
    known: Vec<Arc<Known>>,
}

impl Laid {
    pub(super) fn new(
        exam: &Exam,
        answers: &[Answers],
        known: Vec<Arc<Known>>,
        options: &MarkOptions,
    ) -> Laid {
        let first = Round::new(exam, answers, &known, options);
        // A failure may be due to the layout alone: then it is judged again in the contract's layout.
        let failing = |n: &usize| first.marked[*n].as_ref().is_some_and(|(marks, _)| marks.budget_used > 1.0);
        let failing: Vec<usize> = (0..answers.len()).filter(|n| failing(n)).collect();
        let base = first.found.conventions;
        let laid = parallel::map(failing.len(), |n| {
            let (question, answers) = (&exam.questions[failing[n]], &answers[failing[n]]);
            layout::normalized(question, answers, &base, exam.profile.is_some(), options)
        });
        let (mut answers, mut now) = (answers.to_vec(), known.clone());
        let (mut layouts, mut orders) = (BTreeMap::new(), BTreeMap::new());
        for (n, laid) in failing.into_iter().zip(laid) {
            if let Some(laid) = laid {
                (answers[n], now[n]) = (laid.answers, Arc::default());
                layouts.insert(n, laid.says);
                orders.extend(laid.orders.map(|orders| (exam.questions[n].component.name, orders)));
            }
        }
        let round = if layouts.is_empty() { first } else { Round::new(exam, &answers, &now, options) };
        Laid { round, answers, layouts, orders, known }
    }

    /// The exam with those gradients asked in the order of columns that the same component's forward answers have of which more cases are
    /// right then, or which are wrong as those are and no worse then, and the answers to that, marked; `None` where there are none.
    pub(super) fn in_their_order(
        &self,
        exam: &Exam,
        answers: &[Answers],
        options: &MarkOptions,
    ) -> Option<(Exam, Vec<Answers>, Laid)> {
        if self.orders.is_empty() {
            return None;
        }
        let (mut ordered, mut answers, mut changed) = (exam.clone(), answers.to_vec(), vec![]);
        for (n, question) in ordered.questions.iter_mut().enumerate() {
            question.truths = exam.questions[n].truths.shared();
            let orders = self.orders.get(question.component.name).filter(|_| question.kind == Kind::Vjp);
            let Some((orders, found)) = orders.zip(self.marks(n)) else { continue };
            let (asked, left) = layout::asked_in(question, &answers[n], orders);
            let right = |question: &Question, marks: &Marks| question.cases.len() - marks.wrong_cases.len();
            let (marks, _) = marks(&asked, &left, self.conventions(), options);
            let wrong = |n: usize| self.marks(n).is_some_and(|marks| marks.budget_used > 1.0);
            let both_wrong = wrong(n) && forward_of(&exam.questions, n).is_some_and(wrong);
            let no_worse = marks.wrong_cases.len() <= found.wrong_cases.len();
            if both_wrong && no_worse || right(&asked, &marks) > right(question, found) {
                (*question, answers[n]) = (asked, left);
                changed.push(n);
            }
        }
        if changed.is_empty() {
            return None;
        }
        let mut laid = Laid::new(&ordered, &answers, self.known_but_of(&changed), options);
        for n in changed {
            let says = "asked for columns in the order of the forward answers";
            laid.layouts.insert(n, says.into());
        }
        Some((ordered, answers, laid))
    }

    /// What is known of the answers as they came, but for those to some questions.
    pub(super) fn known_but_of(&self, some: &[usize]) -> Vec<Arc<Known>> {
        let of = |(n, known): (usize, &Arc<Known>)| {
            if some.contains(&n) { Arc::default() } else { known.clone() }
        };
        self.known.iter().enumerate().map(of).collect()
    }

    /// What marking found of a question; `None` where nothing was answered.
    pub(super) fn marks(&self, n: usize) -> Option<&Marks> {
        self.round.marked[n].as_ref().map(|(marks, _)| marks)
    }

    /// The answers to a question, as they are laid now.
    pub(super) fn answers(&self, n: usize) -> &Answers {
        &self.answers[n]
    }

    /// The run's conventions.
    pub(super) fn conventions(&self) -> &Conventions {
        &self.round.found.conventions
    }

    pub(super) fn report(&self, exam: &Exam, options: &MarkOptions) -> Report {
        self.round.report(exam, &self.answers, options, &self.layouts)
    }
}

/// Answers marked in the conventions of the run.
struct Round {
    found: Found,
    /// Marks of each question; `None` where nothing was answered.
    marked: Vec<Option<(Marks, Option<Grade>)>>,
}

impl Round {
    fn new(exam: &Exam, answers: &[Answers], known: &[Arc<Known>], options: &MarkOptions) -> Round {
        // A row that crashed on every case has an answer: that.
        let crashed = |n: usize| !exam.questions[n].crashed.is_empty();
        let answered = |n: &usize| answers[*n].iter().any(Option::is_some) || crashed(*n);
        let answered_questions: Vec<usize> = (0..answers.len()).filter(answered).collect();
        let asked = |&n: &usize| (&exam.questions[n], &answers[n], &*known[n]);
        let questions: Vec<assignment::Asked> = answered_questions.iter().map(asked).collect();
        let mut found = match exam.profile {
            Some(profile) => Found { conventions: profile.conventions, contradicting: vec![] },
            None => assignment::find(&questions, options),
        };
        found.contradicting.iter_mut().for_each(|(n, _)| *n = answered_questions[*n]);
        let marked = parallel::map(answers.len(), |n| {
            let answered = answered_questions.contains(&n);
            let question = &exam.questions[n];
            let marks = |c: &Conventions| marks(question, &answers[n], c, options);
            answered.then(|| known[n].marks(read(question.component, &found.conventions), marks))
        });
        Round { found, marked }
    }

    /// What is known of a row without asking what is wrong in it; `None` where nothing was answered.
    fn row(
        &self,
        question: &Question,
        n: usize,
        answers: &Answers,
        options: &MarkOptions,
    ) -> Option<(Row, &Marks)> {
        let c = &self.found.conventions;
        let (marks, grade) = self.marked[n].as_ref()?;
        let mut row = Row::marked(question, answers, marks, *grade, c);
        if row.verdict == Verdict::Pass {
            row.honest_used = best_honest(question, answers, c, options, grade.unwrap_or(Grade::A));
        }
        Some((row, marks))
    }

    fn report(
        &self,
        exam: &Exam,
        answers: &[Answers],
        options: &MarkOptions,
        layouts: &BTreeMap<usize, String>,
    ) -> Report {
        let c = &self.found.conventions;
        let mut report = Report::new(exam, c);
        // Forward explanations are suspects for the gradient of the same component.
        let mut suspects: BTreeMap<&str, Vec<Suspect>> = BTreeMap::new();
        // So does what else they showed: the conventions next to them, which the run's needn't have where nothing right shows them,
        // and a slip.
        let mut beside: BTreeMap<&str, Explanation> = BTreeMap::new();
        let rows =
            parallel::map(exam.questions.len(), |n| self.row(&exam.questions[n], n, &answers[n], options));
        for (n, (question, row)) in exam.questions.iter().zip(rows).enumerate() {
            let Some((mut row, marks)) = row else {
                report.rows.push(Row::unsupported(question));
                continue;
            };
            row.layouts.extend(layouts.get(&n).cloned());
            if exam.profile.is_none() && !question.admits(c) {
                row.verdict = Verdict::Unproved;
            }
            if let Some((_, own)) = self.found.contradicting.iter().find(|(m, _)| *m == n) {
                row.contradiction = partial(question.component, own);
            }
            if row.verdict == Verdict::Fail && marks.budget_used > 1.0 {
                let known = suspects.get(question.component.name).map_or(&[][..], Vec::as_slice);
                row.diagnosis = match beside.get(question.component.name) {
                    Some(forward) => diagnose_beside(question, &answers[n], (c, forward), known, options),
                    None => diagnose(question, &answers[n], c, known, options),
                };
                // Where a mistake explains them, too, a few bits must be enough.
                let most = row.diagnosis.iter().map(bits_beside).min().unwrap_or(i32::MAX);
                if let Some(forward) = forward_of(&exam.questions, n).filter(|m| *m < n) {
                    let asked = (&exam.questions[forward], &answers[forward]);
                    let named = !row.diagnosis.is_empty();
                    refuted(&mut row.diagnosis, &report.rows[forward], asked, c, options);
                    if named && row.diagnosis.is_empty() {
                        row.diagnosis = slips_alone(question, &answers[n], c, options);
                    }
                }
                if let Some(best) = row.diagnosis.first().filter(|e| e.unexplained.is_empty() && e.wrong()) {
                    beside.insert(question.component.name, best.clone());
                }
                let sets =
                    row.diagnosis.iter().map(suspect).filter(|(set, _)| !set.is_empty()).collect::<Vec<_>>();
                suspects.entry(question.component.name).or_default().extend(sets);
                // Other conventions are no matter of digits.
                let conventions =
                    row.diagnosis.first().is_some_and(|e| !e.wrong() && !e.inaccurate && e.whole());
                if row.faults.is_empty() && !conventions {
                    imprecise(&mut row, exam, question, &answers[n], c, options, most);
                }
                if exam.profile.is_none() && row.verdict == Verdict::Fail {
                    nearest(&mut row, question, &answers[n], c, options);
                }
                if row.verdict == Verdict::Fail && !question.statistics() {
                    let shown_in = apply(&row.shown_in, c);
                    row.example = smallest(question, &answers[n], &shown_in, options);
                    if row.diagnosis.iter().all(|e| !e.whole()) {
                        row.observed = observed(question, &answers[n], &shown_in, options);
                    }
                }
            }
            report.rows.push(row);
        }
        report.settle();
        report
    }
}

/// The question whose gradient question n asks for.
fn forward_of(questions: &[Question], n: usize) -> Option<usize> {
    let forward = |q: &Question| q.kind == Kind::Forward && q.component.name == questions[n].component.name;
    if questions[n].kind == Kind::Vjp { questions.iter().position(forward) } else { None }
}

/// The diagnosis of a gradient beside what the forward answers showed: their slip, or their conventions, where these explain it. What was
/// found but for some cases comes last.
fn diagnose_beside(
    question: &Question,
    answers: &Answers,
    (base, forward): (&Conventions, &Explanation),
    suspects: &[Suspect],
    options: &MarkOptions,
) -> Vec<Explanation> {
    let home = apply(&forward.conventions, base);
    let followed = follows(question, answers, base, (forward, &home), options);
    let whole = |found: &[Explanation]| found.first().is_some_and(Explanation::whole);
    if whole(&followed) {
        return followed;
    }
    let of = |c: &Conventions| partial(question.component, c);
    let mut found = diagnose_in(question, answers, (&home, true), suspects, options);
    if whole(&found) {
        for e in &mut found {
            e.conventions = difference(&of(&apply(&e.conventions, &home)), &of(base));
        }
    } else if home != *base {
        found = diagnose(question, answers, base, suspects, options);
    }
    if whole(&found) {
        return found;
    }
    if !followed.is_empty() {
        return followed;
    }
    let in_part = [follows_usually, follows_but_for_zeros].into_iter();
    let mut in_part = in_part.map(|follows| follows(question, answers, base, (forward, &home), options));
    in_part.find(|followed| !followed.is_empty()).unwrap_or(found)
}

/// Whether the answers are right but for lost bits (`most` of them), in the run's conventions or those next to them.
fn imprecise(
    row: &mut Row,
    exam: &Exam,
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
    most: i32,
) {
    if question.statistics() {
        return;
    }
    let c =
        if exam.profile.is_some() { *base } else { assignment::nearest(question, answers, base, options) };
    if let Some(bits) = lost_bits(question, answers, &c, options).filter(|bits| *bits <= most) {
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
        Some(best) if !best.wrong() && best.whole() => return,
        Some(best) => apply(&best.conventions, base),
        None => assignment::nearest(question, answers, base, options),
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

fn suspect(explanation: &Explanation) -> Suspect {
    (explanation.mistakes.iter().map(|mistake| mistake.name).collect(), explanation.fitted.clone())
}

/// Marks by the stable formula's bound, then by the textbook's where the two differ. The grade is null where they don't.
pub(super) fn marks(
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
) -> (Marks, Option<Grade>) {
    if question.statistics() {
        return (statistics::mark(question, answers, c), None);
    }
    if !question.admits(c) {
        let fault = "not judged: it was asked in the shapes of cs180, and the answers follow other conventions; where a profile has \
                     these, pin it (`profile`)";
        return (Marks { faults: vec![fault.into()], ..Marks::default() }, None);
    }
    let truth = |case: &Case, grade| options.truth(question, case, c, grade);
    let differ = parallel::map(question.cases.len(), |n| {
        let case = &question.cases[n];
        truth(case, Grade::A).bound != truth(case, Grade::B).bound
    });
    let graded: Vec<&Case> =
        question.cases.iter().zip(differ).filter(|(_, differ)| *differ).map(|(case, _)| case).collect();
    // The wider bound first: what exceeds it exceeds the other too.
    let textbook = mark(question, answers, c, options, if graded.is_empty() { Grade::A } else { Grade::B });
    if graded.is_empty() || !textbook.right() {
        return (textbook, None);
    }
    let stable = mark(question, answers, c, options, Grade::A);
    let held = |id: &String| if stable.wrong_cases.contains(id) { Grade::B } else { Grade::A };
    let grades = graded.into_iter().map(|case| (case.id.clone(), held(&case.id))).collect();
    let (marks, grade) = if stable.right() { (stable, Grade::A) } else { (textbook, Grade::B) };
    (Marks { grades, ..marks }, Some(grade))
}
