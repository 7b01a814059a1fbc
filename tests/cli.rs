//! The program as a user meets it: what it prints, and how bad input ends.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// A scene that is validated in no time.
const SMALL: &str = "builtin:blob,size=24,views=6";

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nerf-oracle")).args(args).output().expect("the program starts")
}

fn path(dir: &Path, name: &str) -> String {
    dir.join(name).display().to_string()
}

/// Exit code 2, nothing on stdout, and a message with all of `words` in it.
fn refused(args: &[&str], words: &[&str]) {
    let output = run(args);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    assert!(output.stdout.is_empty(), "{args:?} printed to stdout");
    assert!(!message.contains("panicked"), "{args:?}: {message}");
    for word in words {
        assert!(message.contains(word), "{args:?}: no \"{word}\" in: {message}");
    }
}

/// The JSON object that a command prints.
fn object(args: &[&str]) -> Value {
    let output = run(args);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {message}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{args:?}: {e}"))
}

#[test]
fn names_are_explained_in_both_spellings() {
    let dir = tempfile::tempdir().expect("a folder");
    for (old, new, what) in [
        ("centre_swapped", "center_swapped", "mistake"),
        ("regularised_psnr", "regularized_psnr", "mistake"),
        ("wrong_colours", "wrong_colors", "mistake"),
        ("pixel_centre", "pixel_center", "convention"),
    ] {
        let explained = object(&["explain", new, "--json"]);
        assert_eq!(explained["found"][0]["what"], what, "{new}");
        assert_eq!(object(&["explain", old, "--json"]), explained);
    }
    let hazard = object(&["explain", "VR9", "--json"]);
    assert_eq!(hazard["found"][0]["what"], "hazard");
    assert!(hazard["found"][0]["cases"].as_array().is_some_and(|cases| cases.len() > 5), "{hazard}");
    refused(&["explain", "VRX"], &["VRX", "list"]);
    // Filters: a folder's old name.
    let old = object(&["cases", "optimiser", "--out", &path(dir.path(), "old"), "--json"]);
    let new = object(&["cases", "optimizer", "--out", &path(dir.path(), "new"), "--json"]);
    assert!(old["cases"].as_u64().is_some_and(|cases| cases > 0), "{old}");
    assert_eq!(old["cases"], new["cases"]);
}

#[test]
fn usage_errors_end_with_two() {
    refused(&[], &["Usage"]);
    refused(&["paint"], &["paint"]);
    refused(&["train", "builtin:spheres"], &["--out"]);
    refused(&["train", "builtin:spheres", "--out", "x", "--steps", "0"], &["--steps", "above 0"]);
    refused(&["train", "builtin:spheres", "--out", "x", "--background", "red"], &["black, white"]);
    let most = "18446744073709551615";
    for option in ["--rays", "--samples", "--fine", "--width", "--steps"] {
        refused(&["train", "builtin:spheres", "--out", "x", option, most], &[option, "at most"]);
    }
    refused(
        &["train", "builtin:spheres", "--out", "x", "--stop-at-psnr", "nan"],
        &["--stop-at-psnr", "finite"],
    );
    refused(&["train", "builtin:spheres", "--out", "x", "--width", "8"], &["--width", "--model nerf"]);
    refused(&["train", "builtin:spheres", "--out", "x", "--skip"], &["--skip", "compact"]);
    let pair = ["train", "builtin:spheres", "--out", "x", "--model", "nerf", "--skip", "--fine", "8"];
    refused(&pair, &["--skip", "--fine"]);
    refused(&["fit-image", "x.png", "--out", "x", "--steps", "0"], &["--steps", "above 0"]);
    refused(&["render", "x", "--out", "y.gif", "--path", "circle"], &["orbit:N"]);
}

