//! Marks: what the judge found, as points and as sentences that a student understands.

use serde::{Deserialize, Serialize};

use super::answers::{Heard, Place};
use super::rubric::{Row as Asked, Rubric};
use crate::contract::component::Mistake;
use crate::judge::diagnosis::evidence::Explanation;
use crate::judge::mark::Worst;
use crate::judge::page;
use crate::judge::report::{Report, Row, Verdict};
use crate::registry::all_rows;

/// Names that are listed before it says how many more there are.
const LISTED: usize = 6;

/// What became of a submission.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum State {
    /// It answered to its end.
    Graded,
    /// It was stopped, or ended by itself: what it had answered by then counts.
    Stopped,
    /// There was nothing to judge.
    Broken,
}

impl State {
    /// As tables have it.
    pub(crate) fn word(self) -> &'static str {
        match self {
            State::Graded => "graded",
            State::Stopped => "stopped",
            State::Broken => "broken",
        }
    }
}

/// A submission's marks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Graded {
    /// The name of its content and of the rubric: as long as it stays the same, so do the marks.
    pub(crate) key: String,
    pub(crate) state: State,
    /// Why it was stopped or is broken.
    pub(crate) reason: String,
    /// The conventions that it was judged by.
    pub(crate) conventions: String,
    pub(crate) notes: Vec<String>,
    /// In the rubric's order.
    pub(crate) rows: Vec<Marked>,
}

/// A submission with its marks.
#[derive(Debug)]
pub(crate) struct Entry {
    /// The folder's name.
    pub(crate) name: String,
    /// The name of its page.
    pub(crate) slug: String,
    pub(crate) graded: Graded,
}

impl Entry {
    /// Its page, below the folder of results.
    pub(crate) fn page(&self) -> String {
        format!("pages/{}.html", self.slug)
    }
}

/// A row's marks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Marked {
    pub(crate) component: String,
    pub(crate) direction: String,
    pub(crate) points: f64,
    pub(crate) out_of: f64,
    /// The judge's word, or `absent`.
    pub(crate) verdict: String,
    /// Why, in a few words; empty where it passes.
    pub(crate) why: String,
    /// What was found, sentence by sentence.
    pub(crate) findings: Vec<String>,
    /// What explains it: the best, and those that no answer can tell from it.
    pub(crate) explanations: Vec<Explained>,
    /// The smallest case that is wrong.
    pub(crate) example: String,
    /// Where its function is.
    pub(crate) place: Option<Place>,
}

/// An explanation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Explained {
    /// On a line, with its conventions.
    pub(crate) title: String,
    /// Its mistakes, by their names in the catalogue.
    pub(crate) mistakes: Vec<String>,
}

impl Graded {
    /// One that nothing could be asked of.
    pub(crate) fn broken(key: &str, rubric: &Rubric, reason: &str) -> Graded {
        let rows = rubric.rows.iter().map(|row| absent(row, reason)).collect();
        let (conventions, notes) = Default::default();
        Graded { key: key.into(), state: State::Broken, reason: reason.into(), conventions, notes, rows }
    }

    /// The judge's report as marks.
    pub(crate) fn new(key: &str, rubric: &Rubric, heard: &Heard, report: &Report) -> Graded {
        let rows = rubric.rows.iter().map(|row| marked(row, heard, report)).collect();
        let state = if heard.stopped.is_some() { State::Stopped } else { State::Graded };
        let reason = heard.stopped.clone().unwrap_or_default();
        let conventions = if report.assignment.is_empty() { String::new() } else { report.profile.clone() };
        Graded { key: key.into(), state, reason, conventions, notes: heard.notes.clone(), rows }
    }

    /// All of its points.
    pub(crate) fn points(&self) -> f64 {
        self.rows.iter().map(|row| row.points).sum()
    }
}

/// Points as people write them: 0.1 and 0.2 are 0.3.
pub(crate) fn points(x: f64) -> String {
    format!("{}", (x * 1e6).round() / 1e6)
}

/// A row without answers.
fn absent(row: &Asked, why: &str) -> Marked {
    Marked {
        component: row.component.name.into(),
        direction: row.direction().into(),
        points: 0.0,
        out_of: row.points,
        verdict: "absent".into(),
        why: why.into(),
        findings: vec![],
        explanations: vec![],
        example: String::new(),
        place: None,
    }
}

