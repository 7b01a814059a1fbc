//! What a submission has answered: read leniently, row by row, so that one damaged file costs its own row alone.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::judge::answer::Answers;
use crate::judge::exam::Exam;
use crate::judge::exchange::{DECLARATIONS, declarations, read_question, undeclarable};

/// Where a submission's function is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Place {
    /// The file, below the submission's folder.
    pub(crate) file: String,
    /// The line that defines it.
    pub(crate) line: u64,
    /// Its name there.
    pub(crate) name: String,
}

/// Everything that a submission has answered, and what became of the rest.
#[derive(Debug)]
pub(crate) struct Heard {
    /// The questions as this submission is asked them: without the cases that need more than it takes.
    pub(crate) exam: Exam,
    /// Answers, a list per question; without any where they couldn't be read.
    pub(crate) answers: Vec<Answers>,
    /// Why a row has no answers, by `component/kind`.
    pub(crate) absent: BTreeMap<String, String>,
    /// Where its functions are, by `component/kind`.
    pub(crate) places: BTreeMap<String, Place>,
    /// Why it was stopped before its end.
    pub(crate) stopped: Option<String>,
    /// What the teacher should know.
    pub(crate) notes: Vec<String>,
}

/// Reads the answers to an exam below a folder in which there are no links.
///
/// # Errors
/// Declarations that can't be used, in words.
pub(crate) fn read(exam: &Exam, folder: &Path) -> Result<Heard, String> {
    let plain = |text: String| text.replace(&format!("{}/", folder.display()), "");
    let mut rows = declarations(folder).map_err(|error| plain(error.to_string()))?;
    // Rows that the rubric doesn't ask may be declared too.
    rows.retain(|name, _| exam.questions.iter().any(|question| question.row() == *name));
    let exam = exam.clone().narrowed(&rows);
    let wrong = |what| undeclarable(Path::new(DECLARATIONS), "rows", what).to_string();
    let exam = exam.map_err(wrong)?;
    let (mut answers, mut absent) = (vec![], BTreeMap::new());
    for question in &exam.questions {
        answers.push(read_question(&exam, question, folder).unwrap_or_else(|error| {
            absent.insert(question.row(), plain(error.to_string()));
            vec![None; question.cases.len()]
        }));
    }
    Ok(Heard { exam, answers, absent, places: BTreeMap::new(), stopped: None, notes: vec![] })
}
