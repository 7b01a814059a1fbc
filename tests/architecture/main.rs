//! The house rules, as far as a program can check them.

mod around;
mod complete;
mod imports;
mod names;
mod words;

use std::fs;
use std::path::{Path, PathBuf};

use around::{AROUND, TESTS, is_oracle};
use imports::component_folders;
use sha2::{Digest, Sha256};

/// What an oracle file may not contain, and why.
const FORBIDDEN: &[(&str, &str)] = &[
    ("f32", "the oracle is f64"),
    ("rayon", "the oracle has no threads"),
    ("parallel::", "the oracle has no threads"),
    ("unsafe", "the oracle is safe"),
    (".dot(", "ndarray's dot picks its order by CPU"),
    (".sum(", "an iterator's or array's sum hides its order"),
    ("macro_rules", "the oracle has no macros"),
    (".exp()", "std's functions differ between machines: crate::math"),
    (".sin()", "std's functions differ between machines: crate::math"),
    (".cos()", "std's functions differ between machines: crate::math"),
    (".ln()", "std's functions differ between machines: crate::math"),
    (".powf(", "std's functions differ between machines: crate::math"),
];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All .rs files below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![];
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The code of a file: without comments and without its test module.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("readable source");
    let tests = ["#[cfg(test)]\nmod tests {", "#[cfg(test)]\npub(super) mod tests {"];
    let text = tests.into_iter().fold(&*text, |text, tests| text.split(tests).next().unwrap_or_default());
    text.lines().map(|line| line.split("//").next().unwrap_or_default().to_string() + "\n").collect()
}

fn name(path: &Path) -> String {
    path.file_stem().expect("a name").to_string_lossy().into_owned()
}

/// The oracle files of a component folder: everything that isn't around them.
fn oracle_files(folder: &str) -> Vec<PathBuf> {
    let folder = root().join("src").join(folder);
    let mut files = sources(&folder);
    files.retain(|file| {
        let inside = file.strip_prefix(&folder).expect("below its folder");
        let first = inside.components().next().expect("a name");
        is_oracle(&name(Path::new(first.as_os_str())))
    });
    files
}

#[test]
fn what_is_around_the_oracle_is_there() {
    let src = root().join("src");
    for name in AROUND.iter().chain(TESTS) {
        let there =
            component_folders().iter().any(|folder| src.join(folder).join(format!("{name}.rs")).exists());
        assert!(there, "no component has {name}.rs: take it off tests/architecture/around.rs");
    }
}

#[test]
fn oracle_files_are_plain() {
    let mut files: Vec<PathBuf> =
        component_folders().iter().flat_map(|folder| oracle_files(folder)).collect();
    files.push(root().join("src/training/reference.rs"));
    assert!(files.len() > 12, "the oracle files were not found: {files:?}");
    for file in files {
        let code = code(&file);
        for (word, reason) in FORBIDDEN {
            let line = code.lines().position(|line| line.contains(word)).map(|n| n + 1);
            assert!(line.is_none(), "{}:{}: {word}: {reason}", file.display(), line.unwrap_or(0));
        }
        let lines = fs::read_to_string(&file).expect("readable source").lines().count();
        assert!(lines <= 300, "{}: {lines} lines; an oracle file has at most 300", file.display());
    }
}

/// The mutants of every oracle file were run, and each survivor is explained.
#[test]
fn mutants_are_killed_or_explained() {
    let read = |path: &str| fs::read_to_string(root().join(path)).expect("a readable file");
    let rows: serde_json::Value = serde_json::from_str(&read("tests/pages/MUTANTS.json")).expect("JSON");
    let equivalent: serde_json::Value = serde_json::from_str(&read("tools/mutants.json")).expect("JSON");
    let mut files: Vec<PathBuf> =
        component_folders().iter().flat_map(|folder| oracle_files(folder)).collect();
    files.extend(["math.rs", "random.rs", "training/reference.rs"].map(|file| root().join("src").join(file)));
    for file in files {
        let file = file.strip_prefix(root()).expect("below the root").display().to_string();
        let row = &rows[&file];
        assert!(row.is_object(), "{file} has no row: python tools/mutants.py {file}");
        let hash = Sha256::digest(fs::read(root().join(&file)).expect("readable source"));
        let hash: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(row["sha256"], hash, "{file} has changed since: python tools/mutants.py {file}");
        assert!(row["viable"].as_u64().is_some_and(|viable| viable > 0), "{file}: no mutant was tried");
        for survivor in row["survivors"].as_array().expect("a list") {
            let name = survivor.as_str().expect("a name");
            assert!(equivalent[name].is_string(), "{name} survives without a reason in tools/mutants.json");
        }
    }
}

#[test]
fn files_are_one_idea_long() {
    for file in sources(&root().join("src")) {
        let lines = fs::read_to_string(&file).expect("readable source").lines().count();
        assert!(lines <= 400, "{}: {lines} lines; split it by idea", file.display());
    }
}

#[test]
fn only_parallel_names_rayon_and_only_the_matrix_product_is_unsafe() {
    for file in sources(&root().join("src")) {
        let code = code(&file);
        let parallel = file.ends_with("src/parallel.rs");
        assert!(parallel || !code.contains("rayon::"), "{}: threads live in parallel.rs", file.display());
        // The gemm crate takes raw pointers; one function checks the sizes and hands them over.
        let product = file.ends_with("src/field/fast/product.rs");
        assert!(product || !code.contains("unsafe {"), "{}: no unsafe code", file.display());
    }
}

#[test]
fn nothing_is_left_open() {
    for file in sources(&root().join("src")).into_iter().chain(sources(&root().join("tests"))) {
        if file.ends_with("tests/architecture/main.rs") {
            continue;
        }
        let text = fs::read_to_string(&file).expect("readable source");
        for word in ["todo!(", "unimplemented!(", "TODO", "FIXME", "#[ignore"] {
            // A thread's own words may be quoted in the catalogue of mistakes.
            let quoted = text.lines().filter(|l| l.contains(word)).all(|l| l.contains("nerfacc FIXME"));
            assert!(quoted, "{}: {word}", file.display());
        }
    }
}