fn marked(asked: &Asked, heard: &Heard, report: &Report) -> Marked {
    let (name, direction) = (asked.component.name, asked.direction());
    let place = |direction: &str| heard.places.get(&format!("{name}/{direction}")).cloned();
    let place = place(if direction == "vjp" { "vjp" } else { "forward" }).or_else(|| place("forward"));
    let why = heard.absent.get(&format!("{name}/{direction}"));
    let row = report.of(name, direction).filter(|row| row.verdict != Verdict::Unsupported);
    let Some(row) = row.filter(|row| row.answered > 0 || !row.crashed.is_empty()) else {
        return Marked { place, ..absent(asked, why.map_or("no answer", String::as_str)) };
    };
    let (verdict, points) = worth(asked, row);
    Marked {
        points,
        verdict: verdict.to_string(),
        why: in_short(verdict, row, asked, why),
        findings: findings(row, asked, why, report),
        explanations: explanations(row),
        example: row.example.as_ref().map(ToString::to_string).unwrap_or_default(),
        place,
        ..absent(asked, "")
    }
}

/// Outputs that the rubric wants and nobody answered.
fn wanted<'a>(asked: &'a Asked, row: &Row) -> Vec<&'a str> {
    let bare = |name: &String| name.strip_prefix("grad_").unwrap_or(name).to_string();
    let missing: Vec<String> = row.missing_outputs.iter().map(bare).collect();
    asked.outputs.iter().filter(|name| missing.contains(name)).map(String::as_str).collect()
}

/// The verdict, and its points.
fn worth(asked: &Asked, row: &Row) -> (Verdict, f64) {
    match row.verdict {
        Verdict::Pass | Verdict::Imprecise | Verdict::Edge if !wanted(asked, row).is_empty() => {
            (Verdict::Fail, 0.0)
        }
        Verdict::Pass => (Verdict::Pass, asked.points),
        Verdict::Imprecise => (Verdict::Imprecise, asked.if_imprecise),
        Verdict::Fail | Verdict::Edge if only_edges(asked, row) => {
            (row.verdict, asked.if_only_edge_cases_fail)
        }
        // The rubric has its own say in what an edge case is.
        Verdict::Edge => (Verdict::Fail, 0.0),
        other => (other, 0.0),
    }
}

/// Whether cases are wrong, and all of them are those that the rubric is lenient about.
fn only_edges(asked: &Asked, row: &Row) -> bool {
    let edges = !row.wrong_cases.is_empty() && row.wrong_cases.iter().all(|id| asked.edge_cases.contains(id));
    edges && row.wrong_cases.len() < row.cases && row.contradiction.is_empty()
}

fn in_short(verdict: Verdict, row: &Row, asked: &Asked, why: Option<&String>) -> String {
    let left = match row.left_out.len() {
        0 => String::new(),
        cases => format!("{cases} cases not asked, as it takes less than they need"),
    };
    match verdict {
        Verdict::Pass | Verdict::Unsupported => left,
        Verdict::Unproved => format!("an answer of 0 would be as good in {}", row.unproved.join(", ")),
        Verdict::Imprecise => row.lost_bits.map_or_else(String::new, |bits| format!("{bits} bits lost")),
        Verdict::Fail | Verdict::Edge => {
            let missing = wanted(asked, row);
            let edges = if only_edges(asked, row) { "edge cases alone: " } else { "" };
            let said = match (row.diagnosis.first(), row.faults.first(), why) {
                _ if !missing.is_empty() && row.verdict != Verdict::Fail => {
                    format!("not answered: {}", missing.join(", "))
                }
                (_, _, Some(why)) => why.clone(),
                (Some(best), ..) => page::name(best),
                (None, Some(fault), _) => {
                    fault.split(". It was handed").next().unwrap_or_default().to_string()
                }
                (None, None, None) => "nothing in the catalogue explains these numbers".into(),
            };
            format!("{edges}{said}")
        }
    }
}

/// What is to be said of a row, for those who wrote it.
fn findings(row: &Row, asked: &Asked, why: Option<&String>, report: &Report) -> Vec<String> {
    let mut said: Vec<String> = why.cloned().into_iter().collect();
    if row.verdict == Verdict::Pass {
        said.extend(row.layouts.iter().map(|layout| format!("layout: {layout}")));
    }
    said.extend(row.findings.iter().map(|finding| format!("a choice, no mistake: {finding}")));
    if !row.left_out.is_empty() {
        let cases = row.left_out.keys().map(String::as_str).collect::<Vec<_>>();
        said.push(format!("not asked, as the function takes less than they need: {}", listed(&cases)));
    }
    if !row.missing_outputs.is_empty() {
        said.push(format!("not answered: {}", row.missing_outputs.join(", ")));
    }
    if !wanted(asked, row).is_empty() {
        said.push(format!("the rubric asks for {}", wanted(asked, row).join(", ")));
    }
    match row.verdict {
        Verdict::Unproved => said.push(row.unproved_for()),
        Verdict::Imprecise => said.push(lost(row)),
        Verdict::Fail | Verdict::Edge => {
            said.extend(other_conventions(row, report));
            said.extend(wrong(row));
        }
        Verdict::Pass | Verdict::Unsupported => {}
    }
    said
}

