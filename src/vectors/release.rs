//! A release of vectors: made from today's cases, oracles, bounds and mistakes, and written.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::index::{ACCEPT, Case as Entry, Flag, INDEX, Index, Outcome, Row, SCHEMA};
use super::{lines, sums};
use crate::contract::arithmetic::{Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::{Kind, worst};
use crate::contract::component::Mistake;
use crate::contract::hazard;
use crate::convention::Conventions;
use crate::convention::profiles::Profile;
use crate::error::{Error, Input, Result};
use crate::files::layout::Layout;
use crate::files::{self, npz};
use crate::judge::Exam;
use crate::judge::exam::Question;
use crate::judge::exchange::{LIST, list, packed};
use crate::judge::judging::EXP_ULP;
use crate::judge::mark::MarkOptions;
use crate::parallel;

/// Numbers of a case with more of which it is left out: a network of full size has 595,850 parameters.
pub const LARGEST: usize = 10_000;

/// The types that an answer is bounded in.
const DTYPES: [Dtype; 2] = [Dtype::F64, Dtype::F32];

/// Files that are the same in every release.
const SCHEMA_FILE: &str = include_str!("schema.json");
const README: &str = include_str!("README.md");

/// Vectors in memory.
#[derive(Clone, Debug)]
pub struct Release {
    /// What they are.
    pub index: Index,
    /// How they lie in files.
    pub layout: Layout,
    /// The arrays of every valid case, and of the invalid ones made of it, by place.
    pub arrays: BTreeMap<String, npz::Arrays>,
    /// A line for each valid case, for programs that read no JSON.
    list: String,
}

/// A case with what should come out.
struct Vector<'a> {
    case: &'a Case,
    expected: Arrays,
    /// How far off an honest answer may be in each type that the case exists in.
    allowed: Vec<(Dtype, Arrays)>,
}

/// What becomes of a question.
#[derive(Default)]
struct Made {
    rows: Vec<Row>,
    cases: Vec<Entry>,
    left_out: Vec<(String, String)>,
    arrays: BTreeMap<String, npz::Arrays>,
    list: String,
}

impl Release {
    /// The vectors of the components whose name or folder contains `filter`, in the profile's conventions.
    ///
    /// # Errors
    /// A filter that no component matches.
    pub fn new(filter: &str, profile: &'static Profile, layout: Layout) -> Result<Release> {
        let mut exam = Exam::new(filter, Dtype::F64, Some(profile))?;
        // Those that are for f32 alone.
        for other in Exam::new(filter, Dtype::F32, Some(profile))?.questions {
            let question = exam.questions.iter_mut().find(|question| question.row() == other.row());
            let Some(question) = question else { continue };
            let known: BTreeSet<String> = question.cases.iter().map(|case| case.id.clone()).collect();
            question.cases.extend(other.cases.into_iter().filter(|case| !known.contains(&case.id)));
        }
        let made = parallel::map(exam.questions.len(), |n| of_question(&exam.questions[n], profile, layout));
        let mut all = Made::default();
        for mut question in made {
            all.rows.append(&mut question.rows);
            all.cases.append(&mut question.cases);
            all.left_out.append(&mut question.left_out);
            all.arrays.append(&mut question.arrays);
            all.list += &question.list;
        }
        let index = Index {
            schema: SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            profile: profile.name.into(),
            filter: exam.filter.clone(),
            layout: layout.to_string(),
            accept: ACCEPT.into(),
            rows: all.rows,
            flags: glossary(&all.cases),
            left_out: all.left_out.into_iter().collect(),
            cases: all.cases,
        };
        Ok(Release { index, layout, arrays: all.arrays, list: all.list })
    }

    /// Writes them to a folder that is empty or isn't there yet, the checksums last. Returns the bytes written.
    ///
    /// # Errors
    /// A folder that holds something, or can't be written.
    pub fn write(&self, folder: &Path) -> Result<u64> {
        check_empty(folder)?;
        let places: Vec<_> = self.arrays.iter().collect();
        let written = parallel::map(places.len(), |n| self.layout.write(folder, places[n].0, places[n].1));
        let mut bytes = written.into_iter().sum::<Result<u64>>()?;
        let index = lines::text(&self.index).expect("an index is plain data") + "\n";
        let mut texts = vec![(INDEX, &index[..]), ("schema.json", SCHEMA_FILE), ("README.md", README)];
        if self.layout == Layout::Raw {
            texts.push((LIST, &self.list));
        }
        for (name, text) in texts {
            files::write(&folder.join(name), text)?;
            bytes += text.len() as u64;
        }
        Ok(bytes + sums::write(folder)?)
    }
}

