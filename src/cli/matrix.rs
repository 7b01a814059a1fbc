//! `matrix`: does training learn wherever it is taken? Built-in scenes of all sizes, every pair of settings in some run.

use std::process::ExitCode;

use glam::DVec2;
use serde::Serialize;
use serde_json::json;

use super::options::{positive, positive_number, steps, threads};
use super::output;
use super::spelling::spelled;
use crate::error::Result;
use crate::evaluation::over;
use crate::loss::psnr;
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::ray::{Ray, camera_ray};
use crate::report::table;
use crate::scene::{self, Scene, random_pixel};
use crate::training::compact::{CompactModel, Overrides};
use crate::training::model::Model;
use crate::training::watch::Watch;

/// Train the compact model on built-in scenes of many kinds, and say where it learns.
#[derive(clap::Args, Debug)]
pub(super) struct Args {
    /// Steps of each run.
    #[arg(long, default_value_t = 300, value_parser = steps)]
    steps: usize,
    /// The most training pixels of a run, in millions.
    #[arg(long, default_value_t = 100.0, value_parser = positive_number)]
    megapixels: f64,
    /// The first so many runs alone.
    #[arg(long, value_parser = positive)]
    runs: Option<usize>,
    /// Threads; all cores by default.
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
}

/// How much better than one color all over a run has to be, in dB.
const LEARNED: f64 = 3.0;

/// Training pixels on which that is measured.
const PIXELS: u64 = 4096;

const SIZES: [usize; 6] = [64, 128, 200, 400, 800, 1600];
const VIEWS: [usize; 5] = [3, 10, 30, 100, 300];
const FILLS: [f64; 4] = [0.01, 0.05, 0.25, 1.0];
const BACKGROUNDS: [&str; 4] = ["black", "white", "gray", "random"];
const SEEDS: [u64; 3] = [0, 1, 2];

/// The number of levels of each setting.
const LEVELS: [usize; 5] = [SIZES.len(), VIEWS.len(), FILLS.len(), BACKGROUNDS.len(), SEEDS.len()];

/// A run's levels.
type Combination = [usize; 5];

/// Combinations in which every pair of levels that fits into so many pixels occurs: each the one that adds most pairs.
fn pairwise(megapixels: f64) -> Vec<Combination> {
    let mut all: Vec<Combination> = vec![[0; 5]];
    for (setting, &levels) in LEVELS.iter().enumerate() {
        let with = |c: &Combination| {
            let mut some = vec![*c; levels];
            some.iter_mut().enumerate().for_each(|(level, c)| c[setting] = level);
            some
        };
        all = all.iter().flat_map(with).collect();
    }
    all.retain(|c| (SIZES[c[0]].pow(2) * VIEWS[c[1]]) as f64 <= 1e6 * megapixels);
    let pairs = |c: &Combination| -> Vec<[usize; 4]> {
        (0..5).flat_map(|a| (0..a).map(move |b| (a, b))).map(|(a, b)| [a, b, c[a], c[b]]).collect()
    };
    let mut left: std::collections::BTreeSet<[usize; 4]> = all.iter().flat_map(pairs).collect();
    let mut chosen = vec![];
    while !left.is_empty() {
        let new = |c: &Combination| pairs(c).iter().filter(|pair| left.contains(*pair)).count();
        let Some(best) = all.iter().copied().reduce(|best, c| if new(&c) > new(&best) { c } else { best })
        else {
            break;
        };
        for pair in pairs(&best) {
            left.remove(&pair);
        }
        chosen.push(best);
    }
    chosen
}

/// What a run did.
#[derive(Debug, Serialize)]
struct Row {
    size: usize,
    views: usize,
    fill: f64,
    background: &'static str,
    seed: u64,
    /// Steps done.
    steps: u64,
    /// PSNR on training pixels, and that of their best constant color.
    psnr: f64,
    constant_psnr: f64,
    learned: bool,
    /// Why the run was given up, if it was.
    failure: Option<String>,
}