#[test]
fn bad_input_is_named() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    refused(
        &["train", "builtin:nothing", "--out", &path(dir.path(), "run")],
        &["builtin:nothing", "builtin:"],
    );
    refused(&["train", "no_such.npz", "--out", &path(dir.path(), "run")], &["no_such.npz"]);
    fs::write(dir.path().join("broken.npz"), b"PK\x03\x04 not really").expect("written");
    refused(&["train", &path(dir.path(), "broken.npz"), "--out", &path(dir.path(), "run")], &["broken.npz"]);
    refused(&["evaluate", &path(dir.path(), "no_run")], &["run.json", "Train first"]);
    let near = ["train", "builtin:spheres", "--out", &path(dir.path(), "run"), "--near", "5", "--far", "2"];
    refused(&near, &["--near: found 5"]);
    fs::write(dir.path().join("file"), b"").expect("written");
    let below_a_file = path(dir.path(), "file/run");
    refused(&["train", "builtin:spheres", "--out", &below_a_file], &["file"]);
    refused(&["fit-image", &path(dir.path(), "file"), "--out", &path(dir.path(), "fit")], &["file"]);
}

#[test]
fn a_run_can_be_trained_resumed_measured_and_rendered() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let run = path(dir.path(), "run");
    let common = ["train", SMALL, "--out", &run, "--model", "nerf", "--width", "16", "--rays", "64"];
    let rest = ["--samples", "8", "--threads", "2", "--json"];
    let train = |more: &[&str]| object(&[&common[..], &rest, more].concat());
    let first = train(&["--steps", "4"]);
    assert_eq!((&first["step"], &first["samples"]), (&Value::from(4), &Value::from(4 * 64 * 8)));
    let whole = train(&["--steps", "8", "--overwrite"]);
    train(&["--steps", "4", "--overwrite"]);
    let resumed = train(&["--steps", "8", "--resume"]);
    for figure in ["step", "samples", "loss", "val_psnr"] {
        assert_eq!(whole[figure], resumed[figure], "{figure} differs after --resume");
    }
    for file in ["run.json", "checkpoint.npz", "log.jsonl", "psnr.svg", "views"] {
        assert!(Path::new(&run).join(file).exists(), "no {file}");
    }
    let scores = object(&["evaluate", &run, "--json"]);
    assert_eq!(scores["psnr"], resumed["val_psnr"], "evaluate measures what train measured");
    let gif = path(dir.path(), "film.gif");
    let film = object(&["render", &run, "--out", &gif, "--path", "orbit:3", "--size", "24x16", "--json"]);
    assert_eq!(film["frames"], 3);
    assert_eq!(&fs::read(&gif).expect("a film")[..6], b"GIF89a");
    let png = path(dir.path(), "film.png");
    let depth = ["render", &run, "--out", &png, "--path", "orbit:3", "--size", "24x16", "--depth", "--json"];
    assert_eq!(object(&depth)["frames"], 3);
    let bytes = fs::read(&png).expect("a film");
    assert!(bytes.windows(4).any(|four| four == b"acTL"), "it is animated");
    let scale = 14;
    assert_eq!(bytes[16..24], [0, 0, 0, 24, 0, 0, 0, 16 + scale], "the scale is under each frame");
    films_by_another_program(dir.path(), &run);
}

