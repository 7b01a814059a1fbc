//! Rows that are judged by statistics over all of their cases: all or nothing.

use super::answer::{Answer, Answers};
use super::exam::Question;
use super::mark::Marks;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::component::Mistake;
use crate::contract::special::{Finding, Findings};
use crate::convention::Conventions;

/// What is wrong with an answer as arrays: absent, of a wrong shape, or not finite.
fn fault(question: &Question, case: &Case, answer: Option<&Answer>, c: &Conventions) -> Option<String> {
    let Some(answer) = answer else { return Some(format!("{}: no answer", case.id)) };
    let expected = (question.component.forward.oracle)(&case.inputs, c);
    for port in question.component.outputs {
        let Some(given) = answer.get(port.name) else {
            if optional(question).contains(&port.name) {
                continue;
            }
            return Some(format!("{}: {}: absent", case.id, port.name));
        };
        let (found, wanted) = (given.values.shape(), expected[port.name].shape());
        if found != wanted {
            return Some(format!("{}: {}: wrong shape {found:?}, expected {wanted:?}", case.id, port.name));
        }
        if given.values.iter().any(|x| !x.is_finite()) {
            return Some(format!("{}: {}: NaN or infinity", case.id, port.name));
        }
    }
    None
}

/// Outputs that needn't be answered.
fn optional(question: &Question) -> &'static [&'static str] {
    question.component.special.statistics.map_or(&[], |statistics| statistics.optional)
}

/// Faults of the answers, or what the statistics of all cases say.
fn judged<'a>(question: &'a Question, answers: &Answers, c: &Conventions) -> (Vec<String>, Findings<'a>) {
    let pairs = question.cases.iter().zip(answers);
    let faults: Vec<String> =
        pairs.filter_map(|(case, answer)| fault(question, case, answer.as_ref(), c)).collect();
    let Some(statistics) = question.component.special.statistics.filter(|_| faults.is_empty()) else {
        return (faults, Box::new(std::iter::empty()));
    };
    let plain = |answer: &Answer| -> Arrays {
        answer.iter().map(|(name, given)| (name.clone(), given.values.clone())).collect()
    };
    let answers: Vec<Arrays> = answers.iter().flatten().map(plain).collect();
    (vec![], (statistics.findings)(&question.cases, &answers, c))
}

/// Whether right answers in these conventions could look like this.
pub fn plausible(question: &Question, answers: &Answers, c: &Conventions) -> bool {
    let (faults, mut found) = judged(question, answers, c);
    faults.is_empty() && found.all(|finding| finding.honest)
}

/// The marks: all or nothing.
pub fn mark(question: &Question, answers: &Answers, c: &Conventions) -> Marks {
    let (mut faults, found) = judged(question, answers, c);
    let found = in_order(question, found);
    let (choices, wrong): (Vec<Finding>, Vec<Finding>) =
        found.into_iter().partition(|finding| finding.honest);
    let shown = |finding: &Finding| format!("{}: {}", finding.name, finding.says);
    faults.extend(wrong.iter().map(shown));
    let never = |name: &&&str| answers.iter().flatten().all(|answer| !answer.contains_key(**name));
    Marks {
        budget_used: if faults.is_empty() { 0.0 } else { f64::INFINITY },
        findings: choices.iter().map(shown).collect(),
        missing: optional(question).iter().filter(never).map(|name| name.to_string()).collect(),
        faults,
        ..Marks::default()
    }
}

/// The mistakes that the statistics show in these conventions.
pub(crate) fn mistakes(question: &Question, answers: &Answers, c: &Conventions) -> Vec<&'static Mistake> {
    let row = |finding: Finding| question.component.mistakes.iter().find(|m| m.name == finding.name);
    in_order(question, judged(question, answers, c).1).into_iter().filter_map(row).collect()
}

/// Findings as the row lists its mistakes, which is the order in which a program makes them.
fn in_order(question: &Question, found: Findings) -> Vec<Finding> {
    let mistakes = question.component.mistakes;
    let place = |finding: &Finding| mistakes.iter().position(|m| m.name == finding.name);
    let mut found: Vec<Finding> = found.collect();
    found.sort_by_key(|finding| place(finding).unwrap_or(mistakes.len()));
    found
}
