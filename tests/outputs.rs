//! What the program says reaches somebody, or its exit code says that it didn't; and whatever names its files have, it moves nobody's
//! cursor.

#![cfg(unix)]

use std::fs::{self, File};
use std::io::{PipeWriter, pipe};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};

fn program(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nerf-oracle"));
    command.args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// A device that takes nothing: writing to it is what a full disk answers.
fn full() -> Option<File> {
    File::options().write(true).open("/dev/full").ok()
}

/// A pipe that nobody reads from any more.
fn closed() -> PipeWriter {
    let (_, writer) = pipe().expect("a pipe");
    writer
}

fn ended(command: &mut Command) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = command.output().expect("the program starts");
    (status.code(), String::from_utf8_lossy(&stderr).into_owned())
}

/// A folder with a scene of two pictures; `change` edits its JSON.
fn scene(folder: &Path, change: impl FnOnce(&mut Value)) {
    let pose = |turn: bool| match turn {
        false => [[0, 0, 1, 4], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]],
        true => [[-1, 0, 0, 0], [0, 0, 1, 4], [0, 1, 0, 0], [0, 0, 0, 1]],
    };
    let mut json = json!({ "fl_x": 8, "frames": [
        { "file_path": "a.png", "transform_matrix": pose(false) }, { "file_path": "b.png", "transform_matrix": pose(true) },
    ] });
    change(&mut json);
    fs::create_dir_all(folder).expect("a folder");
    for name in ["a.png", "b.png"] {
        image::RgbImage::from_fn(6, 4, |i, j| image::Rgb([200, 40 * i as u8, 50 * j as u8]))
            .save(folder.join(name))
            .expect("written");
    }
    fs::write(folder.join("transforms.json"), json.to_string()).expect("written");
}

#[test]
fn output_that_is_lost_is_no_success() {
    if full().is_none() {
        return eprintln!("skipped: there is no /dev/full");
    }
    for args in [
        &["list"][..],
        &["list", "--json"],
        &["explain", "mse"],
        &["explain", "mse", "--json"],
        &["--help"],
        &["--version"],
    ] {
        let (code, said) = ended(program(args).stdout(full().expect("a device")));
        assert_eq!(code, Some(2), "{args:?}: {said}");
        assert!(!said.contains("panicked"), "{said}");
    }
    let (_, said) = ended(program(&["list", "--json"]).stdout(full().expect("a device")));
    assert!(said.starts_with("error: stdout: can't be written"), "{said}");
    // Nobody hears why, but the exit code says it.
    for args in [&["explain", "nothing"][..], &["list", "nothing"], &["train", "no.npz", "--out", "x"]] {
        assert_eq!(ended(program(args).stderr(full().expect("a device"))).0, Some(2), "{args:?}");
    }
}

/// A warning that is lost doesn't end the work, which is done and reported, but it is no success.
#[test]
fn a_lost_warning_is_no_success() {
    let Some(full) = full() else { return eprintln!("skipped: there is no /dev/full") };
    let dir = tempfile::tempdir().expect("a folder");
    scene(&dir.path().join("scene"), |json| json["unheard_of"] = json!(1));
    let args = ["inspect", "scene", "--rays", "1", "--samples", "1", "--out", "out"];
    let (code, said) = ended(program(&args).current_dir(dir.path()));
    assert_eq!(code, Some(0), "{said}");
    let (code, _) = ended(program(&args).current_dir(dir.path()).stderr(full));
    assert_eq!(code, Some(2));
    assert!(dir.path().join("out/rays.npz").exists());
    // A closed pipe is the same.
    assert_eq!(ended(program(&args).current_dir(dir.path()).stderr(closed())).0, Some(2));
}

#[test]
fn a_reader_that_has_enough_is_left_in_silence() {
    for args in [&["list"][..], &["list", "--json"], &["--help"]] {
        let ended = program(args).stdout(closed()).output().expect("the program starts");
        assert_eq!(ended.status.code(), Some(141), "{args:?}");
        assert!(ended.stderr.is_empty(), "{args:?}: {}", String::from_utf8_lossy(&ended.stderr));
    }
}

/// Unknown fields, and known ones that would change the picture, are named once, however many frames have them.
#[test]
fn fields_that_are_not_used_are_named_once() {
    let dir = tempfile::tempdir().expect("a folder");
    scene(&dir.path().join("scene"), |json| {
        json["unheard_of"] = json!(1);
        json["sharpness_discard_threshold"] = json!(0.1);
        for frame in json["frames"].as_array_mut().expect("a list") {
            frame["time"] = json!(0.5);
            frame["sharpness"] = json!(30.5);
        }
    });
    let args = ["inspect", "scene", "--rays", "1", "--samples", "1", "--out", "out"];
    let (code, said) = ended(program(&args).current_dir(dir.path()));
    assert_eq!(
        (code, said.as_str()),
        (Some(0), "warning: scene/transforms.json: fields that are not used: unheard_of, time.\n")
    );
}

