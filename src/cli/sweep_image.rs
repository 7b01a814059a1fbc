//! `sweep-image IMAGE --out DIR`: levels x widths x learning rates, one contact sheet and one table.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use image::RgbImage;
use ndarray::Array3;
use serde_json::{Value, json};

use super::options::{at_most, none_or, positive, positive_number, steps, threads};
use super::parts::Merged;
use super::shard::{self, Piece, Shard, exact};
use super::{fit_image, output, progress};
use crate::error::{Error, Result};
use crate::files::{self, picture};
use crate::limits::{LAYERS, LEVELS, SIDE, WIDTH};
use crate::parallel;
use crate::report::page::Page;
use crate::report::{sheet, table};
use crate::scene::digest;
use crate::training::image::{FitSettings, LogPoint, fit};

/// Options of `sweep-image`.
#[derive(clap::Args, Clone, Debug)]
pub(super) struct Args {
    /// A PNG, JPEG or GIF, or builtin:card.
    pub image: String,
    /// The output folder.
    #[arg(long)]
    pub out: PathBuf,
    /// Longest side; the picture is reduced to it.
    #[arg(long, value_parser = at_most::<SIDE>)]
    pub size: Option<usize>,
    /// Bands of the encoding, separated by commas.
    #[arg(long, value_delimiter = ',', default_value = "4,10", value_parser = none_or::<LEVELS>)]
    pub levels: Vec<usize>,
    /// Widths of the hidden layers, separated by commas.
    #[arg(long, value_delimiter = ',', default_value = "64,256", value_parser = at_most::<WIDTH>)]
    pub width: Vec<usize>,
    /// Learning rates, separated by commas.
    #[arg(long, value_delimiter = ',', default_value = "5e-3,1e-2", value_parser = positive_number)]
    pub lr: Vec<f64>,
    /// Steps of each fit.
    #[arg(long, default_value_t = 1000, value_parser = steps)]
    pub steps: usize,
    /// Pixels per step.
    #[arg(long, default_value_t = 10_000, value_parser = positive)]
    pub batch: usize,
    /// Number of hidden layers.
    #[arg(long, default_value_t = 3, value_parser = at_most::<LAYERS>)]
    pub layers: usize,
    /// Seed of parameters and pixels.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// I/N: every Nth fit from the Ith on, as a part for merge, in the folder --out.
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// Threads; all cores by default.
    #[arg(long, value_parser = threads)]
    pub threads: Option<usize>,
}

/// One fit of the sweep.
struct Row {
    /// [`FitSettings`].
    settings: Value,
    last: LogPoint,
}

impl Row {
    /// Whether the fit has diverged: such a row has no figures.
    fn diverged(&self) -> bool {
        !self.last.loss.is_finite() || self.last.psnr.is_nan()
    }
}

/// Runs `sweep-image`.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    parallel::on_threads(args.threads, || {
        files::check_writable(&args.out)?;
        let target = fit_image::load(&args.image, args.size)?;
        let all = combinations(args);
        fit_image::fits(&target, &all.iter().collect::<Vec<_>>(), all.len() as f64)?;
        files::make_folder(&args.out)?;
        let mine: Vec<usize> = (0..all.len()).filter(|n| shard::has(args.shard, *n)).collect();
        let bar = progress::bar(Some(mine.len() as u64 * args.steps as u64), "sweep");
        let (mut rows, mut pictures) = (vec![], vec![]);
        for settings in mine.iter().map(|&n| all[n].clone()) {
            let mut last = None;
            let keep = |_: &LogPoint, fitted: &Array3<f32>| {
                last = Some(picture::to_rgb(fitted.view()));
                Ok::<(), Error>(())
            };
            let log = fit(&target, &settings, keep, |_, _| bar.inc(1))?;
            let name = format!("L{}_W{}_lr{:e}", settings.levels, settings.width, settings.lr);
            bar.set_message(name);
            pictures.extend(last);
            rows.extend(log.last().cloned().map(|last| Row { settings: json!(settings), last }));
        }
        bar.finish_and_clear();
        if let Some(shard) = args.shard {
            let work = work(args, &target);
            let pieces = mine.into_iter().zip(&rows).zip(pictures);
            let pieces = pieces.map(|((n, row), picture)| piece(n, row, picture)).collect::<Vec<_>>();
            let (out, count) = (args.out.display().to_string(), pieces.len());
            shard::write(&args.out, shard, &work, all.len(), pieces)?;
            output::print(json, &json!({"out": out, "fits": count}), &format!("{out}: {count} fits\n"))?;
            return Ok(ExitCode::SUCCESS);
        }
        let columns = args.width.len() * args.lr.len();
        let (object, text) = write(&args.out, &rows, &pictures, columns)?;
        output::print(json, &object, &text)?;
        Ok(ExitCode::SUCCESS)
    })
}

