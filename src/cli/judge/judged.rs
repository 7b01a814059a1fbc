//! The judge's report as a page: verdicts, and for whatever isn't right the diagnosis, where the error sits, and the case by hand.

use std::collections::BTreeMap;

use crate::judge::answer::Answers;
use crate::judge::errors::errors;
use crate::judge::exam::Exam;
use crate::judge::page::{counts, of_row, percent};
use crate::judge::report::Row;
use crate::judge::{Report, Verdict};
use crate::report::heat;
use crate::report::page::Page;

/// Pictures as SVG, by component and kind.
type Pictures = BTreeMap<(&'static str, &'static str), String>;

/// Where the errors of failing rows sit.
pub(super) fn pictures(exam: &Exam, answers: &[Answers], report: &Report, exp_ulp: f64) -> Pictures {
    let picture = |row: &Row| {
        let (worst, found) = (row.worst_case.as_ref()?, errors(exam, answers, row, exp_ulp)?);
        let wrong = found.used.iter().filter(|used| used.is_nan() || **used > 1.0).count();
        let title = format!(
            "Errors of {} in case {}: {wrong} of {} elements are wrong, by rows and columns of its shape {:?}",
            worst.output,
            worst.id,
            found.used.len(),
            found.shape
        );
        Some(((row.name, row.kind), heat::svg(&title, &found.shape, &found.used)))
    };
    let wrong = |row: &&Row| !matches!(row.verdict, Verdict::Pass | Verdict::Unsupported);
    report.rows.iter().filter(wrong).filter_map(picture).collect()
}

/// The page.
pub(super) fn page(report: &Report, pictures: &Pictures) -> String {
    let lead = format!(
        "{}. Answers in {}; conventions {}: {}.",
        counts(report),
        report.dtype,
        if report.pinned { "pinned" } else { "found" },
        report.profile
    );
    let mut page = Page::new("Judged against the reference", &lead);
    page.heading("Verdicts").table(
        &["component", "kind", "cases", "verdict", "grade", "budget used"],
        &report.rows.iter().filter(|row| row.verdict != Verdict::Unsupported).map(cells).collect::<Vec<_>>(),
    );
    page.paragraph(
        "Budget used: the largest error, of what honest arithmetic in this type may cost. Grade A: the stable formula's bound held; B: the \
         textbook's.",
    );
    for row in report.rows.iter().filter(|row| row.verdict != Verdict::Unsupported) {
        let notes = of_row(row);
        if notes.trim().is_empty() {
            continue;
        }
        page.heading(&format!("{} {}: {}", row.name, row.kind, row.verdict));
        page.verbatim(notes.trim());
        if let (Some(picture), Some(worst)) = (pictures.get(&(row.name, row.kind)), &row.worst_case) {
            page.part(&format!("Where {} is wrong, in case {}", worst.output, worst.id));
            page.paragraph("A cell an element: the last axis from left to right, all others from top to bottom; numbers are indices.");
            page.figure(picture);
        }
    }
    page.finish()
}

fn cells(row: &Row) -> Vec<String> {
    let grade = row.grade.map_or("-".into(), |grade| format!("{grade:?}"));
    let budget = row.budget_used.map_or("-".into(), percent);
    let cases = format!("{}/{}", row.answered, row.cases);
    vec![row.name.into(), row.kind.into(), cases, row.verdict.to_string(), grade, budget]
}
