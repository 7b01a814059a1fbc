//! Error bounds of rays, in running error analysis.
//!
//! Grade A covers d = R K^-1 (u, v, 1) / norm with the matrices applied one after the other or multiplied first, K inverted or
//! written out, division by the norm or multiplication with its reciprocal, before the rotation too where the pose is a rotation as
//! nearly as its type can tell; grade B the textbook's (x_w - o) / |x_w - o| at depth 1 too.

use super::arrays::{picture, positions};
use crate::camera::arrays::rows34;
use crate::camera::bound::{Axis, Gather, any_order, hyper, pose_errors, rotate_transposed};
use crate::contract::arithmetic::{Arithmetic, Grade};
use crate::contract::arrays::{Arrays, array, arrays, threes, twos, values};
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Axes, Conventions, Directions};

type Vector = [Bounded; 3];

/// The intermediate values of one ray, from pixel to world space.
struct RayDirection {
    /// What R is applied to: in camera space, in the axes of the pose.
    camera: Vector,
    /// What is divided, over its length: in world space, or `camera`.
    unit: Vector,
    /// That length, 1 where nothing is divided.
    norm: Bounded,
    /// In world space.
    d: Vector,
}

impl RayDirection {
    fn new(
        lens: &[Axis; 2],
        rows: &[[f64; 4]; 3],
        uv: [Bounded; 2],
        c: &Conventions,
        m: &Arithmetic,
    ) -> Self {
        let one = exact(1.0);
        let mut camera = [lens[0].point(uv[0], one, m), lens[1].point(uv[1], one, m), one];
        let mut terms = vec![];
        for k in 0..2 {
            terms.extend(lens[k].terms(uv[k], one, m).map(|term| (k, term)));
        }
        terms.push((2, one));
        let sign = |k: usize, x: Bounded| if k > 0 && c.axes == Axes::Opengl { x.neg() } else { x };
        (1..3).for_each(|k| camera[k] = sign(k, camera[k]));
        if c.directions == Directions::UnitInCamera {
            let (unit, norm) = divided(camera, m);
            let d = rows.map(|row| {
                let terms: Vector = std::array::from_fn(|k| m.mul(exact(row[k]), unit[k]));
                any_order(&terms, m).or(textbook(&terms, row[3], m))
            });
            return RayDirection { camera: unit, unit, norm, d };
        }
        let r = rows.map(|row| {
            let along = |(k, x): (usize, Bounded)| m.mul(exact(row[k]), x);
            let rotated =
                any_order(&[along((0, camera[0])), along((1, camera[1])), along((2, camera[2]))], m);
            // R K^-1 multiplied first.
            let expanded: Vec<Bounded> = terms.iter().map(|&(k, x)| along((k, sign(k, x)))).collect();
            rotated.or(any_order(&expanded, m)).or(textbook(&expanded, row[3], m))
        });
        if c.directions == Directions::Depth {
            return RayDirection { camera, unit: r, norm: one, d: r };
        }
        let (unit, norm) = divided(r, m);
        let mut d = unit;
        if rigid(rows, m) {
            let before = Conventions { directions: Directions::UnitInCamera, ..*c };
            let other = RayDirection::new(lens, rows, uv, &before, m).d;
            d = std::array::from_fn(|k| d[k].or(other[k].widened((other[k].y - d[k].y).abs())));
        }
        RayDirection { camera, unit, norm, d }
    }

    /// The gradient of what was divided, where g is that of the quotient `unit`: (g - unit (unit . g)) / norm, as one quotient or as
    /// the difference of two.
    fn across(&self, g: Vector, m: &Arithmetic) -> Vector {
        let along: [Bounded; 3] = std::array::from_fn(|k| m.mul(self.unit[k], g[k]));
        let along = any_order(&along, m);
        std::array::from_fn(|k| {
            let quotient = m.div(m.sub(g[k], m.mul(self.unit[k], along)), self.norm);
            // r (r . g) / |r|^3, or autograd's sum of g (r / |r|) / |r|: two roundings more.
            let second = m.mul(self.unit[k], m.div(along, self.norm));
            let second = second.widened(2.0 * m.u * second.size());
            quotient.or(m.sub(m.div(g[k], self.norm), second))
        })
    }
}

/// r / |r|, by division or by the reciprocal, and |r|.
fn divided(r: Vector, m: &Arithmetic) -> (Vector, Bounded) {
    let norm = m.sqrt(any_order(&r.map(|r| m.mul(r, r)), m));
    (r.map(|r| m.div(r, norm).or(m.mul(r, m.div(exact(1.0), norm)))), norm)
}

