//! Other programs' weights: imported by a mapping, rendered as their program does, exported bit by bit.

#[path = "shared/mod.rs"]
mod shared;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use nerf_oracle::files::npz;
use serde_json::{Value, json};
use shared::shared;

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nerf-oracle")).args(args).output().expect("the program starts")
}

/// The JSON of a command that goes well.
fn json_of(args: &[&str]) -> Value {
    let output = run(&[args, &["--json"]].concat());
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one object")
}

/// The message of a command that is refused.
fn refused(args: &[&str]) -> String {
    let output = run(args);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
    assert!(!said.contains("panicked"), "{said}");
    said
}

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

const SCENE: &str = "builtin:spheres,size=16,views=8";

/// A run of a pair of small networks, its weights as `own.npz` and their mapping as `own.json`.
fn exported(folder: &Path) {
    let (own, weights) = (path(folder, "own"), path(folder, "own.npz"));
    let small = ["--steps", "3", "--width", "16", "--samples", "12", "--fine", "8", "--rays", "64"];
    json_of(&[&["train", SCENE, "--model", "nerf", "--out", &own][..], &small].concat());
    json_of(&["export", &own, "--out", &weights]);
}

fn import(folder: &Path, weights: &str, mapping: &str, out: &str) -> Value {
    let [weights, mapping, out] = [weights, mapping, out].map(|name| path(folder, name));
    json_of(&["import", &weights, "--mapping", &mapping, "--scene", SCENE, "--out", &out])
}

fn psnr(run: &str, rest: &[&str]) -> f64 {
    json_of(&[&["evaluate", run][..], rest].concat())["psnr"].as_f64().expect("a number")
}

#[test]
fn what_was_exported_is_imported_and_renders_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    exported(root);
    let imported = import(root, "own.npz", "own.json", "again");
    assert_eq!((&imported["arrays"], &imported["unused"]), (&json!(48), &json!([])));
    let (own, again) = (path(root, "own"), path(root, "again"));
    for backend in ["fast", "reference"] {
        let [a, b] = [&own, &again].map(|run| psnr(run, &["--backend", backend]));
        assert!((a - b).abs() < 1e-4, "{backend}: {a} dB by this program's network, {b} by the imported one");
    }
    // Names, bits and mapping come back, from an archive and from a file of safetensors.
    json_of(&["export", &again, "--out", &path(root, "again.npz")]);
    let arrays = npz::read(&root.join("own.npz")).unwrap();
    assert_eq!(arrays, npz::read(&root.join("again.npz")).unwrap());
    assert!(arrays.len() == 48 && arrays.contains_key("fine.trunk7_w"), "{:?}", arrays.keys());
    let mapping = |name: &str| -> Value {
        serde_json::from_str(&fs::read_to_string(root.join(name)).unwrap()).unwrap()
    };
    assert_eq!(mapping("again.json")["layers"], mapping("own.json")["layers"]);
    fs::write(root.join("own.safetensors"), safetensors(&arrays)).unwrap();
    let imported = import(root, "own.safetensors", "again.json", "third");
    assert_eq!(imported["unused"], json!(["counter"]));
    json_of(&["export", &path(root, "third"), "--out", &path(root, "third.npz")]);
    assert_eq!(arrays, npz::read(&root.join("third.npz")).unwrap());
    // A film of it, a part of the pixels, and no training.
    json_of(&["render", &again, "--out", &path(root, "film.gif"), "--path", "orbit:2"]);
    assert!((psnr(&again, &["--every", "3"]) - psnr(&own, &["--every", "3"])).abs() < 1e-3);
    assert!(
        refused(&["evaluate", &again, "--every", "17"]).contains("--every: found 17; expected at most 16")
    );
    assert!(
        refused(&["train", SCENE, "--model", "nerf", "--out", &again, "--resume"]).contains("begun with")
    );
}

