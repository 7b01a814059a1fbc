//! Laws of volume rendering: what may stand for T_i and for alpha_i in w_i = T_i alpha_i, what is made of the weights, and how one marches.

use super::super::arrays::{counted, over, renderings};
use super::super::{Rendering, optical_depths, volume_render, volume_render_alpha};
use super::ALPHA_ERROR;
use super::march_laws::{
    DENSITY, END, OF_DENSITY, OF_OPACITY, SEEN, SKIPPED, SKIPPED_BY_WEIGHT, STEP_CHOICES, end_said, ended,
    of_density, of_opacity, of_weights, other_densities, skipped_said, step_said, stepped, without_faint,
    without_thin,
};
use super::other_alphas::softmax;
use crate::contract::arrays::{Arrays, row, rows3, size};
use crate::contract::laws::{Laws, as_written};
use crate::convention::{Conventions, LastSample};
use crate::math::{exp, expm1};

/// What is accumulated for T: of densities all of these, of opacities the first two.
const ELEMENTS: [&str; 7] =
    ["alpha_j", "(1 - alpha_j)", "sigma_j delta_j", "sigma_j", "delta_j", "exp(-sigma_j)", "(1 - sigma_j)"];

/// How it is accumulated.
const SCANS: [&str; 14] = [
    "sum_{j<i} X",
    "sum_{j<=i} X",
    "prod_{j<i} X",
    "prod_{j<=i} X",
    "(X of sample i itself)",
    "(X of sample i - 1, 0 for the first)",
    "sum_j X",
    "sum_{j>i} X",
    "prod_{j>i} X",
    "(prod_{j<i} X, 0 for the first)",
    "prod_{1<j<=i} X",
    "prod_{1<j<i} X",
    "sum_{j<i-1} X",
    "prod_{j<i-1} X",
];

/// What is made of that.
const OUTER: [&str; 6] = ["exp(-S)", "S", "1 - S", "exp(S)", "max(0, 1 - S)", "1 / (1 + S)"];

/// What stands for alpha_i: of densities all of these, of opacities the first four.
const OWN: [&str; 11] = [
    "alpha_i",
    "1 - alpha_i",
    "alpha_i^2",
    "1",
    "sigma_i",
    "sigma_i delta_i",
    "delta_i",
    "alpha_i delta_i",
    "alpha_i sigma_i",
    "1 - exp(-sigma_i)",
    "1 - sigma_i",
];

/// What the color is.
const COLOR: [&str; 15] = [
    "sum_i w_i c_i",
    "sum_i sum_{j<=i} w_j c_j",
    "sum_i w_i c_i / N",
    "sum_i w_i alpha_i c_i",
    "sum_i w_i c_i + 1 - sum_i w_i",
    "sum_i w_i c_i over the largest w",
    "the color of the heaviest sample",
    "sum_i softmax(w)_i c_i",
    "sum_i w_i c_i, at most 1",
    "sum_i w_i c_i / sum_i w_i, 0 where there is none",
    "sum_i T_i c_i",
    "(1 - w_i) C + w_i c_i, sample by sample",
    "sum_i w_i c_i, held in [0, 1]",
    "sum_i w_i c_i over its largest channel where that is above 1",
    "1 / (1 + exp(-sum_i w_i c_i))",
];

/// What the opacity is.
const OPACITY: [&str; 8] = [
    "sum_i w_i",
    "1 - prod_i (1 - alpha_i)",
    "alpha of the last sample",
    "sum_i alpha_i",
    "the largest w",
    "sum_i w_i / N",
    "sum_i alpha_i, at most 1",
    "1, for every ray",
];

/// What is handed out for T behind the last sample.
const BEHIND: [&str; 3] = ["prod_i (1 - alpha_i)", "1 - sum_i w_i", "T of the last sample"];

const LIGHT: usize = SCANS.len() * OUTER.len();

/// What people write most often for T: element, scan and what is made of it. These are tried first, as there isn't room for three wrong
/// parts of which one is any T.
const COMMON: [[usize; 3]; 9] =
    [[1, 3, 1], [1, 13, 1], [1, 9, 1], [1, 4, 1], [1, 8, 1], [0, 2, 1], [0, 0, 0], [0, 1, 0], [0, 1, 2]];

/// The choice of no light that is lost.
const ALL_LIGHT: usize = 1;