/// `ffmpeg` is asked for the film where it is on the path, and said to be missing, before anything is rendered, where it isn't.
#[cfg(unix)]
fn films_by_another_program(dir: &Path, run: &str) {
    use std::os::unix::fs::PermissionsExt;
    let (film, bin) = (path(dir, "film.mp4"), dir.join("bin"));
    fs::create_dir(&bin).expect("a folder");
    let render = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nerf-oracle"));
        command.args(["render", run, "--out", &film, "--path", "orbit:2", "--size", "7x5"]).env("PATH", &bin);
        let output = command.output().expect("the program starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, message) = render();
    assert!(code == Some(2) && message.contains("ffmpeg") && message.contains(".png"), "{message}");
    assert!(!Path::new(&film).exists());
    // It takes what a film is made of, and answers with that.
    let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\n\
                  while [ \"$1\" != -i ]; do [ \"$1\" = -video_size ] && size=$2; shift; done\n\
                  [ \"$size\" = 7x5 ] || { echo 'not this size' >&2; exit 9; }\n/bin/cp \"$2\" \"$last\"\n";
    let fake = bin.join("ffmpeg");
    fs::write(&fake, script).expect("written");
    fs::set_permissions(&fake, fs::Permissions::from_mode(0o755)).expect("permitted");
    let (code, message) = render();
    assert_eq!(code, Some(0), "{message}");
    assert_eq!(fs::metadata(&film).expect("a film").len(), 2 * 7 * 5 * 3, "two frames of bytes");
    fs::write(&fake, script.replace("7x5", "1x1")).expect("written");
    let (code, message) = render();
    assert!(code == Some(2) && message.contains("not this size"), "{message}");
}

#[cfg(not(unix))]
fn films_by_another_program(_: &Path, _: &str) {}

#[test]
fn a_run_that_leaves_empty_space_out_says_so_and_goes_on() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let run = path(dir.path(), "run");
    let common = ["train", "builtin:slab", "--out", &run, "--rays", "16", "--samples", "8", "--lr", "5e-3"];
    let nerf = [&common[..], &["--model", "nerf", "--width", "8", "--threads", "2", "--json"]].concat();
    let train = |more: &[&str]| object(&[&nerf[..], more].concat());
    // The grid is filled after step 256.
    let whole = train(&["--skip", "--steps", "264"]);
    assert!(whole["samples"].as_u64() < Some(264 * 16 * 8), "every sample was evaluated: {whole}");
    train(&["--skip", "--steps", "258", "--overwrite"]);
    let file = Path::new(&run).join("run.json");
    let settings: Value = serde_json::from_slice(&fs::read(&file).expect("settings")).expect("JSON");
    assert_eq!((&settings["skip"], &settings["settings"]["skip_samples"]), (&true.into(), &true.into()));
    assert_eq!(settings["settings"]["skip_after_step"], 256);
    refused(&[&nerf[..], &["--steps", "264", "--resume"]].concat(), &["run.json", "skip", "true"]);
    let resumed = train(&["--skip", "--steps", "264", "--resume"]);
    for figure in ["step", "samples", "loss", "val_psnr"] {
        assert_eq!(whole[figure], resumed[figure], "{figure} differs after --resume");
    }
    assert_eq!(
        object(&["evaluate", &run, "--json"])["psnr"],
        resumed["val_psnr"],
        "the grid is in the checkpoint"
    );
}

#[test]
fn options_that_do_not_fit_together_leave_no_folder() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let run = path(dir.path(), "run");
    let train = ["train", "builtin:blob", "--out", &run];
    let with = |more: &[&'static str]| [&train[..], more].concat();
    refused(&with(&["--model", "compact", "--skip"]), &["--skip", "compact model always"]);
    refused(&with(&["--model", "compact", "--space", "ndc"]), &["--space", "ndc is for --model nerf"]);
    refused(&with(&["--model", "nerf", "--space", "contracted"]), &["--space", "for --model compact"]);
    refused(&with(&["--model", "nerf", "--space", "ndc"]), &["--space", "auto or box: "]);
    refused(&with(&["--model", "nerf", "--without", "stop"]), &["--without", "compact model's"]);
    let parts = ["stops", "occupancy", "stop", "patience", "coarse_steps", "view_dependence"];
    refused(&with(&["--without", "stops"]), &parts);
    assert!(!Path::new(&run).exists());
}

/// The warnings of validation are in `run.json`, each once, however often a run is resumed.
#[test]
fn a_warning_is_kept_once() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let run = path(dir.path(), "run");
    let tiny = ["--model", "nerf", "--width", "8", "--rays", "16", "--samples", "4"];
    let train = |steps: &str, more: &[&str]| {
        let dead = ["train", "builtin:blob", "--out", &run, "--lr", "1", "--steps", steps, "--json"];
        let printed = object(&[&dead[..], &tiny, more].concat())["warnings"].clone();
        let settings = fs::read(Path::new(&run).join("run.json")).expect("settings");
        (printed, serde_json::from_slice::<Value>(&settings).expect("JSON")["warnings"].clone())
    };
    let (first, kept) = train("4", &[]);
    assert!(first[0].as_str().expect("a warning").contains("every density is 0"), "{first}");
    assert_eq!(kept, first);
    let (again, kept) = train("8", &["--resume"]);
    assert_eq!((&again, &kept), (&first, &first));
}

