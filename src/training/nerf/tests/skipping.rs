//! The occupancy grid of the 8x256 network, and a model that skips by it.

use glam::DVec3;

use super::*;
use crate::bench::nerf_step;

/// The step length in [`settings`].
const STEP: f64 = 0.5;

/// Steps without a grid, and between its updates.
const AFTER: u64 = 2;
const EVERY: u64 = 3;

fn skipping_settings(skip: bool) -> NerfSettings {
    let skip = skip.then_some(Skip { after: AFTER, every: EVERY, resolution: 32 });
    NerfSettings { skip, ..settings(0, false) }
}

/// A model after its first steps, with a density head that gives half of the space between near and far no density.
fn half_empty(settings: NerfSettings, scene: &Scene) -> NerfModel {
    let (mut model, report) = trained(settings, scene, AFTER);
    assert!(model.grid.is_none() && report.samples == 24 * 8, "the first steps are dense");
    let Path::Fast { net, .. } = &mut model.coarse else { panic!("the fast path") };
    let mut oracle = net.to_oracle(&net.params);
    oracle.sigma.b[0] += 100.0;
    net.params = flat(&oracle);
    let points: Vec<f64> =
        Key::new(9, Purpose::Cases).uniforms(0, 0, 3000).iter().map(|u| 4.0 * u - 2.0).collect();
    let mut z: Vec<f64> = net.densities(&points).into_iter().map(f64::from).collect();
    z.sort_by(f64::total_cmp);
    oracle.sigma.b[0] = 100.0 * (oracle.sigma.b[0] - z[500]);
    oracle.sigma.w *= 100.0;
    net.params = flat(&oracle);
    model
}

/// The same state in a model of its own.
fn copy(model: &NerfModel, settings: NerfSettings) -> NerfModel {
    let mut copy = NerfModel::new(settings);
    copy.restore(&model.state(), "checkpoint.npz").unwrap();
    copy
}

/// From 2 to 6.
fn ends(ray: &Ray) -> [[f64; 3]; 2] {
    settings(0, false).ends(ray)
}

/// A ball of radius 0.5 around (x, 0, 0).
fn ball(x: f64) -> impl Fn(&[f64]) -> Vec<f32> {
    move |points| {
        let inside = |p: &[f64]| (p[0] - x).powi(2) + p[1] * p[1] + p[2] * p[2] < 0.25;
        points.chunks(3).map(|p| if inside(p) { 10.0 } else { 0.0 }).collect()
    }
}

/// Points on spheres around (x, 0, 0), and whether each is live.
fn on_spheres(grid: &Grid, x: f64, radius: f64) -> Vec<bool> {
    let u = Key::new(6, Purpose::Cases).uniforms(0, 0, 600);
    let point = |u: &[f64]| {
        let v = DVec3::new(u[0] - 0.5, u[1] - 0.5, u[2] - 0.5).normalize();
        grid.live((radius * v + DVec3::new(x, 0.0, 0.0)).to_array())
    };
    u.chunks(3).map(point).collect()
}

fn share(live: &[bool]) -> f64 {
    live.iter().filter(|&&l| l).count() as f64 / live.len() as f64
}

