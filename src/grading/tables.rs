//! The table in its other forms: text for a terminal, CSV for a spreadsheet, JUnit XML for what shows tests.

use std::io;

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use serde_json::{Value, json};

use super::marks::{Entry, Marked, State, points};
use super::pages::short;
use super::rubric::Rubric;
use crate::report::table;
use crate::shown::shown;

/// A line a submission.
pub(crate) fn text(entries: &[Entry], rubric: &Rubric) -> String {
    let header = ["submission", "points", "of", "passed", "why not all"];
    let line = |entry: &Entry| {
        let graded = &entry.graded;
        let passed = graded.rows.iter().filter(|row| row.verdict == "pass").count();
        let why = |row: &Marked| format!("{} {}: {}", row.component, row.direction, row.why_or_verdict());
        let failed = graded.rows.iter().filter(|row| row.verdict != "pass");
        let why = match graded.state {
            State::Broken => format!("BROKEN: {}", graded.reason),
            State::Stopped => format!("STOPPED: {}", graded.reason),
            State::Graded => failed.map(why).collect::<Vec<_>>().join("; "),
        };
        let of = format!("{}/{}", passed, graded.rows.len());
        vec![short(&entry.name), points(graded.points()), points(rubric.points()), of, short(&why)]
    };
    table::text(&header, &entries.iter().map(line).collect::<Vec<_>>())
}

impl Marked {
    /// Why it doesn't pass, or else its verdict.
    fn why_or_verdict(&self) -> &str {
        if self.why.is_empty() { &self.verdict } else { &self.why }
    }
}

/// A line a submission: its points and verdicts, row by row.
///
/// # Errors
/// Never, as it is written to memory; the writer's own otherwise.
pub(crate) fn csv(entries: &[Entry], rubric: &Rubric) -> io::Result<Vec<u8>> {
    let mut out = csv::Writer::from_writer(vec![]);
    let mut header: Vec<String> = ["submission", "state", "points", "of"].map(String::from).into();
    for row in &rubric.rows {
        header.extend(["points", "verdict", "why"].map(|what| format!("{} {what}", row.name())));
    }
    header.push("reason".into());
    out.write_record(&header)?;
    for entry in entries {
        let graded = &entry.graded;
        let mut record = vec![
            entry.name.clone(),
            graded.state.word().into(),
            points(graded.points()),
            points(rubric.points()),
        ];
        for row in &graded.rows {
            record.extend([points(row.points), row.verdict.clone(), row.why.clone()]);
        }
        record.push(graded.reason.clone());
        out.write_record(record.iter().map(|field| cell(field)))?;
    }
    out.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

/// A text that a spreadsheet shows: one that begins like a formula would be computed.
fn cell(text: &str) -> String {
    let text = shown(text);
    if text.starts_with(['=', '+', '-', '@']) { format!("'{text}") } else { text.into_owned() }
}

/// A suite a submission, a test a row. No times: the same marks are the same bytes.
///
/// # Errors
/// Never, as it is written to memory; the writer's own otherwise.
pub(crate) fn junit(entries: &[Entry], rubric: &Rubric) -> io::Result<String> {
    let mut report = Report::new(&*shown(&rubric.title));
    for entry in entries {
        let mut suite = TestSuite::new(&*shown(&entry.name));
        suite.add_test_cases(entry.graded.rows.iter().map(|row| test(entry, row)));
        report.add_test_suite(suite);
    }
    report.to_string().map_err(|error| io::Error::other(error.to_string()))
}

fn test(entry: &Entry, row: &Marked) -> TestCase {
    let mut status = match &row.verdict[..] {
        "pass" => TestCaseStatus::success(),
        "absent" => TestCaseStatus::non_success(NonSuccessKind::Error),
        _ => TestCaseStatus::non_success(NonSuccessKind::Failure),
    };
    if row.verdict != "pass" {
        let said: Vec<String> = row.findings.iter().map(|finding| shown(finding).into_owned()).collect();
        status
            .set_type(&row.verdict[..])
            .set_message(&*shown(row.why_or_verdict()))
            .set_description(said.join("\n"));
    }
    let mut test = TestCase::new(format!("{} {}", row.component, row.direction), status);
    test.set_classname(&*shown(&entry.name));
    test
}

/// The whole class for machines.
pub(crate) fn object(entries: &[Entry], rubric: &Rubric) -> Value {
    let entry = |entry: &Entry| {
        let graded = &entry.graded;
        json!({
            "name": entry.name, "page": entry.page(), "state": graded.state, "reason": graded.reason,
            "points": (graded.points() * 1e6).round() / 1e6, "conventions": graded.conventions,
            "notes": graded.notes, "rows": graded.rows,
        })
    };
    json!({
        "schema": "nerf-oracle/grades/1", "version": env!("CARGO_PKG_VERSION"), "title": rubric.title,
        "dtype": rubric.exam.dtype.to_string(), "profile": rubric.exam.profile.map(|profile| profile.name),
        "points": rubric.points(), "submissions": entries.iter().map(entry).collect::<Vec<_>>(),
    })
}
