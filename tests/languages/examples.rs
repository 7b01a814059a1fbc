//! The examples in C (also as C++, and by CMake) and JavaScript answer volume rendering in the raw layout, right and with a mistake.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

use super::{ORACLE, installed, succeeds};

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/examples")
}

/// A folder with the cases of volume rendering for C and others.
fn cases() -> TempDir {
    let root = tempfile::tempdir().expect("a folder");
    let out = root.path().join("cases");
    succeeds(Command::new(ORACLE).args(["cases", "volume_render", "--layout", "raw", "--out"]).arg(out));
    root
}

/// What the judge says of `answers` in that folder: verdict and first explanation by kind.
fn judged(root: &Path, answers: &str) -> Vec<(String, String, String)> {
    let folders = ["cases", answers].map(|name| root.join(name));
    let output = Command::new(ORACLE).arg("judge").args(folders).arg("--json").output().expect("it starts");
    let report: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let rows = report["components"].as_array().expect("a list");
    let rows = rows.iter().filter(|row| row["name"] == "volume_render" && row["verdict"] != "unsupported");
    let text = |value: &Value| value.as_str().unwrap_or_default().to_string();
    let mistake = |row: &Value| text(&row["diagnosis"][0]["mistakes"][0]);
    rows.map(|row| (text(&row["kind"]), text(&row["verdict"]), mistake(row))).collect()
}

fn row(kind: &str, verdict: &str, mistake: &str) -> (String, String, String) {
    (kind.into(), verdict.into(), mistake.into())
}

/// Compiles the C example by these words, and runs it on the cases.
fn compiled(root: &Path, compiler: &str, words: &[&str], name: &str) {
    let program = root.join(format!("{name}-program"));
    let source = examples().join("c/volume_render.c");
    let strict = ["-Wall", "-Wextra", "-Werror", "-O2", "-o"];
    succeeds(Command::new(compiler).args(words).args(strict).arg(&program).arg(source).arg("-lm"));
    succeeds(Command::new(program).args(["cases", name]).current_dir(root));
}

#[test]
fn the_c_example_passes_and_its_mistake_is_named() {
    if !installed("cc") {
        return;
    }
    let root = cases();
    compiled(root.path(), "cc", &["-std=c99", "-pedantic"], "right");
    let passes = [row("forward", "pass", ""), row("vjp", "pass", "")];
    assert_eq!(judged(root.path(), "right"), passes);
    compiled(root.path(), "cc", &["-std=c99", "-DINCLUSIVE"], "wrong");
    let mistake = "inclusive_transmittance";
    assert_eq!(judged(root.path(), "wrong"), [row("forward", "fail", mistake), row("vjp", "fail", mistake)]);
    if installed("c++") {
        compiled(root.path(), "c++", &["-std=c++11", "-x", "c++"], "cpp");
        assert_eq!(judged(root.path(), "cpp"), passes);
    }
}

/// The header says what is wrong, and ends: another type, a case that is cut off, a folder in the other layout.
#[test]
fn the_c_header_refuses_what_it_cant_read() {
    if !installed("cc") {
        return;
    }
    let root = cases();
    compiled(root.path(), "cc", &["-std=c99"], "right");
    let refused = |word: &str| {
        let program = root.path().join("right-program");
        let output = Command::new(program)
            .args(["cases", "new"])
            .current_dir(root.path())
            .output()
            .expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(word), "{said}");
    };
    let cases = root.path().join("cases");
    let sigmas = cases.join("volume_render/forward-slab/sigmas.bin");
    let bytes = fs::read(&sigmas).expect("an input");
    fs::write(&sigmas, &bytes[..bytes.len() - 1]).expect("written");
    refused("forward-slab/sigmas.bin: can't be read to its end");
    for (options, word) in [
        (["--layout", "raw", "--dtype", "f64"], "is f64, and f32 was asked for"),
        (
            ["--layout", "npz", "--dtype", "f32"],
            "cases.txt: can't be read; write the cases in the raw layout",
        ),
    ] {
        fs::remove_dir_all(&cases).expect("removed");
        succeeds(
            Command::new(ORACLE).args(["cases", "volume_render"]).args(options).arg("--out").arg(&cases),
        );
        refused(word);
    }
}

#[test]
fn the_cmake_example_judges_itself() {
    if !installed("cmake") {
        return;
    }
    let root = tempfile::tempdir().expect("a folder");
    let build = root.path().join("build");
    let oracle = format!("-DNERF_ORACLE={ORACLE}");
    succeeds(Command::new("cmake").arg("-S").arg(examples().join("c")).arg("-B").arg(&build).arg(oracle));
    succeeds(Command::new("cmake").arg("--build").arg(&build));
    let tested = succeeds(Command::new("ctest").current_dir(&build));
    assert!(tested.contains("100% tests passed") && tested.contains("out of 3"), "{tested}");
}

#[test]
fn the_javascript_example_passes_and_its_mistake_is_named() {
    if !installed("node") {
        return;
    }
    let root = cases();
    let script = examples().join("js/volume_render.mjs");
    let run =
        |words: &[&str]| succeeds(Command::new("node").arg(&script).args(words).current_dir(root.path()));
    run(&["cases", "right"]);
    assert_eq!(judged(root.path(), "right"), [row("forward", "pass", "")]);
    run(&["cases", "wrong", "inclusive"]);
    assert_eq!(judged(root.path(), "wrong"), [row("forward", "fail", "inclusive_transmittance")]);
}
