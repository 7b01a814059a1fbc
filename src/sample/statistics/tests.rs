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
    Array4::from_shape_fn((256, 5, 7, 3), |(n, j, i, k)| {
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
    findings(images().view(), training.clone(), rest.clone(), BOUNDS, CS180).map(|f| f.name).collect()
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
    // Between 0 and the picture's size, rounded: wherever middles of pixels are counted from.
    for shift in [0.0, 0.5] {
        let mut rounded = right(4);
        let key = Key::new(4, Purpose::Samples);
        for (step, call) in rounded.iter_mut().enumerate() {
            for (r, uv) in call.uv.iter_mut().enumerate() {
                let u = |k: u64| key.uniform(step as u64, r as u64, k);
                *uv = [libm::round(7.0 * u(100)) + shift, libm::round(5.0 * u(101)) + shift];
            }
        }
        assert_eq!(names(&rounded, &resting()), ["rounded_to_the_nearest"]);
    }
    // Without colors all else is asked.
    let mut bare = right(4);
    bare.iter_mut().for_each(|call| call.rgbs.clear());
    assert_eq!(names(&bare, &resting()), [""; 0]);
    bare.iter_mut().flat_map(|call| call.uv.iter_mut()).for_each(|uv| uv[0] = uv[0].min(3.5));
    assert_eq!(names(&bare, &resting()), ["pixels_not_uniform"]);
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
        let all = images();
        let found: Vec<_> = findings(all.view(), calls.clone(), resting(), BOUNDS, CS180).collect();
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

#[test]
fn draws_that_come_again_are_named() {
    type Number = Box<dyn Fn(Key, u64, u64, u64) -> f64>;
    let mirrored = |u: f64, odd: bool| if odd { 1.0 - u } else { u };
    let mistakes: [(&str, Number); 13] = [
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(step, r % 512, i))),
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(step, r % 2048, i))),
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(step, r % 1000, i))),
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(step, r % 3, i))),
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(step, r % 4 % 2 + r / 4 * 4, i))),
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(step, r, i % 8))),
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(step, 0, (r + i) % 4096))),
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(0, (r + 100 * step) % 4096, i))),
        ("jitter_repeats", Box::new(|key, step, r, i| key.uniform(0, (r + 2047 * step) % 4096, i))),
        (
            "jitter_antithetic",
            Box::new(move |key, step, r, i| mirrored(key.uniform(step, r / 2, i), r % 2 == 1)),
        ),
        (
            "jitter_antithetic",
            Box::new(move |key, step, r, i| mirrored(key.uniform(step, r, i / 2), i % 2 == 1)),
        ),
        ("jitter_antithetic", Box::new(move |key, step, r, i| mirrored(key.uniform(0, r, i), step == 1))),
        (
            "jitter_correlated",
            Box::new(|key, step, r, i| {
                0.5 * (key.uniform(step, r, i) + key.uniform(step, (r + 5) % 4096, i))
            }),
        ),
    ];
    for (n, (name, number)) in mistakes.iter().enumerate() {
        assert_eq!(names(&training(4, number), &resting())[..1], [*name], "{n}");
    }
}

#[test]
fn jitter_of_the_pixel_is_named() {
    let (mut calls, key) = (right(4), Key::new(4, Purpose::Samples));
    for call in &mut calls {
        for r in 0..RAYS {
            let pixel = (call.image_ids[r] * 5.0 + call.uv[r][1]) * 7.0 + call.uv[r][0];
            let u: Vec<f64> = (0..SAMPLES as u64).map(|i| key.uniform(0, pixel as u64, i)).collect();
            call.t[r] = sample_along_ray(BOUNDS[0], BOUNDS[1], &u, CS180.grid);
        }
    }
    assert_eq!(names(&calls, &resting()), ["jitter_of_the_pixel"]);
}

