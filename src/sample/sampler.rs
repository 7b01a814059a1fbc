//! The row of the contract that is judged by statistics: random rays, and the jitter of their samples. No draw is wrong by itself;
//! `statistics.rs` says what right ones look like together.

use ndarray::Ix4;

use super::statistics::{self, Call};
use super::{rest_u, sample_along_ray};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, array, arrays, input, number, rows, scalar, threes, twos, values};
use crate::contract::case::Case;
use crate::contract::component::{Component, Direction, Entries, Mistake, Port};
use crate::contract::machine::Machine;
use crate::contract::special::{Findings, Special, Statistics};
use crate::convention::Conventions;
use crate::random::{Key, Purpose};
use crate::ray::{PixelDraws, sample_random_rays};

/// Rays a call.
const RAYS: usize = 4096;

/// Samples per ray.
const SAMPLES: usize = 16;

/// Random rays: four calls, two in training and two at rest, judged together.
pub(crate) const SAMPLER: Component = Component {
    name: "sample_random_rays",
    folder: "sample",
    code: include_str!("honest.rs"),
    formula: "image, row and column uniform over all pixels; t_i by its grid, u_i uniform in training, at rest in evaluation",
    source: "NeRF (Mildenhall et al. 2020) section 4 and equation 2",
    inputs: &[
        Port::plain("images", "I,H,W,3", "photographs in [0, 1]"),
        Port::plain("count", "", "how many rays to draw").of(Entries::Count),
        Port::plain("samples", "", "N, samples a ray").of(Entries::Count),
        Port::plain("near", "", "where rays begin"),
        Port::plain("far", "", "where rays end"),
        Port::plain("training", "", "1: samples are jittered; 0: they rest").of(Entries::Bit),
        Port::plain("seed", "", "another number for every call; to be used or not").of(Entries::Count),
    ],
    outputs: &[
        Port::plain("image_ids", "R", "the image of each ray").of(Entries::Pixel),
        Port::plain("uv", "R,2", "its pixel position").of(Entries::Pixel),
        Port::plain("rgbs", "R,3", "its color"),
        Port::plain("t", "R,N", "its samples"),
    ],
    conventions: &["pixel_center", "grid", "rest"],
    forward: Direction { oracle: drawn, bound: unbounded, honest: honestly, wrong: wrongly },
    vjp: None,
    cases: calls,
    mistakes: MISTAKES,
    special: Special {
        forward_name: "statistics",
        // Jitter and colors are judged if there are any; pixels can't be judged without images.
        statistics: Some(Statistics { optional: &["rgbs", "t"], last_word: "outside_the_images", findings }),
        ..Special::NONE
    },
};