fn lost(row: &Row) -> String {
    let bits = row.lost_bits.unwrap_or_default();
    let digits = f64::from(bits) * std::f64::consts::LOG10_2;
    format!(
        "the right formula, with {bits} bits ({digits:.1} digits) lost, first of all in {}",
        row.off.join(", ")
    )
}

/// What the run's conventions are, where the answers follow others.
fn other_conventions(row: &Row, report: &Report) -> Option<String> {
    let own = &row.diagnosis.first()?.conventions;
    let pair = |key: &&str| Some(format!("{key} = {}", report.assignment.get(*key)?));
    let ours: Vec<String> = own.keys().filter_map(pair).collect();
    let how = if report.pinned { "what was asked for" } else { "what the other rows follow" };
    (!ours.is_empty()).then(|| format!("{how}: {}", ours.join(", ")))
}

/// What is wrong, and where.
fn wrong(row: &Row) -> Vec<String> {
    let mut said = vec![];
    if !row.wrong_cases.is_empty() {
        let cases: Vec<&str> = row.wrong_cases.iter().map(String::as_str).collect();
        said.push(format!("wrong in {} of {} cases: {}", cases.len(), row.cases, listed(&cases)));
    }
    // What follows is advice for those who call the judge themselves.
    let fault = |fault: &String| fault.split("; arrays=").next().unwrap_or_default().to_string();
    said.extend(row.faults.iter().take(LISTED).map(fault));
    if row.faults.len() > LISTED {
        said.push(format!("and {} more like these", row.faults.len() - LISTED));
    }
    said.extend(row.worst_case.as_ref().filter(|_| row.budget_used > Some(1.0)).map(worst));
    if !row.contradiction.is_empty() {
        let pairs: Vec<_> = row.contradiction.iter().map(|(key, value)| format!("{key} = {value}")).collect();
        said.push(format!("right with {}, which contradicts the other rows", pairs.join(", ")));
    }
    said.extend(row.observed.iter().cloned());
    if let Some(best) = row.diagnosis.first() {
        if !best.unexplained.is_empty() {
            said.push(format!(
                "that doesn't explain {}: something more is wrong",
                best.unexplained.join(", ")
            ));
        }
        if !best.unexplained_cases.is_empty() {
            let cases: Vec<&str> = best.unexplained_cases.iter().map(String::as_str).collect();
            said.push(format!("that doesn't explain {}: look at these by hand", listed(&cases)));
        }
    } else if let (Some(first), true) = (row.off.first(), row.budget_used > Some(1.0)) {
        said.push(format!("the first output to differ is {first}: begin there"));
    }
    said
}

fn worst(w: &Worst) -> String {
    let allowed = if w.bound == 0.0 { "nothing".into() } else { format!("{:.1e}", w.bound) };
    format!(
        "furthest off in case {}, {}{:?}: got {:.7e}, expected {:.7e}; {allowed} is allowed",
        w.id, w.output, w.index, w.got, w.expected
    )
}

/// The best explanation, and those that say the same on every case.
fn explanations(row: &Row) -> Vec<Explained> {
    let same = row.diagnosis.iter().enumerate().filter(|(n, e)| *n == 0 || e.same_as_best);
    let explained = |(_, e): (usize, &Explanation)| Explained {
        title: page::name(e),
        mistakes: e.mistakes.iter().map(|mistake| mistake.name.to_string()).collect(),
    };
    if [Verdict::Fail, Verdict::Edge].contains(&row.verdict) { same.map(explained).collect() } else { vec![] }
}

/// A mistake of the catalogue.
pub(crate) fn mistake(component: &str, name: &str) -> Option<&'static Mistake> {
    let row = all_rows().find(|row| row.name == component)?;
    row.mistakes.iter().find(|mistake| mistake.name == name)
}

/// Names on a line, the first of them where there are many.
pub(super) fn listed(names: &[&str]) -> String {
    match names.len() {
        n if n > LISTED => format!("{} and {} more", names[..LISTED].join(", "), n - LISTED),
        _ => names.join(", "),
    }
}