#[test]
fn rays_that_come_again_are_named() {
    // Every 512 rays of both calls, then the first call rolled.
    let mut block = right(9);
    for call in &mut block {
        for r in 512..RAYS {
            (call.image_ids[r], call.uv[r], call.rgbs[r]) =
                (call.image_ids[r - 512], call.uv[r - 512], call.rgbs[r - 512]);
        }
    }
    assert_eq!(names(&block, &resting()), ["rays_repeat"]);
    let mut rolled = right(9);
    rolled[1].image_ids = rolled[0].image_ids.clone();
    rolled[1].uv = rolled[0].uv.clone();
    rolled[1].rgbs = rolled[0].rgbs.clone();
    rolled[1].image_ids.rotate_left(77);
    rolled[1].uv.rotate_left(77);
    rolled[1].rgbs.rotate_left(77);
    assert_eq!(names(&rolled, &resting()), ["rays_repeat"]);
    let (mut one, mut there) = (right(9), resting());
    for call in one.iter_mut().chain(&mut there) {
        call.image_ids.fill(7.0);
        for (uv, rgb) in call.uv.iter().zip(&mut call.rgbs) {
            *rgb = color(7, uv);
        }
    }
    assert_eq!(names(&one, &there), ["one_image_for_ever"]);
}

#[test]
fn rounding_is_no_jitter() {
    let mut rest = resting();
    for t in rest[1].t.iter_mut().flatten() {
        *t = f64::from((*t as f32).next_up());
    }
    assert_eq!(names(&right(1), &rest), [""; 0]);
    let mut frozen = right(2);
    frozen[1].t =
        frozen[0].t.iter().map(|t| t.iter().map(|t| f64::from((*t as f32).next_up())).collect()).collect();
    assert_eq!(names(&frozen, &resting()), ["jitter_frozen"]);
}

/// Pixels without replacement: fewer rays than pixels.
#[test]
fn draws_without_replacement_pass() {
    let mut calls = right(11);
    for (step, call) in calls.iter_mut().enumerate() {
        let mut pool: Vec<usize> = (0..256 * 35).collect();
        let key = Key::new(11, Purpose::Rays);
        for r in 0..RAYS {
            let other = r + key.below((pool.len() - r) as u64, step as u64, r as u64, 9) as usize;
            pool.swap(r, other);
            let (image, row, column) = (pool[r] / 35, pool[r] / 7 % 5, pool[r] % 7);
            call.image_ids[r] = image as f64;
            call.uv[r] = [column as f64 + 0.5, row as f64 + 0.5];
            call.rgbs[r] = color(image, &call.uv[r]);
        }
    }
    assert_eq!(names(&calls, &resting()), [""; 0]);
}

/// PCG32 (O'Neill 2014), XSH RR.
struct Pcg(u64);

impl Pcg {
    fn next(&mut self) -> u32 {
        let old = self.0;
        self.0 = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((((old >> 18) ^ old) >> 27) as u32).rotate_right((old >> 59) as u32)
    }
}

/// Philox, PCG, 24 bits as `torch.rand` makes them in f32, and the low 24 bits of a word. 4 trials each, or a 16th of `PROPTEST_CASES`
/// (4000: 1,000 trials in all).
#[test]
fn honest_generators_pass() {
    let trials = u64::from(crate::contract::testing::properties().cases / 16);
    let short = crate::math::power_of_two(-24);
    for seed in 0..trials {
        for generator in 0..4 {
            let mut pcg = Pcg(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + generator);
            let key = Key::new(seed, Purpose::Cases);
            let mut calls = right(1000 + seed);
            for (step, call) in calls.iter_mut().enumerate() {
                for (r, t) in call.t.iter_mut().enumerate() {
                    let mut number = |i: usize| match generator {
                        0 => key.uniform(step as u64, r as u64, i as u64),
                        1 => f64::from(pcg.next()) * short / 256.0,
                        2 => f64::from(pcg.next() >> 8) * short,
                        _ => (key.bits(step as u64, r as u64, i as u64) & 0xff_ffff) as f64 * short,
                    };
                    let u: Vec<f64> = (0..SAMPLES).map(&mut number).collect();
                    *t = sample_along_ray(BOUNDS[0], BOUNDS[1], &u, CS180.grid);
                    if generator > 1 {
                        t.iter_mut().for_each(|t| *t = f64::from(*t as f32));
                    }
                }
            }
            assert_eq!(names(&calls, &resting()), [""; 0], "seed {seed}, generator {generator}");
        }
    }
}
