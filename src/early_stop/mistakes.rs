//! Packed rendering with early stop, wrong on purpose. Without a mistake every function equals the oracle.

use ndarray::{ArrayD, Axis};

use super::arrays::{self as own, one_ray, packed, spans, stopped};
use super::live_samples;
use crate::contract::arrays::{Arrays, array, arrays, number, scalar, values};
use crate::contract::component::Mistake;
use crate::convention::{CS180, Conventions, ProductEps, Stop, Stopped};
use crate::math::expm1;
use crate::volume_rendering::component::{VOLUME_RENDER, VOLUME_RENDER_ALPHA};
use crate::volume_rendering::mistakes::{OWN_STEP, THIN_SKIPPED, unless_thin};
use crate::volume_rendering::volume_render;

/// What it is called in the row that it is a mistake of.
const RECTANGLES: &str = "optical_depth_for_alpha";

const OWN_EPS: Mistake = Mistake::new(
    "eps_of_its_own",
    "stops where T is below a number of one's own",
    "rays end earlier, or later, than they should",
    "the eps that is handed over",
    "1e-4 in most rasterizers of splats and marches, here where another is handed over",
    0,
)
.with("eps", 1e-4, [1e-8, 0.5]);

/// The first order of the exponential in weights and light.
const FIRST_ORDER: Mistake = Mistake::new(
    "opacity_of_first_order",
    "alpha_i = sigma_i delta_i in weights and light: w_i = T_i alpha_i, and T *= 1 - alpha_i",
    "thick steps leave negative light",
    "alpha_i = 1 - exp(-sigma_i delta_i)",
    "clouds of a flight display in GLSL",
    1,
);

/// Mistakes of packed rendering with early stop.
pub(crate) const EARLY_STOP: &[Mistake] = &[
    Mistake::new(
        "renormalized",
        "the color of a ray that stops is divided by its opacity, which becomes 1, and its weights aren't (VR5)",
        "no light is left for the background; a jump of eps in every channel where a ray begins to stop",
        "leave the color as it is: the error is at most eps without it",
        "instant-ngp#384, where it is meant, and its ports",
        3,
    ),
    Mistake::new(
        "clamped",
        "the color is clamped to [0, 1]",
        "no gradient where a color is too bright or too dark; high dynamic range is lost",
        "clamp where the picture is written",
        "1 CIS 580 student, without early stop",
        1,
    ),
    Mistake::new(
        RECTANGLES,
        "w_i = T_i sigma_i delta_i: the integral by rectangles, exact for T alone",
        "a thick step shines brighter than its color, and weights sum to more than 1",
        "alpha_i = 1 - exp(-sigma_i delta_i)",
        "marches in GLSL: color += T sigma delta c; T *= exp(-sigma delta)",
        3,
    ),
    Mistake::new(
        "weight_tested",
        "the ray ends at the first sample whose weight is below eps",
        "whatever lies behind empty space isn't there",
        "test the transmittance, not the weight",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "ends_taken_for_counts",
        "ray r has offsets_{r+1} samples from offsets_r on: pairs of (start, count) expected",
        "rays reach into their neighbors' samples",
        "count = offsets_{r+1} - offsets_r",
        "between packed formats: nerfacc hands over (start, count), others cumulative counts",
        1,
    ),
    Mistake::new(
        "not_reset_between_rays",
        "the transmittance runs on from ray to ray",
        "a ray is dark when its neighbor in the batch is opaque",
        "start every ray at T = 1: a segmented scan, or a difference of cumulative sums",
        "cumulative products over packed arrays",
        1,
    ),
    Mistake::new(
        "gradient_behind_the_stop",
        "samples behind the last live one have the gradient of the whole ray",
        "work is done for samples that were left out, and the gradient belongs to another picture",
        "0 behind the last live sample",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "last_sample_learns_nothing",
        "the sample behind which a ray stops has no gradient: the loop is left before it is written",
        "the surface that ends a ray learns too slowly",
        "write the gradient of the last live sample, then leave",
        "an earlier torch-ngp",
        2,
    )
    .of_gradient(),
    Mistake::new(
        "light_left_forgotten",
        "the cotangent of the transmittance behind the last sample isn't passed on",
        "densities in front of a background learn too slowly or not at all",
        "start the recursion at the last sample with grad_transmittance, not with 0",
        "hand-written backward passes without a background",
        1,
    )
    .of_gradient(),
    OWN_EPS,
    Mistake::new(
        "opaque_sample_tested",
        "the ray ends in front of the first sample whose alpha is above 1 - eps",
        "what is opaque is invisible",
        "test the transmittance behind it",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "weight_tested_behind_the_first",
        "the ray ends in front of the first sample, but for the very first, whose weight is below eps",
        "whatever lies behind empty space isn't there",
        "test the transmittance, not the weight",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "color_divided",
        "the color divided by the opacity, of rays that don't stop too",
        "half-transparent rays as bright as opaque ones",
        "leave the color as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "all_samples_live",
        "all of a ray's samples are counted, and not those that were used",
        "grids and step counts learn that nothing was saved",
        "those up to the stop",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "never_stopped",
        "eps isn't looked at",
        "nothing but time is lost, and numbers differ by up to eps",
        "stop where T < eps",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "light_left_is_none",
        "T is 0 where a ray has stopped",
        "no background behind it: a jump of eps",
        "T as it is, or the color divided",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "stopped_colors_divided",
        "the color of a ray that stops is divided by its opacity, which is told as it is",
        "color and opacity don't fit: the background comes on top of a whole color",
        "divide both, or neither",
        "instant-ngp's pictures, half of it; never seen here",
        0,
    ),
    Mistake::new(
        "divided_by_light_in_front",
        "the color of a ray that stops is divided by 1 - T in front of its last sample, not behind it",
        "surfaces that are brighter than white: divided by 0 where the first sample is opaque",
        "divide by the opacity, or not at all",
        "1 renderer of sparse voxels",
        1,
    ),
    TESTED_FIRST,
    FIRST_ORDER,
    OWN_STEP,
    THIN_SKIPPED,
];

