//! Contracted space and the distortion loss, against the oracle's formulas.

use approx::assert_relative_eq;
use glam::DVec3;

use super::pictures::differences;
use super::{COUNTS, ball, bits, chunk_of, direction, field, oracle_loss, rows};
use crate::contraction::contract;
use crate::convention::{ContractionNorm, ContractionRange, ProductEps};
use crate::distortion::{backward, distortion};
use crate::hash_grid::fast::FEATURES;
use crate::occupancy_grid::fast::{MarchRay, Occupancy, Path, Steps};
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::scene::Scene;
use crate::training::Model;
use crate::training::compact::chunk::Pass;
use crate::training::compact::forward::run;
use crate::training::compact::kernels::Plain;
use crate::training::compact::networks::{Networks, Weights};
use crate::training::compact::pace::Pace;
use crate::training::compact::scatter::Scatter;
use crate::training::compact::settings::CompactSettings;
use crate::training::compact::space::{Space, Winding, contracted};
use crate::training::compact::{CompactModel, Extent, Overrides};
use crate::volume_rendering::volume_render;

fn asked(extent: Extent) -> Overrides {
    Overrides { extent, ..Overrides::default() }
}

/// The pictures of a model in contracted space have the colors of the oracle's contraction, marched step by step in f64.
#[test]
fn contracted_pictures_agree_with_the_reference() {
    let scene = ball();
    let mut model = CompactModel::new(&scene, &asked(Extent::Contracted)).unwrap();
    for step in 1..=40 {
        model.step(&scene, step).unwrap();
    }
    assert!(matches!(model.settings.space, Space::Contracted { .. }));
    let (most, worst) = differences(&model);
    assert!(most > 3 * 8, "{most} samples: several rounds");
    // A sample within rounding of a cell's face may be in the one or in the other.
    assert!(worst < 1e-3, "{worst}");
}

/// In contracted space too: the same bits on any number of threads, and from a checkpoint on.
#[test]
fn contracted_models_are_deterministic_and_resume() {
    let scene = ball();
    let new = || CompactModel::new(&scene, &asked(Extent::Contracted)).unwrap();
    let trained = |mut model: CompactModel, steps: std::ops::RangeInclusive<u64>| {
        for step in steps {
            model.step(&scene, step).unwrap();
        }
        model
    };
    let [one, three] = [1, 3].map(|n| parallel::with_threads(Some(n), || trained(new(), 1..=30)));
    assert!(bits(&one) == bits(&three));
    let mut resumed = new();
    resumed.restore(&trained(new(), 1..=18).state(), "checkpoint").unwrap();
    assert!(bits(&one) == bits(&trained(resumed, 19..=30)));
}

/// The fast contraction is the oracle's, within f32's rounding.
#[test]
fn points_are_contracted_as_the_oracle_has_it() {
    let key = Key::new(1, Purpose::Cases);
    for n in 0..1000 {
        let far = 30f64.powf(2.0 * key.uniform(1, n, 0) - 1.0);
        let x = [0, 1, 2].map(|a| (far * (2.0 * key.uniform(0, n, a) - 1.0)) as f32);
        let v = x.map(|x| 2.0 * f64::from(x) - 1.0);
        let right = contract(v, ContractionNorm::Linf, ContractionRange::Unit);
        contracted(x).iter().zip(right).for_each(|(&p, right)| assert!((f64::from(p) - right).abs() < 2e-6));
    }
}

/// Steps are even, then grow with the distance without a jump; numbers and distances are each other's inverse.
#[test]
fn steps_grow_with_the_distance() {
    let winding = Winding { length: 0.25, even: 2.0 };
    assert_eq!([0.0, 4.0, 8.0].map(|s| winding.t(s)), [0.0, 1.0, 2.0]);
    // From 8 steps on, twice as far after 4 more, four times after 6.
    assert_eq!([12.0, 14.0].map(|s| winding.t(s)), [4.0, 8.0]);
    for k in 0..14 {
        let s = k as f32;
        assert_relative_eq!(winding.s(winding.t(s)), s, max_relative = 1e-5);
        let step = winding.t(s + 0.5) - winding.t(s - 0.5);
        let inside = winding.stretch(winding.t(s), [0.5; 3]);
        assert_relative_eq!(step, 0.25 * inside, max_relative = 0.1);
    }
    // Ten half edges away the density is a hundredth.
    let p = contracted([0.5, 5.5, 0.5]);
    assert_relative_eq!(winding.stretch(1.0, p), 0.01, max_relative = 1e-5);
}

