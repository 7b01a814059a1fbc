//! `--shard I/N` and `merge`: several processes, of which some are killed and some are run twice, leave the bytes of one.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

const PROGRAM: &str = env!("CARGO_BIN_EXE_nerf-oracle");

fn run(args: &[&str]) -> Output {
    Command::new(PROGRAM).args(args).output().expect("the program starts")
}

/// What a command that goes well prints.
fn good(args: &[&str]) -> Vec<u8> {
    let output = run(args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// The message of a command that is refused.
fn refused(args: &[&str]) -> String {
    let output = run(args);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
    said
}

fn path(root: &Path, name: &str) -> String {
    root.join(name).display().to_string()
}

/// A small run.
fn trained(root: &Path, name: &str, seed: &str) -> String {
    let out = path(root, name);
    let scene = "builtin:spheres,size=16,views=24";
    let small = ["--width", "16", "--samples", "12", "--rays", "64", "--steps", "2", "--seed", seed];
    good(&[&["train", scene, "--model", "nerf", "--out", &out][..], &small].concat());
    out
}

/// A film of a run, with these options.
fn film<'a>(run: &'a str, rest: &[&'a str]) -> Vec<&'a str> {
    [&["render", run, "--path", "orbit:7"][..], rest].concat()
}

/// All files of a folder by name.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entry = |entry: fs::DirEntry| {
        (entry.file_name().to_string_lossy().into_owned(), fs::read(entry.path()).expect("a file"))
    };
    let mut files: Vec<_> =
        fs::read_dir(folder).expect("a folder").map(|e| entry(e.expect("an entry"))).collect();
    files.sort();
    files
}

#[test]
fn parts_of_a_film_become_the_film() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let run_of = trained(root, "run", "0");
    let (whole, merged) = (root.join("whole"), root.join("merged"));
    good(&film(&run_of, &["--out", &whole.display().to_string()]));
    let part = |n: usize| path(root, &format!("part{n}"));
    for n in 1..=3 {
        good(&film(&run_of, &["--out", &part(n), "--shard", &format!("{n}/3")]));
    }
    let merge = |parts: &[&str], out: &Path| {
        let out = out.display().to_string();
        [&["merge"][..], parts, &["--out", &out]].concat().into_iter().map(String::from).collect::<Vec<_>>()
    };
    let asked = |parts: &[&str], out: &Path| -> Vec<u8> {
        let args = merge(parts, out);
        good(&args.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let refusal = |parts: &[&str]| {
        let args = merge(parts, &root.join("never"));
        let said = refused(&args.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(!root.join("never").exists(), "{said}");
        said
    };
    let [one, two, three] = [1, 2, 3].map(part);
    // In any order, one of them twice.
    asked(&[&three, &one, &two, &one], &merged);
    assert_eq!(files(&whole), files(&merged));
    assert_eq!(files(&whole).len(), 8, "seven frames and a film");
    asked(&[&one, &two, &three], &root.join("film.gif"));
    assert_eq!(fs::read(whole.join("film.gif")).unwrap(), fs::read(root.join("film.gif")).unwrap());
    assert!(refusal(&[&one, &three]).contains("shards: found 2 of 3, without 2/3"));
    // A part that was cut off counts as missing.
    let cut = path(root, "cut");
    fs::create_dir(&cut).unwrap();
    fs::copy(root.join("part2/000001.png"), root.join("cut/000001.png")).unwrap();
    let said = refusal(&[&one, &cut, &three]);
    assert!(said.contains("without 2/3 (cut off: ") && said.contains("cut)"), "{said}");
    asked(&[&one, &cut, &two, &three], &merged);
    // Parts of other work: another run, another option, another number of parts.
    let other_run = trained(root, "other", "1");
    let other = path(root, "other_part");
    for (args, field) in [
        (vec!["render", &other_run, "--path", "orbit:7", "--shard", "2/3"], "work.checkpoint"),
        (film(&run_of, &["--shard", "2/3", "--background", "white"]), "work.background"),
        (film(&run_of, &["--shard", "2/3", "--depth"]), "work.depth"),
        (film(&run_of, &["--shard", "2/3", "--size", "8x8"]), "work.cameras"),
        (film(&run_of, &["--shard", "2/4"]), "shards"),
        (vec!["render", &run_of, "--path", "orbit:8", "--shard", "2/3"], "count"),
        (vec!["evaluate", &run_of, "--shard", "2/3"], "count"),
    ] {
        good(&[&args[..], &["--out", &other]].concat());
        let said = refusal(&[&one, &other, &three]);
        assert!(said.contains(&format!("part.json: {field}: found")), "{args:?}: {said}");
        fs::remove_dir_all(&other).unwrap();
    }
    // The same part with other results.
    good(&film(&run_of, &["--out", &other, "--shard", "1/3"]));
    fs::copy(root.join("part1/000000.png"), root.join("other_part/000003.png")).unwrap();
    assert!(refusal(&[&one, &two, &three, &other]).contains("other results than those of the same part"));
    let json = fs::read_to_string(root.join("part3/part.json")).unwrap();
    for (text, words) in [
        (json.replace("\"5\":", "\"50\":"), "pieces.5: found none"),
        (json.replace("\"count\":7", "\"count\":\"7\""), "count: found \"7\""),
        (json.replace("part/1", "part/2"), "schema: found"),
        ("{".into(), "JSON: found"),
    ] {
        fs::write(root.join("part3/part.json"), text).unwrap();
        let said = refusal(&[&one, &two, &three]);
        assert!(said.contains(words), "{words:?} isn't in: {said}");
    }
    fs::write(root.join("part3/part.json"), json).unwrap();
    fs::remove_file(root.join("part3/000005.png")).unwrap();
    assert!(refusal(&[&one, &two, &three]).contains("000005.png"));
    for wrong in ["0/3", "4/3", "1", "1/0", "1/1000000"] {
        assert!(
            refused(&film(&run_of, &["--out", &other, "--shard", wrong])).contains("expected I/N"),
            "{wrong}"
        );
    }
}

#[test]
fn parts_of_an_evaluation_and_of_a_sweep_become_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let run_of = trained(root, "run", "0");
    for every in ["1", "2"] {
        let asked = ["evaluate", &run_of, "--every", every];
        let parts: Vec<String> = (1..=2).map(|n| path(root, &format!("views{every}_{n}"))).collect();
        for (n, part) in parts.iter().enumerate() {
            good(&[&asked[..], &["--out", part, "--shard", &format!("{}/2", n + 1)]].concat());
        }
        let merged = path(root, "scores.json");
        let merge = ["merge", &parts[1], &parts[0], "--out", &merged];
        assert_eq!(good(&asked), good(&merge), "the table");
        let printed = good(&[&asked[..], &["--json"]].concat());
        assert_eq!(printed, fs::read(&merged).unwrap());
        assert_eq!(printed, good(&[&merge[..], &["--json"]].concat()));
    }
    assert!(refused(&["evaluate", &run_of, "--shard", "1/2"]).contains("--out"));
    let sweep =
        ["sweep-image", "builtin:card", "--size", "24", "--levels", "2,4", "--width", "8", "--steps", "20"];
    let whole = path(root, "whole");
    good(&[&sweep[..], &["--out", &whole]].concat());
    let parts: Vec<String> = (1..=3).map(|n| path(root, &format!("fits{n}"))).collect();
    for (n, part) in parts.iter().enumerate() {
        good(&[&sweep[..], &["--out", part, "--shard", &format!("{}/3", n + 1)]].concat());
    }
    // The first part once more: only its seconds differ.
    let again = path(root, "again");
    good(&[&sweep[..], &["--out", &again, "--shard", "1/3"]].concat());
    let merged = path(root, "merged");
    good(&["merge", &again, &parts[0], &parts[1], &parts[2], "--out", &merged]);
    let sheet = |folder: &str| fs::read(Path::new(folder).join("contact_sheet.png")).unwrap();
    assert_eq!(sheet(&whole), sheet(&merged));
    let table = |folder: &str| -> Value {
        let text = fs::read_to_string(Path::new(folder).join("table.json")).unwrap();
        let mut table: Value = serde_json::from_str(&text).unwrap();
        table.as_array_mut().unwrap().iter_mut().for_each(|row| row["seconds"] = Value::Null);
        table
    };
    assert_eq!(table(&whole), table(&merged));
    assert!(Path::new(&merged).join("index.html").exists() && Path::new(&merged).join("table.txt").exists());
}

/// The README's line, with a part that is killed and done again by the same line.
#[cfg(unix)]
#[test]
fn a_pool_of_processes_survives_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let run_of = trained(root, "run", "0");
    good(&["render", &run_of, "--path", "orbit:12", "--out", &path(root, "whole.gif")]);
    // One that is killed before it is done leaves no part.json.
    let slow =
        ["render", &run_of, "--path", "orbit:12", "--size", "512x512", "--shard", "2/4", "--threads", "1"];
    let mut killed = Command::new(PROGRAM)
        .args(slow)
        .args(["--out", &path(root, "parts/2")])
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(50));
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(!root.join("parts/2/part.json").exists());
    let line = format!(
        "seq 4 | xargs -P 2 -I{{}} {PROGRAM} render {run_of} --path orbit:12 --shard {{}}/4 --out {}/parts/{{}}",
        root.display()
    );
    for _ in 0..2 {
        // Twice: every part is repeated.
        let done = Command::new("sh").args(["-c", &line]).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    }
    let merge = format!("{PROGRAM} merge {0}/parts/* --out {0}/merged.gif", root.display());
    assert!(Command::new("sh").args(["-c", &merge]).status().unwrap().success());
    assert_eq!(fs::read(root.join("whole.gif")).unwrap(), fs::read(root.join("merged.gif")).unwrap());
}
