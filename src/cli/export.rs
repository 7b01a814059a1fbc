//! `export RUN --out FILE.npz`: a run's weights for other programs, and beside them the mapping that `import` takes.

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::{Map, Value, json};

use super::recipe::FOREIGN;
use super::{output, recorded};
use crate::error::{Error, Input, Result};
use crate::files;
use crate::files::npz::{self, Arrays};
use crate::training::checkpoint::RunFolder;
use crate::training::foreign::mapping::{Mapping, SCHEMA};
use crate::training::foreign::own;
use crate::training::nerf;

/// Options of `export`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// The folder of a run: imported, or trained with --model nerf.
    pub run: PathBuf,
    /// The .npz; the mapping is written beside it as .json.
    #[arg(long)]
    pub out: PathBuf,
}

/// Runs `export`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    files::check_replaceable(&args.out)?;
    if !args.out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npz")) {
        return Err(Error::usage("--out", args.out.display(), "a file that ends in .npz"));
    }
    let folder = RunFolder::open(&args.run)?;
    let (settings, file) = (folder.settings()?, folder.file("run.json").display().to_string());
    recorded::check(&settings, &file)?;
    let state = folder.load()?.state;
    let model = settings["model"].as_str().unwrap_or_default();
    let (arrays, mapping) = match model {
        FOREIGN => {
            let mapping = settings.get("mapping").cloned().unwrap_or_default();
            Mapping::parse(&mapping, &file)?;
            (own(&state), mapping)
        }
        "nerf" => (nerf::parameters(&state), mapping(&settings, &file)?),
        _ => {
            let remedy = "Train with --model nerf; what the compact model has learned is in checkpoint.npz.";
            let expected = "nerf, or imported weights: a mapping has no words for a hash grid";
            return Err(Error::input(Input { file, field: "model", found: model, expected, remedy }));
        }
    };
    write(args, &arrays, &mapping)?;
    let out = args.out.display().to_string();
    output::print(
        json,
        &json!({"out": out, "arrays": arrays.len()}),
        &format!("{out}: {} arrays\n", arrays.len()),
    )?;
    Ok(ExitCode::SUCCESS)
}

fn write(args: &Args, arrays: &Arrays, mapping: &Value) -> Result<()> {
    npz::write(&args.out, arrays, true)?;
    let text = serde_json::to_string_pretty(mapping).expect("plain data");
    files::write(&args.out.with_extension("json"), text + "\n")
}

/// What a trained run's arrays mean.
fn mapping(run: &Map<String, Value>, file: &str) -> Result<Value> {
    let settings = run["settings"].as_object().cloned().unwrap_or_default();
    let get = |name: &str| {
        settings.get(name).cloned().ok_or_else(|| {
            let (expected, remedy) = ("what train wrote there", "Train the run again.");
            let field = format!("settings.{name}");
            Error::input(Input { file, field, found: "no such field", expected, remedy })
        })
    };
    if settings.get("space").is_some_and(|space| space == "ndc") {
        let (found, expected) = ("ndc", "box: a mapping has no words for normalized device coordinates");
        let remedy = "Train with --space box.";
        return Err(Error::input(Input { file, field: "settings.space", found, expected, remedy }));
    }
    let fine = get("fine")?;
    let second = fine.as_u64().filter(|fine| *fine > 0).map(|_| "fine.");
    Ok(json!({
        "schema": SCHEMA, "networks": {"coarse": "", "fine": second},
        "layers": {"trunk": "trunk{}", "density": "sigma", "feature": "feature", "color": ["color0"], "rgb": "color1"},
        "arrays": {"weight": "{}_w", "bias": "{}_b", "layout": "out_in"},
        "depth": get("depth")?, "width": get("width")?, "color_width": get("color_width")?,
        "skip": {"layer": get("skip")?, "order": "hidden_first"},
        "activations": {"trunk": "relu", "feature": "none", "color": "relu"},
        "levels": {"position": get("levels_position")?, "direction": get("levels_direction")?},
        "profile": get("profile")?, "conventions": {},
        "samples": {"coarse": get("samples")?, "fine": fine},
        "near": get("near")?, "far": get("far")?, "background": run["derived"]["background"],
    }))
}