/// Nothing lies between near and far: the run ends within 50 steps with exit 1, says why and what to try, and keeps it in `run.json`.
#[test]
fn a_run_that_does_not_learn_ends_with_one() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    for (name, more) in [("nothing", &["--near", "20", "--far", "21"][..]), ("blown", &["--lr", "1e30"])] {
        let out = path(dir.path(), name);
        let common = ["train", "builtin:spheres", "--out", &out, "--steps", "400", "--threads", "2"];
        let ended = run(&[&common[..], more].concat());
        let said = String::from_utf8(ended.stderr).expect("text");
        assert_eq!(ended.status.code(), Some(1), "{name}: {said}");
        let advice = if name == "nothing" { "Check --near and --far" } else { "Lower --lr" };
        assert!(said.contains("doesn't learn") && said.contains(advice), "{name}: {said}");
        let file = Path::new(&out).join("run.json");
        let settings: Value = serde_json::from_slice(&fs::read(file).expect("settings")).expect("JSON");
        assert!(settings["failure"].as_str().is_some_and(|why| why.contains(advice)), "{name}: {settings}");
        let log = fs::read_to_string(Path::new(&out).join("log.jsonl")).expect("a log");
        let last: Value = serde_json::from_str(log.lines().last().expect("a line")).expect("JSON");
        assert!(last["step"].as_u64() <= Some(50), "{name}: {last}");
    }
}

/// Wall clock ends a run; views are counted; full validations come where they are asked for and at the end.
#[test]
fn a_log_says_how_it_was_measured() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let run = path(dir.path(), "run");
    let small = "builtin:spheres,size=16,views=6";
    let common = ["train", small, "--out", &run, "--threads", "2", "--json"];
    let began = std::time::Instant::now();
    let summary = object(&[&common[..], &["--seconds", "2"]].concat());
    let took = began.elapsed().as_secs_f64();
    let seconds = summary["seconds"].as_f64().expect("seconds");
    assert!(seconds >= 2.0 && seconds <= took, "{seconds} of {took}");
    let lines = || -> Vec<Value> {
        let log = fs::read_to_string(Path::new(&run).join("log.jsonl")).expect("a log");
        log.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
    };
    let (last, before) = (lines().pop().expect("a line"), lines());
    assert_eq!((&last["val_views"], before.len() > 10), (&Value::from(4), true));
    assert!(
        before[..before.len() - 1]
            .iter()
            .all(|line| line["val_psnr"].is_null() && line["val_probe"].is_f64())
    );
    object(&[&common[..], &["--steps", "9", "--val-at", "3,5", "--val-every", "4", "--overwrite"]].concat());
    let measured: Vec<u64> = lines()
        .iter()
        .filter(|line| line["val_views"] == 4)
        .filter_map(|line| line["step"].as_u64())
        .collect();
    assert_eq!(measured, [3, 4, 5, 8, 9]);
}

#[test]
fn a_run_goes_on_with_what_it_was_begun_with() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let run = path(dir.path(), "run");
    let common = ["train", SMALL, "--out", &run, "--model", "nerf", "--rays", "16", "--samples", "4"];
    fn joined<'a>(common: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
        [common, more].concat()
    }
    let train = |more: &[&'static str]| joined(&common, more);
    object(&train(&["--width", "8", "--steps", "2", "--json"]));
    let before = fs::read(dir.path().join("run/run.json")).expect("settings");
    refused(&train(&["--width", "12", "--steps", "4", "--resume"]), &["run.json", "width", "12", "8"]);
    refused(&train(&["--width", "8", "--steps", "4", "--seed", "1", "--resume"]), &["run.json", "seed"]);
    assert_eq!(
        fs::read(dir.path().join("run/run.json")).expect("settings"),
        before,
        "the run stays as it was"
    );
    // Half a line, as a stop in the middle of writing leaves it, and a batch that was met exactly.
    let log = dir.path().join("run/log.jsonl");
    let text = fs::read_to_string(&log).expect("a log").replacen(
        "\"train_psnr\":",
        "\"train_psnr\":null,\"was\":",
        1,
    );
    fs::write(&log, text + "{\"step\":3,\"sec").expect("written");
    assert_eq!(object(&train(&["--width", "8", "--steps", "4", "--resume", "--json"]))["step"], 4);
}

