//! Honest implementations of volume rendering in emulated arithmetic: what the bound must never reject.

use super::Rendering;
use super::arrays::{closed, cotangent, counted_to, ends, gradients_of_densities, gradients_to, renderings};
use super::backward::Cotangent;
use crate::contract::arrays::{Arrays, array, arrays, number, rgb, row, rows3, size, values};
use crate::contract::machine::Machine;
use crate::convention::{Backdrop, Conventions, Depth, EmptyDepth, OpacitySum, ProductEps};

fn alphas(x: &[f64], m: &Machine) -> Vec<f64> {
    x.iter().map(|&x| if m.stable { -m.expm1(-x) } else { m.sub(1.0, m.exp(-x)) }).collect()
}

fn optical_depths(a: &Arrays, r: usize, m: &Machine) -> Vec<f64> {
    row(a, "sigmas", r).iter().zip(row(a, "deltas", r)).map(|(&sigma, delta)| m.mul(sigma, delta)).collect()
}

fn products(alphas: &[f64], eps: ProductEps, m: &Machine) -> Vec<f64> {
    let factors: Vec<f64> = alphas.iter().map(|&a| m.add(m.sub(1.0, a), eps.value())).collect();
    m.cumulative_product(&factors)
}

/// Form 0: exponential of a cumulative sum; 1: cumulative product.
fn transmittance(x: &[f64], alphas: &[f64], eps: ProductEps, m: &Machine) -> Vec<f64> {
    if m.form % 2 == 0 && eps == ProductEps::None {
        m.cumulative_sum(x).iter().map(|&depth| m.exp(-depth)).collect()
    } else {
        products(alphas, eps, m)
    }
}

/// How many of n samples' weights are a ray's opacity.
fn counted_of(n: usize, c: &Conventions) -> usize {
    if c.opacity_sum == OpacitySum::All { n } else { n.saturating_sub(1) }
}

/// Opacity is the sum of the weights, or 1 - T where no eps is added to the factors of T. White shows through what all weights leave.
fn composite(
    alphas: &[f64],
    rgbs: &[[f64; 3]],
    transmittance: Vec<f64>,
    c: &Conventions,
    m: &Machine,
) -> Rendering {
    let weights: Vec<f64> = alphas.iter().zip(&transmittance).map(|(&a, &t)| m.mul(t, a)).collect();
    let mut color = std::array::from_fn(|k| m.dot(&weights, &rgbs.iter().map(|c| c[k]).collect::<Vec<_>>()));
    let opacity = |counted: usize| {
        if m.form % 3 == 2 && c.product_eps == ProductEps::None {
            m.sub(1.0, transmittance[counted])
        } else {
            m.sum(&weights[..counted])
        }
    };
    if c.backdrop == Backdrop::White {
        let left = m.sub(1.0, opacity(weights.len()));
        color = color.map(|color| m.add(color, left));
    }
    let opacity = opacity(counted_of(weights.len(), c));
    Rendering { color, weights, transmittance, opacity }
}

fn render_ray(a: &Arrays, r: usize, c: &Conventions, m: &Machine) -> Rendering {
    let x = optical_depths(a, r, m);
    let alphas = alphas(&x, m);
    let t = transmittance(&x, &alphas, c.product_eps, m);
    composite(&alphas, &rows3(a, "rgbs", r), t, c, m)
}

fn render_ray_alpha(a: &Arrays, r: usize, c: &Conventions, m: &Machine) -> Rendering {
    let alphas: Vec<f64> = row(a, "alphas", r).into_iter().map(|alpha| m.round(alpha)).collect();
    let t = products(&alphas, c.product_eps, m);
    composite(&alphas, &rows3(a, "rgbs", r), t, c, m)
}

/// Rendering from densities.
pub(crate) fn volume_render(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let a = &closed(a, c);
    let (rays, samples) = size(a, "sigmas");
    renderings(samples, &(0..rays).map(|r| render_ray(a, r, c, m)).collect::<Vec<_>>())
}

/// Rendering from opacities.
pub(crate) fn volume_render_alpha(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let a = &counted_to(a, c, &ends(a, c, |light, alpha| passed(m, light, alpha)));
    let (rays, samples) = size(a, "alphas");
    renderings(samples, &(0..rays).map(|r| render_ray_alpha(a, r, c, m)).collect::<Vec<_>>())
}

