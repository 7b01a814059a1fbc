//! What would mix or destroy runs is refused, with a message that says what is there and what to do.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use nerf_oracle::files::npz;
use serde_json::Value;

use super::program::{command, ends, files};

#[rustfmt::skip]
const TINY: &[&str] = &["train", "builtin:blob,size=8,views=4", "--model", "nerf", "--width", "8", "--rays", "16", "--samples", "4"];
#[rustfmt::skip]
const FIT: &[&str] = &["fit-image", "builtin:card", "--size", "12", "--batch", "50", "--width", "8", "--levels", "2"];

fn with<'a>(command: &[&'a str], run: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
    [command, &["--out", run.to_str().expect("a name in UTF-8")], more].concat()
}

/// Exit code 2, and all of `words` in the message.
fn refused(args: &[&str], words: &[&str]) {
    let said = ends(2, args);
    for word in words {
        assert!(said.contains(word), "{args:?}: no \"{word}\" in: {said}");
    }
}

#[test]
fn a_run_is_not_destroyed_by_starting_another() {
    let folder = tempfile::tempdir().expect("a folder");
    for (n, kind) in [TINY, FIT].into_iter().enumerate() {
        let run = folder.path().join(format!("run{n}"));
        ends(0, &with(kind, &run, &["--steps", "2"]));
        let first = files(&run);
        refused(
            &with(kind, &run, &["--steps", "2", "--seed", "5"]),
            &["run.json", "--resume", "--overwrite"],
        );
        refused(&with([FIT, TINY][n], &run, &["--steps", "2"]), &["run.json", "--resume", "--overwrite"]);
        assert!(files(&run) == first, "what was refused changed the run");
        for time in 1..3 {
            ends(0, &with(kind, &run, &["--steps", "1", "--overwrite"]));
            let aside = folder.path().join(format!("run{n}.old-{time}"));
            assert!(aside.join("run.json").exists(), "run{n}: no {}", aside.display());
        }
        let aside = folder.path().join(format!("run{n}.old-1"));
        let same = first.iter().all(|(path, bytes)| {
            fs::read(aside.join(path.strip_prefix(&run).expect("below"))).is_ok_and(|now| now == *bytes)
        });
        assert!(same && files(&aside).len() == first.len(), "the former run is not whole");
        refused(&with(kind, &run, &["--overwrite", "--resume"]), &["--overwrite", "--resume"]);
    }
    // A folder with other things in it is nobody's run.
    let other = folder.path().join("notes");
    fs::create_dir(&other).expect("made");
    fs::write(other.join("notes.txt"), "mine").expect("written");
    ends(0, &with(TINY, &other, &["--steps", "1"]));
    assert_eq!(fs::read_to_string(other.join("notes.txt")).expect("there"), "mine");
    refused(
        &with(TINY, &folder.path().join("none"), &["--steps", "1", "--resume"]),
        &["run.json", "Train first"],
    );
}

#[test]
fn a_second_process_is_refused_with_the_firsts_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let mut first = command(&with(TINY, &run, &["--seconds", "600"]));
    let mut first = first.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("started");
    while !run.join("checkpoint.npz").exists() {
        assert!(first.try_wait().expect("a state").is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(20));
    }
    let pid = if cfg!(windows) { "process ".into() } else { format!("process {} at work", first.id()) };
    for more in [&["--steps", "3"][..], &["--steps", "3", "--resume"], &["--steps", "3", "--overwrite"]] {
        refused(&with(TINY, &run, more), &[&pid, "folder"]);
    }
    // Whoever only reads isn't kept out.
    ends(0, &["evaluate", run.to_str().expect("a name in UTF-8")]);
    first.kill().expect("killed");
    first.wait().expect("ended");
    // A lock of a process that is dead is free.
    ends(0, &with(TINY, &run, &["--seconds", "0.001", "--resume"]));
}

