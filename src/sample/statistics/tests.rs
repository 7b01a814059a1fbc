//! The right sampler passes, and each mistake is named.

use ndarray::Array4;

use super::{Call, findings};
use crate::convention::{CS180, PixelCenter};
use crate::random::{Key, Purpose};
use crate::ray::{PixelDraws, sample_random_rays};
use crate::sample::sample_along_ray;

const RAYS: usize = 4096;
const SAMPLES: usize = 16;
const BOUNDS: [f64; 2] = [2.0, 6.0];

fn images() -> Array4<f64> {
    Array4::from_shape_fn((32, 5, 7, 3), |(n, j, i, k)| {
        ((n * 37 + j * 11 + i * 5 + k * 3) % 17) as f64 / 16.0
    })
}

fn color(image: usize, uv: &[f64; 2]) -> [f64; 3] {
    let images = images();
    std::array::from_fn(|k| images[[image, uv[1] as usize, uv[0] as usize, k]])
}

/// One call of the right sampler: rays from all images; jitter by `number(ray, sample)`.
fn call(seed: u64, step: u64, number: impl Fn(u64, u64) -> f64) -> Call {
    let key = Key::new(seed, Purpose::Rays);
    let u: Vec<[f64; 3]> =
        (0..RAYS as u64).map(|r| std::array::from_fn(|k| key.uniform(step, r, k as u64))).collect();
    let images = images();
    let drawn = sample_random_rays(images.view(), PixelDraws::Pool, &u, PixelCenter::Half);
    let t = |r: u64| {
        let u: Vec<f64> = (0..SAMPLES as u64).map(|i| number(r, i)).collect();
        sample_along_ray(BOUNDS[0], BOUNDS[1], &u, CS180.grid)
    };
    Call {
        image_ids: drawn.iter().map(|d| d.image as f64).collect(),
        uv: drawn.iter().map(|d| d.uv.to_array()).collect(),
        rgbs: drawn.iter().map(|d| d.rgb).collect(),
        t: (0..RAYS as u64).map(t).collect(),
    }
}

/// Two training calls with jitter `number(key, step, ray, sample)`.
fn training(seed: u64, number: impl Fn(Key, u64, u64, u64) -> f64) -> [Call; 2] {
    let key = Key::new(seed, Purpose::Samples);
    [0, 1].map(|step| call(seed, step, |r, i| number(key, step, r, i)))
}

fn right(seed: u64) -> [Call; 2] {
    training(seed, |key, step, r, i| key.uniform(step, r, i))
}

fn resting() -> [Call; 2] {
    [0, 1].map(|step| call(9, step, |_, _| 0.5))
}

fn names(training: &[Call; 2], rest: &[Call; 2]) -> Vec<&'static str> {
    findings(images().view(), training, rest, BOUNDS, &CS180).iter().map(|f| f.name).collect()
}

#[test]
fn the_right_sampler_passes() {
    for seed in 0..20 {
        assert_eq!(names(&right(seed), &resting()), [""; 0], "seed {seed}");
    }
}

#[test]
fn single_precision_passes() {
    let mut calls = right(1);
    calls.iter_mut().flat_map(|call| call.t.iter_mut().flatten()).for_each(|t| *t = f64::from(*t as f32));
    assert_eq!(names(&calls, &resting()), [""; 0]);
}

