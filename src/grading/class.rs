//! The whole class: which submissions have to be graded, all of them at once, and everything that is written.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use super::answers::{self, Heard};
use super::marks::{Entry, Graded, listed};
use super::rubric::Rubric;
use super::sandbox::Sandbox;
use super::submission::{self, Holds, Kind, Submission};
use super::{kept, pages, python, tables};
use crate::contract::arithmetic::Dtype;
use crate::convention::profiles::Profile;
use crate::error::{Error, Result};
use crate::files;
use crate::files::layout::Layout;
use crate::files::lock::Lock;
use crate::judge::exam::Question;
use crate::judge::{Exam, exchange, judging};
use crate::parallel;

/// What is to be done.
#[derive(Debug)]
pub(crate) struct Settings<'a> {
    /// The folder whose sub-folders are the submissions.
    pub(crate) submissions: &'a Path,
    /// Where everything is written.
    pub(crate) out: &'a Path,
    /// The interpreter for submissions in Python.
    pub(crate) python: &'a str,
    /// Whether submissions that haven't changed are graded again.
    pub(crate) again: bool,
    /// Whether pages say how to fix what is wrong.
    pub(crate) reveal: bool,
}

/// A class with its marks.
#[derive(Debug)]
pub(crate) struct Class {
    /// By name.
    pub(crate) entries: Vec<Entry>,
    /// How many of them were graded now; the others' marks were kept.
    pub(crate) new: usize,
    /// How it was done, and what the teacher should know.
    pub(crate) about: Vec<String>,
}

/// Grades all submissions, and writes marks, pages and tables. Nothing where it was stopped; what was graded by then is kept.
///
/// # Errors
/// Folders that can't be read or written, and where there is no Python for submissions that need it.
pub(crate) fn grade(
    rubric: &Rubric,
    settings: &Settings,
    stop: impl Fn() -> bool + Sync,
    done: impl Fn(usize, usize) + Sync,
) -> Result<Option<Class>> {
    let out = settings.out;
    files::make_folder(out)?;
    let _lock = Lock::new(out)?;
    let asked = paths(rubric.exam.dtype, rubric.exam.profile)?;
    let (found, others) = submission::find(settings.submissions, out, &asked)?;
    let sandbox = sandbox(rubric, settings, &found)?;
    let keys = parallel::map(found.len(), |n| found[n].key(&salt(&found[n], rubric, sandbox.as_ref())));
    let mut marks: Vec<Option<Graded>> = vec![None; found.len()];
    // The same content, the same marks: each is graded once.
    let mut todo: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (n, (submission, key)) in found.iter().zip(&keys).enumerate() {
        match key {
            Err(reason) => marks[n] = Some(Graded::broken("", rubric, reason)),
            Ok(key) => {
                let old = kept::load(out, &submission.slug, key, rubric).filter(|_| !settings.again);
                match old {
                    Some(old) => marks[n] = Some(old),
                    None => todo.entry(key).or_default().push(n),
                }
            }
        }
    }
    let new = todo.values().map(Vec::len).sum();
    let mut todo: Vec<(&str, Vec<usize>)> = todo.into_iter().collect();
    todo.sort_by_key(|(_, same)| same[0]);
    let results = parallel::map_apart(todo.len(), |n| {
        let (key, same) = &todo[n];
        if stop() {
            return Ok(None);
        }
        let graded = one(&found[same[0]], key, rubric, &asked, sandbox.as_ref());
        same.iter().try_for_each(|&n| kept::store(out, &found[n].slug, &graded))?;
        done(same.len(), new);
        Ok::<_, Error>(Some(graded))
    });
    for ((_, same), graded) in todo.iter().zip(results) {
        let Some(graded) = graded? else { return Ok(None) };
        same.iter().for_each(|&n| marks[n] = Some(graded.clone()));
    }
    let mut about = sandbox.as_ref().map(Sandbox::describe).unwrap_or_default();
    about.extend(ignored(&others));
    about.extend(alike(&found, &keys));
    let entries = found.into_iter().zip(marks);
    let entry = |(submission, graded): (Submission, Option<Graded>)| Entry {
        name: submission.name,
        slug: submission.slug,
        graded: graded.expect("each submission was kept, refused or graded"),
    };
    let class = Class { entries: entries.map(entry).collect(), new, about };
    write(&class, rubric, settings)?;
    Ok(Some(class))
}

/// Where answers may lie: those of all rows, whether the rubric asks them or not.
fn paths(dtype: Dtype, profile: Option<&'static Profile>) -> Result<BTreeSet<String>> {
    let all = Exam::new("", dtype, profile)?;
    Ok(all.questions.iter().flat_map(Question::paths).map(|path| path + ".npz").collect())
}

