//! Frozen vectors: what a release holds, that its answers are right or wrong as they say, that it is the same every time, and that
//! whatever is changed in one is named.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use nerf_oracle::contract::check::{Kind, budget_used};
use nerf_oracle::convention::profiles::{self, PROFILES};
use nerf_oracle::files::layout::Layout;
use nerf_oracle::files::npz::{self, Array};
use nerf_oracle::parallel;
use nerf_oracle::registry::all_rows;
use nerf_oracle::vectors::{Case, Index, Outcome, Release, verify};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use tempfile::TempDir;

/// The whole release, made once.
fn whole() -> &'static Release {
    static WHOLE: OnceLock<Release> = OnceLock::new();
    WHOLE.get_or_init(|| release("", Layout::Npz))
}

fn release(filter: &str, layout: Layout) -> Release {
    Release::new(filter, profiles::find("cs180").unwrap(), layout).unwrap()
}

/// A small one, written.
fn written(layout: Layout) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    release("composite_background", layout).write(folder.path()).unwrap();
    folder
}

/// All files below a folder, by their names.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut left = vec![folder.to_path_buf()];
    while let Some(next) = left.pop() {
        for path in fs::read_dir(next).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                left.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string().replace('\\', "/");
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

/// The arrays of a case: its answer, what is expected, and what is allowed in a type.
fn arrays<'a>(release: &'a Release, case: &'a Case, dtype: &str) -> Vec<[&'a Array; 3]> {
    let place = case.file.strip_suffix(".npz").unwrap();
    let of = |group: &str, name: &str| &release.arrays[place][&format!("{group}.{name}")];
    let allowed = format!("allowed_{dtype}");
    let names = case.outputs.keys();
    names.map(|name| [of(&case.answer, name), of("expected", name), of(&allowed, name)]).collect()
}

/// The rule of the README, in its own words.
fn accepted([got, expected, allowed]: [&Array; 3]) -> bool {
    let [got, expected, allowed] = [got, expected, allowed].map(Array::to_f64);
    let right = |((got, expected), allowed): ((&f64, &f64), &f64)| {
        got == expected || (got - expected).abs() <= *allowed || *allowed == f64::INFINITY
    };
    got.shape() == expected.shape() && got.iter().zip(&expected).zip(&allowed).all(right)
}

#[test]
fn valid_answers_are_right_and_invalid_ones_are_wrong() {
    for case in &whole().index.cases {
        for dtype in &case.dtypes {
            let right = arrays(whole(), case, dtype).into_iter().all(accepted);
            assert_eq!(right, case.result == Outcome::Valid, "{} in {dtype}", case.id);
        }
    }
}

/// The rule that everybody can write in a line is the judge's own, of right answers and wrong ones, and of NaN.
#[test]
fn the_rule_is_the_judges() {
    let judged = |[got, expected, allowed]: [&Array; 3]| {
        let [got, expected, allowed] = [got, expected, allowed].map(Array::to_f64);
        let all = got.iter().zip(&expected).zip(&allowed);
        got.shape() == expected.shape() && all.into_iter().all(|((&g, &e), &b)| budget_used(g, e, b) <= 1.0)
    };
    for case in &whole().index.cases {
        for [got, expected, allowed] in case.dtypes.iter().flat_map(|dtype| arrays(whole(), case, dtype)) {
            assert_eq!(judged([got, expected, allowed]), accepted([got, expected, allowed]), "{}", case.id);
            let nowhere = expected.to_f64().mapv(|_| f64::NAN).into();
            assert_eq!(
                judged([&nowhere, expected, allowed]),
                accepted([&nowhere, expected, allowed]),
                "{}",
                case.id
            );
        }
    }
}

#[test]
fn every_row_and_every_mistake_is_there() {
    let index = &whole().index;
    let left_out: Vec<&String> = index.left_out.keys().collect();
    let large = ["nerf_mlp/forward/full_size", "nerf_mlp/forward/width_32", "nerf_mlp/vjp/width_32"];
    assert_eq!(left_out, [&large[..], &["sample_random_rays/statistics"]].concat());
    let ids: BTreeSet<&String> = index.cases.iter().map(|case| &case.id).collect();
    assert_eq!(ids.len(), index.cases.len());
    for component in all_rows().filter(|c| c.special.statistics.is_none()) {
        for kind in [Kind::Forward, Kind::Vjp].into_iter().filter(|kind| component.direction(*kind).is_some())
        {
            let name = if kind == Kind::Vjp { "vjp" } else { component.special.forward_name };
            let row = format!("{}/{name}", component.name);
            assert!(index.rows.iter().any(|r| r.name == row), "{row}");
            let of_row: Vec<&Case> = index.cases.iter().filter(|case| case.row == row).collect();
            for dtype in ["f64", "f32"] {
                let valid =
                    |case: &&Case| case.result == Outcome::Valid && case.dtypes.iter().any(|d| d == dtype);
                assert!(of_row.iter().any(valid), "{row} in {dtype}");
            }
            for mistake in component.mistakes.iter().filter(|m| m.gradient == (kind == Kind::Vjp)) {
                let answer = format!("wrong.{}", mistake.name);
                assert!(of_row.iter().any(|case| case.answer == answer), "{row}: {answer}");
            }
        }
    }
    for flag in index.cases.iter().flat_map(|case| &case.flags) {
        assert!(index.flags.contains_key(flag), "{flag}");
    }
}