/// Cells in a ball are found, cells one or more away from it are not; when the ball moves by a cell, the grid follows at the next
/// update, and it finds a new ball anywhere after as many updates as it has parts.
#[test]
fn the_grid_follows_what_it_is_asked_about() {
    let key = Key::new(0, Purpose::Occupancy);
    let mut grid = Grid::new(&scene(), &ends, 64).unwrap();
    let [low, .., high] = grid.corners();
    let cell = (high - low) / 64.0;
    assert!((0.05..0.2).contains(&cell), "{cell}");
    assert!(grid.live([0.0; 3]) && grid.fraction() == 1.0, "nothing is known");
    grid.fill(&key, 1, STEP, &ball(0.0));
    assert!(on_spheres(&grid, 0.0, 0.5 - 2.0 * cell).iter().all(|&l| l));
    assert!(share(&on_spheres(&grid, 0.0, 0.5 - 0.25 * cell)) > 0.9, "cells on its face");
    assert!(!on_spheres(&grid, 0.0, 0.5 + 2.0 * cell).iter().any(|&l| l));
    assert!(grid.live([100.0, 0.0, 0.0]), "outside: unknown");
    assert!(grid.live([f64::NAN, 0.0, 0.0]), "NaN is not hidden");
    grid.update(&key, (2, 1), STEP, &ball(cell));
    assert!(share(&on_spheres(&grid, cell, 0.5 - 1.0 * cell)) > 0.97);
    for n in 2..=9 {
        assert!(n == 2 || share(&on_spheres(&grid, 1.2, 0.3)) > 0.0);
        grid.update(&key, (1 + n, n), STEP, &ball(1.2));
    }
    assert!(share(&on_spheres(&grid, 1.2, 0.5 - 2.0 * cell)) == 1.0);
    // A ball that is gone is forgotten: 10 0.8^n is below the threshold, 0.02 a step of 0.5, from n = 28 on.
    assert!(grid.live([-0.3, 0.0, 0.0]));
    for n in 10..40 {
        grid.update(&key, (1 + n, n), STEP, &ball(1.2));
    }
    assert!(!grid.live([-0.3, 0.0, 0.0]));
}

/// After the first steps a model evaluates only some samples, and its pictures are those of the live ones.
#[test]
fn a_model_works_where_something_is() {
    let scene = scene();
    let mut model = half_empty(skipping_settings(true), &scene);
    let mut dense = copy(&model, skipping_settings(false));
    let (report, all) = (model.step(&scene, AFTER + 1).unwrap(), dense.step(&scene, AFTER + 1).unwrap());
    assert!((24..192).contains(&report.samples) && all.samples == 192, "{} samples", report.samples);
    assert!((report.loss - all.loss).abs() < 0.1 * all.loss, "{} {}", report.loss, all.loss);
    let grid = model.grid.clone().unwrap();
    // Pictures: the same grid.
    let rays: Vec<Ray> = crate::evaluation::camera_rays(&scene.val[0].camera).unwrap();
    let seen = model.render(&rays);
    model.grid = None;
    let all = model.render(&rays);
    model.grid = Some(grid);
    assert!(seen != all, "something is left out");
    let squares =
        seen.iter().zip(&all).flat_map(|(a, b)| (0..3).map(|k| f64::from(a.rgb[k] - b.rgb[k]).powi(2)));
    let decibels = crate::loss::psnr(squares.sum::<f64>() / (3 * rays.len()) as f64, 1.0);
    assert!(decibels > 25.0, "{decibels} dB: cells of an eighth of the scene, few looks at each");
}

/// The grid goes with the checkpoint: to the bit, on any number of threads, through an update.
#[test]
fn a_checkpoint_holds_the_grid_and_threads_change_nothing() {
    let (scene, settings) = (scene(), skipping_settings(true));
    let start = half_empty(settings, &scene);
    let run = |mut model: NerfModel, steps: std::ops::RangeInclusive<u64>| {
        for step in steps {
            let report = model.step(&scene, step).unwrap();
            assert!((12..192).contains(&report.samples), "{} samples", report.samples);
        }
        model
    };
    let (from, end) = (AFTER + 1, AFTER + EVERY + 3);
    let whole = run(copy(&start, settings), from..=end);
    assert!(whole.state().contains_key("occupancy_density"));
    for stop in [from, from + EVERY - 1, from + EVERY] {
        let half = run(copy(&start, settings), from..=stop);
        let resumed = copy(&half, settings);
        assert!(resumed.grid == half.grid);
        let resumed = run(resumed, stop + 1..=end);
        assert!(values(&whole.state()) == values(&resumed.state()), "resumed after {stop}");
    }
    let again = || -> crate::Result<NerfModel> { Ok(run(copy(&start, settings), from..=end)) };
    let one = parallel::with_threads(Some(1), again).unwrap();
    assert!(values(&whole.state()) == values(&one.state()));
    let mut broken = whole.state();
    broken.insert("occupancy_box".into(), crate::files::npz::Array::F64(ndarray::ArrayD::zeros(vec![2, 3])));
    let message = NerfModel::new(settings).restore(&broken, "checkpoint.npz").unwrap_err().to_string();
    assert!(message.contains("occupancy_box") && message.contains("checkpoint.npz"), "{message}");
    broken.remove("occupancy_box");
    assert!(NerfModel::new(settings).restore(&broken, "checkpoint.npz").is_err());
}

