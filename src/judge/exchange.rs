//! Files between the judge and other people's programs. Nothing is trusted: every size is checked before it is unpacked, nothing
//! is executed, nothing outside the two folders is touched.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component as Part, Path};

use half::f16;
use ndarray::ArrayD;

use super::answer::{Answer, Answers, Given};
use super::declared::{self, Declarations, Declared};
use super::exam::{Exam, Manifest, Question, SCHEMA, Stored};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::convention::profiles;
use crate::error::{Error, Input, Result};
use crate::files::{self, npz};
use crate::parallel;

/// A manifest longer than this isn't one of ours.
const LONGEST_MANIFEST: u64 = 16 << 20;

/// Where a candidate declares what it takes.
const DECLARATIONS: &str = "answers.json";

/// The bytes by which an archive may be larger than its arrays: headers, the directory, a few small extras.
const SLACK: u64 = 64 << 10;

/// Writes `cases.json` and one npz a case. Returns the bytes written.
///
/// # Errors
/// Where the folder can't be written.
pub fn write_cases(exam: &Exam, folder: &Path) -> Result<u64> {
    for question in &exam.questions {
        files::make_folder(&folder.join(question.component.name))?;
    }
    let manifest = serde_json::to_string_pretty(&exam.manifest()).expect("a manifest is plain data");
    files::write(&folder.join("cases.json"), &manifest)?;
    let questions: Vec<(&Question, &Case)> =
        exam.questions.iter().flat_map(|s| s.cases.iter().map(move |case| (s, case))).collect();
    let written = parallel::map(questions.len(), |n| {
        let (question, case) = questions[n];
        let path = folder.join(question.path(case) + ".npz");
        let arrays = |(name, a): (&String, &ArrayD<f64>)| (name.clone(), packed(name, a, question, exam));
        npz::write(&path, &case.inputs.iter().map(arrays).collect(), false)?;
        fs::metadata(&path).map(|data| data.len()).map_err(Error::reading(&path))
    });
    written.into_iter().try_fold(manifest.len() as u64, |sum, bytes| Ok(sum + bytes?))
}

/// An input in the type that the files have it in.
pub(super) fn packed(name: &str, array: &ArrayD<f64>, question: &Question, exam: &Exam) -> npz::Array {
    match question.stored(name, array.ndim(), exam.dtype) {
        Stored::F64 => array.clone().into(),
        Stored::F32 => array.mapv(|x| x as f32).into(),
        Stored::F16 => array.mapv(f16::from_f64).into(),
        Stored::I64 => array.mapv(|x| x as i64).into(),
        Stored::U8 => array.mapv(|x| x as u8).into(),
    }
}

/// What `cases.json` in a folder says, of whichever tier.
///
/// # Errors
/// A file that isn't what [`write_cases`] writes in this version.
pub fn read_manifest(folder: &Path) -> Result<Manifest> {
    let path = folder.join("cases.json");
    let size = fs::metadata(&path).map_err(Error::reading(&path))?.len();
    if size > LONGEST_MANIFEST {
        return Err(wrong(&path, "size", format!("{size} bytes"), "a manifest of cases, as it was written"));
    }
    let found: Manifest = serde_json::from_str(&files::read_text(&path)?)
        .map_err(|error| wrong(&path, "JSON", error.to_string(), "a manifest of cases, as it was written"))?;
    if found.schema != SCHEMA || found.version != env!("CARGO_PKG_VERSION") {
        let here = format!("{SCHEMA} of version {}", env!("CARGO_PKG_VERSION"));
        return Err(wrong(&path, "schema", format!("{} of version {}", found.schema, found.version), &here));
    }
    for entry in &found.cases {
        inside(&path, entry["file"].as_str().unwrap_or_default())?;
    }
    Ok(found)
}

fn wrong(path: &Path, field: &str, found: String, expected: &str) -> Error {
    let remedy = "Write the cases again, into an empty folder.";
    Error::input(Input { file: path.display(), field, found, expected, remedy })
}

