//! Error bounds of the fisheye: the formulas once more, in running error analysis.
//!
//! Covered: the angle by `atan` or `atan2`, powers or Horner's scheme, quotient or factor; gradients by the two stretches, or as the chain
//! rule has them, where the difference of both stretches cancels. An inverse is as good as the residual that its arithmetic sees (see
//! [`crate::lens`]).

use super::arrays::{coefficients, undistorted};
use super::bent;
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::Conventions;
use crate::lens::arrays::{Pair, forward, vjp};

/// |x|, as the root of a sum of squares.
fn length(x: [Bounded; 2], m: &Arithmetic) -> Bounded {
    let squares = m.any_order(&x.map(|x| m.mul(x, x)));
    m.sqrt(m.rounded(squares.y, squares.e))
}

/// The angle of a slope: atan is flatter than the identity.
fn angle(r: Bounded, m: &Arithmetic) -> Bounded {
    m.elementary(libm::atan(r.y), r.e)
}

/// The tangent of an angle, whose slope is 1 + tan^2 at the far end of the error.
fn tangent(theta: Bounded, m: &Arithmetic) -> Bounded {
    let y = libm::tan(theta.y);
    let far = theta.y + theta.e;
    let e = if far < std::f64::consts::FRAC_PI_2 { libm::tan(far) - y } else { f64::INFINITY };
    m.elementary(y, e)
}

/// The sum of these coefficients times even powers of theta, 1 the first: theta_d / theta, or the slope of theta_d.
fn polynomial(k: [Bounded; 4], theta: Bounded, m: &Arithmetic) -> Bounded {
    let t2 = m.mul(theta, theta);
    let t4 = m.mul(t2, t2);
    let powers = [t2, t4, m.mul(t4, t2), m.mul(t4, t4)];
    let [a, b, c, d] = [0, 1, 2, 3].map(|n| m.mul(k[n], powers[n]));
    m.any_order(&[exact(1.0), a, b, c, d])
}

fn bent_bounded(k: [f64; 4], theta: Bounded, m: &Arithmetic) -> Bounded {
    m.mul(theta, polynomial(k.map(exact), theta, m))
}

/// A point's two stretches, its direction, and the odd powers of its angle.
struct Point {
    u: [Bounded; 2],
    along: Bounded,
    across: Bounded,
    powers: [Bounded; 4],
}

impl Point {
    fn new(k: [f64; 4], p: [Bounded; 2], m: &Arithmetic) -> Point {
        let r = length(p, m);
        let theta = angle(r, m);
        let steep = [3.0, 5.0, 7.0, 9.0];
        let slope = polynomial([0, 1, 2, 3].map(|n| m.mul(exact(steep[n]), exact(k[n]))), theta, m);
        let squares = m.any_order(&[exact(1.0), m.mul(r, r)]);
        let t2 = m.mul(theta, theta);
        let t3 = m.mul(theta, t2);
        let t5 = m.mul(t3, t2);
        let t7 = m.mul(t5, t2);
        Point {
            u: p.map(|x| m.div(x, r)),
            along: m.div(slope, squares),
            across: m.div(bent_bounded(k, theta, m), r),
            powers: [t3, t5, t7, m.mul(t7, t2)],
        }
    }

    /// a (u . g) u + b (g - (u . g) u): expanded, so that what cancels is covered.
    fn stretched(&self, a: Bounded, b: Bounded, g: [f64; 2], m: &Arithmetic) -> [Bounded; 2] {
        [0, 1].map(|j| {
            let terms: Vec<Bounded> = (0..2)
                .flat_map(|i| {
                    let share = m.mul(m.mul(exact(g[i]), self.u[i]), self.u[j]);
                    [m.mul(a, share), m.mul(b, share).neg()]
                })
                .chain([m.mul(b, exact(g[j]))])
                .collect();
            m.any_order(&terms)
        })
    }

    /// u . g times a factor, and an odd power: the gradient of a coefficient.
    fn of_coefficients(&self, factor: Bounded, g: [f64; 2], m: &Arithmetic) -> [Bounded; 4] {
        self.powers.map(|power| {
            let share = |j: usize| m.mul(m.mul(m.mul(exact(g[j]), self.u[j]), factor), power);
            m.any_order(&[share(0), share(1)])
        })
    }
}

/// Bound of [`super::distort`].
pub(crate) fn fisheye_distort(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let k = coefficients(a);
    forward(a, "points", "distorted", |p| {
        if p == [0.0; 2] {
            return [0.0; 2];
        }
        let r = length(p.map(exact), m);
        let theta_d = bent_bounded(k, angle(r, m), m);
        p.map(|x| {
            let (factor, unit) = (m.div(theta_d, r), m.div(exact(x), r));
            m.mul(exact(x), factor).or(m.mul(theta_d, unit)).or(m.div(m.mul(exact(x), theta_d), r)).e
        })
    })
}

/// Bound of [`super::backward::distort`].
pub(crate) fn fisheye_distort_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let k = coefficients(a);
    let f = |p: Pair, g: Pair| {
        if p == [0.0; 2] {
            return ([0.0; 2], [exact(0.0); 4]);
        }
        let point = Point::new(k, p.map(exact), m);
        let g_p = point.stretched(point.along, point.across, g, m);
        (g_p.map(|g| g.e), point.of_coefficients(exact(1.0), g, m))
    };
    vjp(a, "points", "distorted", f, |terms| m.any_order(terms).e)
}

/// The angle and the point that an iteration finds.
fn inverse(k: [f64; 4], target: Pair, m: &Arithmetic) -> [Bounded; 2] {
    let theta_d = length(target.map(exact), m);
    let theta = libm::atan(undistorted(k, target).length());
    let slope = super::bent_slope(k, theta);
    let seen = bent_bounded(k, exact(theta), m).e + theta_d.e + m.u * bent(k, theta);
    let close = seen / slope + m.u * theta + m.tiny;
    // What the error of the slope leaves of a step, once more.
    let steep = [3.0, 5.0, 7.0, 9.0];
    let beside = Bounded { y: theta, e: close };
    let off = polynomial([0, 1, 2, 3].map(|n| exact(steep[n] * k[n])), beside, m).e / slope;
    let e = if off < 0.5 { close * (1.0 + 2.0 * off / (1.0 - off)) } else { f64::INFINITY };
    let tangent = tangent(Bounded { y: theta, e }, m);
    target.map(|x| {
        let (factor, unit) = (m.div(tangent, theta_d), m.div(exact(x), theta_d));
        m.mul(exact(x), factor).or(m.mul(tangent, unit)).or(m.div(m.mul(exact(x), tangent), theta_d))
    })
}

/// Bound of [`super::undistort`].
pub(crate) fn fisheye_undistort(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let k = coefficients(a);
    forward(a, "distorted", "points", |target| match target {
        [0.0, 0.0] => [0.0; 2],
        _ => inverse(k, target, m).map(|x| x.e),
    })
}

/// Bound of [`super::backward::undistort`], at the point that was found.
pub(crate) fn fisheye_undistort_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let k = coefficients(a);
    let f = |target: Pair, g: Pair| {
        if target == [0.0; 2] {
            return ([0.0; 2], [exact(0.0); 4]);
        }
        let point = Point::new(k, inverse(k, target, m), m);
        let [along, across] = [point.along, point.across].map(|stretch| m.div(exact(1.0), stretch));
        let g_target = point.stretched(along, across, g, m);
        (g_target.map(|g| g.e), point.of_coefficients(along, g, m))
    };
    vjp(a, "distorted", "points", f, |terms| m.any_order(terms).e)
}
