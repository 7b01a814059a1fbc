//! What the judge found: rows for machines, a page for people.

use std::collections::BTreeMap;
use std::fmt;

use serde_json::{Value, json};

use super::answer::Answers;
use super::diagnosis::evidence::Explanation;
use super::diagnosis::slips::slip::Slip;
use super::exam::{Exam, Question};
use super::example::Example;
use super::mark::{Marks, Worst};
use super::partial::{Partial, partial};
use crate::contract::arithmetic::Grade;
use crate::convention::profiles;
use crate::convention::{CHOICES, Conventions};

/// The schema of `judge --json`: fields are added under the same name, and another name is given where one changes.
pub const SCHEMA: &str = "nerf-oracle/report/1";

/// The verdict on a component in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every answer is within its bound.
    Pass,
    /// Something isn't.
    Fail,
    /// Every answer is within its bound, but some output has no element that proves it.
    Unproved,
    /// The right formula, with more digits lost than its arithmetic costs.
    Imprecise,
    /// Right and proved in all cases but those that few programs ever meet: no samples, one sample, an infinite density.
    Edge,
    /// Nothing was answered.
    Unsupported,
}

impl Verdict {
    /// Whether something was answered, and nothing that matters was wrong so far.
    pub(crate) fn open(self) -> bool {
        matches!(self, Verdict::Pass | Verdict::Unproved | Verdict::Imprecise | Verdict::Edge)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Verdict::Pass => "pass",
            Verdict::Fail => "fail",
            Verdict::Unproved => "unproved",
            Verdict::Imprecise => "imprecise",
            Verdict::Edge => "edge",
            Verdict::Unsupported => "unsupported",
        })
    }
}

/// One component in one direction.
#[derive(Clone, Debug)]
pub struct Row {
    /// Component.
    pub name: &'static str,
    /// `forward`, `vjp`, `trace` or `statistics`.
    pub kind: &'static str,
    /// Cases asked.
    pub cases: usize,
    /// Cases answered.
    pub answered: usize,
    /// The verdict.
    pub verdict: Verdict,
    /// Which formula's bound held, where two differ.
    pub grade: Option<Grade>,
    /// The same of each case of which two differ, where the row is right.
    pub grades: BTreeMap<String, Grade>,
    /// Largest error over bound.
    pub budget_used: Option<f64>,
    /// Largest error over bound of the best honest form, asked the same, where the row passes.
    pub honest_used: Option<f64>,
    /// Elements that prove nothing.
    pub vacuous: usize,
    /// Answered outputs that no element proves.
    pub unproved: Vec<String>,
    /// Bits that an imprecise row lost.
    pub lost_bits: Option<i32>,
    /// Outputs without an answer.
    pub missing_outputs: Vec<String>,
    /// The element that used most.
    pub worst_case: Option<Worst>,
    /// The component's conventions, as pinned or found.
    pub conventions: Partial,
    /// Where those are not the run's: the conventions nearest to the answers, in which a failing row is shown.
    pub shown_in: Partial,
    /// The conventions in which it would be right, though the rest of the run isn't.
    pub contradiction: Partial,
    /// Layouts that differ from the contract's, and pass.
    pub layouts: Vec<String>,
    /// Faults of the answers themselves.
    pub faults: Vec<String>,
    /// Cases that need more inputs than the candidate takes, with those inputs.
    pub left_out: BTreeMap<String, String>,
    /// Cases on which it crashed, with what it said.
    pub crashed: BTreeMap<String, String>,
    /// What the wrong cases of an `edge` row are, case by case: no samples, one sample, a pose that isn't rigid.
    pub edge_cases: Vec<&'static str>,
    /// The outputs that are off, in the order in which they are computed.
    pub off: Vec<String>,
    /// The cases of which something is wrong; of statistics, which take all cases together, none.
    pub wrong_cases: Vec<String>,
    /// The smallest case that is wrong.
    pub example: Option<Example>,
    /// What is known of a failure that nothing explains, output by output.
    pub observed: Vec<String>,
    /// Choices that no convention names and that are no mistake; they pass.
    pub findings: Vec<String>,
    /// Explanations, best first; empty if unknown.
    pub diagnosis: Vec<Explanation>,
}