#[test]
fn a_sweep_makes_a_table_and_a_film_a_folder_with_depth() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let (sweep, run) = (path(dir.path(), "sweep"), path(dir.path(), "run"));
    let small = ["--size", "16", "--levels", "2,3", "--width", "8", "--lr", "1e-2", "--steps", "2", "--json"];
    object(&[&["sweep-image", "builtin:card", "--out", &sweep], &small[..]].concat());
    for file in ["contact_sheet.png", "table.txt", "table.json", "index.html"] {
        assert!(Path::new(&sweep).join(file).exists(), "no {file}");
    }
    let reference =
        ["--backend", "reference", "--width", "8", "--rays", "4", "--samples", "4", "--steps", "1"];
    object(&[&["train", SMALL, "--out", &run, "--model", "nerf", "--json"], &reference[..]].concat());
    let frames = path(dir.path(), "frames");
    let view = ["--path", "orbit:2", "--size", "8x6", "--depth", "--background", "white", "--json"];
    object(&[&["render", &run, "--out", &frames], &view[..]].concat());
    assert!(
        Path::new(&frames).join("frame_0000.png").exists() && Path::new(&frames).join("film.gif").exists()
    );
    refused(&["render", &run, "--out", &path(dir.path(), "sweep/table.txt/x.gif")], &["table.txt"]);
}

#[test]
fn a_fit_that_diverges_is_called_so() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let sweep = path(dir.path(), "sweep");
    let small =
        ["--size", "16", "--levels", "2", "--width", "8", "--lr", "1e-2,1e38", "--steps", "3", "--json"];
    let printed = object(&[&["sweep-image", "builtin:card", "--out", &sweep], &small[..]].concat());
    let read = |name: &str| fs::read_to_string(Path::new(&sweep).join(name)).expect(name);
    let rows: Value = serde_json::from_str(&read("table.json")).expect("JSON");
    assert_eq!(rows, printed["rows"]);
    assert_eq!(rows[0]["diverged"], false);
    assert!(rows[0]["psnr"].is_f64() && rows[0]["loss"].is_f64(), "{}", rows[0]);
    assert_eq!((&rows[1]["diverged"], &rows[1]["psnr"]), (&true.into(), &Value::Null));
    assert_eq!(printed["best_psnr"], rows[0]["psnr"]);
    for file in ["table.txt", "index.html"] {
        let text = read(file);
        assert!(text.matches("diverged").count() == 1 && !text.contains("NaN"), "{file}: {text}");
    }
}

/// A scene in the layout of the CS180 course, whose test split has cameras but no photographs.
fn cs180(file: &Path) {
    use nerf_oracle::files::npz::{Array, Arrays, write};
    let pose = |n: usize| {
        let mut pose = ndarray::Array2::<f64>::eye(4);
        // On a circle around the origin, looking at it: turned about y by the angle at which it stands.
        let (sin, cos) = (0.4 * n as f64).sin_cos();
        (pose[[0, 0]], pose[[0, 2]], pose[[2, 0]], pose[[2, 2]]) = (cos, sin, -sin, cos);
        (pose[[0, 3]], pose[[2, 3]]) = (-4.0 * sin, -4.0 * cos);
        pose
    };
    let poses = |count: usize| {
        let all: Vec<f64> = (0..count).flat_map(|n| pose(n).into_iter().collect::<Vec<_>>()).collect();
        Array::F64(ndarray::ArrayD::from_shape_vec(vec![count, 4, 4], all).expect("16 entries a pose"))
    };
    let pictures = |count: usize| {
        let shape = vec![count, 12, 12, 3];
        let level = |i: ndarray::IxDyn| (20 * i[1] + i[2]) as u8;
        Array::U8(ndarray::ArrayD::from_shape_fn(shape, level))
    };
    let focal = Array::F64(ndarray::arr0(12.0).into_dyn());
    let arrays = [
        ("images_train", pictures(3)),
        ("c2ws_train", poses(3)),
        ("images_val", pictures(1)),
        ("c2ws_val", poses(1)),
        ("c2ws_test", poses(2)),
        ("focal", focal),
    ];
    let arrays: Arrays = arrays.into_iter().map(|(name, array)| (name.to_string(), array)).collect();
    write(file, &arrays, true).expect("written");
}

