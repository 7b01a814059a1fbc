//! A coarse and a fine network: how one depends on the other, on both paths.

mod forward;
mod skipping;

use super::*;
use crate::parallel;
use crate::ray::camera_ray;
use crate::scene;
use crate::training::reference::{fine_samples, interval_edges};

fn settings(fine: usize, reference: bool) -> NerfSettings {
    let mut settings = NerfSettings::new(2.0, 6.0, [1.0; 3]);
    (settings.rays, settings.samples, settings.fine) = (24, 8, fine);
    (settings.levels, settings.reference) = ((4, 2), reference);
    let (position, direction) = (3 + 6 * 4, 3 + 6 * 2);
    settings.shape = Shape { position, direction, width: 16, depth: 8, color: 8 };
    settings
}

fn scene() -> Scene {
    let options = scene::Options {
        near: None,
        far: None,
        holdout: None,
        background: None,
        shrink: None,
        integer_pixels: false,
        test_images: false,
    };
    scene::load("builtin:spheres", &options).unwrap()
}

/// A model after some steps, and the last report.
fn trained(settings: NerfSettings, scene: &Scene, steps: u64) -> (NerfModel, StepReport) {
    let mut model = NerfModel::new(settings);
    let mut report = StepReport::default();
    for step in 1..=steps {
        report = model.step(scene, step).unwrap();
    }
    (model, report)
}

fn values(state: &Arrays) -> Vec<(String, Vec<f64>)> {
    state.iter().map(|(name, a)| (name.clone(), a.to_f64().iter().copied().collect())).collect()
}

/// The weights are detached: the coarse network trains as if it were alone, to the bit.
#[test]
fn the_coarse_network_doesnt_know_of_the_fine_one() {
    let scene = scene();
    for reference in [false, true] {
        let (alone, report) = trained(settings(0, reference), &scene, 3);
        let (pair, both) = trained(settings(12, reference), &scene, 3);
        let mut coarse = values(&pair.state());
        coarse.retain(|(name, _)| !name.starts_with(FINE));
        assert_eq!(values(&alone.state()), coarse);
        assert_eq!(both.loss, report.loss + both.mse, "loss = coarse + fine");
        assert_eq!((report.samples, both.samples), (24 * 8, 24 * (8 + 20)));
    }
}

/// Parameters after three steps, and pictures, in f32 and in f64.
#[test]
fn fast_path_and_reference_agree() {
    let scene = scene();
    let (fast, a) = trained(settings(12, false), &scene, 3);
    let (oracle, b) = trained(settings(12, true), &scene, 3);
    // 8 layers in f32 on encodings of 2^3 pi x; the fine samples move with the coarse weights by as much.
    assert!((a.loss - b.loss).abs() < 1e-5 * b.loss, "{} {}", a.loss, b.loss);
    for ((name, x), (_, y)) in values(&fast.state()).into_iter().zip(values(&oracle.state())) {
        if !name.contains("m.") && !name.contains("v.") {
            // A step of Adam is at most the learning rate 1e-3; where a gradient is noise, so is its sign.
            let far = x.iter().zip(&y).filter(|(x, y)| (*x - *y).abs() > 1e-5).count();
            assert!(far * 50 <= x.len(), "{name}: {far} of {}", x.len());
        }
    }
    let rays: Vec<Ray> = (0..32)
        .map(|i| camera_ray(&scene.val[0].camera, glam::DVec2::new(f64::from(i) + 0.5, 20.5)).unwrap())
        .collect();
    for (x, y) in fast.render(&rays).iter().zip(oracle.render(&rays)) {
        assert!((0..3).all(|k| (x.rgb[k] - y.rgb[k]).abs() < 2e-4), "{x:?} {y:?}");
    }
}

#[test]
fn rates_fall_with_the_steps() {
    let model = NerfModel::new(settings(0, false));
    let rate = |step| model.adam(step).lr / model.settings.lr;
    assert_eq!((rate(0), rate(4500)), (1.0, 0.5));
}

#[test]
fn a_checkpoint_goes_on_and_threads_change_nothing() {
    let scene = scene();
    let (whole, _) = trained(settings(12, false), &scene, 4);
    let (half, _) = trained(settings(12, false), &scene, 2);
    let mut resumed = NerfModel::new(settings(12, false));
    resumed.restore(&half.state(), "checkpoint.npz").unwrap();
    for step in 3..=4 {
        resumed.step(&scene, step).unwrap();
    }
    assert_eq!(values(&whole.state()), values(&resumed.state()));
    let alone = || -> crate::Result<NerfModel> { Ok(trained(settings(12, false), &scene, 4).0) };
    let one = parallel::with_threads(Some(1), alone).unwrap();
    assert_eq!(values(&whole.state()), values(&one.state()));
    // One network alone can't take a pair's checkpoint, nor the other way round.
    let message =
        NerfModel::new(settings(0, false)).restore(&half.state(), "checkpoint.npz").unwrap_err().to_string();
    assert!(message.contains("`fine`") && message.contains("checkpoint.npz"), "{message}");
    let alone = trained(settings(0, false), &scene, 1).0;
    assert!(resumed.restore(&alone.state(), "checkpoint.npz").is_err());
}

/// The union holds the coarse samples, the others lie where the weights are, and the steps reach from the first sample to far.
#[test]
fn fine_samples_follow_the_weights() {
    let edges = interval_edges(2.0, 6.0, 4);
    assert_eq!(edges, [2.0, 3.0, 4.0, 5.0, 6.0]);
    let coarse = [2.5, 3.5, 4.5, 5.5];
    let (t, deltas) = fine_samples(&coarse, &edges, &[0.0, 0.0, 1.0, 0.0], &[0.125, 0.625, 0.875], 6.0);
    assert_eq!(t, [2.5, 3.5, 4.125, 4.5, 4.625, 4.875, 5.5]);
    assert_eq!(deltas, [1.0, 0.625, 0.375, 0.125, 0.25, 0.625, 0.5]);
}

/// TR1: about one seed in two draws a density head that is 0 everywhere. None starts with it, on either path.
#[test]
fn no_seed_starts_dead() {
    let scene = scene();
    let mut turned = 0;
    for seed in 0..16 {
        let settings = NerfSettings { seed, ..settings(0, false) };
        let drawn = Path::new(&settings, &Key::new(seed, Purpose::Parameters)).state("");
        let (model, _) = trained(settings, &scene, 1);
        assert!(!model.dead, "seed {seed}");
        turned += usize::from(model.turned);
        let (reference, _) = trained(NerfSettings { reference: true, ..settings }, &scene, 1);
        assert_eq!(model.turned, reference.turned, "seed {seed}");
        // One step of Adam moves a parameter by lr at most: its sign still shows whether the head was turned.
        let [before, after] = [drawn, model.state()].map(|state| state["sigma_w"].to_f64());
        let kept = before.iter().zip(&after).filter(|(a, b)| (*a - *b).abs() <= 1.2 * settings.lr).count();
        assert!(
            if model.turned { kept < before.len() } else { kept == before.len() },
            "seed {seed}: {kept} kept"
        );
    }
    assert!((3..=13).contains(&turned), "{turned} of 16");
}
