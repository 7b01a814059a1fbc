//! A run's recipe: the options of `train` that say what is trained. `run.json` keeps it; whoever opens a run rebuilds its model from it.

use std::path::Path;

use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::options::Space;
use super::recorded;
use super::train::Args;
use crate::error::{Error, Input, Result};
use crate::field::nerf_mlp::Shape;
use crate::limits::{self, COMPACT_SAMPLE, PARAMETER, STEP_SAMPLE};
use crate::scene::{self, Scene};
use crate::training::checkpoint::RunFolder;
use crate::training::compact::{CompactModel, CompactSettings, Extent, Overrides, Part};
use crate::training::foreign::ForeignModel;
use crate::training::foreign::mapping::Mapping;
use crate::training::identity::Identity;
use crate::training::model::Model;
use crate::training::nerf::{NerfModel, NerfSettings, Skip, forward};

/// What `run.json` calls the model of imported weights.
pub(super) const FOREIGN: &str = "foreign";

/// What `--resume` may not change.
const KEPT: [&str; 13] = [
    "scene",
    "scene_options",
    "model",
    "backend",
    "seed",
    "rays",
    "samples",
    "fine",
    "lr",
    "width",
    "space",
    "without",
    "skip",
];

/// The recipe that the command line gives.
pub(super) fn given(args: &Args) -> Map<String, Value> {
    let mut scene_options = json!({
        "near": args.near, "far": args.far, "holdout": args.holdout, "background": args.background,
    });
    if let Some(n) = args.scale {
        // Only where given: runs of before this option have no such field, and can be resumed.
        scene_options["shrink"] = n.into();
    }
    let recipe = json!({
        "scene": args.scene, "scene_options": scene_options, "model": args.model, "backend": args.backend,
        "seed": args.seed, "rays": args.rays, "samples": args.samples, "fine": args.fine, "lr": args.lr, "width": args.width,
        "skip": args.skip, "steps": args.steps, "without": args.without,
    });
    let Value::Object(mut recipe) = recipe else { unreachable!("an object literal") };
    if args.space != Space::Auto {
        // For the same reason.
        recipe.insert("space".into(), json!(args.space));
    }
    recipe
}

/// What of a recipe determines every bit of a run; the scene does by its content, wherever it lies.
pub(super) fn kept(recipe: &Map<String, Value>) -> Map<String, Value> {
    let names = KEPT.iter().filter(|name| **name != "scene");
    names.filter_map(|name| Some((name.to_string(), recipe.get(*name)?.clone()))).collect()
}

/// The run to resume, which must have been started with this recipe, and the warnings that it had so far.
pub(super) fn resumed(
    run: &Path,
    recipe: &Map<String, Value>,
    identity: &Identity,
) -> Result<(RunFolder, Vec<Value>)> {
    let folder = RunFolder::resume(run, identity.clone())?;
    let file = folder.file("run.json").display().to_string();
    let before = folder.settings()?;
    recorded::check(&before, &file)?;
    check_kept(&KEPT, &before, recipe, &file)?;
    let warnings = before.get("warnings").and_then(Value::as_array).cloned().unwrap_or_default();
    if let Some(known) = Identity::of_settings(&before) {
        known.check_content(&identity.content, &file)?;
    }
    Ok((folder, warnings))
}

/// Refuses options that aren't those that a run was begun with.
pub(super) fn check_kept(
    names: &[&str],
    before: &Map<String, Value>,
    recipe: &Map<String, Value>,
    file: &str,
) -> Result<()> {
    // A field that an older run lacks was at its default.
    let defaults = json!({"fine": 0, "width": null, "skip": false, "space": "auto", "without": []});
    for &name in names {
        let had = before.get(name).unwrap_or(&defaults[name]);
        let found = recipe.get(name).unwrap_or(&defaults[name]);
        if had != found {
            let remedy =
                "Give --resume the options that the run was begun with; --steps and --seconds may differ.";
            return Err(Error::input(Input { file, field: name, found, expected: had, remedy }));
        }
    }
    Ok(())
}

/// The scene that a recipe (given on the command line, or read from `run.json`) names.
pub(super) fn load_scene(recipe: &Map<String, Value>, test_images: bool, file: &str) -> Result<Scene> {
    let given = &recipe.get("scene_options").cloned().unwrap_or_default();
    let name = recipe.get("scene").and_then(Value::as_str).ok_or_else(|| {
        Error::input(Input {
            file,
            field: "scene",
            found: "no name",
            expected: "the scene that was trained",
            remedy: "Train the run again.",
        })
    })?;
    let number = |key: &str| given[key].as_f64();
    let background = <[f64; 3]>::deserialize(&given["background"]).ok();
    let options = scene::Options {
        near: number("near"),
        far: number("far"),
        holdout: given["holdout"].as_u64().map(|n| n as usize),
        background,
        shrink: given["shrink"].as_u64().map(|n| n as usize),
        integer_pixels: given["integer_pixels"].as_bool() == Some(true),
        test_images,
    };
    scene::load(name, &options)
}

/// The model that a recipe describes, with its initial parameters.
pub(super) fn build(recipe: &Map<String, Value>, scene: &Scene) -> Result<Box<dyn Model>> {
    // Runs from before these options have none.
    let without: Vec<Part> = listed(recipe, "without", json!([]), "names of parts")?;
    // A run.json whose settings have no space is from before there was a choice.
    let old = recipe.get("settings").is_some_and(|settings| settings.get("space").is_none());
    let space: Space =
        listed(recipe, "space", json!(if old { "box" } else { "auto" }), "auto, box, contracted or ndc")?;
    if named(recipe, "model", FOREIGN) {
        return Ok(Box::new(foreign(recipe)?));
    }
    if named(recipe, "model", "compact") {
        return Ok(Box::new(compact(recipe, scene, space.extent()?, without)?));
    }
    if !without.is_empty() {
        return Err(Error::usage("--without", "given", "no --without: its parts are the compact model's"));
    }
    Ok(Box::new(nerf(recipe, scene, space)?))
}