#[test]
fn a_test_split_without_photographs_is_refused() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let (scene, run) = (path(dir.path(), "scene.npz"), path(dir.path(), "run"));
    cs180(Path::new(&scene));
    let args =
        ["train", &scene, "--out", &run, "--model", "nerf", "--width", "8", "--rays", "16", "--samples", "4"];
    object(&[&args[..], &["--steps", "2", "--json"]].concat());
    refused(&["evaluate", &run, "--split", "test"], &["test", "photographs"]);
    let film = object(&["render", &run, "--out", &path(dir.path(), "frames"), "--json"]);
    assert_eq!(film["frames"], 2, "the film follows the scene's test path");
}

#[test]
fn a_broken_checkpoint_is_refused() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let run = path(dir.path(), "run");
    let args = ["train", SMALL, "--out", &run, "--model", "nerf", "--width", "8", "--rays", "16"];
    object(&[&args[..], &["--samples", "4", "--steps", "1", "--json"]].concat());
    let file = Path::new(&run).join("checkpoint.npz");
    let bytes = fs::read(&file).expect("a checkpoint");
    fs::write(&file, &bytes[..bytes.len() / 2]).expect("written");
    refused(&["render", &run, "--out", &path(dir.path(), "f.gif")], &["checkpoint.npz"]);
}

#[test]
fn an_image_is_fitted() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let picture = path(dir.path(), "ramp.png");
    image::RgbImage::from_fn(12, 9, |x, y| image::Rgb([20 * x as u8, 25 * y as u8, 128]))
        .save(&picture)
        .expect("saved");
    let out = path(dir.path(), "fit");
    let args =
        ["fit-image", &picture, "--out", &out, "--steps", "150", "--batch", "108", "--width", "32", "--json"];
    let fit = object(&args);
    let log = fit["log"].as_array().expect("a log");
    let steps: Vec<u64> = log.iter().map(|p| p["step"].as_u64().expect("a step")).collect();
    assert_eq!(steps, [1, 101, 150]);
    let psnr = |n: usize| log[n]["psnr"].as_f64().expect("a figure");
    assert!(psnr(2) > psnr(0) + 5.0, "{} -> {}", psnr(0), psnr(2));
    assert!(Path::new(&out).join("step_0101.png").exists() && Path::new(&out).join("psnr.svg").exists());
}

/// Pictures without anything in them are refused before anything is written.
#[test]
fn pictures_of_one_color_are_refused() {
    use nerf_oracle::files::npz::{Array, read, write};
    let dir = tempfile::tempdir().expect("a temporary folder");
    let (scene, out) = (dir.path().join("scene.npz"), path(dir.path(), "run"));
    cs180(&scene);
    let mut arrays = read(&scene).expect("arrays");
    arrays.insert("images_train".into(), Array::U8(ndarray::ArrayD::from_elem(vec![3, 12, 12, 3], 7)));
    write(&scene, &arrays, true).expect("written");
    let scene = scene.to_str().expect("a name in UTF-8");
    refused(&["train", scene, "--out", &out], &["the same color in every pixel", "something to learn"]);
    assert!(!Path::new(&out).exists());
}