/// Names with escape sequences, line ends and marks that turn the direction of reading, wherever names are shown.
#[test]
fn names_from_files_move_no_cursor() {
    const EVIL: &str = "A\u{1b}[31m\u{202e}\n\u{9b}<b>.png";
    let hidden = |c: char| (c.is_control() && c != '\n') || ('\u{202a}'..='\u{202e}').contains(&c);
    let dir = tempfile::tempdir().expect("a folder");
    let clean = |args: &[&str], words: &str| {
        let ended = program(args).current_dir(dir.path()).output().expect("the program starts");
        for text in [ended.stdout, ended.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()) {
            assert!(!text.contains(hidden), "{args:?}: {text:?}");
            assert!(!text.contains("\n\\u{9b}"), "a name has no line of its own: {text:?}");
            if text.contains(words) {
                return ended.status.code();
            }
        }
        panic!("{args:?}: nothing says {words}");
    };
    let inspect = |scene: &'static str| ["inspect", scene, "--rays", "1", "--samples", "1", "--out", "out"];
    let shown = "A\\u{1b}[31m\\u{202e}\\u{a}\\u{9b}<b>";
    // A missing picture; an unknown field; a mask that isn't there; a model that nobody knows.
    let frame = |json: &mut Value| {
        json["frames"].as_array_mut().expect("a list").push(json!({"file_path": EVIL, "transform_matrix": 7}))
    };
    scene(&dir.path().join("missing"), frame);
    assert_eq!(clean(&inspect("missing"), shown), Some(0));
    scene(&dir.path().join("field"), |json| json[EVIL] = json!(1));
    assert_eq!(clean(&inspect("field"), shown), Some(0));
    scene(&dir.path().join("mask"), |json| json["frames"][0]["mask_path"] = json!(EVIL));
    // As a quoted text.
    assert_eq!(clean(&inspect("mask"), &shown.replace("\\u{a}", "\\n")), Some(2));
    scene(&dir.path().join("model"), |json| json["camera_model"] = json!(EVIL));
    assert_eq!(clean(&inspect("model"), shown), Some(2));
    // The scene's own name, in text, in JSON and in the run's curve; a picture's name in a table.
    scene(&dir.path().join(EVIL), |json| json["frames"][0]["file_path"] = json!(EVIL));
    image::RgbImage::from_fn(6, 4, |i, j| image::Rgb([200, 40 * i as u8, 50 * j as u8]))
        .save(dir.path().join(EVIL).join(EVIL))
        .expect("written");
    assert_eq!(clean(&["inspect", EVIL, "--rays", "1", "--samples", "1", "--out", "out"], shown), Some(0));
    let train = [
        "train",
        EVIL,
        "--out",
        "run",
        "--model",
        "nerf",
        "--width",
        "8",
        "--rays",
        "8",
        "--samples",
        "4",
        "--steps",
        "1",
    ];
    let (code, said) = ended(program(&[&train[..], &["--holdout", "2"]].concat()).current_dir(dir.path()));
    assert_eq!(code, Some(0), "{said}");
    let svg = fs::read_to_string(dir.path().join("run/psnr.svg")).expect("a curve");
    assert!(svg.contains("A\\u{1b}[31m\\u{202e}\\u{a}\\u{9b}&lt;b&gt;") && !svg.contains(hidden), "{svg}");
    assert_eq!(clean(&["evaluate", "run"], shown), Some(0));
    assert_eq!(clean(&["evaluate", "run", "--json"], "A\\u001b[31m\\u202e\\n\\u009b<b>"), Some(0));
}

/// A self-check of one component, whose page has verdicts.
const CHECK: [&str; 2] = ["check", "composite_background"];

fn printed(command: &mut Command) -> String {
    let Output { stdout, .. } = command.output().expect("the program starts");
    String::from_utf8_lossy(&stdout).into_owned()
}

#[test]
fn verdicts_have_colors_on_a_terminal_alone() {
    let plain = printed(&mut program(&CHECK));
    assert!(plain.contains("  pass\n") && !plain.contains('\u{1b}'), "{plain}");
    let painted = printed(program(&CHECK).env("CLICOLOR_FORCE", "1"));
    assert!(painted.contains("\u{1b}[32mpass\u{1b}[0m\n"), "{painted:?}");
    let stripped = painted.replace("\u{1b}[32m", "").replace("\u{1b}[0m", "");
    assert_eq!(stripped, plain, "nothing else changes");
    let never = printed(program(&CHECK).env("CLICOLOR_FORCE", "1").arg("--json"));
    assert!(never.starts_with('{') && !never.contains('\u{1b}'), "JSON is for programs");
    let (_, message) = ended(program(&["evaluate", "none"]).env("CLICOLOR_FORCE", "1"));
    assert!(message.contains("\u{1b}[31merror:"), "{message:?}");
    let (_, message) = ended(program(&["evaluate", "none"]).env("NO_COLOR", "1"));
    assert!(message.starts_with("error: none"), "{message:?}");
}

#[test]
fn who_asks_for_quiet_has_it_but_for_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run").display().to_string();
    // It leaves a part out in this scene, and says so.
    let args = ["train", "builtin:blob", "--out", &out, "--rays", "8", "--steps", "1", "--overwrite"];
    let (code, loud) = ended(&mut program(&args));
    assert!(code == Some(0) && loud.contains("left out"), "{loud}");
    let (code, quiet) = ended(program(&args).arg("--quiet"));
    assert_eq!((code, quiet.as_str()), (Some(0), ""));
    let (code, error) = ended(&mut program(&["evaluate", "none", "-q"]));
    assert!(code == Some(2) && error.contains("run.json"), "{error}");
}

#[test]
fn completions_and_manuals_know_the_options() {
    for (shell, word) in
        [("bash", "complete "), ("zsh", "#compdef nerf-oracle"), ("fish", "complete -c nerf-oracle")]
    {
        let script = printed(&mut program(&["completions", shell]));
        assert!(script.contains(word) && script.contains("stop-at-psnr"), "{shell}");
    }
    let page = |args: &[&str]| printed(&mut program(args)).replace('\\', "");
    let program_page = page(&["man"]);
    assert!(program_page.contains(".TH nerf-oracle 1") && program_page.contains("inspect"), "{program_page}");
    let page = page(&["man", "train"]);
    assert!(page.contains("nerf-oracle-train") && page.contains("--stop-at-psnr"), "{page}");
}