/// Whether a manifest has each case of the one that is expected, and no other.
///
/// # Errors
/// The first case that it doesn't have.
pub(super) fn complete(folder: &Path, found: &Manifest, expected: &Manifest) -> Result<()> {
    let path = folder.join("cases.json");
    if let Some(entry) = expected.cases.iter().find(|entry| !found.cases.contains(entry)) {
        return Err(wrong(
            &path,
            "cases",
            format!("no entry like {}", entry["file"]),
            "every case, unchanged",
        ));
    }
    if found.cases.len() != expected.cases.len() || found.tier != expected.tier {
        return Err(wrong(&path, "cases", format!("{} entries", found.cases.len()), "each case once"));
    }
    Ok(())
}

/// The exam that a folder of cases holds: built again here, then compared, so that no question or input can have been left out or
/// changed.
///
/// # Errors
/// A manifest or an npz that isn't what [`write_cases`] writes, named with its file.
pub fn read_exam(folder: &Path) -> Result<Exam> {
    let found = read_manifest(folder)?;
    let profile = found.profile.as_deref().map(profiles::find).transpose()?;
    let exam = Exam::new(&found.filter, found.dtype.parse()?, profile)?;
    complete(folder, &found, &exam.manifest())?;
    unchanged(&exam, folder)?;
    Ok(exam)
}

/// The inputs in the files are the inputs that the truth is computed from.
fn unchanged(exam: &Exam, folder: &Path) -> Result<()> {
    let questions = parallel::map(exam.questions.len(), |n| {
        let question = &exam.questions[n];
        let written = |case: &Case| as_written(&folder.join(question.path(case) + ".npz"), case);
        question.cases.iter().try_for_each(written)
    });
    questions.into_iter().collect()
}

/// Whether a file holds a case's inputs.
///
/// # Errors
/// The first input that it doesn't hold.
pub(super) fn as_written(path: &Path, case: &Case) -> Result<()> {
    let found = read_arrays(path, case.inputs.keys().collect(), bytes(&case.inputs))?;
    let other = |(name, input): &(&String, &ArrayD<f64>)| {
        found.get(*name).is_none_or(|found| !same(&found.values, input))
    };
    match case.inputs.iter().find(other) {
        None => Ok(()),
        Some((name, _)) => Err(Error::input(Input {
            file: path.display(),
            field: format!("array {name}"),
            found: "other numbers than the case has",
            expected: "the inputs as they were written",
            remedy: "Write the cases again.",
        })),
    }
}

fn same(a: &ArrayD<f64>, b: &ArrayD<f64>) -> bool {
    a.shape() == b.shape() && a.iter().zip(b).all(|(a, b)| a == b)
}

fn bytes(arrays: &Arrays) -> u64 {
    arrays.values().map(|array| 8 * array.len() as u64).sum()
}

/// The exam as a candidate is asked it that may have declared something: `answers.json` in the folder of its answers.
///
/// # Errors
/// A file that isn't what the contract says, or that names what the exam doesn't have.
pub fn declared(exam: Exam, folder: &Path) -> Result<Exam> {
    narrowed(exam, folder, Exam::narrowed)
}

/// The same of an exam of either tier.
pub(super) fn narrowed<T>(
    exam: T,
    folder: &Path,
    narrow: impl FnOnce(T, &BTreeMap<String, Declared>) -> Result<T, String>,
) -> Result<T> {
    let path = folder.join(DECLARATIONS);
    if !path.is_file() {
        return Ok(exam);
    }
    let wrong = |field: &str, found: String| {
        let expected = format!("{} with rows by component/kind", declared::SCHEMA);
        let remedy = "Write it again, or remove it: then everything is asked.";
        Error::input(Input { file: path.display(), field, found, expected, remedy })
    };
    let size = fs::metadata(&path).map_err(Error::reading(&path))?.len();
    if size > LONGEST_MANIFEST {
        return Err(wrong("size", format!("{size} bytes")));
    }
    let found: Declarations =
        serde_json::from_str(&files::read_text(&path)?).map_err(|error| wrong("JSON", error.to_string()))?;
    if found.schema != declared::SCHEMA {
        return Err(wrong("schema", found.schema));
    }
    narrow(exam, &found.rows).map_err(|what| wrong("rows", what))
}

