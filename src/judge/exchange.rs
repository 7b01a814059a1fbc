//! Files between the judge and other people's programs, as npz or as bare numbers ([`Layout`]). Nothing is trusted: every size is checked
//! before it is unpacked, nothing is executed, nothing outside the two folders is touched.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component as Part, Path};

use half::f16;
use ndarray::ArrayD;

use super::answer::{Answer, Answers, Given};
use super::declared::{self, Declarations, Declared};
use super::exam::{Exam, Manifest, Question, SCHEMA, Stored};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::convention::profiles;
use crate::error::{Error, Input, Result};
use crate::files::layout::{Layout, Store};
use crate::files::{self, npz};
use crate::parallel;

/// A manifest longer than this isn't one of ours.
const LONGEST_MANIFEST: u64 = 16 << 20;

/// Where a candidate declares what it takes.
pub(crate) const DECLARATIONS: &str = "answers.json";

/// The bytes by which an archive may be larger than its arrays: headers, the directory, a few small extras.
const SLACK: u64 = 64 << 10;

/// The cases once more, one a line, for programs that read no JSON: component, kind, id and folder, with spaces between.
pub const LIST: &str = "cases.txt";

/// Writes `cases.json` and the inputs of every case, as npz or raw; raw, the list of the cases too. Returns the bytes written.
///
/// # Errors
/// Where the folder can't be written.
pub fn write_cases(exam: &Exam, folder: &Path, layout: Layout) -> Result<u64> {
    for question in &exam.questions {
        files::make_folder(&folder.join(question.component.name))?;
    }
    let manifest = serde_json::to_string_pretty(&manifest(exam, layout)).expect("a manifest is plain data");
    files::write(&folder.join("cases.json"), &manifest)?;
    let questions: Vec<(&Question, &Case)> =
        exam.questions.iter().flat_map(|s| s.cases.iter().map(move |case| (s, case))).collect();
    let list = if layout == Layout::Raw { list(&questions) } else { String::new() };
    if !list.is_empty() {
        files::write(&folder.join(LIST), &list)?;
    }
    let written = parallel::map(questions.len(), |n| {
        let (question, case) = questions[n];
        layout.write(folder, &question.path(case), &packed(question, case, exam.dtype))
    });
    written.into_iter().try_fold((manifest.len() + list.len()) as u64, |sum, bytes| Ok(sum + bytes?))
}

/// The lines of [`LIST`].
pub fn list(cases: &[(&Question, &Case)]) -> String {
    let line = |(question, case): &(&Question, &Case)| {
        let (component, kind) = (question.component.name, question.kind_name());
        format!("{component} {kind} {} {}\n", case.id, question.path(case))
    };
    cases.iter().map(line).collect()
}

/// What `cases.json` says in a layout.
fn manifest(exam: &Exam, layout: Layout) -> Manifest {
    let mut manifest = exam.manifest();
    if layout != Layout::Npz {
        manifest.layout = Some(layout.to_string());
        let places = exam.questions.iter().flat_map(|s| s.cases.iter().map(|case| s.path(case)));
        for (entry, place) in manifest.cases.iter_mut().zip(places) {
            entry["file"] = layout.file(&place).into();
        }
    }
    manifest
}

/// A case's inputs in the types that the files have them in.
pub fn packed(question: &Question, case: &Case, dtype: Dtype) -> npz::Arrays {
    let array = |(name, a): (&String, &ArrayD<f64>)| (name.clone(), stored(name, a, question, dtype));
    case.inputs.iter().map(array).collect()
}

