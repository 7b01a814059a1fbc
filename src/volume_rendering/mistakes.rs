//! Volume rendering, wrong on purpose. Every function takes the names of its mistakes; without any it equals the oracle.

use super::component::{self, renderings, row, rows3, size};
use super::{Rendering, volume_render as oracle, volume_render_alpha as oracle_alpha};
use crate::convention::{Conventions, ProductEps};
use crate::maths::exp;
use crate::verify::component::{Arrays, Mistake, input};

/// A row of the catalogue.
const fn mistake(
    name: &'static str,
    cause: &'static str,
    effect: &'static str,
    fix: &'static str,
    seen: &'static str,
    count: u32,
) -> Mistake {
    Mistake { name, cause, effect, fix, seen, count, gradient: false }
}

const INCLUSIVE: Mistake = mistake(
    "inclusive_transmittance",
    "w_i = T_{i+1} alpha_i: the sample shades itself (an inclusive cumprod or cumsum)",
    "surfaces too dark by a factor of 1 - alpha; spikes read (.25, .125, .0625)",
    "shift the cumulative product by one: T_0 = 1",
    "1 of 38 CS180 projects, 8 others",
    9,
);
const ROLLED: Mistake = mistake(
    "rolled_transmittance",
    "T = roll(cumprod(1 - alpha), 1), whose first entry is the last product instead of 1",
    "the first sample is attenuated by the whole ray; spikes read (.0625, .25, .125)",
    "set T_0 = 1 behind the roll",
    "2 public implementations",
    2,
);
const FIRST_ZERO: Mistake = mistake(
    "first_transmittance_zero",
    "T_0 = 0 (a zero in front of the cumulative product instead of a one)",
    "the first sample is invisible; spikes read (0, .25, .125)",
    "put 1 in front of the product (0 in front of the sum)",
    "1 public implementation",
    1,
);
const OPACITY_AS_T: Mistake = mistake(
    "opacity_as_transmittance",
    "T = 1 - prod(1 - alpha): opacity in the place of transmittance",
    "what lies behind shines through what lies in front; spikes read (.25, .375, .4375)",
    "use the product itself",
    "3 public implementations",
    3,
);
const DIVIDED: Mistake = mistake(
    "divided_by_opacity",
    "C / A: the weights are normalised",
    "half-transparent rays as bright as opaque ones; NaN on an empty ray",
    "leave the weights as they are",
    "2 public implementations",
    2,
);
const ALPHA_FORGOTTEN: Mistake = mistake(
    "alpha_forgotten",
    "w_i = T_i",
    "empty space glows; weights sum to more than 1",
    "multiply by alpha_i",
    "1 public implementation",
    1,
);
const OVER_RAYS: Mistake = mistake(
    "transmittance_over_rays",
    "the cumulative sum or product runs over rays instead of samples (axis 0 for axis 1)",
    "a ray's colour depends on its neighbours in the batch",
    "accumulate along the sample axis",
    "1 public implementation",
    1,
);