/// Steps and pictures in f32 and in f64 with one grid: the right half of the box is empty.
#[test]
fn both_paths_leave_out_the_same() {
    let scene = scene();
    let run = |reference, skip: bool| {
        let mut model = NerfModel::new(NerfSettings { rays: 32, samples: 16, ..settings(0, reference) });
        let mut grid = Grid::new(&scene, &ends, 16).unwrap();
        grid.fill(&Key::new(0, Purpose::Occupancy), 1, STEP, &|points: &[f64]| {
            points.chunks(3).map(|p| if p[0] < 0.0 { 1.0 } else { 0.0 }).collect()
        });
        model.grid = skip.then_some(grid);
        let reports: Vec<_> = (1..=3).map(|step| model.step(&scene, step).unwrap()).collect();
        (model, reports)
    };
    let ((fast, a), (oracle, b), (_, dense)) = (run(false, true), run(true, true), run(false, false));
    for (a, b) in a.iter().zip(&b) {
        assert!((a.loss - b.loss).abs() < 1e-5 * b.loss, "{} {}", a.loss, b.loss);
        assert_eq!(a.samples, b.samples);
    }
    assert!((100..400).contains(&a[0].samples) && dense[0].samples == 512, "{} samples", a[0].samples);
    assert!((a[0].loss - dense[0].loss).abs() > 1e-3 * a[0].loss, "it matters what is left out");
    for ((name, x), (_, y)) in values(&fast.state()).into_iter().zip(values(&oracle.state())) {
        if !name.contains("m.") && !name.contains("v.") && !name.contains("occupancy") {
            let far = x.iter().zip(&y).filter(|(x, y)| (*x - *y).abs() > 1e-5).count();
            assert!(far * 50 <= x.len(), "{name}: {far} of {}", x.len());
        }
    }
    let rays = crate::evaluation::camera_rays(&scene.val[0].camera).unwrap();
    let rays: Vec<Ray> = rays.into_iter().step_by(61).collect();
    for (x, y) in fast.render(&rays).iter().zip(oracle.render(&rays)) {
        assert!((0..3).all(|k| (x.rgb[k] - y.rgb[k]).abs() < 2e-4), "{x:?} {y:?}");
    }
}

/// The comparison that `bench` prints counts what it leaves out.
#[test]
fn a_comparison_of_steps() {
    let scene = scene();
    let mut model = half_empty(skipping_settings(true), &scene);
    model.step(&scene, AFTER + 1).unwrap();
    let before = values(&model.state());
    let found = nerf_step::compare(&mut model, &scene, 2).unwrap().unwrap();
    assert_eq!(before, values(&model.state()), "measuring trains nothing");
    let number = |name: &str| found[name].as_f64().unwrap();
    assert!(number("evaluated") < 1.0 && number("backward") <= number("evaluated"));
    assert!(number("ceiling") > 1.0 && number("loss_db").abs() < 1.0 && number("skip_seconds") > 0.0);
    let pair = &mut NerfModel::new(settings(12, false));
    assert!(nerf_step::compare(pair, &scene, 2).unwrap().is_none(), "a pair");
}
