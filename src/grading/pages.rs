//! Pages: one a submission for the student, one for the teacher. A student's page says nothing of other students.

use super::marks::{Entry, Explained, Graded, Marked, State, mistake, points};
use super::rubric::Rubric;
use crate::report::page::Page;

/// A submission's page. What to do about a mistake is on it only where it is to be revealed.
pub(crate) fn of_student(entry: &Entry, rubric: &Rubric, reveal: bool) -> String {
    let graded = &entry.graded;
    let lead =
        format!("{}: {} of {} points.", rubric.title, points(graded.points()), points(rubric.points()));
    let mut page = Page::new(&entry.name, &lead);
    match graded.state {
        State::Graded => {}
        State::Stopped => {
            page.paragraph(&format!("Stopped: {}. What it had answered by then counts.", graded.reason));
        }
        State::Broken => {
            page.paragraph(&format!("Nothing could be judged: {}.", graded.reason));
        }
    }
    if !graded.conventions.is_empty() {
        let how = if rubric.exam.profile.is_some() { "asked for" } else { "found" };
        page.paragraph(&format!(
            "Conventions {how}: {}. Arithmetic: {}.",
            graded.conventions, rubric.exam.dtype
        ));
    }
    page.list(&graded.notes);
    let rows: Vec<_> = graded.rows.iter().map(summary).collect();
    page.text_table(&["row", "points", "verdict", "why"], &rows);
    for row in graded.rows.iter().filter(|row| !row.findings.is_empty() || !row.explanations.is_empty()) {
        section(&mut page, row, reveal);
    }
    page.finish()
}

fn summary(row: &Marked) -> Vec<String> {
    let of = format!("{} of {}", points(row.points), points(row.out_of));
    vec![format!("{} {}", row.component, row.direction), of, row.verdict.clone(), row.why.clone()]
}

fn section(page: &mut Page, row: &Marked, reveal: bool) {
    page.heading(&format!("{} {}: {}", row.component, row.direction, row.verdict));
    for (n, explained) in row.explanations.iter().enumerate() {
        explanation(page, row, explained, n > 0, reveal);
    }
    page.list(&row.findings);
    if !row.example.is_empty() {
        page.paragraph("To follow by hand:").verbatim(&row.example);
    }
}

/// A mistake: its name, what was probably written and where, what it does; what to do only where that is to be revealed.
fn explanation(page: &mut Page, row: &Marked, explained: &Explained, same: bool, reveal: bool) {
    let which = if same { "Or, the same in every case" } else { "These numbers are those of" };
    page.paragraph(&format!("{which}: {}.", explained.title));
    let at = row.place.as_ref().map_or_else(String::new, |place| {
        format!(" in {} from line {} on, {}", place.file, place.line, place.name)
    });
    for found in explained.mistakes.iter().filter_map(|name| mistake(&row.component, name)) {
        let mut said = vec![format!("The line to look for{at}: {}", found.cause)];
        said.push(format!("What it does: {}", found.effect));
        if reveal {
            said.push(format!("To fix it: {}", found.fix));
        }
        page.list(&said);
    }
}

/// The teacher's page: the table, with a link to each submission's.
pub(crate) fn of_class(entries: &[Entry], rubric: &Rubric, about: &[String]) -> String {
    let lead = format!("{} submissions, {} points.", entries.len(), points(rubric.points()));
    let mut page = Page::new(&rubric.title, &lead);
    page.list(about);
    let names: Vec<String> =
        rubric.rows.iter().map(|row| format!("{} ({})", row.name(), points(row.points))).collect();
    let header: Vec<&str> = ["submission", "points", "state"]
        .into_iter()
        .chain(names.iter().map(String::as_str))
        .chain(["reason"])
        .collect();
    let cell = |row: &Marked| match &row.why[..] {
        "" => format!("{} {}", points(row.points), row.verdict),
        why => format!("{} {}: {}", points(row.points), row.verdict, short(why)),
    };
    let line = |entry: &Entry| {
        let Graded { state, reason, rows, .. } = &entry.graded;
        let mut cells = vec![entry.name.clone(), points(entry.graded.points()), state.word().to_string()];
        // A broken submission has the same reason in every row.
        cells.extend(
            rows.iter().map(|row| if *state == State::Broken { points(row.points) } else { cell(row) }),
        );
        cells.push(short(reason));
        (entry.page(), cells)
    };
    page.linked_table(&header, &entries.iter().map(line).collect::<Vec<_>>());
    page.finish()
}

/// At a length that a table takes.
pub(crate) fn short(text: &str) -> String {
    const MOST: usize = 90;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_string(),
    }
}
