//! Error bounds of volume rendering: the formulas once more, in running error analysis.
//!
//! Every form that the contract calls honest is covered: T as the exponential of a cumulative sum or as a cumulative
//! product, sums in any order, the light behind a sample as a recursion, as a suffix sum, or as the total minus a prefix sum.

pub(crate) mod depth;

use super::arrays::{
    LEAST_LIGHT, closed, cotangent, counted_to, exact_ends, gradients_of_densities, gradients_to,
    render_alpha, render_alpha_vjp,
};
use super::backward::Cotangent;
use crate::contract::arithmetic::{Arithmetic, Grade};
use crate::contract::arrays::{Arrays, array, arrays, rgb, row, rows3, size, values};
use crate::contract::bounded::{Bounded, Running, exact};
use crate::convention::{AlphaCap, AlphaStop, Backdrop, Conventions, OpacitySum, ProductEps};

/// One ray with its errors.
pub(crate) struct Ray {
    alphas: Vec<Bounded>,
    /// d alpha / dx = e^-x; 1 where alpha is given.
    slopes: Vec<Bounded>,
    rgbs: Vec<[Bounded; 3]>,
    /// In front of each sample and, last, behind all: (N + 1).
    transmittance: Vec<Bounded>,
    pub(crate) weights: Vec<Bounded>,
    /// Whether white is behind it, which loses what the sum of all weights gains.
    white: bool,
    /// How many samples' weights are what it hands out for its opacity.
    counted: usize,
}

impl Ray {
    pub(crate) fn of_case(a: &Arrays, r: usize, eps: ProductEps, m: &Arithmetic) -> Ray {
        let deltas: Vec<Bounded> = row(a, "deltas", r).into_iter().map(exact).collect();
        let sigmas: Vec<Bounded> = row(a, "sigmas", r).into_iter().map(exact).collect();
        Ray::from_densities(&sigmas, &deltas, colors(a, r), eps, m)
    }

    /// A ray whose densities, colors and step lengths have errors of their own.
    pub(crate) fn from_densities(
        sigmas: &[Bounded],
        deltas: &[Bounded],
        rgbs: Vec<[Bounded; 3]>,
        eps: ProductEps,
        m: &Arithmetic,
    ) -> Ray {
        let x: Vec<Bounded> =
            sigmas.iter().zip(deltas).map(|(&sigma, &delta)| optical_depth(sigma, delta, m)).collect();
        let slopes: Vec<Bounded> = x.iter().map(|x| m.exp(x.neg())).collect();
        let alpha = |(x, slope): (&Bounded, &Bounded)| match m.grade {
            Grade::A => m.one_minus_exp(*x),
            Grade::B => m.sub(exact(1.0), *slope).or(m.one_minus_exp(*x)),
        };
        let alphas: Vec<Bounded> = x.iter().zip(&slopes).map(alpha).collect();
        let mut transmittance = products(&alphas, eps, m);
        if eps == ProductEps::None {
            // Either form is honest: the exponential of the sum, or the product.
            let mut behind = Running::default();
            for (i, t) in transmittance.iter_mut().enumerate() {
                let depth = behind.sum(m);
                *t = m.exp(m.rounded(depth.y, depth.e).neg()).or(*t).capped(0.0, 1.0);
                x.get(i).iter().for_each(|x| behind.add(**x));
            }
        }
        Ray::new(alphas, slopes, rgbs, transmittance, m)
    }

    fn from_alphas(a: &Arrays, r: usize, c: &Conventions, m: &Arithmetic) -> Ray {
        // A cap is a number that types round.
        let capped = |alpha: f64| c.alpha_cap != AlphaCap::None && alpha == c.alpha_cap.value();
        let one = |alpha| if capped(alpha) { exact(alpha).widened(m.u * alpha) } else { exact(alpha) };
        let alphas: Vec<Bounded> = row(a, "alphas", r).into_iter().map(one).collect();
        let transmittance = products(&alphas, c.product_eps, m);
        let slopes = vec![exact(1.0); alphas.len()];
        Ray::new(alphas, slopes, colors(a, r), transmittance, m)
    }