/// Following a ray past empty parts finds what trying every sample finds.
#[test]
fn no_sample_is_passed_by() {
    let key = Key::new(2, Purpose::Cases);
    let mut grid = Occupancy::full(64);
    for n in 0..600 {
        let at: [usize; 3] = [0, 1, 2].map(|a| (64.0 * key.uniform(0, n, a)) as usize);
        grid.density[(at[2] * 64 + at[1]) * 64 + at[0]] = 1.0 + (n % 2) as f32;
    }
    grid.apply_thresholds([0.5, 1.5]);
    let winding = Winding { length: 0.003, even: 1.5 };
    let ray = |n: u64| {
        let [o, d] = [1, 2].map(|s| [0, 1, 2].map(|a| (3.0 * key.uniform(s, n, a) - 1.0) as f32));
        MarchRay { o, d, near: 0.1, far: 80.0, u: key.uniform(3, n, 0) as f32, patience: u32::MAX }
    };
    let rays: Vec<MarchRay> = (0..400).map(ray).collect();
    let (mut steps, mut met) = (Steps::default(), 0);
    grid.follow(&winding, &rays, &mut steps);
    for (n, ray) in rays.iter().enumerate() {
        let [first, last] = winding.ends(ray);
        let all = (0..).map(|i| first + i as f32).take_while(|k| *k < last);
        let found: Vec<f32> = all.filter(|k| grid.occupied(grid.cell(winding.at(ray, *k)))).collect();
        assert_eq!(steps.of(n), found, "ray {n}");
        met += usize::from(!found.is_empty());
    }
    assert!(met > 40, "{met} rays meet something");
    // Two samples in opaque cells are enough for the impatient.
    let short: Vec<MarchRay> = rays.iter().map(|ray| MarchRay { patience: 2, ..*ray }).collect();
    let mut some = Steps::default();
    grid.follow(&winding, &short, &mut some);
    let ended = (0..400).filter(|n| some.cut(*n)).count();
    assert!(ended > 5, "{ended} rays end");
    (0..400).for_each(|n| assert!(steps.of(n).starts_with(some.of(n))));
}

/// A ray's charges are the gradient of the oracle's distortion loss with respect to its weights.
#[test]
fn scattered_weights_cost_what_the_oracle_says() {
    let settings =
        CompactSettings { distortion: 0.5, ..CompactSettings::derive(&ball(), &asked(Extent::Box)) };
    let scatter = Scatter::new(&settings, Pace::new(&settings, 64.0), 10).unwrap();
    let (near, far) = (settings.near, settings.far);
    let place = |t: f64| (1.0 / near - 1.0 / t) / (1.0 / near - 1.0 / far);
    let step = settings.size / 64.0;
    let weights: Vec<f64> = (0..12).map(|i| f64::from(i * i % 7) / 50.0).collect();
    let t: Vec<f64> = (0..12).map(|i| near + (f64::from(i) + 3.5) * step).collect();
    // Samples side by side: their intervals are those of the oracle's edges, but for the step's own curve in 1 / t.
    let edges: Vec<f64> = (0..=12).map(|i| place(near + (f64::from(i) + 3.0) * step)).collect();
    let mut samples = vec![[0.0f32; 16]; 12];
    samples.iter_mut().zip(&weights).for_each(|(sample, w)| sample[3] = *w as f32);
    let places: Vec<f32> = t.iter().map(|t| *t as f32).collect();
    scatter.charge(&places, &mut samples, 0..12);
    let (right, _) = backward::distortion(&weights, &edges, 0.5 / 10.0);
    assert!(distortion(&weights, &edges) > 0.0);
    for (sample, right) in samples.iter().zip(right) {
        assert_relative_eq!(f64::from(sample[6]), right, max_relative = 1e-3);
    }
    assert!(
        Scatter::new(
            &CompactSettings { distortion: 0.0, ..settings.clone() },
            Pace::new(&settings, 64.0),
            10
        )
        .is_none()
    );
}