/// 10 MiB are what a project may be asked to keep.
#[test]
fn all_of_it_is_small_and_the_same_every_time() {
    let [one, other] = [1, 3].map(|threads| {
        let folder = tempfile::tempdir().unwrap();
        let written = parallel::with_threads(Some(threads), || match threads {
            1 => whole().write(folder.path()),
            _ => release("", Layout::Npz).write(folder.path()),
        });
        (written.unwrap(), folder)
    });
    let [a, b] = [&one.1, &other.1].map(|folder| files(folder.path()));
    assert!(a == b && a.len() > 600);
    let bytes: usize = a.values().map(Vec::len).sum();
    assert_eq!(bytes as u64, one.0);
    assert!(bytes < 10 << 20, "{bytes} bytes");
    println!("{bytes} bytes in {} files, index.json {}", a.len(), a["index.json"].len());
}

#[test]
fn every_profile_has_vectors() {
    for profile in PROFILES {
        for filter in ["volume_render", "image_rays", "positional_encoding"] {
            let release = Release::new(filter, profile, Layout::Npz).unwrap();
            assert!(release.index.cases.len() > 10, "{} {filter}", profile.name);
        }
    }
}

/// What `verify` says of a small release that was changed.
fn differences(layout: Layout, change: impl FnOnce(&Path)) -> Vec<String> {
    let folder = written(layout);
    change(folder.path());
    verify(folder.path()).unwrap().differences
}

/// Takes the sums anew: whoever changes a file can do that too.
fn sums_taken_again(folder: &Path) {
    let files = files(folder).into_iter().filter(|(name, _)| name != "SHA256SUMS");
    let line = |(name, bytes): (String, Vec<u8>)| {
        let sum: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        format!("{sum}  {name}\n")
    };
    fs::write(folder.join("SHA256SUMS"), files.map(line).collect::<String>()).unwrap();
}

fn changed_index(folder: &Path, change: impl FnOnce(&mut Index)) {
    let path = folder.join("index.json");
    let mut index: Index = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    change(&mut index);
    fs::write(path, serde_json::to_string(&index).unwrap()).unwrap();
    sums_taken_again(folder);
}

const FIRST: &str = "composite_background/forward-three_opacities.npz";

#[test]
fn a_file_that_changed_is_named() {
    for layout in [Layout::Npz, Layout::Raw] {
        assert_eq!(differences(layout, |_| ()), [""; 0]);
        assert_eq!(differences(layout, sums_taken_again), [""; 0], "they are what sha256sum writes");
    }
    let flipped = differences(Layout::Npz, |folder| {
        let mut bytes = fs::read(folder.join(FIRST)).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(folder.join(FIRST), bytes).unwrap();
    });
    assert_eq!(flipped, [format!("{FIRST}: not the bytes that its sum was taken of")]);
    let gone = differences(Layout::Npz, |folder| fs::remove_file(folder.join(FIRST)).unwrap());
    assert_eq!(gone, [format!("{FIRST}: listed in SHA256SUMS, and not there")]);
    let more = differences(Layout::Npz, |folder| fs::write(folder.join("notes.txt"), "x").unwrap());
    assert_eq!(more, ["notes.txt: not listed in SHA256SUMS"]);
}