/// An input in the type that the files have it in.
pub(super) fn stored(name: &str, array: &ArrayD<f64>, question: &Question, dtype: Dtype) -> npz::Array {
    match question.stored(name, array.ndim(), dtype) {
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
    let layout = found.layout.as_deref().map_or(Ok(Layout::Npz), str::parse)?;
    complete(folder, &found, &manifest(&exam, layout))?;
    unchanged(&exam, folder, layout)?;
    Ok(exam)
}

/// The inputs in the files are the inputs that the truth is computed from.
fn unchanged(exam: &Exam, folder: &Path, layout: Layout) -> Result<()> {
    let questions = parallel::map(exam.questions.len(), |n| {
        let question = &exam.questions[n];
        let written = |case: &Case| as_written(layout, folder, &question.path(case), case);
        question.cases.iter().try_for_each(written)
    });
    questions.into_iter().collect()
}

/// Whether the files at a place hold a case's inputs.
///
/// # Errors
/// The first input that they don't hold.
pub(super) fn as_written(layout: Layout, folder: &Path, place: &str, case: &Case) -> Result<()> {
    let found = read_arrays(layout, folder, place, case.inputs.keys().collect(), bytes(&case.inputs))?;
    let other = |(name, input): &(&String, &ArrayD<f64>)| {
        found.get(*name).is_none_or(|found| !same(&found.values, input))
    };
    match case.inputs.iter().find(other) {
        None => Ok(()),
        Some((name, _)) => Err(Error::input(Input {
            file: folder.join(layout.file(place)).display(),
            field: format!("array {name}"),
            found: "other numbers than the case has",
            expected: "the inputs as they were written",
            remedy: "Write the cases again.",
        })),
    }
}

fn same(a: &ArrayD<f64>, b: &ArrayD<f64>) -> bool {
    a.shape() == b.shape() && a.iter().zip(b).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
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
    narrow: impl FnOnce(T, &BTreeMap<String, Declared>) -> std::result::Result<T, String>,
) -> Result<T> {
    let rows = declarations(folder)?;
    narrow(exam, &rows).map_err(|what| undeclarable(&folder.join(DECLARATIONS), "rows", what))
}

/// What a candidate declares in the folder of its answers, by row; nothing where it has no `answers.json`.
///
/// # Errors
/// A file that isn't what the contract says.
pub(crate) fn declarations(folder: &Path) -> Result<BTreeMap<String, Declared>> {
    let path = folder.join(DECLARATIONS);
    if !path.is_file() {
        return Ok(BTreeMap::new());
    }
    let wrong = |field: &str, found: String| undeclarable(&path, field, found);
    let size = fs::metadata(&path).map_err(Error::reading(&path))?.len();
    if size > LONGEST_MANIFEST {
        return Err(wrong("size", format!("{size} bytes")));
    }
    let found: Declarations =
        serde_json::from_str(&files::read_text(&path)?).map_err(|error| wrong("JSON", error.to_string()))?;
    if found.schema != declared::SCHEMA {
        return Err(wrong("schema", found.schema));
    }
    Ok(found.rows)
}

/// Declarations that can't be used.
pub(crate) fn undeclarable(path: &Path, field: &str, found: String) -> Error {
    let expected = format!("{} with rows by component/kind", declared::SCHEMA);
    let remedy = "Write it again, or remove it: then everything is asked.";
    Error::input(Input { file: path.display(), field, found, expected, remedy })
}

/// All answers below a folder, a list per question. Each lies at its case's place, in either layout.
///
/// # Errors
/// Anything in the folder that the manifest doesn't list, links, files that are damaged, too large, or don't hold numbers.
pub fn read_answers(exam: &Exam, folder: &Path) -> Result<Vec<Answers>> {
    nothing_else(exam, folder)?;
    let read = parallel::map(exam.questions.len(), |n| read_question(exam, &exam.questions[n], folder));
    read.into_iter().collect()
}

/// The answers to one question below a folder, whatever else lies there.
///
/// # Errors
/// Files that are damaged, too large, or don't hold numbers.
pub(crate) fn read_question(exam: &Exam, question: &Question, folder: &Path) -> Result<Answers> {
    let c = exam.conventions();
    let direction = question.component.direction(question.kind).expect("a question has its direction");
    let read = |case: &Case| -> Result<Option<Answer>> {
        let place = question.path(case);
        let Some(layout) = layout_of(folder, &place)? else { return Ok(None) };
        let outputs = (direction.oracle)(&case.inputs, &c);
        // Twice: an encoding may be wider in other conventions, and answers may contain the inputs too.
        let allowed = 2 * bytes(&outputs) + bytes(&case.inputs);
        read_arrays(layout, folder, &place, outputs.keys().collect(), allowed).map(Some)
    };
    question.cases.iter().map(read).collect()
}

/// The layout of the answer at a place, if there is one.
pub(super) fn layout_of(folder: &Path, place: &str) -> Result<Option<Layout>> {
    let there = |layout: &Layout| match layout {
        Layout::Npz => folder.join(layout.file(place)).exists(),
        Layout::Raw => folder.join(place).is_dir(),
    };
    match [Layout::Npz, Layout::Raw].into_iter().filter(there).collect::<Vec<_>>()[..] {
        [] => Ok(None),
        [layout] => Ok(Some(layout)),
        _ => Err(Error::input(Input {
            file: folder.join(place).display(),
            field: "answer",
            found: "an npz and a folder",
            expected: "one of them",
            remedy: "Remove the one that isn't meant.",
        })),
    }
}

/// Reads the arrays of these names, if all arrays at the place have at most `allowed` bytes (and some slack).
pub(super) fn read_arrays(
    layout: Layout,
    folder: &Path,
    place: &str,
    names: BTreeSet<&String>,
    allowed: u64,
) -> Result<BTreeMap<String, Given>> {
    let path = folder.join(layout.file(place));
    let expected = format!("at most {} bytes, as the manifest has it", allowed + SLACK);
    let remedy = "Store the outputs that cases.json lists, uncompressed (numpy.savez), and nothing else.";
    let refuse = |what: &str, found: String| {
        Err(Error::input(Input { file: path.display(), field: what, found, expected: &expected, remedy }))
    };
    let size = fs::metadata(&path).map_err(Error::reading(&path))?.len();
    if size > allowed + SLACK {
        return refuse("file", format!("{size} bytes"));
    }
    let mut store = Store::open(layout, folder, place)?;
    let unpacked = store.bytes();
    if unpacked > allowed + SLACK {
        return refuse("archive", format!("unpacks to {unpacked} bytes"));
    }
    let there = store.names();
    for name in &there {
        inside(&path, name)?;
    }
    let wanted = there.into_iter().filter(|name| names.contains(name));
    wanted
        .map(|name| {
            let array = store.array(&name)?;
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
    let places = || exam.questions.iter().flat_map(Question::paths);
    let archives: BTreeSet<_> = places().map(|place| folder.join(Layout::Npz.file(&place))).collect();
    // What lies in them is for their index to say.
    let raw: BTreeSet<_> = places().map(|place| folder.join(place)).collect();
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
            let asked = if kind.is_dir() { &raw } else { &archives };
            if !(kind.is_dir() || kind.is_file()) || !asked.contains(&entry.path()) {
                return refuse(&entry.path(), "something that no case asks for");
            }
        }
    }
    Ok(())
}