/// A place for submissions in Python to run, with the cases in it, where there is one.
fn sandbox(rubric: &Rubric, settings: &Settings, found: &[Submission]) -> Result<Option<Sandbox>> {
    if !found.iter().any(is_python) {
        return Ok(None);
    }
    let whole = |path: &Path| path.canonicalize().map_err(Error::reading(path));
    let hidden = vec![whole(settings.submissions)?, whole(settings.out)?];
    let sandbox = Sandbox::new(settings.python, rubric.limits, hidden)?;
    exchange::write_cases(&python::asked(rubric)?, &sandbox.cases(), Layout::Npz)?;
    Ok(Some(sandbox))
}

fn is_python(submission: &Submission) -> bool {
    submission.holds.as_ref().is_ok_and(|holds| holds.kind == Kind::Python)
}

/// What decides a submission's marks besides what it holds.
fn salt(submission: &Submission, rubric: &Rubric, sandbox: Option<&Sandbox>) -> String {
    let python = sandbox.filter(|_| is_python(submission)).map(Sandbox::identity).unwrap_or_default();
    format!("{}\n{python}\n{}", env!("CARGO_PKG_VERSION"), rubric.text)
}

/// Grades one, whatever becomes of it.
fn one(
    submission: &Submission,
    key: &str,
    rubric: &Rubric,
    asked: &BTreeSet<String>,
    sandbox: Option<&Sandbox>,
) -> Graded {
    let heard = match &submission.holds {
        Err(reason) => Err(reason.clone()),
        Ok(holds) if holds.kind == Kind::Answers => read(submission, holds, rubric, asked),
        Ok(_) => python::ask(rubric, submission, sandbox.expect("there is one where there is Python")),
    };
    let judged = heard.and_then(|heard| {
        let judge = || judging::judge_answers(&heard.exam, &heard.answers, rubric.exp_ulp);
        // A fault of the judge's own must not cost the others their marks.
        let report =
            catch_unwind(AssertUnwindSafe(judge)).map_err(|_| "the judge itself failed on these answers")?;
        Ok(Graded::new(key, rubric, &heard, &report))
    });
    judged.unwrap_or_else(|reason| Graded::broken(key, rubric, &reason))
}

fn read(
    submission: &Submission,
    holds: &Holds,
    rubric: &Rubric,
    asked: &BTreeSet<String>,
) -> Result<Heard, String> {
    let mut heard = answers::read(&rubric.exam, &submission.folder)?;
    let used = |file: &str| asked.contains(file) || file == exchange::DECLARATIONS;
    let unused: Vec<&str> = holds.files.iter().map(String::as_str).filter(|file| !used(file)).collect();
    if let Some(first) = unused.first() {
        let more = if unused.len() > 1 { format!(" and {} more", unused.len() - 1) } else { String::new() };
        heard.notes.push(format!("not used, as no case asks for it: {first}{more}"));
    }
    Ok(heard)
}

fn ignored(others: &[String]) -> Option<String> {
    let first = others.first()?;
    let more = if others.len() > 1 { format!(" and {} more", others.len() - 1) } else { String::new() };
    Some(format!("not graded, as they are no folders: {first}{more}"))
}

/// Submissions that hold the same, byte for byte.
fn alike(found: &[Submission], keys: &[Result<String, String>]) -> Vec<String> {
    let mut same: BTreeMap<&String, Vec<&str>> = BTreeMap::new();
    for (submission, key) in found.iter().zip(keys).filter(|(submission, _)| submission.holds.is_ok()) {
        if let Ok(key) = key {
            same.entry(key).or_default().push(&submission.name);
        }
    }
    let mut groups: Vec<Vec<&str>> = same.into_values().filter(|names| names.len() > 1).collect();
    groups.sort();
    groups.iter().map(|names| format!("the same, byte for byte: {}", listed(names))).collect()
}

/// Pages and tables.
fn write(class: &Class, rubric: &Rubric, settings: &Settings) -> Result<()> {
    let (out, entries) = (settings.out, &class.entries[..]);
    for entry in entries {
        kept::write(&out.join(entry.page()), pages::of_student(entry, rubric, settings.reveal).as_bytes())?;
    }
    let whole = |name: &str, bytes: io::Result<Vec<u8>>| {
        let path = out.join(name);
        bytes.map_err(Error::writing(&path)).and_then(|bytes| kept::write(&path, &bytes))
    };
    whole("grades.csv", tables::csv(entries, rubric))?;
    whole("junit.xml", tables::junit(entries, rubric).map(String::into_bytes))?;
    whole("grades.json", Ok(tables::object(entries, rubric).to_string().into_bytes()))?;
    whole("index.html", Ok(pages::of_class(entries, rubric, &class.about).into_bytes()))
}