/// What [`statistics::findings`] can name.
const MISTAKES: &[Mistake] = &[
    row(
        "outside_the_images",
        "a position that is no pixel",
        "colors of other pixels",
        "check the ranges of image, row and column",
        0,
    ),
    row(
        "rounded_to_the_nearest",
        "round(u W) for a column, and round(u H) for a row",
        "the first ones are drawn half as often as others, and one more is drawn that isn't there",
        "floor(u W), or whole numbers below W",
        1,
    ),
    row(
        "first_images_only",
        "an index in [0, H W) of a flat list of N H W pixels",
        "the other views are never trained",
        "draw from all N H W pixels",
        2,
    ),
    row(
        "images_not_uniform",
        "some images are drawn more often",
        "views of unequal quality",
        "draw the image uniformly",
        0,
    ),
    row(
        "pixels_not_uniform",
        "some pixels are drawn more often",
        "regions of unequal quality",
        "draw rows and columns uniformly",
        0,
    ),
    row(
        "rays_frozen",
        "every call draws the same pixels",
        "the network sees one batch",
        "draw anew in every call",
        1,
    ),
    row(
        "rays_repeat",
        "a generator is seeded anew for every block of rays, or the second call has the first one's rays in another order",
        "a part of the pixels is trained over and over",
        "one stream for all rays and steps",
        0,
    ),
    row(
        "one_image_for_ever",
        "the image is drawn once for the run",
        "the other views are never trained",
        "draw the image anew in every call",
        0,
    ),
    row("divided_twice_by_255", "c / 255^2", "black targets", "divide once", 2),
    row(
        "wrong_colors",
        "colors of other pixels than uv says",
        "nothing is learned",
        "index images by [image, row, column]",
        1,
    ),
    row(
        "never_jittered",
        "u is the same for every ray, sample and call",
        "rings at the sample distances",
        "draw u in training",
        3,
    ),
    row(
        "jitter_frozen",
        "the jitter is drawn once for the run",
        "fixed sample positions, rings",
        "draw u anew in every step",
        1,
    ),
    row(
        "one_jitter_for_all_rays",
        "noise of shape N, broadcast over rays",
        "neighboring rays err together: noise in the picture",
        "draw one u for every ray and sample",
        11,
    ),
    row(
        "rays_jittered_together",
        "neighboring rays share their noise",
        "noise in the picture",
        "draw one u for every ray and sample",
        0,
    ),
    row(
        "jitter_repeats",
        "a generator is seeded anew for every block of rays, or its counter is short",
        "positions that come again: patterns in the picture",
        "one stream for all rays, samples and steps",
        0,
    ),
    row(
        "jitter_of_the_pixel",
        "noise as a function of the pixel alone",
        "fixed sample positions for every pixel, in every step",
        "let the step's number into the noise",
        0,
    ),
    row(
        "jitter_antithetic",
        "every other number is 1 less the one before",
        "half as many independent positions",
        "draw one u for every ray and sample",
        0,
    ),
    row(
        "jitter_correlated",
        "numbers that depend on those of other rays or samples",
        "rays or samples that move together",
        "draw one u for every ray and sample",
        0,
    ),
    row(
        "jitter_width_0.02",
        "jitter over a fixed 0.02",
        "gaps between samples that are never seen",
        "scale u by the interval",
        1,
    ),
    row(
        "jitter_width_0.1",
        "jitter over a fixed 0.1",
        "samples out of order or gaps",
        "scale u by the interval",
        1,
    ),
    row(
        "jitter_width_1",
        "jitter over a fixed 1",
        "samples out of order, beyond far",
        "scale u by the interval",
        1,
    ),
    row("jitter_centered_on_edges", "u in [-0.5, 0.5)", "t below near", "u in [0, 1)", 1),
    row(
        "jitter_gaussian",
        "normal instead of uniform",
        "samples out of their intervals",
        "draw u uniformly",
        3,
    ),
    row(
        "jitter_not_uniform",
        "u of another law",
        "some depths are seen less",
        "draw u uniformly in [0, 1)",
        0,
    ),
    row(
        "jitter_at_evaluation",
        "jitter is left on when nothing is trained",
        "two renders of a view differ",
        "rest at u = 0.5 in evaluation",
        6,
    ),
    row(
        "not_at_rest",
        "samples rest elsewhere than in training's intervals",
        "a shift between training and evaluation",
        "one grid for both",
        1,
    ),
];

const fn row(
    name: &'static str,
    cause: &'static str,
    effect: &'static str,
    fix: &'static str,
    count: u32,
) -> Mistake {
    Mistake::new(name, cause, effect, fix, "public implementations, see the count", count)
}