/// Runs it. 1 where a run doesn't learn.
pub(super) fn run(args: &Args, json: bool) -> Result<ExitCode> {
    let mut combinations = pairwise(args.megapixels);
    combinations.truncate(args.runs.unwrap_or(usize::MAX));
    let rows: Vec<Row> = parallel::on_threads(args.threads, || {
        let one = |(n, c): (usize, &Combination)| {
            let row = train(c, args.steps as u64)?;
            output::note(&format!("{} of {}: {}", n + 1, combinations.len(), cells(&row).join(" ")));
            Ok(row)
        };
        combinations.iter().enumerate().map(one).collect::<Result<_>>()
    })?;
    let learned = rows.iter().filter(|row| row.learned).count();
    let mut text = table::text(
        &["pixels", "views", "fill", "background", "seed", "step", "dB", "one color dB", "learned"],
        &rows.iter().map(cells).collect::<Vec<_>>(),
    );
    text += &format!("{learned} of {} runs learn: {LEARNED} dB above the best constant color\n", rows.len());
    let object = json!({"rows": rows, "runs": rows.len(), "learned": learned, "wanted_gain_db": LEARNED});
    output::print(json, &object, &text)?;
    Ok(if learned == rows.len() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn cells(row: &Row) -> Vec<String> {
    let Row { size, views, fill, background, seed, steps, psnr, constant_psnr, learned, failure } = row;
    let verdict = match failure {
        Some(why) => format!("no: {why}"),
        None => if *learned { "yes" } else { "no" }.to_string(),
    };
    vec![
        size.to_string(),
        views.to_string(),
        fill.to_string(),
        background.to_string(),
        seed.to_string(),
        steps.to_string(),
        format!("{psnr:.2}"),
        format!("{constant_psnr:.2}"),
        verdict,
    ]
}

fn train(c: &Combination, steps: u64) -> Result<Row> {
    let (size, views, fill, seed) = (SIZES[c[0]], VIEWS[c[1]], FILLS[c[2]], SEEDS[c[4]]);
    let background = match BACKGROUNDS[c[3]] {
        "black" => [0.0; 3],
        "white" => [1.0; 3],
        "gray" => [0.5; 3],
        // Another color for every combination.
        _ => {
            let u = Key::new(seed, Purpose::Cases).uniforms(size as u64, views as u64, 3);
            [u[0], u[1], u[2]]
        }
    };
    let options = scene::Options { background: Some(background), ..scene::Options::default() };
    let scene = scene::load(&format!("builtin:spheres,size={size},views={views},fill={fill}"), &options)?;
    let mut model = CompactModel::new(&scene, &Overrides { seed, ..Overrides::default() })?;
    let mut watch = Watch::new(&scene, model.start(), model.any_background());
    let (mut done, mut failure) = (0, None);
    while done < steps && failure.is_none() {
        done += 1;
        failure = watch.failure(done, &model.step(&scene, done)?).as_deref().map(spelled);
    }
    let [psnr, constant_psnr] = figures(&model, &scene, seed)?;
    let learned = failure.is_none() && psnr >= constant_psnr + LEARNED;
    Ok(Row {
        size,
        views,
        fill,
        background: BACKGROUNDS[c[3]],
        seed,
        steps: done,
        psnr,
        constant_psnr,
        learned,
        failure,
    })
}

/// PSNR over seeded training pixels of the model and of their mean color.
fn figures(model: &CompactModel, scene: &Scene, seed: u64) -> Result<[f64; 2]> {
    let key = Key::new(seed, Purpose::Probe);
    let pixel = |n: u64| -> Result<(Ray, [f32; 3])> {
        let [frame, j, i] = random_pixel(&scene.train, &key, 0, n);
        let frame = &scene.train[frame];
        let image = frame.image.as_ref().expect("training frames have pictures");
        let ray = camera_ray(&frame.camera, DVec2::new(i as f64 + 0.5, j as f64 + 0.5))?;
        Ok((ray, image.at(j, i)))
    };
    let (rays, targets): (Vec<Ray>, Vec<[f32; 3]>) =
        (0..PIXELS).map(pixel).collect::<Result<Vec<_>>>()?.into_iter().unzip();
    let background = scene.background.map(|b| b as f32);
    let seen: Vec<[f32; 3]> = model.render(&rays).into_iter().map(|pixel| over(pixel, background)).collect();
    let mean = [0, 1, 2].map(|k| targets.iter().map(|t| f64::from(t[k])).sum::<f64>() / PIXELS as f64);
    let error = |color: &dyn Fn(usize, usize) -> f64| {
        let squares = targets
            .iter()
            .enumerate()
            .map(|(n, target)| (0..3).map(|k| (color(n, k) - f64::from(target[k])).powi(2)).sum::<f64>());
        psnr(squares.sum::<f64>() / (3 * PIXELS) as f64, 1.0)
    };
    Ok([error(&|n, k| f64::from(seen[n][k].clamp(0.0, 1.0))), error(&|_, k| mean[k])])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_that_fits_is_in_some_run() {
        let runs = pairwise(100.0);
        assert!((30..=48).contains(&runs.len()), "{} runs", runs.len());
        let fits = |c: &Combination| SIZES[c[0]].pow(2) * VIEWS[c[1]] <= 100_000_000;
        assert!(runs.iter().all(fits));
        for a in 0..5 {
            for b in 0..a {
                for (x, y) in (0..LEVELS[a]).flat_map(|x| (0..LEVELS[b]).map(move |y| (x, y))) {
                    let too_large = (a, b) == (1, 0) && SIZES[y].pow(2) * VIEWS[x] > 100_000_000;
                    assert!(too_large || runs.iter().any(|c| (c[a], c[b]) == (x, y)), "{a} {b} {x} {y}");
                }
            }
        }
    }

    /// The smallest combination learns, and says so by its figures; without steps it doesn't.
    #[test]
    fn a_small_run_learns() {
        let row = train(&[0, 1, 3, 0, 0], 60).unwrap();
        assert!(row.learned && row.failure.is_none() && row.psnr > row.constant_psnr + 3.0, "{row:?}");
        let none = train(&[0, 1, 3, 0, 0], 0).unwrap();
        assert!(!none.learned && none.steps == 0, "{none:?}");
    }
}