/// g_alpha by recursion from the last sample (form 0), by suffix sums (1), or as total minus prefix, as instant-ngp does (2).
fn gradients(
    alphas: &[f64],
    rgbs: &[[f64; 3]],
    slopes: &[f64],
    f: &Rendering,
    g: &Cotangent,
    c: &Conventions,
    m: &Machine,
) -> Vec<f64> {
    let n = alphas.len();
    let eps = c.product_eps.value();
    let on_opacity = |i: usize| {
        let own = if i < counted_of(n, c) { g.opacity } else { 0.0 };
        if c.backdrop == Backdrop::White { m.sub(own, m.sum(&g.color)) } else { own }
    };
    let g_w: Vec<f64> =
        (0..n).map(|i| m.add(m.add(m.dot(&g.color, &rgbs[i]), g.weights[i]), on_opacity(i))).collect();
    if m.form % 3 == 0 || slopes.iter().all(|&s| s == 1.0) || eps != 0.0 {
        let mut behind = g.transmittance;
        let mut g_x = vec![0.0; n];
        for i in (0..n).rev() {
            g_x[i] = m.mul(slopes[i], m.mul(f.transmittance[i], m.sub(g_w[i], behind)));
            let passed = m.mul(m.add(m.sub(1.0, alphas[i]), eps), behind);
            behind = m.add(m.mul(alphas[i], g_w[i]), passed);
        }
        return g_x;
    }
    let mut terms: Vec<f64> = (0..n).map(|i| m.mul(f.weights[i], g_w[i])).collect();
    terms.push(m.mul(f.transmittance[n], g.transmittance));
    let total = m.sum(&terms);
    let suffix = |i: usize| {
        if m.form % 3 == 1 { m.sum(&terms[i + 1..]) } else { m.sub(total, m.sum(&terms[..=i])) }
    };
    (0..n).map(|i| m.sub(m.mul(m.mul(f.transmittance[i], slopes[i]), g_w[i]), suffix(i))).collect()
}

/// Gradient of rendering from densities.
pub(crate) fn volume_render_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let a = &closed(a, c);
    let (rays, samples) = size(a, "sigmas");
    let (mut g_sigmas, mut g_rgbs, mut g_deltas) = (vec![], vec![], vec![]);
    for r in 0..rays {
        let x = optical_depths(a, r, m);
        let slopes: Vec<f64> = x.iter().map(|&x| m.exp(-x)).collect();
        let (f, g) = (render_ray(a, r, c, m), cotangent(a, r));
        let g_x = gradients(&alphas(&x, m), &rows3(a, "rgbs", r), &slopes, &f, &g, c, m);
        g_sigmas.extend(row(a, "deltas", r).iter().zip(&g_x).map(|(&delta, &g)| m.mul(delta, g)));
        g_deltas.extend(row(a, "sigmas", r).iter().zip(&g_x).map(|(&sigma, &g)| m.mul(sigma, g)));
        g_rgbs.extend(f.weights.iter().flat_map(|&w| g.color.map(|g| m.mul(w, g))));
    }
    let gradients = arrays([
        ("grad_sigmas", array(&[rays, samples], g_sigmas)),
        ("grad_rgbs", array(&[rays, samples, 3], g_rgbs)),
        ("grad_deltas", array(&[rays, samples], g_deltas)),
    ]);
    gradients_of_densities(a, c, gradients)
}

/// Gradient of rendering from opacities.
pub(crate) fn volume_render_alpha_vjp(given: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let ends = ends(given, c, |light, alpha| passed(m, light, alpha));
    let a = &counted_to(given, c, &ends);
    let (rays, samples) = size(a, "alphas");
    let (mut g_alphas, mut g_rgbs) = (vec![], vec![]);
    for r in 0..rays {
        let (f, g) = (render_ray_alpha(a, r, c, m), cotangent(a, r));
        let slopes = vec![1.0; samples];
        let alphas: Vec<f64> = row(a, "alphas", r).into_iter().map(|alpha| m.round(alpha)).collect();
        g_alphas.extend(gradients(&alphas, &rows3(a, "rgbs", r), &slopes, &f, &g, c, m));
        g_rgbs.extend(f.weights.iter().flat_map(|&w| g.color.map(|g| m.mul(w, g))));
    }
    let gradients = arrays([
        ("grad_alphas", array(&[rays, samples], g_alphas)),
        ("grad_rgbs", array(&[rays, samples, 3], g_rgbs)),
    ]);
    gradients_to(given, c, &ends, gradients)
}

/// The light behind a sample.
fn passed(m: &Machine, light: f64, alpha: f64) -> f64 {
    m.mul(light, m.sub(1.0, m.round(alpha)))
}

/// C + (1 - A) b, or C + b - A b.
pub(crate) fn composite_background(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (opacity, b) = (values(a, "opacity"), rgb(&values(a, "background")));
    let mut out = vec![];
    for (r, &opacity) in opacity.iter().enumerate() {
        let c = rows3(a, "colors", r)[0];
        for k in 0..3 {
            out.push(match m.form % 2 {
                0 => m.add(c[k], m.mul(m.sub(1.0, opacity), b[k])),
                _ => m.sub(m.add(c[k], b[k]), m.mul(opacity, b[k])),
            });
        }
    }
    arrays([("colors_out", array(&[opacity.len(), 3], out))])
}