    fn new(
        alphas: Vec<Bounded>,
        slopes: Vec<Bounded>,
        rgbs: Vec<[Bounded; 3]>,
        transmittance: Vec<Bounded>,
        m: &Arithmetic,
    ) -> Ray {
        let weights: Vec<Bounded> =
            alphas.iter().zip(&transmittance).map(|(&alpha, &t)| m.mul(t, alpha)).collect();
        let counted = weights.len();
        Ray { alphas, slopes, rgbs, transmittance, weights, white: false, counted }
    }

    /// In the conventions of what a ray's opacity is, and of what is behind it.
    fn over(self, c: &Conventions) -> Ray {
        let counted = match c.opacity_sum {
            OpacitySum::All => self.counted,
            OpacitySum::WithoutLast => self.counted.saturating_sub(1),
        };
        Ray { white: c.backdrop == Backdrop::White, counted, ..self }
    }

    /// The outputs: color, opacity, transmittance.
    pub(crate) fn outputs(&self, eps: ProductEps, m: &Arithmetic) -> ([Bounded; 3], Bounded, Bounded) {
        let behind = self.transmittance[self.alphas.len()];
        let color = |k: usize| {
            let colors: Vec<Bounded> = self.rgbs.iter().map(|c| c[k]).collect();
            m.dot(&self.weights, &colors)
        };
        ([color(0), color(1), color(2)], self.opacity(self.counted, eps, m), behind)
    }

    /// The sum of the first weights, or 1 - T: the same over the reals when no eps is added to the factors. Not capped at [0, 1]: an honest
    /// sum of 256 textbook alphas reaches 3 in bf16.
    fn opacity(&self, counted: usize, eps: ProductEps, m: &Arithmetic) -> Bounded {
        let (sum, left) = (m.sum(&self.weights[..counted]), self.transmittance[counted]);
        if eps == ProductEps::None { sum.or(m.sub(exact(1.0), left)) } else { sum }
    }

    /// Errors of g_x (g_alpha times the slope) and of g_rgb.
    fn gradients(&self, g: &Cotangent, eps: ProductEps, m: &Arithmetic) -> (Vec<Bounded>, Vec<[f64; 3]>) {
        let (g_x, g_rgb) = self.gradients_from(&Arriving::exactly(g), eps, m);
        (g_x, g_rgb.iter().map(|g| g.map(|g| g.e)).collect())
    }

    /// g_x and g_rgb from cotangents with errors of their own.
    pub(crate) fn gradients_from(
        &self,
        g: &Arriving,
        eps: ProductEps,
        m: &Arithmetic,
    ) -> (Vec<Bounded>, Vec<[Bounded; 3]>) {
        let n = self.alphas.len();
        let g_w: Vec<Bounded> = (0..n).map(|i| self.weight_gradient(i, g, m)).collect();
        // The absolute values of all terms: the magnitude at which a total minus a prefix sum rounds.
        let all: Vec<Bounded> = (0..n).map(|i| m.mul(self.weights[i], g_w[i])).collect();
        let last = m.mul(self.transmittance[n], g.transmittance);
        let total = m.sum(&[&all[..], &[last]].concat());
        let mut behind = g.transmittance;
        let mut g_x = vec![exact(0.0); n];
        for i in (0..n).rev() {
            // T (g_w - B), each product rounded; or T e^-x g_w minus the suffix sum.
            let inner = m.sub(g_w[i], behind);
            let g_alpha = m.mul(self.transmittance[i], inner);
            let recursive = m.mul(self.slopes[i], g_alpha);
            // The suffix sum, off by the rounding of the total and of the subtraction.
            let through = m.mul(m.mul(self.transmittance[i], self.slopes[i]), g_w[i]);
            let suffix = total.e + m.u * (total.size() + self.transmittance[i].size() * behind.size());
            let subtracted = m.sub(through, exact(through.y - recursive.y).widened(suffix));
            g_x[i] = Bounded { y: recursive.y, e: recursive.e.max(subtracted.e) };
            let passed = m.add(m.sub(exact(1.0), self.alphas[i]), exact(eps.value()));
            behind = m.add(m.mul(self.alphas[i], g_w[i]), m.mul(passed, behind));
        }
        let g_rgb = |w: &Bounded| g.color.map(|g| m.mul(*w, g));
        (g_x, self.weights.iter().map(g_rgb).collect())
    }

