//! `train SCENE --out RUN`.

use std::cell::RefCell;
use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use clap::ValueEnum;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::options::{
    Backend, Space, at_most, color, distance, finite_number, host, none_or, positive, positive_number, scale,
    steps, threads,
};
use super::signals::{Signal, Signals};
use super::spelling::spelled;
use super::{live, output, progress, recipe, recorded, run_page};
use crate::error::{Error, Input, Result};
use crate::files;
use crate::limits::{RAYS, SAMPLES, WIDTH};
use crate::parallel;
use crate::report::{table, training};
use crate::scene::Scene;
use crate::serve::Port;
use crate::training::checkpoint::RunFolder;
use crate::training::compact::Part;
use crate::training::identity::Identity;
use crate::training::model::Model;
use crate::training::run::{LogPoint, News, Options, Run};
use crate::training::watch::blank;

/// Options of `train`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// builtin:NAME, an .npz, a folder or file of transforms*.json, or a capture's folder with COLMAP's sparse/0 or LLFF's
    /// poses_bounds.npy (or a folder of pictures in it, such as images_4).
    pub scene: String,
    /// The run's folder.
    #[arg(long)]
    pub out: PathBuf,
    /// Which field.
    #[arg(long, value_enum, default_value_t = Kind::Compact)]
    pub model: Kind,
    /// Stop after this many steps.
    #[arg(long, value_parser = steps)]
    pub steps: Option<usize>,
    /// Stop after this many seconds of wall clock from the first step, everything included but the full validation at the end.
    #[arg(long, value_parser = positive_number)]
    pub seconds: Option<f64>,
    /// Stop when validation reaches this PSNR, in dB.
    #[arg(long, value_parser = finite_number)]
    pub stop_at_psnr: Option<f64>,
    /// Rays per step.
    #[arg(long, value_parser = at_most::<RAYS>)]
    pub rays: Option<usize>,
    /// Samples per ray.
    #[arg(long, value_parser = at_most::<SAMPLES>)]
    pub samples: Option<usize>,
    /// Samples per ray of a second network, drawn by the first one's weights (--model nerf); 0: one network alone.
    #[arg(long, default_value_t = 0, value_parser = none_or::<SAMPLES>)]
    pub fine: usize,
    /// Where samples start.
    #[arg(long, value_parser = distance)]
    pub near: Option<f64>,
    /// Where they end.
    #[arg(long, value_parser = distance)]
    pub far: Option<f64>,
    /// Learning rate at the start; it falls by 1 / sqrt(1 + step / 1500); the compact model's stays with `--without decay`.
    #[arg(long, value_parser = positive_number)]
    pub lr: Option<f64>,
    /// Every Nth frame is for validation, where the scene has no split of its own.
    #[arg(long, value_parser = positive)]
    pub holdout: Option<usize>,
    /// 1/N: pictures of one pixel for each square of N x N.
    #[arg(long, value_name = "1/N", value_parser = scale)]
    pub scale: Option<usize>,
    /// Full validation every N steps.
    #[arg(long, value_parser = positive)]
    pub val_every: Option<usize>,
    /// Full validation at these steps.
    #[arg(long, value_name = "STEP", value_delimiter = ',', value_parser = positive)]
    pub val_at: Vec<usize>,
    /// All views in full validations, instead of at most 8 of them, evenly chosen.
    #[arg(long)]
    pub val_all: bool,
    /// The color behind everything: black, white or R,G,B.
    #[arg(long, value_parser = color)]
    pub background: Option<[f64; 3]>,
    /// Seed of everything random.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Threads; all cores by default. The result doesn't depend on it.
    #[arg(long, value_parser = threads)]
    pub threads: Option<usize>,
    /// Which path computes.
    #[arg(long, value_enum, default_value_t = Backend::Fast)]
    pub backend: Backend,
    /// Go on from the run's checkpoint.
    #[arg(long)]
    pub resume: bool,
    /// Move a run that is in the folder aside, to RUN.old-1 or the next free number, instead of refusing.
    #[arg(long, conflicts_with = "resume")]
    pub overwrite: bool,
    /// Leave out samples in empty space and after the early stop, once that is known (--model nerf; compact always does).
    #[arg(long)]
    pub skip: bool,
    /// Width of the 8x256 network's layers (--model nerf).
    #[arg(long, value_parser = at_most::<WIDTH>)]
    pub width: Option<usize>,
    /// The part of space that a model holds, and its coordinates.
    #[arg(long, value_enum, default_value_t)]
    pub space: Space,
    /// Parts of the compact model to leave out, to see what they are worth.
    #[arg(long, value_enum, value_delimiter = ',')]
    pub without: Vec<Part>,
    /// Show the run on a page while it trains, at this port of this machine; 0: any that is free.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = live::PORT)]
    pub serve: Option<u16>,
    /// The address of that page. Any but this machine's own (127.0.0.1) shows the run to whoever reaches it.
    #[arg(long, value_name = "ADDRESS", default_value = live::HOST, value_parser = host, requires = "serve")]
    pub host: IpAddr,
}