/// Gradient of the background.
pub(crate) fn composite_background_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (opacity, b) = (values(a, "opacity"), rgb(&values(a, "background")));
    let rays = opacity.len();
    let g: Vec<[f64; 3]> = (0..rays).map(|r| rows3(a, "grad_colors_out", r)[0]).collect();
    let passed = |r: usize, k: usize| match m.form % 2 {
        0 => m.mul(m.sub(1.0, opacity[r]), g[r][k]),
        _ => m.sub(g[r][k], m.mul(opacity[r], g[r][k])),
    };
    let g_b = (0..3).map(|k| m.sum(&(0..rays).map(|r| passed(r, k)).collect::<Vec<_>>())).collect();
    arrays([
        ("grad_colors", array(&[rays, 3], g.concat())),
        ("grad_opacity", array(&[rays], g.iter().map(|g| -m.dot(g, &b)).collect())),
        ("grad_background", array(&[3], g_b)),
    ])
}

/// A, or by convention A kept from 0: at least 1e-12, or 1e-7 more.
fn beside(opacity: f64, c: &Conventions, m: &Machine) -> f64 {
    match c.empty_depth {
        EmptyDepth::Far => opacity,
        _ if m.form % 2 == 0 => opacity.max(1e-12),
        _ => m.add(opacity, m.round(1e-7)),
    }
}

/// Sum of w t over sum of w, or the sum of normalized weights times t.
pub(crate) fn depth(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (rays, _) = size(a, "weights");
    let ray = |r: usize| {
        let (w, t) = (row(a, "weights", r), row(a, "t", r));
        let opacity = beside(m.sum(&w), c, m);
        match c.depth {
            Depth::Plain => m.dot(&w, &t),
            Depth::FarBehind => {
                let (far, opacity) = (m.round(number(a, "far")), m.sum(&w));
                match m.form % 3 {
                    0 => m.add(m.dot(&w, &t), m.mul(m.sub(1.0, opacity), far)),
                    1 => m.sub(m.add(m.dot(&w, &t), far), m.mul(opacity, far)),
                    // One more sample.
                    _ => m.dot(&[&w[..], &[m.sub(1.0, opacity)]].concat(), &[&t[..], &[far]].concat()),
                }
            }
            Depth::Divided if w.iter().all(|&w| w == 0.0) => match c.empty_depth {
                EmptyDepth::Far => m.round(number(a, "far")),
                EmptyDepth::Zero => m.div(0.0, opacity),
                EmptyDepth::First => t[0],
                EmptyDepth::Last => t[t.len() - 1],
            },
            Depth::Divided if m.form % 2 == 0 => m.div(m.dot(&w, &t), opacity),
            Depth::Divided => m.dot(&w.iter().map(|&w| m.div(w, opacity)).collect::<Vec<_>>(), &t),
        }
    };
    arrays([("depth", array(&[rays], (0..rays).map(ray).collect()))])
}

/// Gradient of the expected distance.
pub(crate) fn depth_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (rays, samples) = size(a, "weights");
    let (mut g_weights, mut g_t) = (vec![], vec![]);
    let far = m.round(number(a, "far"));
    for (r, g) in values(a, "grad_depth").into_iter().enumerate() {
        let (w, t) = (row(a, "weights", r), row(a, "t", r));
        let (weighted, opacity) = (m.dot(&w, &t), beside(m.sum(&w), c, m));
        for i in 0..samples {
            let (on_w, on_t) = match c.depth {
                Depth::Plain => (m.mul(g, t[i]), m.mul(g, w[i])),
                Depth::FarBehind if m.form % 2 == 0 => (m.mul(g, m.sub(t[i], far)), m.mul(g, w[i])),
                Depth::FarBehind => (m.sub(m.mul(g, t[i]), m.mul(g, far)), m.mul(g, w[i])),
                Depth::Divided if w.iter().all(|&w| w == 0.0) => (0.0, 0.0),
                Depth::Divided if m.form % 2 == 0 => {
                    let centered = m.sub(t[i], m.div(weighted, opacity));
                    (m.div(m.mul(g, centered), opacity), m.div(m.mul(g, w[i]), opacity))
                }
                Depth::Divided => {
                    let square = m.mul(opacity, opacity);
                    let scaled = m.div(g, opacity);
                    (m.sub(m.mul(scaled, t[i]), m.div(m.mul(g, weighted), square)), m.mul(scaled, w[i]))
                }
            };
            g_weights.push(on_w);
            g_t.push(on_t);
        }
    }
    arrays([("grad_weights", array(&[rays, samples], g_weights)), ("grad_t", array(&[rays, samples], g_t))])
}