    fn weight_gradient(&self, i: usize, g: &Arriving, m: &Arithmetic) -> Bounded {
        let terms: Vec<Bounded> = (0..3).map(|k| m.mul(g.color[k], self.rgbs[i][k])).collect();
        let color = m.sum(&terms);
        let color = m.rounded(color.y, color.e);
        let mut opacity = if i < self.counted { g.opacity } else { exact(0.0) };
        if self.white {
            let lost = m.sum(&g.color);
            opacity = m.sub(opacity, m.rounded(lost.y, lost.e));
        }
        m.add(m.add(color, g.weights[i]), opacity)
    }
}

/// A ray's colors as they are given.
fn colors(a: &Arrays, r: usize) -> Vec<[Bounded; 3]> {
    rows3(a, "rgbs", r).into_iter().map(|c| c.map(exact)).collect()
}

/// Cotangents with errors.
pub(crate) struct Arriving {
    pub color: [Bounded; 3],
    pub weights: Vec<Bounded>,
    pub opacity: Bounded,
    pub transmittance: Bounded,
}

impl Arriving {
    fn exactly(g: &Cotangent) -> Arriving {
        Arriving {
            color: g.color.map(exact),
            weights: g.weights.iter().copied().map(exact).collect(),
            opacity: exact(g.opacity),
            transmittance: exact(g.transmittance),
        }
    }
}

/// How far off T may be in front of each sample of a ray and behind the last one: (N + 1).
pub(crate) fn transmittance(sigmas: &[f64], deltas: &[f64], m: &Arithmetic) -> Vec<f64> {
    let deltas: Vec<Bounded> = deltas.iter().copied().map(exact).collect();
    let rgbs = vec![[exact(0.0); 3]; sigmas.len()];
    let sigmas: Vec<Bounded> = sigmas.iter().copied().map(exact).collect();
    let ray = Ray::from_densities(&sigmas, &deltas, rgbs, ProductEps::None, m);
    ray.transmittance.iter().map(|t| t.e).collect()
}

fn optical_depth(sigma: Bounded, delta: Bounded, m: &Arithmetic) -> Bounded {
    if sigma == exact(0.0) || delta == exact(0.0) { exact(0.0) } else { m.mul(sigma, delta) }
}

/// T_i = prod_{j<i} (1 - alpha_j + eps).
fn products(alphas: &[Bounded], eps: ProductEps, m: &Arithmetic) -> Vec<Bounded> {
    let mut t = vec![exact(1.0)];
    for &alpha in alphas {
        let factor = m.add(m.sub(exact(1.0), alpha), exact(eps.value()));
        t.push(m.mul(t[t.len() - 1], factor).capped(0.0, 1.0 + eps.value()));
    }
    t
}