/// Mistakes of rendering from densities.
pub const VOLUME_RENDER: &[Mistake] = &[
    INCLUSIVE,
    ROLLED,
    FIRST_ZERO,
    OPACITY_AS_T,
    DIVIDED,
    ALPHA_FORGOTTEN,
    OVER_RAYS,
    mistake(
        "delta_missing",
        "alpha = 1 - exp(-sigma)",
        "density is learned in the wrong unit and changes with the number of samples",
        "multiply sigma by the step length",
        "5 public implementations",
        5,
    ),
    mistake(
        "delta_unit_interval",
        "delta = 1 / N, as if near and far were 0 and 1",
        "density off by (far - near); one passes the course's own test",
        "delta = (far - near) / N, or the differences of t",
        "3 public implementations",
        3,
    ),
    mistake(
        "delta_over_n_minus_1",
        "delta = (far - near) / (N - 1) on a grid of N intervals",
        "density off by N / (N - 1), more at fewer samples",
        "divide by N, or use the grid that includes both ends",
        "3 public implementations",
        3,
    ),
    mistake(
        "backward_delta",
        "delta_i = t_i - t_{i-1}, delta_0 = 0",
        "the first sample is invisible and every density belongs to the wrong step",
        "delta_i = t_{i+1} - t_i",
        "3 public implementations",
        3,
    ),
    mistake(
        "delta_differenced_twice",
        "differences of the step lengths are taken as step lengths, last 1e10",
        "only the last sample is visible",
        "take the differences of t once",
        "1 public implementation",
        1,
    ),
    mistake(
        "first_gap_for_all",
        "the first step of a ray is used for all of its samples",
        "varies from call to call when samples are jittered",
        "one step for each sample",
        "1 public implementation",
        1,
    ),
    mistake(
        "first_ray_deltas",
        "the first ray's steps are used for every ray of the batch",
        "rays with other bounds get wrong densities",
        "one row of steps for each ray",
        "kornia 0.8.2 RegularRenderer (0.139 for 0.289)",
        1,
    ),
    mistake(
        "eps_on_alpha",
        "1e-10 is added to alpha (and to T)",
        "empty rays aren't empty; below what f32 can see",
        "add nothing",
        "1 public implementation",
        1,
    ),
    mistake(
        "scaled_exponential",
        "alpha = 1 - k exp(-x) with k other than 1 (here 0.99)",
        "empty space has an opacity of 1 - k",
        "alpha = 1 - exp(-x)",
        "1 public implementation",
        1,
    ),
];

/// Mistakes of rendering from opacities.
pub const VOLUME_RENDER_ALPHA: &[Mistake] = &[
    INCLUSIVE,
    ROLLED,
    FIRST_ZERO,
    OPACITY_AS_T,
    DIVIDED,
    ALPHA_FORGOTTEN,
    OVER_RAYS,
    Mistake {
        name: "product_gradient_zero_at_opaque",
        cause: "the product's gradient divides by 1 - alpha and is set to 0 where that is 0",
        effect: "an opaque sample can never become transparent again",
        seen: "nerfacc FIXME; alpha = [.5, 1, .3, .2], cotangent [1, 2, 3, 4]: [2, 0, 0, 0] for [2, 2.9, 0, 0]",
        fix: "use the recursion from behind, which divides by nothing",
        count: 1,
        gradient: true,
    },
];

/// Mistakes of the background.
pub const COMPOSITE_BACKGROUND: &[Mistake] = &[
    mistake(
        "attenuated_twice",
        "A C + (1 - A) b: the rendered colour is premultiplied already",
        "half-transparent edges too dark; right only at A = 0 or 1",
        "C + (1 - A) b",
        "instant-nsr-pl#54, nerfstudio#2165",
        2,
    ),
    mistake(
        "one_channel",
        "the background is written to the first channel alone",
        "empty rays have the wrong hue",
        "add (1 - A) b to every channel",
        "1 public implementation",
        1,
    ),
    mistake(
        "background_255",
        "b is in 0..255 where C is in 0..1",
        "everything that isn't opaque is white",
        "divide the background by 255",
        "1 public implementation",
        1,
    ),
    mistake(
        "background_always",
        "C + b: the background isn't attenuated (an appended sample that isn't opaque, or a forgotten 1 - A)",
        "opaque objects glow",
        "C + (1 - A) b",
        "1 public implementation",
        1,
    ),
];

/// Mistakes of the expected distance.
pub const DEPTH: &[Mistake] = &[
    mistake(
        "zero_by_zero",
        "sum w t / sum w on a ray without weight",
        "NaN in depth pictures, and in losses on them",
        "say what an empty ray's depth is: far",
        "nerf-pytorch#28 and many others",
        10,
    ),
    mistake(
        "depth_of_index",
        "sum w i / sum w: the sample's number in the place of t",
        "depth without units",
        "weigh t",
        "never; cheap to keep",
        0,
    ),
];

/// The steps as the mistakes have them.
fn wrong_deltas(a: &Arrays, r: usize, wrong: &[&str]) -> Vec<f64> {
    let mut deltas = row(a, "deltas", if wrong.contains(&"first_ray_deltas") { 0 } else { r });
    let n = deltas.len();
    for name in wrong {
        match *name {
            "delta_missing" => deltas.fill(1.0),
            "delta_unit_interval" => deltas.fill(1.0 / n as f64),
            "delta_over_n_minus_1" if n > 1 => {
                deltas.iter_mut().for_each(|delta| *delta *= n as f64 / (n - 1) as f64)
            }
            "backward_delta" if n > 0 => {
                deltas.rotate_right(1);
                deltas[0] = 0.0;
            }
            "delta_differenced_twice" if n > 0 => {
                deltas = (1..n).map(|i| deltas[i] - deltas[i - 1]).chain([1e10]).collect()
            }
            "first_gap_for_all" if n > 0 => deltas = vec![deltas[0]; n],
            _ => {}
        }
    }
    deltas
}