/// The number of a T, which is `element * LIGHT + scan * OUTER.len() + outer`, for a choice of it behind that of all light.
fn light(choice: usize) -> usize {
    let choice = choice - ALL_LIGHT;
    let number = |[element, scan, outer]: [usize; 3]| element * LIGHT + scan * OUTER.len() + outer;
    let mut common = COMMON.map(number);
    if let Some(number) = common.get(choice - 1) {
        return *number;
    }
    // The others in their order.
    common.sort_unstable();
    common.iter().fold(choice - 1 - common.len(), |n, common| n + usize::from(n >= *common))
}

/// Those of densities. What is cheap to try with all else comes last: T has more choices than all others together.
pub(crate) const OF_DENSITIES: Laws = Laws {
    choices: &[
        1 + ALL_LIGHT + ELEMENTS.len() * LIGHT,
        OWN.len(),
        COLOR.len(),
        OPACITY.len(),
        SEEN.len(),
        OF_DENSITY.len(),
        SKIPPED,
        END.len(),
        BEHIND.len(),
        STEP_CHOICES,
        DENSITY.len(),
    ],
    says: |part, choice| match part {
        5 => format!("alpha_i = {}", OF_DENSITY[choice]),
        9 => format!("delta_i = {}", step_said(choice)),
        10 => format!("{} for sigma_i", DENSITY[choice]),
        _ => says(part, choice),
    },
    of: of_densities,
    rounding: &[],
};

/// Those of opacities.
pub(crate) const OF_OPACITIES: Laws = Laws {
    choices: &[
        1 + ALL_LIGHT + 2 * LIGHT,
        4,
        COLOR.len(),
        OPACITY.len(),
        SEEN.len(),
        OF_OPACITY.len(),
        // A density isn't known, a weight is.
        SKIPPED_BY_WEIGHT,
        END.len(),
        BEHIND.len(),
    ],
    says: |part, choice| match part {
        5 => format!("{} for alpha_i", OF_OPACITY[choice]),
        6 => skipped_said(of_weights(choice)),
        _ => says(part, choice),
    },
    of: of_opacities,
    rounding: &[],
};

fn says(part: usize, choice: usize) -> String {
    match part {
        0 if choice == ALL_LIGHT => "T_i = 1".into(),
        0 => {
            let n = light(choice);
            let scan = SCANS[n / OUTER.len() % SCANS.len()].replace('X', ELEMENTS[n / LIGHT]);
            format!("T_i = {}", OUTER[n % OUTER.len()].replace('S', &scan))
        }
        1 => format!(
            "w_i = T_i {}",
            if OWN[choice].contains(' ') { format!("({})", OWN[choice]) } else { OWN[choice].into() }
        ),
        2 => format!("C = {}", COLOR[choice]),
        3 => format!("A = {}", OPACITY[choice]),
        4 => format!("C = 0 and A = 0 where A < {}", as_written(SEEN[choice])),
        6 => skipped_said(choice),
        7 => end_said(choice),
        _ => format!("transmittance behind all = {}", BEHIND[choice]),
    }
}

/// A sample's numbers.
#[derive(Clone, Copy)]
struct Sample {
    alpha: f64,
    sigma: f64,
    delta: f64,
    depth: f64,
}

impl Sample {
    fn element(&self, n: usize, eps: f64) -> f64 {
        match n {
            0 => self.alpha,
            1 => 1.0 - self.alpha + eps,
            2 => self.depth,
            3 => self.sigma,
            4 => self.delta,
            5 => exp(-self.sigma),
            _ => 1.0 - self.sigma,
        }
    }

    fn own(&self, n: usize) -> f64 {
        match n {
            0 => self.alpha,
            1 => 1.0 - self.alpha,
            2 => self.alpha * self.alpha,
            3 => 1.0,
            4 => self.sigma,
            5 => self.depth,
            6 => self.delta,
            7 => self.alpha * self.delta,
            8 => self.alpha * self.sigma,
            9 => -expm1(-self.sigma),
            _ => 1.0 - self.sigma,
        }
    }
}