/// All files of a sweep; returns what is printed.
fn write(out: &Path, rows: &[Row], pictures: &[RgbImage], columns: usize) -> Result<(Value, String)> {
    picture::write_rgb(&out.join("contact_sheet.png"), &sheet::contact_sheet(pictures, columns))?;
    let header = ["levels", "width", "lr", "PSNR dB", "seconds"];
    let cells: Vec<Vec<String>> = rows.iter().map(cells).collect();
    let text = table::text(&header, &cells);
    let objects: Vec<Value> = rows.iter().map(object).collect();
    files::write(&out.join("table.txt"), &text)?;
    files::write(&out.join("table.json"), json!(objects).to_string())?;
    let mut page = Page::new("Sweep", "One row a number of bands, one column a width and learning rate.");
    page.picture("contact_sheet.png", "the fitted pictures, in the order of the table", 960)
        .table(&header, &cells);
    files::write(&out.join("index.html"), page.finish())?;
    let best = rows.iter().map(|row| row.last.psnr).fold(f64::NEG_INFINITY, f64::max);
    Ok((json!({"rows": objects, "best_psnr": best}), text))
}

/// All that determines the fits, their seconds aside.
fn work(args: &Args, target: &Array3<f32>) -> Value {
    json!({
        "command": "sweep-image", "version": env!("CARGO_PKG_VERSION"), "picture": digest::of_picture(target),
        "columns": args.width.len() * args.lr.len(), "fits": combinations(args),
    })
}

fn piece(number: usize, row: &Row, picture: RgbImage) -> Piece {
    let LogPoint { step, seconds, loss, psnr } = row.last;
    let value = json!({
        "settings": row.settings, "step": step, "seconds": exact(seconds), "loss": exact(loss), "psnr": exact(psnr),
    });
    Piece { number, value, picture: Some(picture) }
}

/// The files of a sweep, from parts; returns what is printed.
pub(super) fn merge(whole: &Merged, out: &Path) -> Result<(Value, String)> {
    files::check_writable(out)?;
    files::make_folder(out)?;
    let row = |(n, value): (usize, &Value)| {
        let step = value["step"].as_u64().ok_or_else(|| whole.wrong(n, "step"))?;
        let number = |name: &str| whole.number(n, name);
        let last =
            LogPoint { step, seconds: number("seconds")?, loss: number("loss")?, psnr: number("psnr")? };
        Ok(Row { settings: value["settings"].clone(), last })
    };
    let rows = whole.values.iter().enumerate().map(row).collect::<Result<Vec<_>>>()?;
    let columns = whole.work["columns"].as_u64().unwrap_or(1) as usize;
    write(out, &rows, &whole.pictures()?, columns)
}

fn combinations(args: &Args) -> Vec<FitSettings> {
    let mut all = vec![];
    for &levels in &args.levels {
        for &width in &args.width {
            for &lr in &args.lr {
                let (steps, batch, layers, seed) = (args.steps as u64, args.batch, args.layers, args.seed);
                all.push(FitSettings { steps, batch, levels, width, layers, lr, seed, reference: false });
            }
        }
    }
    all
}

fn cells(row: &Row) -> Vec<String> {
    let [levels, width] = ["levels", "width"].map(|name| row.settings[name].to_string());
    let lr = row.settings["lr"].as_f64().unwrap_or(f64::NAN);
    let psnr = if row.diverged() { "diverged".into() } else { format!("{:.2}", row.last.psnr) };
    let seconds = format!("{:.1}", row.last.seconds);
    vec![levels, width, format!("{lr:e}"), psnr, seconds]
}

/// PSNR and loss are null where they aren't finite, as JSON has no word for that.
fn object(row: &Row) -> Value {
    let LogPoint { psnr, seconds, loss, .. } = row.last;
    json!({"settings": row.settings, "psnr": psnr, "seconds": seconds, "loss": loss, "diverged": row.diverged()})
}