impl Args {
    /// Defaults, as the command line has them.
    pub(super) fn new(scene: &str, out: &Path) -> Self {
        #[rustfmt::skip]
        let args = Args {
            scene: scene.into(), out: out.into(), model: Kind::Nerf, steps: None, seconds: None, stop_at_psnr: None, rays: None,
            samples: None, fine: 0, near: None, far: None, lr: None, holdout: None, scale: None, val_every: None, val_at: vec![], val_all: false, background: None, seed: 0,
            threads: None, backend: Backend::Fast, resume: false, overwrite: false, skip: false, width: None,
            space: Space::Auto, without: vec![], serve: None, host: IpAddr::V4(Ipv4Addr::LOCALHOST),
        };
        args
    }
}

/// Which field is trained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    /// A hash grid and two small networks: seconds instead of hours.
    Compact,
    /// The NeRF paper's network.
    Nerf,
}

/// Runs `train`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    parallel::on_threads(args.threads, || {
        let summary = train(args)?;
        output::print(json, &summary.object, &summary.text)?;
        Ok(match (&summary.failure, summary.stopped) {
            (None, None) => ExitCode::SUCCESS,
            (None, Some(signal)) => signal.end("--resume goes on from here"),
            (Some(why), _) => {
                output::say(&format!("error: {}: this run doesn't learn: {why}", args.scene));
                ExitCode::from(1)
            }
        })
    })
}

/// The summary of a run.
pub(super) struct Summary {
    /// For `--json`.
    pub object: Value,
    /// For people.
    pub text: String,
    /// The last full validation, in dB.
    pub val_psnr: Option<f64>,
    /// Why the run was given up, where it doesn't learn.
    pub failure: Option<String>,
    /// The signal that stopped it.
    pub stopped: Option<Signal>,
}

/// Trains as `args` say.
pub(super) fn train(args: &Args) -> Result<Summary> {
    files::check_writable(&args.out)?;
    let recipe = recipe::given(args);
    let scene = Arc::new(recipe::load_scene(&recipe, false, "arguments")?);
    scene.warnings.iter().for_each(|warning| output::say(&format!("warning: {warning}")));
    // Of what isn't seen of a built-in scene between near and far, the run itself says more.
    if !args.scene.starts_with("builtin:") && blank(&scene.train) {
        return Err(Error::input(Input {
            file: &scene.name,
            field: "pictures",
            found: "the same color in every pixel",
            expected: "something to learn",
            remedy: "Check that the pictures are those that were meant, and their opacity: transparent pixels show nothing.",
        }));
    }
    let identity = Identity::new(&recipe::kept(&recipe), scene.digest());
    // A run that was stopped before it had written anything begins.
    let resume = args.resume && !RunFolder::is_untouched(&args.out);
    let resumed = resume.then(|| recipe::resumed(&args.out, &recipe, &identity)).transpose()?;
    let mut model = recipe::build(&recipe, &scene)?;
    // Not later: where it is taken, nothing has begun.
    let port = args.serve.map(|port| Port::take(args.host, port, "serve")).transpose()?;
    // Not earlier: until there is something to keep a signal ends the program at once.
    let signals = Signals::listen();
    // Not earlier: inconsistent options leave no folder.
    let (folder, mut warnings) = match resumed {
        Some(resumed) => resumed,
        None => {
            let folder = RunFolder::begin(&args.out, identity.clone(), args.overwrite)?;
            (folder, scene.warnings.iter().map(|w| json!(w)).collect())
        }
    };
    files::make_folder(&folder.file("views"))?;
    left_out(&model.settings()).iter().for_each(|line| output::note(line));
    let mut settings = run_json(args, &recipe, &scene, &*model);
    settings.extend(identity.settings());
    if resume {
        recorded::check_newer(&folder.settings()?, &*model, &folder.file("run.json").display().to_string())?;
        recorded::check_same(
            &folder.settings()?,
            &scene,
            &*model,
            &folder.file("run.json").display().to_string(),
        )?;
    }
    let options = end(args);
    let mut run = Run::new(&mut *model, &scene, &folder, &options)?;
    if resume {
        run.resume()?;
    }
    // Not earlier: a run that can't be resumed stays unchanged. Not later: one that is stopped is resumed and rendered with these.
    settings.insert("warnings".into(), json!(warnings));
    folder.write_settings(&settings)?;
    let page = port.map(|port| {
        let recipe = recipe.clone();
        let (shown, scene) = (scene.clone(), scene.clone());
        let build = Box::new(move || recipe::build(&recipe, &scene));
        live::Page::open(port, &shown, build, &args.out, &options, &run.log)
    });
    let page = page.transpose()?;
    watched(&mut run, &options, page.as_ref(), || signals.heard().is_some())?;
    let said: Vec<String> = run.warnings.iter().map(|warning| spelled(warning)).collect();
    said.iter().for_each(|warning| output::say(&format!("warning: {warning}")));
    let new: Vec<Value> = said.iter().map(|w| json!(w)).filter(|w| !warnings.contains(w)).collect();
    let failure = run.failure.as_deref().map(spelled);
    if !new.is_empty() || failure.is_some() {
        // The warnings of training are all that wasn't known then.
        settings.insert("failure".into(), json!(failure));
        warnings.extend(new);
        settings.insert("warnings".into(), json!(warnings));
        folder.write_settings(&settings)?;
    }
    files::write(&folder.file("psnr.svg"), training::curve(&scene.name, &run.log))?;
    run_page::write(&folder, &scene, &run.log, &warnings, failure.as_deref())?;
    Ok(Summary { stopped: signals.heard(), ..summary(&run.log, &said, failure, args) })
}

