//! `import WEIGHTS --mapping FILE --scene SCENE --out RUN`: another program's network as a run that can be measured and rendered.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::{Map, Value, json};

use super::options::{positive, scale};
use super::recipe::{self, FOREIGN};
use super::{output, recorded};
use crate::error::{Error, Input, Result};
use crate::files::npz::{Arrays, Npz};
use crate::files::{self, json as parsed, safetensors};
use crate::limits;
use crate::scene::{Scene, listed};
use crate::training::checkpoint::RunFolder;
use crate::training::foreign::mapping::Mapping;
use crate::training::foreign::{ForeignModel, keep};
use crate::training::identity::Identity;
use crate::training::model::Model;

/// Options of `import`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// The weights: .npz or .safetensors (tools/torch_weights.py makes an .npz of a PyTorch file).
    pub weights: PathBuf,
    /// What they mean: a JSON file with names, depth, width, skip, activations, encoding and sampling.
    #[arg(long)]
    pub mapping: PathBuf,
    /// The scene that they were trained on, as train takes it.
    #[arg(long)]
    pub scene: String,
    /// The folder of the run.
    #[arg(long)]
    pub out: PathBuf,
    /// 1/N: pictures of one pixel for each square of N x N.
    #[arg(long, value_name = "1/N", value_parser = scale)]
    pub scale: Option<usize>,
    /// Every Nth frame is for validation, where the scene has no split.
    #[arg(long, value_parser = positive)]
    pub holdout: Option<usize>,
    /// Move a run that is in the folder aside.
    #[arg(long)]
    pub overwrite: bool,
}

/// Runs `import`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    files::check_writable(&args.out)?;
    let file = args.mapping.display().to_string();
    let text = files::read_text(&args.mapping)?;
    let object = parsed::parse_object(&text).map_err(|error| {
        let (expected, remedy) = ("a mapping, one object", "The README has an example.");
        Error::input(Input { file: &file, field: "JSON", found: error, expected, remedy })
    })?;
    let mapping = Mapping::parse(&Value::Object(object), &file)?;
    let mut model = ForeignModel::new(mapping.clone(), false, &file)?;
    let (arrays, mut unused) = read(&args.weights)?;
    unused.extend(model.take(&arrays, &args.weights.display().to_string())?);
    let recipe = recipe(args, &mapping, model.integer_pixels());
    let scene = recipe::load_scene(&recipe, false, "arguments")?;
    let mut warnings = scene.warnings.clone();
    if !unused.is_empty() {
        let names = listed(&unused);
        warnings.push(format!("{}: arrays that the mapping doesn't name: {names}.", args.weights.display()));
    }
    warnings.iter().for_each(|warning| output::say(&format!("warning: {warning}")));
    let mut kept = recipe::kept(&recipe);
    kept.insert("mapping".into(), recipe["mapping"].clone());
    let identity = Identity::new(&kept, scene.digest());
    let folder = RunFolder::begin(&args.out, identity.clone(), args.overwrite)?;
    files::make_folder(&folder.file("views"))?;
    let mut settings = run_json(&recipe, &scene, &model, &warnings);
    settings.extend(identity.settings());
    folder.write_settings(&settings)?;
    keep(&folder, &model)?;
    let (out, count) = (args.out.display().to_string(), model.state().len());
    let object = json!({"run": out, "arrays": count, "unused": unused, "warnings": warnings});
    output::print(json, &object, &format!("{out}: {count} arrays\n"))?;
    Ok(ExitCode::SUCCESS)
}

/// All arrays of floats, and the names of what else there is.
fn read(path: &Path) -> Result<(Arrays, Vec<String>)> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("safetensors")) {
        return safetensors::read(path);
    }
    let mut npz = Npz::open(path)?;
    limits::fits(path.display(), 2.0 * npz.unpacked_bytes() as f64, "Import fewer arrays at once.")?;
    let names: Vec<String> = npz.names().map(String::from).collect();
    let mut arrays = Arrays::new();
    for name in names {
        arrays.insert(name.clone(), npz.array(&name)?);
    }
    Ok((arrays, vec![]))
}

/// What `run.json` says of how the run came to be, as if it had been trained.
fn recipe(args: &Args, mapping: &Mapping, integer_pixels: bool) -> Map<String, Value> {
    let mut scene_options = json!({
        "near": mapping.near, "far": mapping.far, "holdout": args.holdout, "background": mapping.background,
        "integer_pixels": integer_pixels,
    });
    if let Some(n) = args.scale {
        scene_options["shrink"] = n.into();
    }
    let recipe = json!({
        "scene": args.scene, "scene_options": scene_options, "model": FOREIGN, "backend": "fast", "seed": 0, "rays": null,
        "samples": null, "fine": null, "lr": null, "width": null, "skip": false, "steps": null, "without": [],
        "mapping": mapping, "weights": args.weights.display().to_string(),
    });
    let Value::Object(recipe) = recipe else { unreachable!("an object literal") };
    recipe
}

fn run_json(
    recipe: &Map<String, Value>,
    scene: &Scene,
    model: &ForeignModel,
    warnings: &[String],
) -> Map<String, Value> {
    let mut run = recorded::begun(recipe, scene, model);
    run.insert("end".into(), json!({"steps": null, "seconds": null, "stop_at_psnr": null}));
    run.insert("warnings".into(), json!(warnings));
    run
}