fn forward(rays: &[Ray], c: &Conventions, m: &Arithmetic) -> Arrays {
    let samples = rays.first().map_or(0, |ray| ray.weights.len());
    let outputs: Vec<_> = rays.iter().map(|ray| ray.outputs(c.product_eps, m)).collect();
    let shown = |ray: &Ray, color: Bounded| match c.backdrop {
        Backdrop::None => color,
        Backdrop::White => m.add(color, m.sub(exact(1.0), ray.opacity(ray.weights.len(), c.product_eps, m))),
    };
    let colors =
        rays.iter().zip(&outputs).flat_map(|(ray, o)| o.0.map(|color| shown(ray, color).e)).collect();
    arrays([
        ("colors", array(&[rays.len(), 3], colors)),
        (
            "weights",
            array(&[rays.len(), samples], rays.iter().flat_map(|r| r.weights.iter().map(|w| w.e)).collect()),
        ),
        ("opacity", array(&[rays.len()], outputs.iter().map(|o| o.1.e).collect())),
        ("transmittance", array(&[rays.len()], outputs.iter().map(|o| o.2.e).collect())),
    ])
}

/// Bound of [`super::volume_render`].
pub(crate) fn volume_render(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let a = &closed(a, c);
    let (rays, _) = size(a, "sigmas");
    let rays: Vec<Ray> = (0..rays).map(|r| Ray::of_case(a, r, c.product_eps, m).over(c)).collect();
    forward(&rays, c, m)
}

/// Bound of [`super::volume_render_alpha`].
pub(crate) fn volume_render_alpha(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    wherever_it_ends(a, c, m, |ends| {
        let (a, c) = (&counted_to(a, c, ends), &Conventions { alpha_stop: AlphaStop::None, ..*c });
        let (rays, _) = size(a, "alphas");
        let rays: Vec<Ray> = (0..rays).map(|r| Ray::from_alphas(a, r, c, m).over(c)).collect();
        (render_alpha(a, c), forward(&rays, c, m))
    })
}

/// The bound where roundings may decide which sample of a ray is the last, as behind two opacities of 0.99: every end that is possible is
/// right, so that it reaches from each to each. `at`: truth and bound where rays end behind so many samples.
fn wherever_it_ends(
    a: &Arrays,
    c: &Conventions,
    m: &Arithmetic,
    at: impl Fn(&[usize]) -> (Arrays, Arrays),
) -> Arrays {
    let (truth, mut widest) = at(&exact_ends(a, c));
    if c.alpha_stop == AlphaStop::None {
        return widest;
    }
    let (rays, samples) = size(a, "alphas");
    let whole = counted_to(a, c, &vec![samples; rays]);
    let possible: Vec<[usize; 2]> = (0..rays).map(|r| possible_ends(&whole, r, c, m)).collect();
    let steps = possible.iter().map(|[early, late]| late - early).max().unwrap_or(0);
    for step in 0..=steps {
        let ends: Vec<usize> = possible.iter().map(|[early, late]| (early + step).min(*late)).collect();
        let (other, bound) = at(&ends);
        for (name, widest) in &mut widest {
            let apart = (&other[name] - &truth[name]).mapv(f64::abs) + &bound[name];
            widest.zip_mut_with(&apart, |widest, apart| *widest = widest.max(*apart));
        }
    }
    widest
}

/// The first and the last number of samples behind which a ray may end. `all`: opacities as they count, none left out at the end.
fn possible_ends(all: &Arrays, r: usize, c: &Conventions, m: &Arithmetic) -> [usize; 2] {
    let light = Ray::from_alphas(all, r, c, m).transmittance;
    let end = |spent: fn(&Bounded) -> bool| light[1..].iter().position(spent).unwrap_or(light.len() - 1);
    [end(|t| t.y - t.e < LEAST_LIGHT), end(|t| t.y + t.e < LEAST_LIGHT)]
}