/// That nothing of another release can be left between the new files.
fn check_empty(folder: &Path) -> Result<()> {
    match fs::read_dir(folder).map(|mut entries| entries.next().is_none()) {
        Ok(true) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => files::check_writable(folder),
        Err(error) => Err(Error::writing(folder)(error)),
        Ok(false) => Err(Error::input(Input {
            file: folder.display(),
            field: "folder",
            found: "files in it",
            expected: "an empty folder, or none",
            remedy: "Name a new one, and put it in the other's place.",
        })),
    }
}

fn of_question(question: &Question, profile: &Profile, layout: Layout) -> Made {
    let mut made = Made::default();
    if question.statistics() {
        let why = "judged by the statistics of thousands of draws: no single answer is the right one";
        made.left_out.push((question.row(), why.into()));
        return made;
    }
    let c = &profile.conventions;
    made.rows.push(Row::new(question, c));
    let vectors = kept(question, c, &mut made.left_out);
    for vector in &vectors {
        made.list += &list(&[(question, vector.case)]);
        made.cases.push(vector.entry(question, layout));
        made.arrays.insert(question.path(vector.case), vector.arrays(question));
    }
    for mistake in question.component.mistakes.iter().filter(|m| m.gradient == (question.kind == Kind::Vjp)) {
        if let Some((vector, wrong, dtypes)) = caught(question, &vectors, mistake, c) {
            made.cases.push(vector.invalid(question, layout, mistake, &wrong, dtypes));
            let arrays = made.arrays.get_mut(&question.path(vector.case)).expect("its case is there");
            arrays.extend(named(&format!("wrong.{}", mistake.name), &wrong));
        }
    }
    made
}

/// The cases that aren't too large.
fn kept<'a>(
    question: &'a Question,
    c: &Conventions,
    left_out: &mut Vec<(String, String)>,
) -> Vec<Vector<'a>> {
    let mut kept = vec![];
    for case in &question.cases {
        let numbers = case.size();
        if numbers > LARGEST {
            let why = format!("{numbers} numbers, too many to keep; `cases` writes it");
            left_out.push((format!("{}/{}", question.row(), case.id), why));
            continue;
        }
        let truth = |dtype| MarkOptions { dtype, exp_ulp: EXP_ULP }.truth(question, case, c, Grade::B);
        let dtypes = DTYPES.into_iter().filter(|dtype| case.exists_in(*dtype));
        let allowed = dtypes.map(|dtype| (dtype, truth(dtype).bound.clone())).collect();
        kept.push(Vector { case, expected: (*truth(Dtype::F64).expected).clone(), allowed });
    }
    kept
}

/// The smallest case that shows a mistake in the most types, with the outputs that are wrong and these types.
fn caught<'a>(
    question: &Question,
    vectors: &'a [Vector<'a>],
    mistake: &Mistake,
    c: &Conventions,
) -> Option<(&'a Vector<'a>, Arrays, Vec<Dtype>)> {
    let direction = question.component.direction(question.kind).expect("a question has its direction");
    let mut by_size: Vec<&Vector> = vectors.iter().collect();
    by_size.sort_by_key(|vector| vector.case.size());
    let mut best = None;
    for vector in by_size {
        let answer = (direction.wrong)(&vector.case.inputs, c, &[mistake.name]);
        let (mut wrong, mut dtypes) = (Arrays::new(), vec![]);
        for (dtype, allowed) in &vector.allowed {
            let off = vector.off(&answer, allowed);
            dtypes.extend((!off.is_empty()).then_some(*dtype));
            wrong.extend(off);
        }
        if dtypes.len() > best.as_ref().map_or(0, |(_, _, dtypes): &(_, _, Vec<_>)| dtypes.len()) {
            best = Some((vector, wrong, dtypes));
        }
    }
    best
}

