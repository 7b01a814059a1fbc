//! The oracle refuses arrays whose lengths don't fit together, with a message that names them; and no public oracle function that
//! takes two arrays is left out.

use std::collections::BTreeMap;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

#[path = "../architecture/around.rs"]
mod around;
mod rows;

use around::is_oracle;

/// A public oracle function, a call that it takes, and calls that it must refuse, each with the words of its message.
#[derive(Debug)]
pub struct Row {
    /// Module path below the crate, the type where it is a method, and the name.
    name: &'static str,
    right: fn(),
    wrong: Vec<(&'static str, fn())>,
}

/// Functions of two arrays that have no lengths to compare, and why.
const ANY_LENGTHS: &[(&str, &str)] = &[
    ("importance_sampling::union", "two passes may have any numbers of samples"),
    ("field::trunk::Plan::join", "a trunk may have any width, and an encoding any number of columns"),
];

/// What a parameter that holds arrays has in its type. A type with arrays in it belongs here as soon as an oracle function takes it.
const ARRAYS: &[&str] = &[
    "&[",
    "&mut [",
    "Vec<",
    "Array",
    "Layer",
    "Level",
    "Mlp",
    "Tape",
    "Rendering",
    "Cotangent",
    "Scan",
    "Field",
    "Target",
    "Batch",
    "State",
    "OccupancyGrid",
];

/// A public function of an oracle file.
struct Function {
    /// Parameters that hold arrays, `self` among them.
    arrays: usize,
    /// Whether its documentation says when it panics.
    panics: bool,
}

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The oracle files: those of the component folders that aren't around them, and the reference of a training step.
fn oracle_files() -> Vec<PathBuf> {
    let mut files = vec![source().join("training/reference.rs")];
    for entry in fs::read_dir(source()).expect("src").map(|entry| entry.expect("an entry").path()) {
        if entry.join("honest.rs").exists() {
            let inside = fs::read_dir(&entry).expect("a folder").map(|file| file.expect("an entry").path());
            files.extend(inside.filter(|file| {
                let stem = file.file_stem().expect("a name").to_string_lossy().into_owned();
                file.is_file() && is_oracle(&stem)
            }));
        }
    }
    files
}

/// `src/field/mlp.rs` -> `field::mlp`, `src/field/mod.rs` -> `field`.
fn module(file: &Path) -> String {
    let inside = file.strip_prefix(source()).expect("below src").with_extension("");
    let parts: Vec<_> = inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    parts.join("::").trim_end_matches("::mod").to_string()
}

/// The parameters of a signature that begins behind its opening parenthesis.
fn parameters(text: &str) -> Vec<String> {
    let (mut all, mut one, mut depth) = (vec![], String::new(), 0);
    for c in text.chars() {
        match c {
            ')' if depth == 0 => break,
            ',' if depth == 0 => all.push(std::mem::take(&mut one)),
            _ => {
                depth += i32::from("([{<".contains(c)) - i32::from(")]}>".contains(c));
                one.push(c);
            }
        }
    }
    all.push(one);
    all.retain(|parameter| !parameter.trim().is_empty());
    all
}

/// The public functions of a file, by their paths.
fn functions(file: &Path) -> BTreeMap<String, Function> {
    let text = fs::read_to_string(file).expect("readable source");
    let text = text.split("#[cfg(test)]\nmod tests {").next().expect("a first part");
    let holds_arrays = |of: &str| ARRAYS.iter().any(|word| of.contains(word));
    let (mut found, mut owner, mut panics, mut at) = (BTreeMap::new(), None, false, 0);
    for line in text.split_inclusive('\n') {
        at += line.len();
        let trimmed = line.trim_start();
        if line.starts_with("impl") {
            let of = line.trim_end().trim_end_matches(" {");
            owner = Some(of.rsplit(' ').next().expect("a type").to_string());
        } else if line.starts_with('}') {
            owner = None;
        } else if trimmed.starts_with("///") {
            panics |= trimmed.contains("# Panics");
        } else if let Some(signature) = trimmed.strip_prefix("pub fn ") {
            let name = signature.split(['(', '<']).next().expect("a name");
            let path = [Some(module(file)), owner.clone(), Some(name.to_string())];
            let path = path.into_iter().flatten().collect::<Vec<_>>().join("::");
            let start = at - line.len() + line.find('(').expect("parameters") + 1;
            let arrays = parameters(&text[start..]).into_iter().filter(|parameter| {
                let of_self = parameter.trim().trim_start_matches(['&']).trim_start_matches("mut ") == "self";
                holds_arrays(if of_self { owner.as_deref().unwrap_or_default() } else { parameter })
            });
            found.insert(path, Function { arrays: arrays.count(), panics });
            panics = false;
        } else if !trimmed.starts_with('#') {
            panics = false;
        }
    }
    found
}

/// All public oracle functions.
fn oracle() -> BTreeMap<String, Function> {
    oracle_files().iter().flat_map(|file| functions(file)).collect()
}

/// The message with which a call panics; `None` if it returns.
fn refusal(call: fn()) -> Option<String> {
    let payload = catch_unwind(AssertUnwindSafe(call)).err()?;
    let said = payload.downcast_ref::<String>().cloned();
    Some(said.or(payload.downcast_ref::<&str>().map(|said| said.to_string())).unwrap_or_default())
}

#[test]
fn lengths_that_do_not_fit_are_refused_with_their_names() {
    for row in rows::all() {
        let said = refusal(row.right);
        assert!(said.is_none(), "{}: refuses a call whose lengths fit: {said:?}", row.name);
        for (n, (words, call)) in row.wrong.into_iter().enumerate() {
            let said =
                refusal(call).unwrap_or_else(|| panic!("{}: takes wrong call {n} ({words})", row.name));
            assert!(said.contains(words), "{}: wrong call {n} says {said:?} instead of {words:?}", row.name);
            // Both lengths are there too, where there are two.
            let lengths = said.contains("left: ") && said.contains("right: ");
            assert!(
                lengths || !words.contains(" and "),
                "{}: wrong call {n} names no lengths: {said:?}",
                row.name
            );
        }
    }
}

#[test]
fn every_public_oracle_function_of_two_arrays_is_in_the_table() {
    let (oracle, rows) = (oracle(), rows::all());
    assert!(oracle.len() > 60, "{} functions: the oracle files were not found", oracle.len());
    for row in &rows {
        assert!(oracle.contains_key(row.name), "{} is no public oracle function (any more)", row.name);
        assert!(oracle[row.name].panics, "{}: its documentation has no `# Panics`", row.name);
    }
    for (name, _) in ANY_LENGTHS {
        assert!(oracle.contains_key(*name), "{name} is no public oracle function (any more)");
    }
    for (name, function) in &oracle {
        let exempt = ANY_LENGTHS.iter().any(|(exempt, _)| exempt == name);
        if function.arrays < 2 || exempt {
            continue;
        }
        let row = rows.iter().find(|row| row.name == name).unwrap_or_else(|| {
            panic!("{name} takes {} arrays: assert their lengths, say so under `# Panics`, and add a row to tests/refuses/rows.rs", function.arrays)
        });
        let least = function.arrays - 1;
        assert!(
            row.wrong.len() >= least,
            "{name} takes {} arrays: {least} wrong calls at least",
            function.arrays
        );
    }
}

/// The scan itself: what it takes for a parameter, and whose.
#[test]
fn signatures_are_read() {
    assert_eq!(
        parameters("a: &[f64], b: (f64, f64), c: Vec<(A, B)>) -> D {"),
        ["a: &[f64]", " b: (f64, f64)", " c: Vec<(A, B)>"]
    );
    assert_eq!(parameters("&mut self) {"), ["&mut self"]);
    let oracle = oracle();
    let arrays = |name: &str| oracle[name].arrays;
    assert_eq!((arrays("loss::mse"), arrays("loss::psnr"), arrays("sample::step_sizes")), (2, 0, 1));
    assert_eq!((arrays("field::Layer::forward"), arrays("occupancy_grid::OccupancyGrid::update")), (2, 3));
    assert_eq!(arrays("volume_rendering::backward::volume_render"), 5);
}