#[test]
fn files_of_another_run_or_scene_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for (kind, seed, steps) in [(TINY, "1", "4"), (FIT, "1", "4")] {
        let (ours, other) = (path("ours"), path("other"));
        ends(0, &with(kind, &ours, &["--steps", "2", "--seed", seed, "--overwrite"]));
        ends(0, &with(kind, &other, &["--steps", "2", "--seed", "2", "--overwrite"]));
        for file in ["checkpoint.npz", "log.jsonl"] {
            let own = fs::read(ours.join(file)).expect("there");
            fs::copy(other.join(file), ours.join(file)).expect("copied");
            let go_on = with(kind, &ours, &["--steps", steps, "--seed", seed, "--resume"]);
            refused(&go_on, &[file, "run_id", "another run's"]);
            fs::write(ours.join(file), own).expect("back");
        }
        ends(0, &with(kind, &ours, &["--steps", steps, "--seed", seed, "--resume"]));
    }
    // The same path, other pictures.
    let (scene, run) = (path("scene.npz"), path("scene_run"));
    write_scene(&scene, 0);
    let all = [
        &["train", scene.to_str().expect("UTF-8"), "--model", "nerf", "--near", "1", "--far", "5"],
        &TINY[4..],
    ]
    .concat();
    ends(0, &with(&all, &run, &["--steps", "2"]));
    let evaluate = ["evaluate", run.to_str().expect("UTF-8")];
    ends(0, &evaluate);
    write_scene(&scene, 1);
    refused(&with(&all, &run, &["--steps", "4", "--resume"]), &["content_sha256", "scene has changed"]);
    refused(&evaluate, &["content_sha256", "scene has changed"]);
}

/// A scene in the layout of the tiny-NeRF notebook, with one byte chosen.
fn write_scene(path: &Path, byte: u8) {
    let mut pictures =
        ndarray::Array4::<u8>::from_shape_fn((5, 8, 8, 3), |(n, j, i, _)| (n * 20 + j * 8 + i) as u8);
    pictures[[1, 2, 3, 0]] = byte;
    let mut poses = ndarray::Array3::<f64>::zeros((5, 4, 4));
    for n in 0..5 {
        (0..4).for_each(|a| poses[[n, a, a]] = 1.0);
        poses[[n, 2, 3]] = 4.0;
        poses[[n, 0, 3]] = n as f64 * 0.1;
    }
    let arrays = [
        ("images", pictures.mapv(|x| f32::from(x) / 255.0).into()),
        ("poses", poses.into()),
        ("focal", ndarray::arr0(9.0f64).into()),
    ];
    let arrays: npz::Arrays = arrays.into_iter().map(|(name, array)| (name.to_string(), array)).collect();
    npz::write(path, &arrays, false).expect("written");
}

/// Numbers of run.json come back with their very bits.
#[test]
fn a_number_with_many_digits_can_be_resumed() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let near = ["--near", "1.5766741007281717"];
    ends(0, &with(TINY, &run, &[&near[..], &["--steps", "2"]].concat()));
    ends(0, &with(TINY, &run, &[&near[..], &["--steps", "4", "--resume"]].concat()));
}

/// Parameters or a loss that are no numbers end a run with the step; the checkpoint is of before.
#[test]
fn what_is_no_number_is_never_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let finite = |run: &Path| {
        let arrays = npz::read(&run.join("checkpoint.npz")).expect("a checkpoint");
        assert!(arrays.values().all(|array| array.to_f64().iter().all(|x| x.is_finite())));
    };
    for (name, steps) in [("one", "1"), ("more", "40")] {
        for model in ["compact", "nerf"] {
            let run = folder.path().join(format!("{name}_{model}"));
            let args = ["train", TINY[1], "--model", model, "--lr", "1e38", "--steps", steps, "--rays", "16"];
            let output = command(&with(&args, &run, &[])).output().expect("started");
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            finite(&run);
            let log = fs::read_to_string(run.join("log.jsonl")).expect("a log");
            let lines: Vec<Value> =
                log.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
            let broken = lines.iter().any(|line| line["loss"].is_null());
            assert!(output.status.code() == Some(1) || !broken, "{name}, {model}: {said}");
            if output.status.code() == Some(1) {
                assert!(said.contains("step") && said.contains("--lr"), "{said}");
            }
        }
    }
    let fit = folder.path().join("fit");
    refused(&with(FIT, &fit, &["--lr", "1e38", "--steps", "50"]), &["step", "--lr"]);
    finite(&fit);
}

/// Before anything is loaded or computed.
#[test]
fn a_folder_that_cannot_be_written_is_found_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("written");
    let below = file.join("out");
    let out = below.to_str().expect("UTF-8");
    // What would have to be read first isn't there: that isn't what is said.
    for args in [
        &["render", "no_run", "--out", out][..],
        &["render", "no_run", "--out", &format!("{out}.gif")],
        &["inspect", "no_scene", "--out", out],
        &["train", "no_scene", "--out", out],
        &["fit-image", "no_picture", "--out", out],
        &["sweep-image", "no_picture", "--out", out],
        &["cases", "no_row", "--out", out],
        &["bench", "no_row", "--out", out],
    ] {
        let said = ends(2, args);
        assert!(said.contains("can't be written") && !said.contains("no_"), "{args:?}: {said}");
    }
    assert_eq!(files(folder.path()).len(), 1, "nothing was left");
}
