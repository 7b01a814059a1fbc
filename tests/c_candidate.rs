//! Another language, no library: `tools/examples/candidate.c` reads the cases, answers volume rendering in f32, and passes.

use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn run(program: impl AsRef<OsStr>, args: &[&Path]) -> Output {
    Command::new(program).args(args).output().expect("the program starts")
}

/// What a command that must succeed prints.
fn succeeds(output: Output) -> Vec<u8> {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{message}{}", String::from_utf8_lossy(&output.stdout));
    output.stdout
}

/// The row of volume rendering's forward pass in the judge's report.
fn row(report: &[u8]) -> Value {
    let report: Value = serde_json::from_slice(report).expect("one JSON object");
    let components = report["components"].as_array().expect("a list");
    let wanted = |row: &&Value| row["name"] == "volume_render" && row["kind"] == "forward";
    components.iter().find(wanted).expect("its row").clone()
}

#[test]
fn the_c_example_is_compiled_and_passes() {
    if Command::new("cc").arg("--version").output().is_err() {
        // Past the test harness, which would keep it to itself.
        let _ = writeln!(std::io::stderr(), "skipped: there is no C compiler named cc");
        return;
    }
    let oracle = env!("CARGO_BIN_EXE_nerf-oracle");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/examples/candidate.c");
    let root = tempfile::tempdir().unwrap();
    let [candidate, cases, answers] = ["candidate", "cases", "answers"].map(|name| root.path().join(name));
    let strict = ["-std=c11", "-D_DEFAULT_SOURCE", "-Wall", "-Wextra", "-Werror", "-O2"];
    let compiled = Command::new("cc").args(strict).arg("-o").arg(&candidate).arg(&source).arg("-lm").output();
    succeeds(compiled.expect("cc starts"));

    let dtype = ["--dtype", "f32", "--out"].map(Path::new);
    succeeds(run(oracle, &[&[Path::new("cases")], &dtype[..], &[&cases]].concat()));
    succeeds(run(&candidate, &[&cases, &answers]));
    let judge = [Path::new("judge"), &cases, &answers, Path::new("--json")];
    let row = row(&succeeds(run(oracle, &judge)));
    assert_eq!((&row["verdict"], &row["grade"]), (&"pass".into(), &"A".into()), "{row}");
    assert_eq!(row["answered"], row["cases"]);

    // Answers that are cut off are refused, with the file's name.
    let file =
        fs::read_dir(answers.join("volume_render")).unwrap().next().expect("an answer").unwrap().path();
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    let refused = run(oracle, &judge);
    assert_eq!(refused.status.code(), Some(2));
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(message.contains(&*file.file_name().unwrap().to_string_lossy()), "{message}");
}