impl Vector<'_> {
    /// The outputs of an answer that are further off than is allowed.
    fn off(&self, answer: &Arrays, allowed: &Arrays) -> Arrays {
        let alone = |arrays: &Arrays, name: &String| Arrays::from([(name.clone(), arrays[name].clone())]);
        let used = |name: &String| worst(answer, &alone(&self.expected, name), allowed);
        let off = self.expected.keys().filter(|name| used(name) > 1.0);
        off.map(|name| (name.clone(), answer[name].clone())).collect()
    }

    fn arrays(&self, question: &Question) -> npz::Arrays {
        let mut arrays: npz::Arrays = packed(question, self.case, Dtype::F64)
            .into_iter()
            .map(|(name, array)| (format!("inputs.{name}"), array))
            .collect();
        arrays.extend(named("expected", &self.expected));
        for (dtype, allowed) in &self.allowed {
            arrays.extend(named(&format!("allowed_{dtype}"), allowed));
        }
        arrays
    }

    fn entry(&self, question: &Question, layout: Layout) -> Entry {
        Entry {
            id: format!("{}/{}", question.row(), self.case.id),
            row: question.row(),
            result: Outcome::Valid,
            file: layout.file(&question.path(self.case)),
            answer: "expected".into(),
            dtypes: self.allowed.iter().map(|(dtype, _)| dtype.to_string()).collect(),
            comment: self.case.comment.into(),
            flags: flags(self.case),
            inputs: shapes(&self.case.inputs),
            outputs: shapes(&self.expected),
        }
    }

    /// The same case, answered with a mistake.
    fn invalid(
        &self,
        question: &Question,
        layout: Layout,
        mistake: &Mistake,
        wrong: &Arrays,
        dtypes: Vec<Dtype>,
    ) -> Entry {
        let valid = self.entry(question, layout);
        Entry {
            id: format!("{}/{}", valid.id, mistake.name),
            result: Outcome::Invalid,
            answer: format!("wrong.{}", mistake.name),
            dtypes: dtypes.iter().map(Dtype::to_string).collect(),
            comment: mistake.cause.into(),
            outputs: shapes(wrong),
            ..valid
        }
    }
}

fn named(group: &str, arrays: &Arrays) -> npz::Arrays {
    arrays.iter().map(|(name, array)| (format!("{group}.{name}"), array.clone().into())).collect()
}

fn shapes(arrays: &Arrays) -> BTreeMap<String, Vec<usize>> {
    arrays.iter().map(|(name, array)| (name.clone(), array.shape().to_vec())).collect()
}

/// Flags besides the hazards: name, title, effect.
const PECULIAR: [(&str, &str, &str); 2] = [
    ("edge", "an edge case, which few programs ever meet", "code that can't take it crashes, or returns NaN"),
    (
        "every_bit",
        "numbers that use every bit of f32 or of f64",
        "inputs that are rounded to a shorter type on the way show",
    ),
];

fn flags(case: &Case) -> Vec<String> {
    let hazard = hazard::of_case(&case.id).map(|hazard| hazard.id);
    let [(edge, ..), (every_bit, ..)] = PECULIAR;
    let peculiar = [case.edge.map(|_| edge), case.full.map(|_| every_bit)];
    hazard.into_iter().chain(peculiar.into_iter().flatten()).map(String::from).collect()
}

/// What the flags of these cases mean.
fn glossary(cases: &[Entry]) -> BTreeMap<String, Flag> {
    let hazards = hazard::HAZARDS.iter().map(|h| (h.id, [h.title, h.effect, h.seen]));
    let peculiar = PECULIAR.iter().map(|&(id, title, effect)| (id, [title, effect, "made for the purpose"]));
    let used = |id: &str| cases.iter().any(|case| case.flags.iter().any(|flag| flag == id));
    let flag = |[title, effect, seen]: [&str; 3]| Flag {
        title: title.into(),
        effect: effect.into(),
        seen: seen.into(),
    };
    hazards
        .chain(peculiar)
        .filter(|(id, _)| used(id))
        .map(|(id, says)| (id.to_string(), flag(says)))
        .collect()
}