/// The format by hand: the header's length, the header, the numbers. One array isn't of floats.
fn safetensors(arrays: &npz::Arrays) -> Vec<u8> {
    let (mut header, mut data) = (json!({"__metadata__": {"format": "pt"}}), vec![]);
    for (name, array) in arrays {
        let from = data.len();
        data.extend(array.to_f64().iter().flat_map(|&x| (x as f32).to_le_bytes()));
        header[name] = json!({"dtype": "F32", "shape": array.shape(), "data_offsets": [from, data.len()]});
    }
    let from = data.len();
    data.extend([0u8; 8]);
    header["counter"] = json!({"dtype": "I64", "shape": [1], "data_offsets": [from, from + 8]});
    let mut header = header.to_string().into_bytes();
    header.resize(header.len().next_multiple_of(8), b' ');
    [&(header.len() as u64).to_le_bytes()[..], &header, &data].concat()
}

#[test]
fn a_wrong_mapping_or_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    exported(root);
    let mapping: Value = serde_json::from_str(&fs::read_to_string(root.join("own.json")).unwrap()).unwrap();
    let asked = |weights: &str, text: &str| {
        fs::write(root.join("wrong.json"), text).unwrap();
        let [weights, mapping, out] = [weights, "wrong.json", "none"].map(|name| path(root, name));
        let said = refused(&["import", &weights, "--mapping", &mapping, "--scene", SCENE, "--out", &out]);
        assert!(!root.join("none").exists(), "no folder is left: {said}");
        said
    };
    #[rustfmt::skip]
    let changes: [(&str, Value, &str); 19] = [
        ("/schema", json!("nerf-oracle/mapping/2"), "schema: found nerf-oracle/mapping/2"),
        ("/depth", json!(7), "skip"), ("/depth", json!(9), "array trunk8_w: found only ["),
        ("/depth", json!(0), "depth: found 0"), ("/depth", json!("8"), "depth: found invalid type: string"),
        ("/width", json!(32), "array trunk0_w: found shape [16, 63]; expected shape [32, 63]"),
        ("/color_width", json!(16), "array color0_w: found shape [8, 43]; expected shape [16, 43]"),
        ("/skip/layer", json!(5), "array trunk4_w: found shape [16, 79]; expected shape [16, 16]"),
        ("/skip/layer", json!(8), "skip.layer: found 8; expected 1 to 7"), ("/skip/order", json!("left"), "skip.order"),
        ("/levels/position", json!(6), "array trunk0_w: found shape [16, 63]; expected shape [16, 39]"),
        ("/arrays/layout", json!("in_out"), "array trunk0_w: found shape [16, 63]; expected shape [63, 16]"),
        ("/networks/fine", json!(null), "fine: found samples.fine 8"), ("/networks/coarse", json!("x."), "array x.trunk0_w: found only ["),
        ("/layers/trunk", json!(["a"]), "layers.trunk: found 1 names; expected 8"),
        ("/profile", json!("nerf2019"), "profile: found nerf2019"), ("/near", json!(9), "near and far"),
        ("/conventions", json!({"density": "cubed"}), "conventions.density: found cubed; expected relu | softplus | exp"),
        ("/conventions", json!({"axes": "opengl"}), "conventions.axes: found a name without effect"),
    ];
    for (place, value, words) in changes {
        let mut wrong = mapping.clone();
        if place == "/depth" && value == json!(7) {
            wrong["skip"]["layer"] = json!(7);
        }
        *wrong.pointer_mut(place).unwrap() = value;
        let said = asked("own.npz", &wrong.to_string());
        assert!(said.contains(words), "{place}: {words:?} isn't in: {said}");
    }
    let whole = mapping.to_string();
    for (text, words) in [
        ("{", "JSON"),
        ("{}", "missing field"),
        (&whole.replacen("\"depth\"", "\"deepness\"", 1), "unknown field `deepness`"),
        (&whole.replacen("{", "{\"near\":2,", 1), "twice"),
    ] {
        let said = asked("own.npz", text);
        assert!(said.contains("wrong.json") && said.contains(words), "{words:?} isn't in: {said}");
    }
    let mut arrays = npz::read(&root.join("own.npz")).unwrap();
    let bytes = safetensors(&arrays);
    fs::write(root.join("cut.safetensors"), &bytes[..bytes.len() - 1]).unwrap();
    assert!(asked("cut.safetensors", &whole).contains("cut.safetensors: header"));
    fs::write(root.join("short.safetensors"), [255; 9]).unwrap();
    assert!(asked("short.safetensors", &whole).contains("short.safetensors: header"));
    assert!(asked("own.json", &whole).contains("own.json: archive"));
    let npz::Array::F32(sigma) = arrays.get_mut("sigma_b").unwrap() else { panic!("a float") };
    sigma[[0]] = f32::NAN;
    npz::write(&root.join("nan.npz"), &arrays, false).unwrap();
    assert!(asked("nan.npz", &whole).contains("array sigma_b: found NaN; expected finite"));
    json_of(&["train", SCENE, "--model", "compact", "--steps", "2", "--out", &path(root, "compact")]);
    let compact = refused(&["export", &path(root, "compact"), "--out", &path(root, "compact.npz")]);
    assert!(compact.contains("model: found compact; expected nerf"), "{compact}");
    assert!(
        refused(&["export", &path(root, "own"), "--out", &path(root, "own.pt")]).contains("ends in .npz")
    );
}