impl Row {
    /// Why a row that is within its bounds isn't proved.
    pub(crate) fn unproved_for(&self) -> String {
        match self.faults.first().filter(|_| self.unproved.is_empty()) {
            Some(fault) => fault.clone(),
            None => format!(
                "every number is within its bound, but 0 would be too, in every element of {}",
                self.unproved.join(", ")
            ),
        }
    }

    /// Nothing was answered.
    pub fn unsupported(question: &Question) -> Row {
        Row {
            name: question.component.name,
            kind: question.kind_name(),
            cases: question.cases.len(),
            answered: 0,
            verdict: Verdict::Unsupported,
            grade: None,
            grades: BTreeMap::new(),
            budget_used: None,
            honest_used: None,
            vacuous: 0,
            unproved: vec![],
            lost_bits: None,
            missing_outputs: vec![],
            worst_case: None,
            conventions: Partial::new(),
            shown_in: Partial::new(),
            contradiction: Partial::new(),
            layouts: vec![],
            faults: vec![],
            left_out: question.left_out.clone(),
            crashed: question.crashed.clone(),
            edge_cases: vec![],
            off: vec![],
            wrong_cases: vec![],
            example: None,
            observed: vec![],
            findings: vec![],
            diagnosis: vec![],
        }
    }

    /// A question with its marks.
    pub fn marked(
        question: &Question,
        answers: &Answers,
        marks: &Marks,
        grade: Option<Grade>,
        c: &Conventions,
    ) -> Row {
        Row {
            answered: answers.iter().flatten().count(),
            verdict: match (marks.right(), marks.unproved.is_empty()) {
                (true, true) => Verdict::Pass,
                (true, false) => Verdict::Unproved,
                (false, _) => Verdict::Fail,
            },
            grade,
            grades: marks.grades.clone(),
            budget_used: Some(marks.budget_used),
            vacuous: marks.vacuous,
            unproved: marks.unproved.iter().cloned().collect(),
            missing_outputs: marks.missing.iter().cloned().collect(),
            worst_case: marks.worst.clone(),
            conventions: partial(question.component, c),
            layouts: marks.layouts.iter().cloned().collect(),
            faults: marks.faults.clone(),
            off: marks.off.clone(),
            wrong_cases: marks.wrong_cases.clone(),
            findings: marks.findings.clone(),
            ..Row::unsupported(question)
        }
    }

    /// How many times the largest error of the best of four honest machines the largest error is, both in units of what is allowed.
    pub fn over_honest(&self) -> Option<f64> {
        Some(self.budget_used? / self.honest_used?)
    }

    fn json(&self) -> Value {
        json!({
            "name": self.name,
            "kind": self.kind,
            "cases": self.cases,
            "answered": self.answered,
            "verdict": self.verdict.to_string(),
            "grade": self.grade.map(|grade| format!("{grade:?}")),
            "grades": self.grades.iter().map(|(id, grade)| (id, format!("{grade:?}"))).collect::<BTreeMap<_, _>>(),
            "budget_used": self.budget_used.map(number),
            "over_honest": self.over_honest().map(number),
            "vacuous": self.vacuous,
            "unproved": self.unproved,
            "lost_bits": self.lost_bits,
            "missing_outputs": self.missing_outputs,
            "worst_case": self.worst_case.as_ref().map(|w| json!({
                "id": w.id, "output": w.output, "index": w.index, "got": number(w.got),
                "expected": number(w.expected), "bound": number(w.bound), "ulp": number(w.ulp),
            })),
            "conventions": self.conventions,
            "shown_in": self.shown_in,
            "contradiction": self.contradiction,
            "layouts": self.layouts,
            "findings": self.findings,
            "faults": self.faults,
            "left_out": self.left_out,
            "crashed": self.crashed,
            "edge_cases": self.edge_cases,
            "wrong_cases": self.wrong_cases,
            "first_to_differ": self.off.first(),
            "observed": self.observed,
            "example": self.example.as_ref().map(Example::json),
            "diagnosis": self.diagnosis.iter().map(|e| json!({
                "mistakes": e.mistakes.iter().map(|m| m.name).collect::<Vec<_>>(),
                "fitted": e.fitted.first(),
                "numbers": e.fitted,
                "slip": e.slip.as_ref().map(Slip::says),
                "conventions": e.conventions,
                "residual": number(e.residual),
                "same_as_best": e.same_as_best,
                "inaccurate": e.inaccurate,
                "unexplained": e.unexplained,
                "spared": e.spared,
                "unexplained_cases": e.unexplained_cases,
            })).collect::<Vec<_>>(),
        })
    }
}