/// Trains to the end; progress goes to the terminal and to the live page.
fn watched(
    run: &mut Run,
    options: &Options,
    page: Option<&live::Page>,
    stop: impl Fn() -> bool,
) -> Result<()> {
    let bar = RefCell::new(progress::Training::new(options, &run.log));
    let mut stepped = |step, model: &dyn Model| {
        bar.borrow_mut().stepped(step);
        page.iter().for_each(|page| page.stepped(step, model));
    };
    let told = |news: News| match news {
        News::Point(point) => {
            bar.borrow_mut().measured(point);
            page.iter().for_each(|page| page.measured(point));
        }
        News::SlowCheckpoints { cost, every } => bar.borrow().say_slow(cost, every),
    };
    run.go_watched(stop, told, &mut stepped)?;
    bar.borrow().finish();
    Ok(())
}

/// The parts that the model leaves out in this scene, with their reasons.
fn left_out(settings: &Map<String, Value>) -> Vec<String> {
    let reasons = settings.get("reasons").and_then(Value::as_object);
    let line = |(name, why): (&String, &Value)| {
        let why = why.as_str().filter(|why| why.starts_with("left out"))?;
        Some(format!("{} {why}", name.replace('_', " ")))
    };
    reasons.into_iter().flatten().filter_map(line).collect()
}

/// When the run ends: by default after 5,000 steps.
fn end(args: &Args) -> Options {
    let open = args.seconds.is_some() || args.stop_at_psnr.is_some();
    Options {
        steps: args.steps.map(|n| n as u64).or((!open).then_some(5000)),
        seconds: args.seconds,
        stop_at_psnr: args.stop_at_psnr,
        val_every: args.val_every.map(|n| n as u64),
        val_at: args.val_at.iter().map(|&n| n as u64).collect(),
        val_all: args.val_all,
        seed: args.seed,
    }
}

/// All settings, given and derived, with the reasons; version, machine, seed.
fn run_json(
    args: &Args,
    recipe: &Map<String, Value>,
    scene: &Scene,
    model: &dyn Model,
) -> Map<String, Value> {
    let mut run = recorded::begun(recipe, scene, model);
    run.insert(
        "end".into(),
        json!({"steps": args.steps, "seconds": args.seconds, "stop_at_psnr": args.stop_at_psnr}),
    );
    run.insert("threads".into(), parallel::threads().into());
    run.insert("machine".into(), json!({"os": std::env::consts::OS, "arch": std::env::consts::ARCH}));
    run
}

fn summary(log: &[LogPoint], warnings: &[String], failure: Option<String>, args: &Args) -> Summary {
    let full: Vec<&LogPoint> = log.iter().filter(|p| p.val_psnr.is_some()).collect();
    let last = log.last();
    let rows: Vec<Vec<String>> = full
        .iter()
        .copied()
        .chain(last.filter(|p| p.val_psnr.is_none()))
        .map(|p| {
            let figures = [output::decibels(Some(p.train_psnr)), output::decibels(p.val_psnr)];
            [p.step.to_string(), format!("{:.1}", p.seconds)].into_iter().chain(figures).collect()
        })
        .collect();
    let text =
        table::text(&["step", "seconds", "train dB", "val dB"], &rows) + &format!("{}\n", args.out.display());
    let val_psnr = full.last().and_then(|p| p.val_psnr);
    let object = json!({
        "run": args.out.display().to_string(), "step": last.map(|p| p.step), "seconds": last.map(|p| p.seconds),
        "samples": last.map(|p| p.samples), "loss": last.map(|p| p.loss), "val_psnr": val_psnr,
        "val_psnr_pooled": full.last().and_then(|p| p.val_psnr_pooled),
        "val_views": full.last().and_then(|p| p.val_views), "warnings": warnings, "failure": failure,
    });
    Summary { object, text, val_psnr, failure, stopped: None }
}
