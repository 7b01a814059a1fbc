//! Honest distortion losses in emulated arithmetic: all pairs (stable), or running sums (textbook), with or without what is at i.

use super::arrays::{forward, vjp};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// Middles and lengths of the intervals.
fn intervals(t: &[f64], m: &Machine) -> (Vec<f64>, Vec<f64>) {
    let middle = t.windows(2).map(|ends| m.div(m.add(ends[0], ends[1]), 2.0)).collect();
    (middle, t.windows(2).map(|ends| m.sub(ends[1], ends[0])).collect())
}

/// sum_j w_j |m_i - m_j|.
fn apart(i: usize, weights: &[f64], middle: &[f64], m: &Machine) -> f64 {
    let distances: Vec<f64> = middle.iter().map(|other| m.sub(middle[i], *other).abs()).collect();
    m.dot(weights, &distances)
}

/// m_i sum_{j<i} w_j - sum_{j<i} w_j m_j, with or without j = i.
fn in_front(i: usize, weights: &[f64], middle: &[f64], m: &Machine) -> f64 {
    let end = i + (m.form % 2) as usize;
    m.sub(m.mul(middle[i], m.sum(&weights[..end])), m.dot(&weights[..end], &middle[..end]))
}

/// w^2 delta / 3.
fn own(w: f64, length: f64, m: &Machine) -> f64 {
    if m.form % 2 == 0 {
        m.div(m.mul(m.mul(w, w), length), 3.0)
    } else {
        m.mul(m.mul(m.div(1.0, 3.0), length), m.mul(w, w))
    }
}

/// The loss.
pub(crate) fn distortion(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    forward(a, |weights, t| {
        let (middle, length) = intervals(t, m);
        let all = 0..weights.len();
        let own: Vec<f64> = all.clone().map(|i| own(weights[i], length[i], m)).collect();
        let inner = |i: usize| {
            if m.stable { apart(i, weights, &middle, m) } else { in_front(i, weights, &middle, m) }
        };
        let between = m.dot(weights, &all.map(inner).collect::<Vec<_>>());
        m.add(if m.stable { between } else { m.mul(2.0, between) }, m.sum(&own))
    })
}

/// The gradient of a middle, halved: w_i sum_j w_j sign(m_i - m_j), or by what is in front and behind.
fn ahead(i: usize, weights: &[f64], middle: &[f64], m: &Machine) -> f64 {
    let sign = |j: usize| match middle[i].partial_cmp(&middle[j]) {
        _ if !m.stable => f64::from(i32::from(j < i) - i32::from(j > i)),
        Some(std::cmp::Ordering::Greater) => 1.0,
        Some(std::cmp::Ordering::Less) => -1.0,
        _ => 0.0,
    };
    let signs: Vec<f64> = (0..weights.len()).map(sign).collect();
    m.mul(weights[i], m.dot(weights, &signs))
}

/// Its gradients.
pub(crate) fn distortion_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |weights, t, g| {
        let (n, (middle, length)) = (weights.len(), intervals(t, m));
        let third = m.div(1.0, 3.0);
        let (mut g_weights, mut parts) = (vec![], vec![vec![]; n + 1]);
        for i in 0..n {
            let inner = if m.stable {
                apart(i, weights, &middle, m)
            } else {
                let weight = m.sum(&weights[i + 1..]);
                let behind = m.sub(m.dot(&weights[i + 1..], &middle[i + 1..]), m.mul(middle[i], weight));
                m.add(in_front(i, weights, &middle, m), behind)
            };
            let own = m.mul(m.mul(2.0, third), m.mul(weights[i], length[i]));
            g_weights.push(m.mul(g, m.add(m.mul(2.0, inner), own)));
            let of_middle = m.mul(g, ahead(i, weights, &middle, m));
            let of_length = m.mul(g, m.mul(third, m.mul(weights[i], weights[i])));
            parts[i].extend([of_middle, -of_length]);
            parts[i + 1].extend([of_middle, of_length]);
        }
        (g_weights, parts.iter().map(|parts| m.sum(parts)).collect())
    })
}
