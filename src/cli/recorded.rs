//! What `run.json` says, checked value by value: each setting against what its option takes, and what was derived from them against what
//! is derived today, so that an edit that changes the model is refused instead of changing it.

use serde_json::{Map, Value, json};

use crate::error::{Error, Input, Result};
use crate::files::json::Holds::{self, *};
use crate::files::json::short;
use crate::limits::{LENGTH, RAYS, SAMPLES, STEPS, WIDTH};
use crate::scene::Scene;
use crate::training::model::Model;

const REMEDY: &str = "Put back what train wrote there, or train the run again.";

/// Of what is derived, which isn't always done as it was.
const REDERIVED: &str = "Put back what train wrote there. Where nobody has changed it, another version trained the run and derived this \
     differently: use that one, or train the run again.";

const DISTANCE: Holds = Maybe(&Number(0.0, LENGTH));
const COUNT: Holds = Maybe(&Whole(1, STEPS as u64));
const POSITIVE: Holds = Maybe(&Above(0.0, f64::MAX));

/// The fields that decide what a run is; a run from before an option has no field for it.
#[rustfmt::skip]
const RUN: Holds = Object(&[
    ("scene", Text),
    ("scene_options", Object(&[
        ("near", DISTANCE), ("far", DISTANCE), ("holdout", Maybe(&Whole(2, 1 << 24))), ("background", Maybe(&Numbers(3, 0.0, 1.0))),
        ("shrink", Maybe(&Whole(1, 64))), ("integer_pixels", Maybe(&Flag)),
    ])),
    ("model", Word(&["compact", "nerf", "foreign"])), ("mapping", Maybe(&Anything)), ("weights", Maybe(&Text)), ("backend", Word(&["fast", "reference"])), ("seed", Whole(0, u64::MAX)),
    ("rays", Maybe(&Whole(1, RAYS as u64))), ("samples", Maybe(&Whole(1, SAMPLES as u64))),
    ("fine", Maybe(&Whole(0, SAMPLES as u64))), ("lr", POSITIVE), ("width", Maybe(&Whole(1, WIDTH as u64))),
    ("skip", Maybe(&Flag)), ("steps", COUNT), ("space", Maybe(&Text)), ("without", Maybe(&List(&Text))), ("version", Text),
    ("derived", Object(&[])), ("reasons", Object(&[])), ("settings", Object(&[])),
    ("end", Object(&[("steps", COUNT), ("seconds", POSITIVE), ("stop_at_psnr", Maybe(&Number(f64::MIN, f64::MAX)))])),
    ("threads", Maybe(&Whole(1, 1 << 16))), ("machine", Maybe(&Anything)), ("warnings", Maybe(&List(&Text))),
    ("failure", Maybe(&Text)),
]);

/// Checks each field of `run.json`.
///
/// # Errors
/// Where one holds what its option doesn't take, or is missing.
pub(super) fn check(run: &Map<String, Value>, file: &str) -> Result<()> {
    RUN.check(file, "", &Value::Object(run.clone()), REMEDY)
}

/// An error about a scene or an option that nobody gave on the command line: `file` names them.
pub(super) fn named(error: Error, file: &str) -> Error {
    match error {
        Error::Input(input) if input.file != file => {
            Error::Input(Input { remedy: format!("{} It is {file} that names it.", input.remedy), ..input })
        }
        Error::Usage { argument, found, expected } => {
            Error::input(Input { file, field: argument, found, expected, remedy: REMEDY })
        }
        other => other,
    }
}

/// What a scene gives where the options leave it open, as `run.json` has it.
pub(super) fn derived(scene: &Scene) -> Value {
    let (width, height) = scene.size();
    json!({
        "near": scene.near, "far": scene.far, "background": scene.background, "width": width, "height": height,
        "train_frames": scene.train.len(), "val_frames": scene.val.len(), "test_frames": scene.test.len(),
        "focus": scene.focus.to_array(),
    })
}

/// What `run.json` says of every run, whether it is trained here or its weights come from elsewhere.
pub(super) fn begun(recipe: &Map<String, Value>, scene: &Scene, model: &dyn Model) -> Map<String, Value> {
    let mut run = recipe.clone();
    run.insert("version".into(), env!("CARGO_PKG_VERSION").into());
    run.insert("derived".into(), derived(scene));
    run.insert("reasons".into(), Value::Object(scene.reasons.clone()));
    run.insert("settings".into(), Value::Object(model.settings()));
    run
}

/// Checks that the scene and the model are those of `run.json`.
///
/// # Errors
/// Where a value was another one when the run was trained.
pub(super) fn check_same(
    run: &Map<String, Value>,
    scene: &Scene,
    model: &dyn Model,
    file: &str,
) -> Result<()> {
    let (derived, settings) = (derived(scene), Value::Object(model.settings()));
    // Reasons are words; how many test frames are loaded depends on what for.
    let words = ["reasons", "test_frames"];
    for (part, now) in [("derived", &derived), ("settings", &settings)] {
        for (name, had) in run.get(part).and_then(Value::as_object).into_iter().flatten() {
            let now = now.get(name).unwrap_or(&Value::Null);
            if !words.contains(&name.as_str()) && !same(had, now) {
                let (field, expected) =
                    (format!("{part}.{name}"), format!("{}, which its scene and options give", short(now)));
                return Err(Error::input(Input {
                    file,
                    field,
                    found: short(had),
                    expected,
                    remedy: REDERIVED,
                }));
            }
        }
    }
    Ok(())
}

/// Settings that runs from before them lack, and what a model was like then.
fn since() -> [(&'static str, Value); 3] {
    [("space", json!("box")), ("distortion", json!(0.0)), ("batch_grows", json!(500.0))]
}

/// Checks that nothing is new in a run that goes on.
///
/// # Errors
/// Where a setting, of which `run.json` says nothing, isn't as it always was before.
pub(super) fn check_newer(run: &Map<String, Value>, model: &dyn Model, file: &str) -> Result<()> {
    let now = model.settings();
    let had = run.get("settings").and_then(Value::as_object);
    for (name, before) in since() {
        let new =
            now.get(name).filter(|now| had.is_some_and(|had| !had.contains_key(name)) && **now != before);
        if let Some(new) = new {
            let (field, found) =
                (format!("settings.{name}"), "nothing: the run is from before there was one");
            let (expected, remedy) =
                (short(new), "Resume it with the version that began it, or train it again.");
            return Err(Error::input(Input { file, field, found, expected, remedy }));
        }
    }
    Ok(())
}

/// Whether two values are the same, numbers but for the last digits of a file or of another machine's arithmetic.
fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        // A seed of 2^60 has no last digit to lose.
        _ if a.is_u64() && b.is_u64() => a == b,
        _ => match (a.as_f64(), b.as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * a.abs().max(b.abs()),
            _ => a == b,
        },
    }
}
