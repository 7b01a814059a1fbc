//! Vector-Jacobian product of the box intersection, by hand.

use super::Hit;

/// Gradients of `enter` and `leave` with respect to `o` and `d`; zeros where the ray misses.
///
/// t = (face - o_a) / d_a on the axis a that determines the end: dt / d o_a = -1 / d_a, dt / d d_a = -t / d_a. Where two axes tie (an
/// edge), the first of them: any choice is a subgradient.
pub fn intersect(o: [f64; 3], d: [f64; 3], low: [f64; 3], high: [f64; 3], g: Hit) -> ([f64; 3], [f64; 3]) {
    let (mut g_o, mut g_d) = ([0.0; 3], [0.0; 3]);
    let Some(hit) = super::intersect(o, d, low, high) else { return (g_o, g_d) };
    for (t, g_t, entering) in [(hit.enter, g.enter, true), (hit.leave, g.leave, false)] {
        let Some(a) = deciding_axis(o, d, low, high, t, entering) else { continue };
        g_o[a] -= g_t / d[a];
        g_d[a] -= g_t * t / d[a];
    }
    (g_o, g_d)
}

/// The same for [`super::between`]: an end that `near` or `far` determines has no gradient, nor has a ray that misses.
pub fn between(
    o: [f64; 3],
    d: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
    range: [f64; 2],
    g: Hit,
) -> ([f64; 3], [f64; 3]) {
    let (Some(line), Some(_)) =
        (super::intersect(o, d, low, high), super::between(o, d, low, high, range[0], range[1]))
    else {
        return ([0.0; 3], [0.0; 3]);
    };
    let enter = if line.enter > range[0] { g.enter } else { 0.0 };
    let leave = if line.leave < range[1] { g.leave } else { 0.0 };
    intersect(o, d, low, high, Hit { enter, leave })
}

/// The first axis whose face lies at `t`.
fn deciding_axis(
    o: [f64; 3],
    d: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
    t: f64,
    entering: bool,
) -> Option<usize> {
    (0..3).find(|&a| {
        let face = if d[a].is_sign_positive() == entering { low[a] } else { high[a] };
        d[a] != 0.0 && (face - o[a]) / d[a] == t
    })
}