#[test]
fn mistakes_of_the_rays_are_named() {
    let (mut first, mut resting_there) = (right(2), resting());
    for call in first.iter_mut().chain(&mut resting_there) {
        call.image_ids.fill(0.0);
        for (uv, rgb) in call.uv.iter().zip(&mut call.rgbs) {
            *rgb = color(0, uv);
        }
    }
    assert_eq!(names(&first, &resting_there), ["first_images_only"]);
    let mut dark = right(3);
    dark.iter_mut().flat_map(|call| call.rgbs.iter_mut().flatten()).for_each(|c| *c /= 255.0);
    assert_eq!(names(&dark, &resting()), ["divided_twice_by_255"]);
    let mut corners = right(4);
    corners.iter_mut().flat_map(|call| call.uv.iter_mut().flatten()).for_each(|x| *x -= 0.5);
    assert_eq!(names(&corners, &resting()), ["outside_the_images"]);
    let mut frozen = right(5);
    (frozen[1].image_ids, frozen[1].uv, frozen[1].rgbs) =
        (frozen[0].image_ids.clone(), frozen[0].uv.clone(), frozen[0].rgbs.clone());
    assert_eq!(names(&frozen, &resting()), ["rays_frozen"]);
    let mut left = right(6);
    for call in &mut left {
        // The right half of the picture is never drawn.
        for ((uv, id), rgb) in call.uv.iter_mut().zip(&call.image_ids).zip(&mut call.rgbs) {
            uv[0] = uv[0].min(3.5);
            *rgb = color(*id as usize, uv);
        }
    }
    assert_eq!(names(&left, &resting()), ["pixels_not_uniform"]);
    let mut swapped = right(7);
    swapped.iter_mut().for_each(|call| call.rgbs.rotate_left(1));
    assert_eq!(names(&swapped, &resting()), ["wrong_colors"]);
}

#[test]
fn mistakes_of_the_jitter_are_named() {
    let width = (BOUNDS[1] - BOUNDS[0]) / SAMPLES as f64;
    let gaussian = |key: Key, step: u64, r: u64, i: u64| {
        let (a, b) = (key.uniform(step, r, 2 * i), key.uniform(step, r, 2 * i + 1));
        (-2.0 * crate::math::ln(1.0 - a)).sqrt() * crate::math::cos(std::f64::consts::TAU * b)
    };
    type Number = Box<dyn Fn(Key, u64, u64, u64) -> f64>;
    let fixed = |w: f64| -> Number { Box::new(move |key, step, r, i| key.uniform(step, r, i) * w / width) };
    let mistakes: [(&str, Number); 9] = [
        ("one_jitter_for_all_rays", Box::new(|key, step, _, i| key.uniform(step, 0, i))),
        ("rays_jittered_together", Box::new(|key, step, r, i| key.uniform(step, r / 2, i))),
        ("never_jittered", Box::new(|_, _, _, _| 0.5)),
        ("jitter_frozen", Box::new(|key, _, r, i| key.uniform(0, r, i))),
        ("jitter_gaussian", Box::new(gaussian)),
        ("jitter_width_0.02", fixed(0.02)),
        ("jitter_width_0.1", fixed(0.1)),
        ("jitter_width_1", fixed(1.0)),
        ("jitter_centered_on_edges", Box::new(|key, step, r, i| key.uniform(step, r, i) - 0.5)),
    ];
    for (name, number) in &mistakes {
        for seed in 0..3 {
            assert_eq!(names(&training(seed, number), &resting()), [*name], "seed {seed}");
        }
    }
    let half = training(1, |key, step, r, i| 0.5 * key.uniform(step, r, i));
    assert_eq!(names(&half, &resting()), ["jitter_not_uniform"]);
}

#[test]
fn honest_choices_are_told_and_pass() {
    let per_ray = training(3, |key, step, r, _| key.uniform(step, r, 0));
    let shown = |calls: &[Call; 2], name: &str| {
        let found = findings(images().view(), calls, &resting(), BOUNDS, &CS180);
        assert!(found.len() == 1 && found[0].name == name && found[0].honest, "{name}: {found:?}");
    };
    shown(&per_ray, "one_jitter_per_ray");
    for (dealt_to, blocks) in [(1, false), (3, false), (4, true)] {
        let mut calls = right(8);
        for call in &mut calls {
            let drawn: Vec<f64> = call.image_ids[..dealt_to].to_vec();
            for r in 0..RAYS {
                let slot = if blocks { r * dealt_to / RAYS } else { r % dealt_to };
                call.image_ids[r] = drawn[slot];
                call.rgbs[r] = color(drawn[slot] as usize, &call.uv[r]);
            }
        }
        shown(&calls, "rays_per_image");
    }
}

#[test]
fn mistakes_at_evaluation_are_named() {
    assert_eq!(names(&right(1), &right(2)), ["jitter_at_evaluation"]);
    let edges = [0, 1].map(|step| call(9, step, |_, _| 0.0));
    assert_eq!(names(&right(1), &edges), ["not_at_rest"]);
}
