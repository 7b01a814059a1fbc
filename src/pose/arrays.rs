//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{backward, from_colmap};
use crate::camera::arrays::{flat, pose};
use crate::contract::arrays::{Arrays, array, arrays, threes, values};
use crate::convention::Conventions;

/// A quaternion and a translation.
pub(crate) type Written = ([f64; 4], [f64; 3]);

/// The poses of a case, as they are written.
pub(crate) fn written(a: &Arrays) -> Vec<Written> {
    let q = values(a, "q");
    q.chunks_exact(4).map(|q| [q[0], q[1], q[2], q[3]]).zip(threes(a, "t")).collect()
}

/// `f(q, t)` of each picture, as 16 row-major entries.
pub(crate) fn forward(a: &Arrays, f: impl Fn(Written) -> [f64; 16]) -> Arrays {
    let poses = written(a);
    arrays([("c2w", array(&[poses.len(), 4, 4], poses.into_iter().flat_map(f).collect()))])
}

/// `f((q, t), g_c2w)` of each picture, as the gradients.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(Written, [f64; 16]) -> Written) -> Arrays {
    let g = values(a, "grad_c2w");
    let g = g.chunks_exact(16).map(|g| std::array::from_fn(|n| g[n]));
    let gradients: Vec<Written> = written(a).into_iter().zip(g).map(|(written, g)| f(written, g)).collect();
    let m = gradients.len();
    arrays([
        ("grad_q", array(&[m, 4], gradients.iter().flat_map(|g| g.0).collect())),
        ("grad_t", array(&[m, 3], gradients.iter().flat_map(|g| g.1).collect())),
    ])
}

pub(super) fn pose_from_colmap(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |(q, t)| flat(&from_colmap(q, t, c.axes, c.quaternion)))
}

pub(super) fn pose_from_colmap_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |(q, t), g| backward::from_colmap(q, t, c.axes, c.quaternion, &pose(&g, 0)))
}