/// Whether the columns are orthonormal but for roundings: entries made of a quaternion in this type are off by up to 4 u each, a product
/// of two columns by twice as much, and its own sum.
fn rigid(rows: &[[f64; 4]; 3], m: &Arithmetic) -> bool {
    let product = |i: usize, j: usize| rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
    let off = |i: usize, j: usize| (product(i, j) - if i == j { 1.0 } else { 0.0 }).abs();
    (0..3).all(|i| (i..3).all(|j| off(i, j) <= 16.0 * m.u))
}

/// x_w - o, where the grade allows it.
fn textbook(terms: &[Bounded], o: f64, m: &Arithmetic) -> Bounded {
    let o = exact(o);
    match m.grade {
        Grade::A => any_order(terms, m),
        Grade::B => m.sub(any_order(&[terms, &[o]].concat(), m), o),
    }
}

/// Bound of [`super::pixel_to_ray`]. The origin is passed through unchanged.
pub(crate) fn pixel_to_ray(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (lens, c2w, uv) = (Axis::of(&values(a, "K")), values(a, "c2w"), twos(a, "uv"));
    let direction =
        |n: usize| RayDirection::new(&lens, &rows34(&c2w, n), uv[n].map(exact), c, m).d.map(|d| d.e);
    arrays([
        ("rays_o", array(&[uv.len(), 3], vec![0.0; 3 * uv.len()])),
        ("rays_d", array(&[uv.len(), 3], (0..uv.len()).flat_map(direction).collect())),
    ])
}

/// Bound of [`super::backward::pixel_to_ray`]. In the textbook form the gradient of the translation also sums the parts through x_w and
/// -o, which cancel.
pub(crate) fn pixel_to_ray_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (lens, c2w, uv) = (Axis::of(&values(a, "K")), values(a, "c2w"), twos(a, "uv"));
    let (g_o, g_d) = (threes(a, "grad_rays_o"), threes(a, "grad_rays_d"));
    let (mut gather, mut g_c2w, mut g_uv) = (Gather::default(), vec![], vec![]);
    for n in 0..uv.len() {
        let rows = rows34(&c2w, n);
        let ray = RayDirection::new(&lens, &rows, uv[n].map(exact), c, m);
        let g_d = g_d[n].map(exact);
        let g_r = if c.directions == Directions::Unit { ray.across(g_d, m) } else { g_d };
        let translation = |k: usize| match m.grade {
            Grade::A => 0.0,
            Grade::B => any_order(&[exact(g_o[n][k]), exact(g_r[k].size()), exact(-g_r[k].size())], m).e,
        };
        g_c2w.extend(pose_errors(g_r, ray.camera, std::array::from_fn(translation), m));
        let mut g_camera = rotate_transposed(&rows, g_r, m);
        if c.directions == Directions::UnitInCamera {
            g_camera = ray.across(g_camera, m);
        }
        let [x, y, z] = g_camera;
        let g_camera = if c.axes == Axes::Opengl { [x, y.neg(), z.neg()] } else { [x, y, z] };
        g_uv.extend(gather.pixel(&lens, uv[n], 1.0, g_camera, m).0);
    }
    arrays([
        ("grad_K", gather.k(m)),
        ("grad_c2w", array(&[uv.len(), 4, 4], g_c2w)),
        ("grad_uv", array(&[uv.len(), 2], g_uv)),
    ])
}

/// Bound of the rays of a picture: focal length and center are rounded to the type, pixel centers are exact.
pub(crate) fn image_rays(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (height, width, k, _) = picture(a);
    let rows = rows34(&values(a, "c2w"), 0);
    let axis = |f: f64, c: f64| Axis { f: hyper(f, m), c: hyper(c, m) };
    let lens = [axis(k.fx, k.cx), axis(k.fy, k.cy)];
    let uv: Vec<[Bounded; 2]> = positions(a, c).iter().map(|uv| uv.to_array().map(|x| hyper(x, m))).collect();
    let d = uv.iter().flat_map(|&uv| RayDirection::new(&lens, &rows, uv, c, m).d.map(|d| d.e)).collect();
    arrays([
        ("uv", array(&[height, width, 2], uv.concat().iter().map(|x| x.e).collect())),
        ("rays_o", array(&[height, width, 3], vec![0.0; 3 * height * width])),
        ("rays_d", array(&[height, width, 3], d)),
    ])
}