/// What goes wrong between opacities and the outputs.
fn wrong_composite(mut rendering: Rendering, alphas: &[f64], rgbs: &[[f64; 3]], wrong: &[&str]) -> Rendering {
    let n = alphas.len();
    let mut t = rendering.transmittance.clone();
    for name in wrong {
        match *name {
            "inclusive_transmittance" => t.rotate_left(1),
            "rolled_transmittance" => t[0] = t[n],
            "first_transmittance_zero" => t[0] = 0.0,
            "opacity_as_transmittance" => t = (0..=n).map(|i| 1.0 - t[(i + 1).min(n)]).collect(),
            _ => {}
        }
    }
    let forgotten = wrong.contains(&"alpha_forgotten");
    if forgotten || t != rendering.transmittance {
        let behind = rendering.transmittance[n];
        rendering.weights = (0..n).map(|i| if forgotten { t[i] } else { t[i] * alphas[i] }).collect();
        rendering.color = std::array::from_fn(|k| (0..n).map(|i| rendering.weights[i] * rgbs[i][k]).sum());
        rendering.opacity = rendering.weights.iter().sum();
        rendering.transmittance = t;
        rendering.transmittance[n] = behind;
    }
    if wrong.contains(&"divided_by_opacity") {
        rendering.color = rendering.color.map(|c| c / rendering.opacity);
    }
    rendering
}

/// alpha_i and T_i of all rays; with the accumulation along the wrong axis where that is the mistake.
fn over_rays(alphas: &[Vec<f64>], rays: &mut [Rendering], wrong: &[&str]) {
    if !wrong.contains(&"transmittance_over_rays") {
        return;
    }
    for i in 0..alphas.first().map_or(0, Vec::len) {
        let mut t = 1.0;
        for (r, ray) in rays.iter_mut().enumerate() {
            ray.transmittance[i] = t;
            t *= 1.0 - alphas[r][i];
        }
    }
}

/// Recomputes weights, colour and opacity from T.
fn recompose(rendering: Rendering, alphas: &[f64], rgbs: &[[f64; 3]]) -> Rendering {
    let weights: Vec<f64> = alphas.iter().zip(&rendering.transmittance).map(|(a, t)| a * t).collect();
    let color = std::array::from_fn(|k| weights.iter().zip(rgbs).map(|(w, c)| w * c[k]).sum());
    Rendering { color, opacity: weights.iter().sum(), weights, ..rendering }
}

fn render_all(
    alphas: Vec<Vec<f64>>,
    mut rays: Vec<Rendering>,
    rgbs: impl Fn(usize) -> Vec<[f64; 3]>,
    wrong: &[&str],
) -> Vec<Rendering> {
    over_rays(&alphas, &mut rays, wrong);
    let finish = |(r, mut ray): (usize, Rendering)| {
        if wrong.contains(&"transmittance_over_rays") {
            ray = recompose(ray, &alphas[r], &rgbs(r));
        }
        wrong_composite(ray, &alphas[r], &rgbs(r), wrong)
    };
    rays.into_iter().enumerate().map(finish).collect()
}