#[test]
fn what_would_be_written_otherwise_today_is_named() {
    let other = |change: &dyn Fn(&mut npz::Arrays)| {
        differences(Layout::Npz, |folder| {
            let path = folder.join(FIRST);
            let mut arrays = npz::read(&path).unwrap();
            change(&mut arrays);
            npz::write(&path, &arrays, false).unwrap();
            sums_taken_again(folder);
        })
    };
    let element = other(&|arrays| {
        let Some(Array::F64(colors)) = arrays.get_mut("expected.colors_out") else { panic!("no such array") };
        colors[[1, 2]] = 7.0;
        colors[[2, 0]] = 8.0;
    });
    let said = format!("{FIRST}: expected.colors_out: [1, 2] is 7e0, today ");
    assert!(element.len() == 1 && element[0].starts_with(&said), "{element:?}");
    assert!(element[0].ends_with(", and 1 more"), "{element:?}");
    let shape =
        other(&|arrays| drop(arrays.insert("allowed_f32.colors_out".into(), ndarray::arr1(&[1.0]).into())));
    assert_eq!(shape, [format!("{FIRST}: allowed_f32.colors_out: f64 [1], today f64 [3, 3]")]);
    let gone = other(&|arrays| drop(arrays.remove("inputs.opacity").unwrap()));
    assert_eq!(gone, [format!("{FIRST}: inputs.opacity: new since")]);
    let more = other(&|arrays| drop(arrays.insert("inputs.time".into(), ndarray::arr1(&[1.0]).into())));
    assert_eq!(more, [format!("{FIRST}: inputs.time: today there is no such array")]);

    let index =
        |change: &dyn Fn(&mut Index)| differences(Layout::Npz, |folder| changed_index(folder, change));
    let id = "composite_background/forward/three_opacities";
    assert_eq!(
        index(&|index| index.cases[0].comment = "x".into()),
        [format!("{id}: described otherwise today")]
    );
    assert_eq!(index(&|index| drop(index.cases.remove(0))), [format!("{id}: new since")]);
    let renamed = index(&|index| index.cases[0].id += "_of_old");
    assert_eq!(renamed, [format!("{id}: new since"), format!("{id}_of_old: today there is no such case")]);
    assert_eq!(index(&|index| index.rows.clear()), ["index.json: rows: described otherwise today"]);
}

/// Exit codes, and what is refused.
#[test]
fn the_program_writes_and_checks() {
    let root = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| {
        let program =
            Command::new(env!("CARGO_BIN_EXE_nerf-oracle")).args(args).current_dir(root.path()).output();
        let output = program.expect("the program starts");
        let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        (output.status.code(), text.concat())
    };
    let expect = |args: &[&str], code: i32, words: &str| {
        let (ended, said) = run(args);
        assert_eq!(ended, Some(code), "{args:?}: {said}");
        assert!(said.contains(words), "{args:?}: {said}");
    };
    expect(&["vectors", "composite", "--out", "kept"], 0, "rows in kept");
    expect(&["vectors", "--verify", "kept"], 0, "whole, and what would be written today");
    let (_, said) = run(&["vectors", "--verify", "kept", "--json"]);
    let object: Value = serde_json::from_str(&said).expect("one JSON object");
    assert_eq!(object["differences"], json!([]));
    expect(&["vectors", "composite", "--out", "kept"], 2, "expected an empty folder, or none");
    expect(&["vectors", "none", "--out", "new"], 2, "none");
    expect(&["vectors", "--out", "new", "--profile", "none"], 2, "none");
    expect(&["vectors", "--out", "new", "--layout", "zip"], 2, "--layout");
    expect(&["vectors"], 2, "--out");
    expect(&["vectors", "--out", "new", "--verify", "kept"], 2, "--verify");
    assert!(!root.path().join("new").exists());
    fs::write(root.path().join("kept/README.md"), "").unwrap();
    expect(
        &["vectors", "--verify", "kept"],
        1,
        "README.md: not the bytes that its sum was taken of\n1 differences",
    );
    fs::write(root.path().join("kept/SHA256SUMS"), "sums").unwrap();
    expect(&["vectors", "--verify", "kept"], 2, "line 1");
    fs::remove_file(root.path().join("kept/SHA256SUMS")).unwrap();
    expect(&["vectors", "--verify", "kept"], 2, "SHA256SUMS: can't be read");
    let kept = root.path().join("kept");
    let other = |field: &str, words: &str| {
        changed_index(&kept, |index| match field {
            "schema" => index.schema = "x".into(),
            "layout" => index.layout = "x".into(),
            "profile" => index.profile = "x".into(),
            _ => index.filter = "xyz".into(),
        });
        expect(&["vectors", "--verify", "kept"], 2, words);
    };
    // Each is refused before the next is read.
    for field in ["filter", "profile", "layout", "schema"] {
        other(field, &format!("index.json: {field}: found x"));
    }
    fs::write(kept.join("index.json"), "{\"schema\": 1}").unwrap();
    sums_taken_again(&kept);
    expect(&["vectors", "--verify", "kept"], 2, "index.json: JSON");
}