/// X accumulated for every sample.
fn scanned(x: &[f64], n: usize) -> Vec<f64> {
    let sum = |x: &[f64]| x.iter().sum::<f64>();
    let product = |x: &[f64]| x.iter().product::<f64>();
    let of = |i: usize| match n {
        0 => sum(&x[..i]),
        1 => sum(&x[..=i]),
        2 => product(&x[..i]),
        3 => product(&x[..=i]),
        4 => x[i],
        5 => i.checked_sub(1).map_or(0.0, |before| x[before]),
        6 => sum(x),
        7 => sum(&x[i + 1..]),
        8 => product(&x[i + 1..]),
        9 if i == 0 => 0.0,
        9 => product(&x[..i]),
        10 => product(&x[1..=i]),
        11 => product(&x[i.min(1)..i]),
        12 => sum(&x[..i.saturating_sub(1)]),
        _ => product(&x[..i.saturating_sub(1)]),
    };
    (0..x.len()).map(of).collect()
}

fn outer(s: f64, n: usize) -> f64 {
    match n {
        0 => exp(-s),
        1 => s,
        2 => 1.0 - s,
        3 => exp(s),
        4 => (1.0 - s).max(0.0),
        _ => 1.0 / (1.0 + s),
    }
}

/// A ray by these choices; `right` is what the oracle says of its opacities.
fn ray(samples: &[Sample], rgbs: &[[f64; 3]], mut right: Rendering, eps: f64, law: &[usize]) -> Rendering {
    let n = samples.len();
    let mut t = right.transmittance.clone();
    if law[0] == ALL_LIGHT {
        t.fill(1.0);
    } else if law[0] > 0 {
        let light = light(law[0]);
        let x: Vec<f64> = samples.iter().map(|s| s.element(light / LIGHT, eps)).collect();
        let scan = scanned(&x, light / OUTER.len() % SCANS.len());
        t[..n].iter_mut().zip(scan).for_each(|(t, s)| *t = outer(s, light % OUTER.len()));
    }
    let mut weights: Vec<f64> = match &law[..2] {
        [0, 0] => right.weights.clone(),
        _ => samples.iter().zip(&t).map(|(s, t)| super::super::product(*t, s.own(law[1]))).collect(),
    };
    let end = ended(&t, law[7]);
    weights[end..].fill(0.0);
    for light in [&mut t, &mut right.transmittance] {
        let left = light[end];
        light[end..].fill(left);
    }
    let behind = right.transmittance[n];
    t[n] = match law[8] {
        0 => behind,
        1 => 1.0 - weights.iter().sum::<f64>(),
        _ => t[end.saturating_sub(1)],
    };
    let marched = &samples[..end];
    let (color, opacity) =
        (colored(marched, rgbs, &weights, &t, law[2]), opacity(marched, &weights, behind, law[3]));
    let (color, opacity) = if opacity < SEEN[law[4]] { ([0.0; 3], 0.0) } else { (color, opacity) };
    Rendering { color, weights, transmittance: t, opacity }
}

/// The color of so many samples up to the end of the march, among all weights.
fn colored(samples: &[Sample], rgbs: &[[f64; 3]], weights: &[f64], t: &[f64], choice: usize) -> [f64; 3] {
    let (n, end) = (weights.len(), samples.len());
    let whole: f64 = weights.iter().sum();
    let of = |weights: &[f64]| -> [f64; 3] {
        std::array::from_fn(|k| weights.iter().zip(rgbs).map(|(w, c)| w * c[k]).sum())
    };
    let each = |f: &dyn Fn(usize) -> f64| (0..end).map(f).collect::<Vec<f64>>();
    let most = weights.iter().copied().fold(0.0, f64::max);
    match choice {
        0 => of(weights),
        1 => of(&each(&|i| (end - i) as f64 * weights[i])),
        2 => of(weights).map(|c| c / n as f64),
        3 => of(&each(&|i| weights[i] * samples[i].alpha)),
        4 => of(weights).map(|c| c + 1.0 - whole),
        5 => of(weights).map(|c| c / most),
        6 => rgbs.get(weights.iter().position(|w| *w == most).unwrap_or(0)).copied().unwrap_or([0.0; 3]),
        7 => of(&softmax(&weights[..end])),
        8 => of(weights).map(|c| c.min(1.0)),
        9 => of(weights).map(|c| if whole == 0.0 { 0.0 } else { c / whole }),
        10 => of(&each(&|i| t[i])),
        11 => std::array::from_fn(|k| {
            weights.iter().zip(rgbs).fold(0.0, |front, (w, c)| (1.0 - w) * front + w * c[k])
        }),
        12 => of(weights).map(|c| c.clamp(0.0, 1.0)),
        13 => {
            let color = of(weights);
            color.map(|c| c / color.iter().copied().fold(1.0, f64::max))
        }
        _ => of(weights).map(|c| 1.0 / (1.0 + exp(-c))),
    }
}