/// Rendering from densities.
pub fn volume_render(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (count, samples) = size(a, "sigmas");
    let (mut all, mut rays) = (vec![], vec![]);
    for r in 0..count {
        let (sigmas, deltas) = (row(a, "sigmas", r), wrong_deltas(a, r, wrong));
        let mut alphas: Vec<f64> =
            super::optical_depths(&sigmas, &deltas).iter().map(|&x| -crate::maths::expm1(-x)).collect();
        let mut ray = oracle(&sigmas, &rows3(a, "rgbs", r), &deltas, c.product_eps);
        let touched = wrong.contains(&"eps_on_alpha") || wrong.contains(&"scaled_exponential");
        if touched {
            for (alpha, x) in alphas.iter_mut().zip(super::optical_depths(&sigmas, &deltas)) {
                let k = if wrong.contains(&"scaled_exponential") { 0.99 } else { 1.0 };
                *alpha = 1.0 - k * exp(-x);
            }
            ray = oracle_alpha(&alphas, &rows3(a, "rgbs", r), c.product_eps);
        }
        if wrong.contains(&"eps_on_alpha") {
            alphas.iter_mut().for_each(|alpha| *alpha += 1e-10);
            ray = oracle_alpha(&alphas, &rows3(a, "rgbs", r), ProductEps::TenToMinusTen);
        }
        all.push(alphas);
        rays.push(ray);
    }
    renderings(samples, &render_all(all, rays, |r| rows3(a, "rgbs", r), wrong))
}

/// Rendering from opacities.
pub fn volume_render_alpha(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (count, samples) = size(a, "alphas");
    let alphas: Vec<Vec<f64>> = (0..count).map(|r| row(a, "alphas", r)).collect();
    let rays = (0..count).map(|r| oracle_alpha(&alphas[r], &rows3(a, "rgbs", r), c.product_eps)).collect();
    renderings(samples, &render_all(alphas, rays, |r| rows3(a, "rgbs", r), wrong))
}

/// Gradient from densities: none of its own.
pub fn volume_render_vjp(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    (component::VOLUME_RENDER.vjp.expect("registered").oracle)(a, c)
}

/// Gradient from opacities.
pub fn volume_render_alpha_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut gradients = (component::VOLUME_RENDER_ALPHA.vjp.expect("registered").oracle)(a, c);
    if wrong.contains(&"product_gradient_zero_at_opaque") {
        // What reaches alpha through the product is lost where alpha = 1; what its own weight brings stays.
        let (rays, samples) = size(a, "alphas");
        let mut g_alphas = input(&gradients, "grad_alphas").clone();
        for r in 0..rays {
            let (alphas, g) = (row(a, "alphas", r), component::cotangent(a, r));
            let ray = oracle_alpha(&alphas, &rows3(a, "rgbs", r), c.product_eps);
            for i in (0..samples).filter(|&i| alphas[i] == 1.0) {
                let rgb = rows3(a, "rgbs", r)[i];
                let color: f64 = (0..3).map(|k| g.color[k] * rgb[k]).sum();
                g_alphas[[r, i]] = ray.transmittance[i] * (color + g.weights[i] + g.opacity);
            }
        }
        gradients.insert("grad_alphas".into(), g_alphas);
    }
    gradients
}

/// Background.
pub fn composite_background(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    if wrong.contains(&"background_255") {
        a.get_mut("background").expect("checked").mapv_inplace(|b| 255.0 * b);
    }
    if wrong.contains(&"one_channel") {
        a.get_mut("background").expect("checked").iter_mut().skip(1).for_each(|b| *b = 0.0);
    }
    if wrong.contains(&"attenuated_twice") {
        let opacity = input(&a, "opacity").clone();
        let colors = a.get_mut("colors").expect("checked");
        colors.indexed_iter_mut().for_each(|(i, c)| *c *= opacity[[i[0]]]);
    }
    if wrong.contains(&"background_always") {
        a.get_mut("opacity").expect("checked").fill(0.0);
    }
    (component::COMPOSITE_BACKGROUND.forward.oracle)(&a, c)
}

/// Gradient of the background: none of its own.
pub fn composite_background_vjp(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    (component::COMPOSITE_BACKGROUND.vjp.expect("registered").oracle)(a, c)
}

/// Expected distance.
pub fn depth(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    if wrong.contains(&"zero_by_zero") {
        a.insert("far".into(), crate::verify::component::scalar(f64::NAN));
    }
    if wrong.contains(&"depth_of_index") {
        a.get_mut("t").expect("checked").indexed_iter_mut().for_each(|(i, t)| *t = i[1] as f64);
    }
    (component::DEPTH.forward.oracle)(&a, c)
}

/// Gradient of the expected distance: none of its own.
pub fn depth_vjp(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    (component::DEPTH.vjp.expect("registered").oracle)(a, c)
}