/// What was carried over may stop a ray in front of its first sample.
const TESTED_FIRST: Mistake = Mistake::new(
    "carried_light_tested_first",
    "the transmittance runs on from ray to ray, and is tested in front of a ray's first sample",
    "all rays behind the first opaque one are black",
    "start every ray at T = 1",
    "never; cheap to keep",
    0,
);

/// Number of samples that are used, as the mistakes have it; `carried` is the light that arrives.
fn live(ray: &Arrays, carried: f64, eps: f64, stop: Stop, wrong: &[&str]) -> usize {
    let (sigmas, deltas) = (values(ray, "sigmas"), values(ray, "deltas"));
    let n = sigmas.len();
    if wrong.contains(&TESTED_FIRST.name) && carried < eps.min(1.0) {
        return 0;
    }
    if wrong.contains(&"weight_tested") {
        let weights = values(&(VOLUME_RENDER.forward.oracle)(ray, &CS180), "weights");
        return weights.iter().position(|w| carried * w < eps).map_or(n, |i| i + 1);
    }
    let alphas = || sigmas.iter().zip(&deltas).map(|(sigma, delta)| -expm1(-sigma * delta));
    if wrong.contains(&"opaque_sample_tested") {
        return alphas().position(|alpha| alpha > 1.0 - eps).unwrap_or(n);
    }
    if wrong.contains(&"weight_tested_behind_the_first") {
        let weights = values(&(VOLUME_RENDER.forward.oracle)(ray, &CS180), "weights");
        return weights.iter().skip(1).position(|w| carried * w < eps).map_or(n, |i| i + 1);
    }
    let live = live_samples(&sigmas, &deltas, eps / carried);
    // Whether it stops at its last sample, too: T behind them all.
    let t = volume_render(&sigmas[..live], &vec![[0.0; 3]; live], &deltas[..live], ProductEps::None);
    if carried * t.transmittance[live] >= eps {
        return live;
    }
    match stop {
        Stop::Behind => live,
        Stop::InFront => live - 1,
        Stop::OneMore => (live + 1).min(n),
    }
}

/// A ray whose opacities are optical depths, `carried` the light that arrives, and how many samples it uses until less than `eps` is left.
fn of_first_order(ray: &Arrays, carried: f64, eps: f64, stop: Stop) -> (usize, Arrays) {
    let depths = values(ray, "sigmas").into_iter().zip(values(ray, "deltas")).map(|(s, d)| s * d);
    let mut alphas: Vec<f64> = depths.collect();
    let mut light = carried;
    let end = alphas.iter().position(|alpha| {
        light *= 1.0 - alpha;
        light < eps
    });
    let n = match (end, stop) {
        (None, _) => alphas.len(),
        (Some(last), Stop::Behind) => last + 1,
        (Some(last), Stop::InFront) => last,
        (Some(last), Stop::OneMore) => (last + 2).min(alphas.len()),
    };
    alphas.truncate(n);
    let rgbs = values(ray, "rgbs")[..3 * n].to_vec();
    let samples = arrays([("alphas", array(&[1, n], alphas)), ("rgbs", array(&[1, n, 3], rgbs))]);
    (n, (VOLUME_RENDER_ALPHA.forward.oracle)(&samples, &CS180))
}