/// The opacity of so many samples up to the end of the march, among all weights, with the light behind them.
fn opacity(samples: &[Sample], weights: &[f64], behind: f64, choice: usize) -> f64 {
    let whole: f64 = weights.iter().sum();
    let alphas: f64 = samples.iter().map(|s| s.alpha).sum();
    match choice {
        0 => whole,
        1 => 1.0 - behind,
        2 => samples.last().map_or(0.0, |s| s.alpha),
        3 => alphas,
        4 => weights.iter().copied().fold(0.0, f64::max),
        5 => whole / weights.len() as f64,
        6 => alphas.min(1.0),
        _ => 1.0,
    }
}

fn of_densities(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let ((count, n), closed) = (size(a, "sigmas"), c.last_sample == LastSample::Opaque);
    let one = |r: usize| {
        let rgbs = rows3(a, "rgbs", r);
        let mut sigmas = other_densities(row(a, "sigmas", r), law[10]);
        let deltas = stepped(row(a, "deltas", r), law[9]);
        without_thin(&mut sigmas, law[6]);
        let mut depths = optical_depths(&sigmas, &deltas);
        let mut alphas: Vec<f64> = depths.iter().map(|&x| -expm1(-x)).collect();
        let mut right = volume_render(&sigmas, &rgbs, &deltas, c.product_eps);
        if a.contains_key(ALPHA_ERROR) {
            let off = alphas.iter_mut().zip(row(a, ALPHA_ERROR, r)).filter(|(alpha, _)| **alpha != 0.0);
            off.for_each(|(alpha, e)| *alpha = (*alpha + e).clamp(0.0, 1.0));
        }
        (0..n).for_each(|i| alphas[i] = of_density(alphas[i], sigmas[i], depths[i], law[5]));
        let skips = without_faint(&mut alphas, law[6]);
        // An opaque last sample is so whatever the others are made of.
        if let Some(last) = n.checked_sub(1).filter(|_| closed) {
            (alphas[last], depths[last]) = (1.0, 1e10);
        }
        if skips || closed || law[5] > 0 || a.contains_key(ALPHA_ERROR) {
            right = volume_render_alpha(&alphas, &rgbs, c.product_eps);
        }
        let sample =
            |i: usize| Sample { alpha: alphas[i], sigma: sigmas[i], delta: deltas[i], depth: depths[i] };
        ray(&(0..n).map(sample).collect::<Vec<_>>(), &rgbs, right, c.product_eps.value(), law)
    };
    over(c, renderings(n, &(0..count).map(one).collect::<Vec<_>>()))
}

fn of_opacities(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let a = &counted(a, c);
    let (count, n) = size(a, "alphas");
    let one = |r: usize| {
        let (mut alphas, rgbs) = (row(a, "alphas", r), rows3(a, "rgbs", r));
        alphas.iter_mut().for_each(|alpha| *alpha = of_opacity(*alpha, law[5]));
        without_faint(&mut alphas, of_weights(law[6]));
        let right = volume_render_alpha(&alphas, &rgbs, c.product_eps);
        let sample = |alpha: &f64| Sample { alpha: *alpha, sigma: 0.0, delta: 0.0, depth: 0.0 };
        ray(&alphas.iter().map(sample).collect::<Vec<_>>(), &rgbs, right, c.product_eps.value(), law)
    };
    over(c, renderings(n, &(0..count).map(one).collect::<Vec<_>>()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_light_has_one_choice() {
        let all = ELEMENTS.len() * LIGHT;
        let mut lights: Vec<usize> = (1..=all).map(|choice| light(choice + ALL_LIGHT)).collect();
        assert_eq!(says(0, ALL_LIGHT), "T_i = 1");
        assert_eq!(says(0, 1 + ALL_LIGHT), "T_i = prod_{j<=i} (1 - alpha_j)");
        // Of opacities the first two elements are known.
        assert!(lights[..2 * LIGHT].iter().all(|light| *light < 2 * LIGHT));
        lights.sort_unstable();
        assert!(lights.iter().copied().eq(0..all));
    }
}