/// A field of a recipe that isn't a number; `missing` where there is none.
fn listed<T: serde::de::DeserializeOwned>(
    recipe: &Map<String, Value>,
    field: &str,
    missing: Value,
    expected: &str,
) -> Result<T> {
    serde_json::from_value(recipe.get(field).cloned().unwrap_or(missing)).map_err(|error| {
        let remedy = "Train the run again.";
        Error::input(Input { file: "run.json", field, found: error, expected, remedy })
    })
}

/// The networks of another program; their arrays are in the checkpoint.
fn foreign(recipe: &Map<String, Value>) -> Result<ForeignModel> {
    let mapping = Mapping::parse(recipe.get("mapping").unwrap_or(&Value::Null), "run.json")?;
    ForeignModel::new(mapping, named(recipe, "backend", "reference"), "run.json")
}

fn compact(
    recipe: &Map<String, Value>,
    scene: &Scene,
    extent: Extent,
    without: Vec<Part>,
) -> Result<CompactModel> {
    if named(recipe, "backend", "reference") {
        return Err(Error::usage(
            "--backend",
            "reference",
            "fast: the reference trains and renders --model nerf",
        ));
    }
    if let Some(fine) = whole(recipe, "fine").filter(|&fine| fine > 0) {
        return Err(Error::usage("--fine", fine, "0: a second network belongs to --model nerf"));
    }
    if let Some(width) = whole(recipe, "width") {
        return Err(Error::usage(
            "--width",
            width,
            "no width: --model nerf has it, compact's networks are fixed",
        ));
    }
    if skip(recipe) {
        return Err(Error::usage(
            "--skip",
            "given",
            "no --skip: the compact model always leaves empty space out",
        ));
    }
    let [samples, rays] = ["samples", "rays"].map(|key| whole(recipe, key).map(|n| n as usize));
    let overrides = Overrides { seed: seed(recipe), samples, rays, lr: lr(recipe), extent, without };
    let settings = CompactSettings::derive(scene, &overrides);
    if extent == Extent::Contracted && !settings.contracted() {
        let expected = "auto or box: the cameras stand at the point that they look at, so that nothing says what is near";
        return Err(Error::usage("--space", "contracted", expected));
    }
    // Without a given number of them, rays fill a batch of a fixed size.
    fits_step(rays.unwrap_or(0), settings.longest_ray(), COMPACT_SAMPLE)?;
    CompactModel::new(scene, &overrides)
}

fn nerf(recipe: &Map<String, Value>, scene: &Scene, space: Space) -> Result<NerfModel> {
    let mut settings = NerfSettings::new(scene.near, scene.far, scene.background);
    match space {
        Space::Auto => settings.choose_space(scene),
        Space::Box => settings.space_reason = "as asked for",
        Space::Ndc => {
            let (cube, _) = forward::cube(scene)
                .map_err(|why| Error::usage("--space", "ndc", format!("auto or box: {why}")))?;
            (settings.cube, settings.space_reason) = (Some(cube), "as asked for");
        }
        Space::Contracted => {
            let expected = "auto, box or ndc: contracted is for --model compact";
            return Err(Error::usage("--space", "contracted", expected));
        }
    }
    settings.seed = seed(recipe);
    settings.reference = named(recipe, "backend", "reference");
    if let Some(rays) = whole(recipe, "rays") {
        settings.rays = rays as usize;
    }
    if let Some(samples) = whole(recipe, "samples") {
        settings.samples = samples as usize;
    }
    settings.fine = whole(recipe, "fine").unwrap_or(0) as usize;
    settings.skip = skip(recipe).then(Skip::default);
    if settings.skip.is_some() && settings.fine > 0 {
        return Err(Error::usage(
            "--skip",
            "given",
            "no --fine beside it: one network has a grid, a pair has none",
        ));
    }
    if let Some(lr) = lr(recipe) {
        settings.lr = lr;
    }
    if let Some(width) = whole(recipe, "width") {
        settings.set_width(width as usize);
    }
    fits_step(settings.rays, (settings.samples + settings.fine) as f64, STEP_SAMPLE)?;
    let Shape { width, depth, .. } = settings.shape;
    let networks = if settings.fine > 0 { 2.0 } else { 1.0 };
    let parameters = networks * (width * width * (depth + 1)) as f64;
    limits::fits(format!("a network of width {width}"), PARAMETER * parameters, "Lower `width`.")?;
    Ok(NerfModel::new(settings))
}

/// That a training step fits into memory.
fn fits_step(rays: usize, samples: f64, bytes: f64) -> Result<()> {
    let what = format!("a step of {rays} rays with {samples:.0} samples each");
    limits::fits(what, bytes * rays as f64 * samples, "Lower `rays` or `samples`.")
}

fn whole(recipe: &Map<String, Value>, key: &str) -> Option<u64> {
    recipe.get(key).and_then(Value::as_u64)
}

fn named(recipe: &Map<String, Value>, key: &str, value: &str) -> bool {
    recipe.get(key).and_then(Value::as_str) == Some(value)
}

fn seed(recipe: &Map<String, Value>) -> u64 {
    whole(recipe, "seed").unwrap_or(0)
}

fn lr(recipe: &Map<String, Value>) -> Option<f64> {
    recipe.get("lr").and_then(Value::as_f64)
}

fn skip(recipe: &Map<String, Value>) -> bool {
    recipe.get("skip") == Some(&Value::Bool(true))
}