/// Packed rendering with early stop.
pub(crate) fn early_stop(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return own::early_stop(a, c);
    }
    let mut given = a.clone();
    if let Some(step) = OWN_STEP.among(wrong) {
        given.get_mut("deltas").expect("an input").fill(step);
    }
    if let Some(least) = THIN_SKIPPED.among(wrong) {
        given.get_mut("sigmas").expect("an input").mapv_inplace(|sigma| unless_thin(sigma, least));
    }
    let a = &given;
    let samples = values(a, "sigmas").len();
    let eps = match () {
        () if wrong.contains(&"never_stopped") => 0.0,
        () => OWN_EPS.among(wrong).unwrap_or(number(a, "eps")),
    };
    let (mut carried, mut rays) = (1.0, vec![]);
    for (r, (first, length)) in spans(a).into_iter().enumerate() {
        let counts = wrong.contains(&"ends_taken_for_counts");
        let reach = if counts { (first + length).min(samples - first) } else { length };
        let shown = if wrong.contains(&RECTANGLES) { &[RECTANGLES][..] } else { &[] };
        let whole = one_ray(a, r, first, reach);
        let (n, mut ray) = if wrong.contains(&FIRST_ORDER.name) {
            of_first_order(&whole, carried, eps, c.stop)
        } else {
            let n = live(&whole, carried, eps, c.stop, wrong);
            (n, (VOLUME_RENDER.forward.wrong)(&one_ray(a, r, first, n), &CS180, shown))
        };
        for name in ["colors", "weights", "opacity", "transmittance"] {
            ray.get_mut(name).expect("an output").mapv_inplace(|x| carried * x);
        }
        let t = number(&ray, "transmittance");
        let alone = wrong.contains(&"stopped_colors_divided");
        let divided: &[&str] = match c.stopped {
            Stopped::Left if alone || wrong.contains(&"renormalized") => &["colors"],
            Stopped::Left => &[],
            Stopped::MadeOpaque => &["colors", "weights"],
        };
        let opacity = number(&ray, "opacity");
        if wrong.contains(&"divided_by_light_in_front") && t < eps && n > 0 {
            // The last sample's weight apart.
            let front = opacity - values(&ray, "weights").last().unwrap_or(&0.0);
            ray.get_mut("colors").expect("an output").mapv_inplace(|x| x / front);
        }
        if !divided.is_empty() && t < eps && opacity > 0.0 {
            for name in divided {
                ray.get_mut(*name).expect("an output").mapv_inplace(|x| x / opacity);
            }
            if !alone {
                ray.insert("opacity".into(), scalar(1.0));
                ray.insert("transmittance".into(), scalar(0.0));
            }
        }
        if wrong.contains(&"clamped") {
            ray.get_mut("colors").expect("an output").mapv_inplace(|c| c.clamp(0.0, 1.0));
        }
        if wrong.contains(&"color_divided") && opacity > 0.0 {
            ray.get_mut("colors").expect("an output").mapv_inplace(|c| c / opacity);
        }
        if wrong.contains(&"light_left_is_none") && t < eps {
            ray.insert("transmittance".into(), scalar(0.0));
        }
        if wrong.contains(&"not_reset_between_rays") || wrong.contains(&TESTED_FIRST.name) {
            carried = t;
        }
        // Weights that would reach into the next ray's samples are dropped.
        let mut ray = stopped(n, length, ray);
        if wrong.contains(&"all_samples_live") {
            ray.insert("live".into(), array(&[1], vec![length as f64]));
        }
        rays.push(ray);
    }
    packed(rays)
}

/// Its gradient.
pub(crate) fn early_stop_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    if wrong.contains(&"gradient_behind_the_stop") {
        a.insert("eps".into(), scalar(0.0));
    }
    if wrong.contains(&"light_left_forgotten") {
        a.get_mut("grad_transmittance").expect("a cotangent").fill(0.0);
    }
    let mut gradient = own::early_stop_vjp(&a, c);
    if wrong.contains(&"last_sample_learns_nothing") {
        let live = values(&own::early_stop(&a, c), "live");
        let behind = values(&own::early_stop(&a, c), "transmittance");
        for (r, (first, _)) in spans(&a).into_iter().enumerate() {
            if live[r] > 0.0 && behind[r] < number(&a, "eps") {
                let last = first + live[r] as usize - 1;
                for name in ["grad_sigmas", "grad_rgbs", "grad_deltas"] {
                    let g: &mut ArrayD<f64> = gradient.get_mut(name).expect("a gradient");
                    g.index_axis_mut(Axis(0), last).fill(0.0);
                }
            }
        }
    }
    gradient
}