/// JSON has no infinity and no NaN: they become strings.
fn number(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { json!(x.to_string()) }
}

/// The whole run.
#[derive(Clone, Debug)]
pub struct Report {
    /// The type under test.
    pub dtype: String,
    /// The profile that was pinned, or the one found with its deviations.
    pub profile: String,
    /// Whether it was pinned.
    pub pinned: bool,
    /// The conventions that the run was judged by.
    pub assignment: BTreeMap<&'static str, String>,
    /// Cases that the type can't hold.
    pub left_out: usize,
    /// One row a component and direction, in pipeline order.
    pub rows: Vec<Row>,
}

impl Report {
    /// Without any row yet.
    pub fn new(exam: &Exam, c: &Conventions) -> Report {
        Report {
            dtype: exam.dtype.to_string(),
            profile: exam.profile.map_or_else(String::new, |profile| profile.name.to_string()),
            pinned: exam.profile.is_some(),
            assignment: CHOICES.iter().map(|(key, _)| (*key, c.get(key))).collect(),
            left_out: exam.left_out.len(),
            rows: vec![],
        }
    }

    /// Once all rows are there: names what was found, by the conventions that the answered components depend on.
    pub fn settle(&mut self) {
        let answered = self.rows.iter().filter(|row| row.verdict != Verdict::Unsupported);
        let keys: Vec<&str> = answered.flat_map(|row| row.conventions.keys().copied()).collect();
        self.assignment.retain(|key, _| keys.contains(key));
        if !self.pinned {
            self.profile = profiles::describe(&self.assignment);
        }
    }

    /// The row of a component in a direction.
    pub fn of(&self, name: &str, kind: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.name == name && row.kind == kind)
    }

    /// How many rows have this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.rows.iter().filter(|row| row.verdict == verdict).count()
    }

    /// 0: something passed and nothing failed; 1: something failed, is unproved, imprecise or wrong in edge cases; 2: nothing was answered.
    pub fn exit_code(&self) -> u8 {
        self.exit_code_allowing(&[])
    }

    /// The same where these verdicts count as passes.
    pub fn exit_code_allowing(&self, allowed: &[Verdict]) -> u8 {
        let wrong = [Verdict::Fail, Verdict::Unproved, Verdict::Imprecise, Verdict::Edge].into_iter();
        let wrong: usize = wrong.filter(|verdict| !allowed.contains(verdict)).map(|v| self.count(v)).sum();
        let right: usize = allowed.iter().chain(&[Verdict::Pass]).map(|v| self.count(*v)).sum();
        match (wrong, right) {
            (0, 0) => 2,
            (0, _) => 0,
            _ => 1,
        }
    }

    /// The contract's JSON.
    pub fn json(&self) -> Value {
        json!({
            "schema": SCHEMA,
            "version": env!("CARGO_PKG_VERSION"),
            "dtype": self.dtype,
            "profile": self.profile,
            "pinned": self.pinned,
            "assignment": self.assignment,
            "left_out": self.left_out,
            "components": self.rows.iter().map(Row::json).collect::<Vec<_>>(),
        })
    }
}