/// The mapping of the network in `foreign_weights`, as the README has it.
fn lego(networks: Value, fine: usize) -> Value {
    json!({
        "schema": "nerf-oracle/mapping/1", "networks": networks,
        "layers": {
            "trunk": ["layer1", "layers_xyz.0", "layers_xyz.1", "layers_xyz.2"], "density": "fc_alpha", "feature": "fc_feat",
            "color": ["layers_dir.0"], "rgb": "fc_rgb",
        },
        "depth": 4, "width": 128, "skip": null,
        "activations": {"trunk": ["none", "relu", "relu", "relu"], "feature": "relu", "color": "relu"},
        "levels": {"position": 10, "direction": 4}, "profile": "nerf2020",
        "samples": {"coarse": 64, "fine": fine}, "near": 2, "far": 6, "background": [1, 1, 1],
    })
}

/// A network that PyTorch has trained shows what it shows there: 27.20 dB, and 24.21 dB of the coarse one, over every 8th pixel.
#[test]
fn another_programs_network_shows_what_it_showed_there() {
    let (Some(weights), Some(scene)) = (shared("foreign_weights/lego_4x128.npz"), shared("lego_800")) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let (weights, scene) = (weights.display().to_string(), scene.display().to_string());
    let both = [
        (
            "fine",
            lego(json!({"coarse": "model_coarse_state_dict/", "fine": "model_fine_state_dict/"}), 64),
            27.2,
        ),
        ("coarse", lego(json!({"coarse": "model_coarse_state_dict/"}), 0), 24.2),
    ];
    for (name, mapping, expected) in both {
        let [file, out] = [format!("{name}.json"), name.to_string()].map(|name| path(root, &name));
        fs::write(&file, mapping.to_string()).unwrap();
        json_of(&[
            "import",
            &weights,
            "--mapping",
            &file,
            "--scene",
            &scene,
            "--scale",
            "1/2",
            "--out",
            &out,
        ]);
        // Every 16th is a quarter of those pixels, which takes seconds, not a minute.
        let found = psnr(&out, &["--every", "16"]);
        assert!((found - expected).abs() < 0.5, "{name}: {found} dB, {expected} expected");
    }
    json_of(&["export", &path(root, "fine"), "--out", &path(root, "back.npz")]);
    let mut theirs = npz::read(Path::new(&weights)).unwrap();
    // The file has a number beside the networks, which no mapping names.
    theirs.remove("loss").unwrap();
    assert_eq!(theirs, npz::read(&root.join("back.npz")).unwrap());
}