/// Bound of [`super::backward::volume_render`].
pub(crate) fn volume_render_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let a = &closed(a, c);
    let (rays, samples) = size(a, "sigmas");
    let (mut g_sigmas, mut g_rgbs, mut g_deltas) = (vec![], vec![], vec![]);
    for r in 0..rays {
        let ray = Ray::of_case(a, r, c.product_eps, m).over(c);
        let (g_x, g_rgb) = ray.gradients(&cotangent(a, r), c.product_eps, m);
        g_sigmas.extend(row(a, "deltas", r).iter().zip(&g_x).map(|(&delta, &g)| m.mul(exact(delta), g).e));
        g_deltas.extend(row(a, "sigmas", r).iter().zip(&g_x).map(|(&sigma, &g)| m.mul(exact(sigma), g).e));
        g_rgbs.extend(g_rgb.concat());
    }
    let bounds = arrays([
        ("grad_sigmas", array(&[rays, samples], g_sigmas)),
        ("grad_rgbs", array(&[rays, samples, 3], g_rgbs)),
        ("grad_deltas", array(&[rays, samples], g_deltas)),
    ]);
    gradients_of_densities(a, c, bounds)
}

/// Bound of [`super::backward::volume_render_alpha`].
pub(crate) fn volume_render_alpha_vjp(given: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    wherever_it_ends(given, c, m, |ends| {
        let (a, c) = (&counted_to(given, c, ends), &Conventions { alpha_stop: AlphaStop::None, ..*c });
        let (rays, samples) = size(a, "alphas");
        let (mut g_alphas, mut g_rgbs) = (vec![], vec![]);
        for r in 0..rays {
            let ray = Ray::from_alphas(a, r, c, m).over(c);
            let (g_x, g_rgb) = ray.gradients(&cotangent(a, r), c.product_eps, m);
            g_alphas.extend(g_x.iter().map(|g| g.e));
            g_rgbs.extend(g_rgb.concat());
        }
        let bounds = arrays([
            ("grad_alphas", array(&[rays, samples], g_alphas)),
            ("grad_rgbs", array(&[rays, samples, 3], g_rgbs)),
        ]);
        let [truth, bounds] = [render_alpha_vjp(a, c), bounds].map(|all| gradients_to(given, c, ends, all));
        (truth, bounds)
    })
}

/// Bound of [`super::composite_background`]: C + (1 - A) b, or C + b - A b.
pub(crate) fn composite_background(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (opacity, b) = (values(a, "opacity"), rgb(&values(a, "background")));
    let mut errors = vec![];
    for (r, &opacity) in opacity.iter().enumerate() {
        let color = rows3(a, "colors", r)[0];
        for k in 0..3 {
            let (c, b, opacity) = (exact(color[k]), exact(b[k]), exact(opacity));
            let factored = m.add(c, m.mul(m.sub(exact(1.0), opacity), b));
            let expanded = m.sum(&[c, b, m.mul(opacity, b).neg()]);
            errors.push(factored.or(m.rounded(expanded.y, expanded.e)).e);
        }
    }
    arrays([("colors_out", array(&[opacity.len(), 3], errors))])
}

/// Bound of [`super::backward::composite_background`].
pub(crate) fn composite_background_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (opacity, b) = (values(a, "opacity"), rgb(&values(a, "background")));
    let b: Vec<Bounded> = b.into_iter().map(exact).collect();
    let mut g_opacity = vec![];
    let mut terms = vec![vec![]; 3];
    for (r, &opacity) in opacity.iter().enumerate() {
        let g: Vec<Bounded> = rows3(a, "grad_colors_out", r)[0].into_iter().map(exact).collect();
        let dot = m.dot(&g, &b);
        g_opacity.push(m.rounded(dot.y, dot.e).e);
        for k in 0..3 {
            // Factored, or the gradient of b minus that of the product A b.
            let factored = m.mul(m.sub(exact(1.0), exact(opacity)), g[k]);
            let expanded = m.sub(g[k], m.mul(exact(opacity), g[k]));
            terms[k].push(factored.or(expanded));
        }
    }
    let g_background = terms.iter().map(|terms| m.sum(terms)).map(|g| m.rounded(g.y, g.e).e).collect();
    arrays([
        ("grad_colors", array(&[opacity.len(), 3], vec![0.0; 3 * opacity.len()])),
        ("grad_opacity", array(&[opacity.len()], g_opacity)),
        ("grad_background", array(&[3], g_background)),
    ])
}
