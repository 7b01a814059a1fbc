//! Where a ray enters and leaves an axis-aligned box.
//!
//! The slab method (Kay and Kajiya 1986): a box is the intersection of three slabs, a ray's part inside it the intersection of its
//! parts inside the slabs. Letters: `o` origin, `d` direction, `t` distance along it.

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// The interval of t in which a ray is inside a slab or a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// t of entry; below 0 where the origin is inside or beyond.
    pub enter: f64,
    /// t of exit.
    pub leave: f64,
}

/// The t with low <= o + t d <= high along one axis: all of the line, or none of it, where d is 0.
fn slab(o: f64, d: f64, low: f64, high: f64) -> Option<Hit> {
    if d == 0.0 {
        let inside = low <= o && o <= high;
        return inside.then_some(Hit { enter: f64::NEG_INFINITY, leave: f64::INFINITY });
    }
    let (a, b) = ((low - o) / d, (high - o) / d);
    Some(if d.is_sign_positive() { Hit { enter: a, leave: b } } else { Hit { enter: b, leave: a } })
}

/// Where the line o + t d meets the closed box [low, high]; `None` if it misses.
///
/// # Convention
/// The box is closed: a ray that lies in a face (CG1, where `0 * inf` gives other codes NaN) or touches an edge meets the box. `t` isn't
/// clipped at 0: `enter` < 0 says that the origin is inside (or the box behind, where `leave` < 0 too). A direction of 0 along an axis is
/// a case of its own, not a division by a small number (CG2).
///
/// ```
/// use nerf_oracle::ray_aabb::{Hit, intersect};
/// let hit = |o, d| intersect(o, d, [0.0; 3], [1.0; 3]);
/// assert_eq!(hit([0.5, 0.5, -1.0], [0.0, 0.0, 2.0]), Some(Hit { enter: 0.5, leave: 1.0 }));
/// assert_eq!(hit([0.0, 0.5, -1.0], [0.0, 0.0, 1.0]), Some(Hit { enter: 1.0, leave: 2.0 })); // in a face
/// assert_eq!(hit([1.5, 0.5, -1.0], [0.0, 0.0, 1.0]), None);
/// ```
pub fn intersect(o: [f64; 3], d: [f64; 3], low: [f64; 3], high: [f64; 3]) -> Option<Hit> {
    let mut hit = Hit { enter: f64::NEG_INFINITY, leave: f64::INFINITY };
    for a in 0..3 {
        let slab = slab(o[a], d[a], low[a], high[a])?;
        hit = Hit { enter: hit.enter.max(slab.enter), leave: hit.leave.min(slab.leave) };
    }
    (hit.enter <= hit.leave).then_some(hit)
}

/// The part of [`intersect`]'s interval that lies in [near, far]; `None` if it is empty: the box is missed, behind `near` or
/// beyond `far`.
///
/// ```
/// use nerf_oracle::ray_aabb::{Hit, between};
/// let hit = |near, far| between([0.5, 0.5, -1.0], [0.0, 0.0, 1.0], [0.0; 3], [1.0; 3], near, far);
/// assert_eq!(hit(1.25, 6.0), Some(Hit { enter: 1.25, leave: 2.0 }));
/// assert_eq!(hit(2.5, 6.0), None);
/// ```
pub fn between(o: [f64; 3], d: [f64; 3], low: [f64; 3], high: [f64; 3], near: f64, far: f64) -> Option<Hit> {
    let line = intersect(o, d, low, high)?;
    let hit = Hit { enter: line.enter.max(near), leave: line.leave.min(far) };
    (hit.enter <= hit.leave).then_some(hit)
}