/// The four calls.
fn calls() -> Vec<Case> {
    // So many images that one for all four calls comes by chance with a probability below 1e-7, and more pixels than rays, so that they
    // may be drawn without replacement.
    let shape = [256, 5, 7, 3];
    let pixel = |k: usize| ((k / 105 * 37 + k / 21 * 11 + k / 3 * 5 + k % 3 * 3) % 17) as f64 / 16.0;
    let images: Vec<f64> = (0..shape.iter().product()).map(pixel).collect();
    let call = |(seed, id): (usize, &str)| {
        let training = if seed < 2 { 1.0 } else { 0.0 };
        Case::new(
            id,
            "one of four calls that are judged together",
            vec![
                ("images", array(&shape, images.clone())),
                ("count", scalar(RAYS as f64)),
                ("samples", scalar(SAMPLES as f64)),
                ("near", scalar(2.0)),
                ("far", scalar(6.0)),
                ("training", scalar(training)),
                ("seed", scalar(seed as f64)),
            ],
        )
    };
    ["training_a", "training_b", "rest_a", "rest_b"].into_iter().enumerate().map(call).collect()
}

/// A right sampler.
fn drawn(a: &Arrays, c: &Conventions) -> Arrays {
    let seed = number(a, "seed") as u64;
    let (count, samples) = (number(a, "count") as usize, number(a, "samples") as usize);
    let images = input(a, "images").view().into_dimensionality::<Ix4>().expect("(I, H, W, 3)");
    let (rays, jitter) = (Key::new(seed, Purpose::Rays), Key::new(seed, Purpose::Samples));
    let u: Vec<[f64; 3]> =
        (0..count as u64).map(|r| std::array::from_fn(|k| rays.uniform(0, r, k as u64))).collect();
    let pixels = sample_random_rays(images, PixelDraws::Pool, &u, c.pixel_center);
    let t = |r: usize| {
        let resting = number(a, "training") == 0.0;
        let u = |i: usize| if resting { rest_u(c.rest) } else { jitter.uniform(0, r as u64, i as u64) };
        sample_along_ray(
            number(a, "near"),
            number(a, "far"),
            &(0..samples).map(u).collect::<Vec<_>>(),
            c.grid,
        )
    };
    arrays([
        ("image_ids", array(&[count], pixels.iter().map(|p| p.image as f64).collect())),
        ("uv", array(&[count, 2], pixels.iter().flat_map(|p| [p.uv.x, p.uv.y]).collect())),
        ("rgbs", array(&[count, 3], pixels.iter().flat_map(|p| p.rgb).collect())),
        ("t", array(&[count, samples], (0..count).flat_map(t).collect())),
    ])
}

/// The bound of a single draw: infinite, since no draw is wrong by itself.
fn unbounded(a: &Arrays, c: &Conventions, _: &Arithmetic) -> Arrays {
    drawn(a, c).into_iter().map(|(name, a)| (name, a.mapv(|_| f64::INFINITY))).collect()
}

fn honestly(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    drawn(a, c).into_iter().map(|(name, a)| (name, a.mapv(|x| m.round(x)))).collect()
}

/// The mistakes of samplers live in the tests of the statistics: here nothing is wrong.
fn wrongly(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    drawn(a, c)
}

/// An answer as a call.
fn call(answer: &Arrays) -> Call {
    Call {
        image_ids: values(answer, "image_ids"),
        uv: twos(answer, "uv"),
        rgbs: if answer.contains_key("rgbs") { threes(answer, "rgbs") } else { vec![] },
        t: if answer.contains_key("t") { rows(answer, "t") } else { vec![] },
    }
}

/// What the statistics of the four calls say.
fn findings<'a>(cases: &'a [Case], answers: &[Arrays], c: &Conventions) -> Findings<'a> {
    let calls: Vec<Call> = answers.iter().map(call).collect();
    let [a, b, rest_a, rest_b] = <[Call; 4]>::try_from(calls).expect("an answer to each of the four calls");
    let inputs = &cases[0].inputs;
    let images = input(inputs, "images").view().into_dimensionality::<Ix4>().expect("(I, H, W, 3)");
    let bounds = [number(inputs, "near"), number(inputs, "far")];
    Box::new(statistics::findings(images, [a, b], [rest_a, rest_b], bounds, *c))
}