/// All answers below a folder, a list per question.
///
/// # Errors
/// Anything in the folder that the manifest doesn't list, links, files that are damaged, too large, or don't hold numbers.
pub fn read_answers(exam: &Exam, folder: &Path) -> Result<Vec<Answers>> {
    nothing_else(exam, folder)?;
    let c = exam.conventions();
    let questions = parallel::map(exam.questions.len(), |n| {
        let question = &exam.questions[n];
        let direction = question.component.direction(question.kind).expect("a question has its direction");
        let read = |case: &Case| -> Result<Option<Answer>> {
            let path = folder.join(question.path(case) + ".npz");
            if !path.exists() {
                return Ok(None);
            }
            let outputs = (direction.oracle)(&case.inputs, &c);
            // Twice: an encoding may be wider in other conventions, and answers may contain the inputs too.
            let allowed = 2 * bytes(&outputs) + bytes(&case.inputs);
            read_arrays(&path, outputs.keys().collect(), allowed).map(Some)
        };
        question.cases.iter().map(read).collect::<Result<Answers>>()
    });
    questions.into_iter().collect()
}

/// Reads the arrays of these names, if the archive unpacks to at most `allowed` bytes (and some slack).
pub(super) fn read_arrays(
    path: &Path,
    names: BTreeSet<&String>,
    allowed: u64,
) -> Result<BTreeMap<String, Given>> {
    let expected = format!("at most {} bytes, as the manifest has it", allowed + SLACK);
    let remedy = "Store the outputs that cases.json lists, uncompressed (numpy.savez), and nothing else.";
    let refuse = |what: &str, found: String| {
        Err(Error::input(Input { file: path.display(), field: what, found, expected: &expected, remedy }))
    };
    let size = fs::metadata(path).map_err(Error::reading(path))?.len();
    if size > allowed + SLACK {
        return refuse("file", format!("{size} bytes"));
    }
    let mut archive = npz::Npz::open(path)?;
    let unpacked = archive.unpacked_bytes();
    if unpacked > allowed + SLACK {
        return refuse("archive", format!("unpacks to {unpacked} bytes"));
    }
    let there: Vec<String> = archive.names().map(String::from).collect();
    for name in &there {
        inside(path, name)?;
    }
    let wanted = there.into_iter().filter(|name| names.contains(name));
    wanted
        .map(|name| {
            let array = archive.array(&name)?;
            Ok((name, Given { values: array.to_f64(), dtype: array.dtype() }))
        })
        .collect()
}

/// Refuses names that climb out of their folder.
fn inside(file: &Path, name: &str) -> Result<()> {
    let plain = Path::new(name).components().all(|part| matches!(part, Part::Normal(_)));
    if plain && !name.is_empty() && !name.contains(['\\', '\0']) {
        return Ok(());
    }
    let remedy = "Use the names that cases.json lists.";
    Err(Error::input(Input {
        file: file.display(),
        field: "name",
        found: name,
        expected: "a name inside the folder",
        remedy,
    }))
}

/// Refuses whatever else lies in the folder of answers: a file in the wrong place would silently not be judged.
pub(super) fn nothing_else(exam: &Exam, folder: &Path) -> Result<()> {
    let asked: BTreeSet<_> =
        exam.questions.iter().flat_map(Question::paths).map(|path| folder.join(path + ".npz")).collect();
    let folders: BTreeSet<_> = exam.questions.iter().map(|s| folder.join(s.component.name)).collect();
    let entries = |folder: &Path| -> Result<Vec<fs::DirEntry>> {
        let list = fs::read_dir(folder).map_err(Error::reading(folder))?;
        list.collect::<std::io::Result<_>>().map_err(Error::reading(folder))
    };
    let refuse = |path: &Path, found: &str| {
        let remedy = "Remove it, or store it at the `file` that cases.json gives.";
        Err(Error::input(Input {
            file: path.display(),
            field: "answers",
            found,
            expected: "only files that cases.json lists",
            remedy,
        }))
    };
    for entry in entries(folder)? {
        let (path, kind) = (entry.path(), entry.file_type().map_err(Error::reading(folder))?);
        if kind.is_symlink() {
            return refuse(&path, "a link");
        }
        if kind.is_file() && path == folder.join(DECLARATIONS) {
            continue;
        }
        if !kind.is_dir() || !folders.contains(&path) {
            return refuse(&path, "something that no case asks for");
        }
        for entry in entries(&path)? {
            let kind = entry.file_type().map_err(Error::reading(&path))?;
            if kind.is_symlink() {
                return refuse(&entry.path(), "a link");
            }
            if !kind.is_file() || !asked.contains(&entry.path()) {
                return refuse(&entry.path(), "something that no case asks for");
            }
        }
    }
    Ok(())
}