/// Through weights, densities and layers: a chunk's encodings have the gradient of both losses.
#[test]
fn the_distortion_loss_reaches_the_encodings() {
    let settings =
        CompactSettings { distortion: 2.0, ..CompactSettings::derive(&ball(), &asked(Extent::Box)) };
    let rays = COUNTS.len();
    let nets = Networks::new(Weights::random(&Key::new(4, Purpose::Parameters)));
    let encodings = rows::<32>(5, COUNTS.iter().sum());
    let scatter = Scatter::new(&settings, Pace::new(&settings, 64.0), rays);
    let pass = Pass {
        nets: &nets,
        weights: &nets.weights,
        stop: 0.0,
        view_dependent: true,
        gradient: Some(2.0 / (3 * rays) as f32),
        scatter,
    };
    let mut chunk = chunk_of(&encodings, 0.05);
    let (near, far, step) = (settings.near, settings.far, settings.size / 64.0);
    for ray in chunk.rays.clone() {
        (0..ray.count).for_each(|i| chunk.t[ray.first + i] = (near + (i as f64 + 0.5) * step) as f32);
    }
    run(crate::simd::arch(), &pass, &mut chunk, &Plain);
    let place = |t: f64| (1.0 / near - 1.0 / t) / (1.0 / near - 1.0 / far);
    let loss = |encodings: &[[f32; 32]]| {
        let (mut first, mut scattered) = (0, 0.0);
        for (r, count) in COUNTS.into_iter().enumerate() {
            let unit = direction(r).map(|x| f64::from(x as f32));
            let samples = encodings[first..first + count].iter();
            let (sigmas, rgbs): (Vec<f64>, Vec<[f64; 3]>) =
                samples.map(|e| field(&nets.weights, &e.map(f64::from), unit)).unzip();
            first += count;
            let seen = volume_render(&sigmas, &rgbs, &vec![f64::from(0.05f32); count], ProductEps::None);
            let edges: Vec<f64> = (0..=count).map(|i| place(near + i as f64 * step)).collect();
            scattered += distortion(&seen.weights, &edges);
        }
        oracle_loss(&nets.weights, encodings, f64::from(0.05f32)) + 2.0 * scattered / rays as f64
    };
    let mut differs = 0.0f64;
    for (p, f) in [(0, 0), (3, 17), (8, 31), (40, 5), (101, 9)] {
        let at = |h: f32, of: &dyn Fn(&[[f32; 32]]) -> f64| {
            let mut moved = encodings.clone();
            moved[p][f] += h;
            of(&moved)
        };
        let slope = (at(1e-3, &loss) - at(-1e-3, &loss)) / 2e-3;
        let color = |e: &[[f32; 32]]| oracle_loss(&nets.weights, e, f64::from(0.05f32));
        let alone = (at(1e-3, &color) - at(-1e-3, &color)) / 2e-3;
        differs = differs.max((slope - alone).abs() / slope.abs());
        let got = f64::from(chunk.encoding[f / FEATURES][p][f % FEATURES]);
        assert!((slope - got).abs() < 1e-6 + 2e-2 * got.abs(), "{p} {f}: {slope} {got}");
    }
    assert!(differs > 0.1, "the distortion loss matters here: {differs}");
}

/// What is around a scene decides: pictures of a cut-out object have a box, what is far wider than the cameras' own cube
/// is contracted, and so is what has no bounds.
#[test]
fn the_scene_says_which_space_it_needs() {
    let full = |half: f64| {
        let mut scene = ball();
        // Not a border of background.
        scene.background = [0.9; 3];
        scene.bounds = Some((DVec3::splat(-half), DVec3::splat(half)));
        scene
    };
    let mut unknown = full(1.0);
    unknown.bounds = None;
    let space = |scene: &Scene, extent| CompactSettings::derive(scene, &asked(extent)).space;
    let contracted = |space| matches!(space, Space::Contracted { .. });
    assert_eq!(space(&ball(), Extent::Auto), Space::Box);
    assert_eq!(space(&full(3.0), Extent::Auto), Space::Box);
    assert!(contracted(space(&full(30.0), Extent::Auto)));
    assert!(contracted(space(&unknown, Extent::Auto)));
    unknown.far_given = true;
    assert_eq!(space(&unknown, Extent::Auto), Space::Box);
    let derived = |far: f64, given: bool| {
        let mut scene = full(30.0);
        (scene.far, scene.far_given) = (far, given);
        CompactSettings::derive(&scene, &asked(Extent::Auto)).far
    };
    assert_eq!([derived(7.0, true), derived(500.0, false)], [7.0, 500.0]);
    assert!((150.0..250.0).contains(&derived(7.0, false)) && derived(1e9, true) < 3e4);
    // One camera far away takes little from the others' cube.
    let mut outlier = full(30.0);
    let size = |scene: &Scene| CompactSettings::derive(scene, &asked(Extent::Contracted)).size;
    let before = size(&outlier);
    outlier.train[0].camera.c2w.w_axis = (outlier.focus + 1e3).extend(1.0);
    assert!(size(&outlier) < 4.0 * before, "{} {before}", size(&outlier));
    // Pictures of hardly any light aren't a cut-out's background because they are nearly black.
    let mut night = unknown.clone();
    (night.background, night.far_given) = ([0.0; 3], false);
    for frame in &mut night.train {
        let dark = |(j, i, _): (usize, usize, usize)| 0.005 + 0.001 * ((3 * j + i) % 7) as f32;
        frame.image = Some(ndarray::Array3::from_shape_fn((16, 16, 3), dark).into());
    }
    assert!(contracted(space(&night, Extent::Auto)));
    let mut together = unknown.clone();
    together.train.iter_mut().for_each(|frame| frame.camera.c2w.w_axis = DVec3::ZERO.extend(1.0));
    assert_eq!(space(&together, Extent::Contracted), Space::Box);
    assert_eq!(space(&full(30.0), Extent::Box), Space::Box);
    assert!(contracted(space(&ball(), Extent::Contracted)));
    let mut wide_object = ball();
    wide_object.bounds = full(30.0).bounds;
    assert_eq!(space(&wide_object, Extent::Auto), Space::Box);
}
