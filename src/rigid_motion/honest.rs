//! Honest exponential maps in emulated arithmetic: coefficients by their series, by quotients that don't cancel, by the textbook's; R as
//! I + a K + b K^2, as cos I + a K + b w w^T, about an axis of length 1, by way of a quaternion; V as a matrix, by cross products, or with
//! a rho in it. Gradients of each, as automatic differentiation has them, by hand, and by the left Jacobian.

use super::arrays::{Rows, se3, se3_vjp, so3, so3_vjp};
use super::{LEAST_SQUARE, SERIES_BELOW, halves, held};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, MotionLayout, RotationClamp, TwistOrder, TwistTranslation};

/// The number of ways, and that of those which don't cancel. The others have w w^T (5), cross products (6) and V as a matrix (7).
pub(super) const WAYS: u64 = 8;
pub(super) const STABLE: u64 = 5;

/// Three numbers.
type Three<N> = [N; 3];
/// Rows of a matrix.
type Matrix<N> = [[N; 3]; 3];

/// Coefficients of a matrix d I + p K + q (K^2 or w w^T), and their slopes over w.
#[derive(Clone, Copy)]
struct Powers<N> {
    /// cos theta or a, where the last power is w w^T; None: 1, and it is K^2.
    whole: Option<[N; 2]>,
    p: N,
    q: N,
    slopes: [N; 2],
}

/// A rotation vector in some arithmetic, on one of the ways.
pub(super) struct Ways<'a, O: Operations> {
    o: &'a O,
    w: Three<O::Number>,
    /// theta, and its square.
    theta: O::Number,
    square: O::Number,
    /// The square over the reals, which says whose turn it is.
    exact: f64,
    way: u64,
    /// Whether the square is held, or close to it.
    held: bool,
    /// The smallest normal number of the type: what it is divided by has to be larger.
    tiny: f64,
    /// What slopes are multiplied by.
    open: O::Number,
}

impl<'a, O: Operations> Ways<'a, O> {
    pub(super) fn new(o: &'a O, w: [f64; 3], clamp: RotationClamp, way: u64, tiny: f64) -> Self {
        let (given, exact) = (w.map(|x| o.exact(x)), held(w, clamp));
        let (mut square, mut open) = (o.dot(&given, &given), o.exact(1.0));
        if clamp != RotationClamp::None {
            let least = o.hyper(LEAST_SQUARE);
            (open, square) = (o.above(square, least, open), o.max(square, least));
        }
        let held = clamp != RotationClamp::None && exact < 2.0 * LEAST_SQUARE;
        Ways { o, w: given, theta: o.sqrt(square), square, exact, way, held, tiny, open }
    }

    /// Whether this way divides as the textbook does, by powers of theta up to the fourth: from 1e-5 on, or where they are numbers of
    /// the type.
    fn divides(&self) -> bool {
        self.way >= STABLE && self.exact >= (16.0 * self.tiny.sqrt()).max(1e-10)
    }

    /// c_k of a square whose root is `theta`, by its series or by quotients.
    fn coefficient(&self, k: u32, square: O::Number, theta: O::Number, exact: f64) -> O::Number {
        let o = self.o;
        let factorial: f64 = (1..=k).map(f64::from).product();
        if exact < SERIES_BELOW {
            let step = |left: O::Number, j: u32| {
                let n = f64::from(k + 2 * j);
                o.sub(o.exact(1.0), o.mul(o.hyper(1.0 / (n * (n - 1.0))), o.mul(square, left)))
            };
            return o.mul(o.hyper(1.0 / factorial), (1..=super::TERMS).rev().fold(o.exact(1.0), step));
        }
        match k {
            1 => o.div(o.sin(theta), theta),
            2 => {
                let half = o.div(o.sin(o.times(0.5, theta)), theta);
                o.times(2.0, o.mul(half, half))
            }
            _ => {
                let before = self.coefficient(k - 2, square, theta, exact);
                let limit: f64 = (1..=k - 2).map(|n| 1.0 / f64::from(n)).product();
                o.div(o.sub(o.hyper(limit), before), square)
            }
        }
    }

    /// c_k at the angle.
    fn own(&self, k: u32) -> O::Number {
        self.coefficient(k, self.square, self.theta, self.exact)
    }

    /// a, b and c.
    fn coefficients(&self) -> Three<O::Number> {
        let o = self.o;
        if !self.divides() {
            return [1, 2, 3].map(|k| self.own(k));
        }
        let theta = self.theta;
        let falls = o.sub(o.exact(1.0), o.cos(theta));
        let lags = o.sub(theta, o.sin(theta));
        [o.div(o.sin(theta), theta), o.div(falls, self.square), o.div(lags, o.mul(theta, self.square))]
    }

    /// Their slopes over w.
    fn slopes(&self) -> Three<O::Number> {
        let (o, theta) = (self.o, self.theta);
        let slopes = if self.divides() {
            // Of each quotient two parts: the numerator's slope, and the denominator's.
            let falls = o.sub(o.exact(1.0), o.cos(theta));
            let lags = o.sub(theta, o.sin(theta));
            let cube = o.mul(theta, self.square);
            let fourth = o.mul(self.square, self.square);
            [
                o.sub(o.div(o.cos(theta), theta), o.div(o.sin(theta), self.square)),
                o.sub(o.div(o.sin(theta), self.square), o.div(o.times(2.0, falls), cube)),
                o.sub(o.div(falls, cube), o.div(o.times(3.0, lags), fourth)),
            ]
            .map(|slope| o.div(slope, theta))
        } else {
            let [two, three, four, five] = [2, 3, 4, 5].map(|k| self.own(k));
            [o.sub(three, two), o.sub(o.times(2.0, four), three), o.sub(o.times(3.0, five), four)]
        };
        slopes.map(|slope| o.mul(self.open, slope))
    }

    /// Whether the last power of this way is w w^T.
    fn outer(&self) -> bool {
        !self.held && self.way % 4 == 1
    }

    /// R's coefficients.
    fn of_rotation(&self) -> Powers<O::Number> {
        let ([a, b, _], [da, db, _]) = (self.coefficients(), self.slopes());
        let whole = self.outer().then(|| [self.o.cos(self.theta), self.o.neg(a)]);
        Powers { whole, p: a, q: b, slopes: [da, db] }
    }

    /// V's coefficients.
    fn of_translation(&self) -> Powers<O::Number> {
        let ([a, b, c], [da, db, dc]) = (self.coefficients(), self.slopes());
        Powers { whole: self.outer().then_some([a, da]), p: b, q: c, slopes: [db, dc] }
    }

    /// d I + p K + q (K^2 or w w^T), whose numbers come as d, p and q times the vector `w`.
    fn matrix(&self, w: Three<O::Number>, powers: &Powers<O::Number>) -> Matrix<O::Number> {
        let o = self.o;
        let Powers { whole, p, q, .. } = *powers;
        [0, 1, 2].map(|i| {
            [0, 1, 2].map(|j| match whole {
                _ if i != j => {
                    let turn = o.mul(p, w[3 - i - j]);
                    let turn = if (i + 1) % 3 == j { o.neg(turn) } else { turn };
                    o.add(o.mul(q, o.mul(w[i], w[j])), turn)
                }
                Some([whole, _]) => o.add(whole, o.mul(q, o.mul(w[i], w[i]))),
                None => {
                    let others = [w[(i + 1) % 3], w[(i + 2) % 3]];
                    o.sub(o.exact(1.0), o.mul(q, o.dot(&others, &others)))
                }
            })
        })
    }

    /// About an axis of length 1: sine and 1 - cosine.
    fn about(&self) -> (Three<O::Number>, O::Number, O::Number) {
        let o = self.o;
        let half = o.sin(o.times(0.5, self.theta));
        let axis = self.w.map(|x| o.div(x, self.theta));
        (axis, o.sin(self.theta), o.times(2.0, o.mul(half, half)))
    }

    /// The quaternion's real part, and what w is multiplied by for the others.
    fn quaternion(&self) -> [O::Number; 2] {
        let o = self.o;
        let (square, half) = (o.times(0.25, self.square), o.times(0.5, self.theta));
        [o.cos(half), o.times(0.5, self.coefficient(1, square, half, 0.25 * self.exact))]
    }

    /// Whether this way has an axis of length 1, by a length whose square the type holds.
    fn has_axis(&self) -> bool {
        self.way == 2 && !self.held && self.exact >= 64.0 * self.tiny
    }

    /// Whether it goes by way of a quaternion.
    fn has_quaternion(&self) -> bool {
        self.way == 3 && !self.held
    }

    /// R.
    pub(super) fn rotation(&self) -> Matrix<O::Number> {
        let o = self.o;
        let plain = |p: O::Number, q: O::Number| Powers { whole: None, p, q, slopes: [p, q] };
        if self.has_axis() {
            let (axis, sine, versine) = self.about();
            return self.matrix(axis, &plain(sine, versine));
        }
        if self.has_quaternion() {
            let [real, factor] = self.quaternion();
            return self.matrix(self.w.map(|x| o.mul(factor, x)), &plain(o.times(2.0, real), o.exact(2.0)));
        }
        self.matrix(self.w, &self.of_rotation())
    }

    /// w x p.
    fn cross(&self, p: Three<O::Number>) -> Three<O::Number> {
        let (o, w) = (self.o, self.w);
        [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            o.dot(&[w[j], o.neg(w[k])], &[p[k], p[j]])
        })
    }

    /// V p, or its transpose's product: `sign` is that of K.
    pub(super) fn along(&self, p: Three<O::Number>, sign: f64) -> Three<O::Number> {
        let o = self.o;
        let [a, b, c] = self.coefficients();
        let b = o.times(sign, b);
        if self.way % 3 == 1 {
            let powers = Powers { p: b, ..self.of_translation() };
            return self.matrix(self.w, &powers).map(|row| o.dot(&row, &p));
        }
        let across = self.cross(p);
        if self.way % 3 == 2 && !self.held {
            let inner = o.dot(&self.w, &p);
            return [0, 1, 2]
                .map(|i| o.sum(&[o.mul(a, p[i]), o.mul(b, across[i]), o.mul(c, o.mul(self.w[i], inner))]));
        }
        let twice = self.cross(across);
        [0, 1, 2].map(|i| o.sum(&[p[i], o.mul(b, across[i]), o.mul(c, twice[i])]))
    }

    /// The gradient of g : K.
    fn turned(&self, g: &Matrix<O::Number>) -> Three<O::Number> {
        [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            self.o.sub(g[j][i], g[i][j])
        })
    }

    /// The gradient of g : K^2, or of g : w w^T.
    fn squared(&self, g: &Matrix<O::Number>, w: Three<O::Number>, outer: bool) -> Three<O::Number> {
        let o = self.o;
        [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let own = if outer { o.times(2.0, g[i][i]) } else { o.times(-2.0, o.add(g[j][j], g[k][k])) };
            o.dot(&[o.add(g[i][j], g[j][i]), o.add(g[i][k], g[k][i]), own], &[w[j], w[k], w[i]])
        })
    }

    /// The gradient of g : (d I + p K + q (K^2 or w w^T)) with respect to w.
    fn through(&self, g: &Matrix<O::Number>, powers: &Powers<O::Number>) -> Three<O::Number> {
        let (o, w) = (self.o, self.w);
        let Powers { whole, p, q, slopes: [dp, dq] } = *powers;
        let (v, s) = (self.turned(g), self.squared(g, w, whole.is_some()));
        let of_square = o.times(0.5, o.dot(&s, &w));
        let mut parts = vec![o.mul(dp, o.dot(&v, &w)), o.mul(dq, of_square)];
        if let Some([_, slope]) = whole {
            parts.push(o.mul(slope, o.sum(&[g[0][0], g[1][1], g[2][2]])));
        }
        let stretched = o.sum(&parts);
        [0, 1, 2].map(|i| o.sum(&[o.mul(p, v[i]), o.mul(q, s[i]), o.mul(stretched, w[i])]))
    }

    /// The gradient of g : R with respect to w.
    pub(super) fn of_matrix(&self, g: &Matrix<O::Number>) -> Three<O::Number> {
        match () {
            () if self.has_axis() => self.of_axis(g),
            () if self.has_quaternion() => self.of_quaternion(g),
            () if self.way == 4 && !self.held => self.of_jacobian(g),
            () => self.through(g, &self.of_rotation()),
        }
    }

    /// By the left Jacobian V: dR = [V dw]_x R, so that g_w = V^T of what turns g R^T.
    fn of_jacobian(&self, g: &Matrix<O::Number>) -> Three<O::Number> {
        let r = self.matrix(self.w, &self.of_rotation());
        let back = [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.o.dot(&g[i], &r[j])));
        self.along(self.turned(&back), -1.0)
    }

    /// By way of the angle and of the axis, which is divided by its length.
    fn of_axis(&self, g: &Matrix<O::Number>) -> Three<O::Number> {
        let o = self.o;
        let (axis, sine, versine) = self.about();
        let (v, s) = (self.turned(g), self.squared(g, axis, false));
        let of_square = o.times(0.5, o.dot(&s, &axis));
        let g_theta = o.dot(&[o.cos(self.theta), sine], &[o.dot(&v, &axis), of_square]);
        let g_axis = [0, 1, 2].map(|i| o.dot(&[sine, versine], &[v[i], s[i]]));
        let radial = o.dot(&g_axis, &axis);
        [0, 1, 2].map(|i| {
            let across = o.div(o.sub(g_axis[i], o.mul(axis[i], radial)), self.theta);
            o.add(o.mul(axis[i], g_theta), across)
        })
    }

    /// By way of the quaternion (cos, f w) of half of the angle.
    fn of_quaternion(&self, g: &Matrix<O::Number>) -> Three<O::Number> {
        let (o, w) = (self.o, self.w);
        let [real, factor] = self.quaternion();
        let vector = w.map(|x| o.mul(factor, x));
        let (v, s) = (self.turned(g), self.squared(g, vector, false));
        let g_real = o.times(2.0, o.dot(&vector, &v));
        let g_vector = [0, 1, 2].map(|i| o.times(2.0, o.add(o.mul(real, v[i]), s[i])));
        let (square, half, exact) = (o.times(0.25, self.square), o.times(0.5, self.theta), 0.25 * self.exact);
        let [two, three] = [2, 3].map(|k| self.coefficient(k, square, half, exact));
        let slope = o.times(0.125, o.sub(three, two));
        let stretched = o.dot(&[slope, o.times(-0.5, factor)], &[o.dot(&g_vector, &w), g_real]);
        [0, 1, 2].map(|i| o.dot(&[factor, w[i]], &[g_vector[i], stretched]))
    }

    /// The gradients of t = V rho with respect to rho and w.
    pub(super) fn of_along(&self, rho: Three<O::Number>, g: Three<O::Number>) -> [Three<O::Number>; 2] {
        let g_v = g.map(|g| rho.map(|rho| self.o.mul(g, rho)));
        [self.along(g, -1.0), self.through(&g_v, &self.of_translation())]
    }
}

/// What a motion's matrix is made of in some arithmetic.
pub(super) fn motion<O: Operations>(
    o: &O,
    twist: [f64; 6],
    c: &Conventions,
    (way, tiny): (u64, f64),
) -> [O::Number; 16] {
    let (rho, w) = halves(twist, c.twist_order);
    let ways = Ways::new(o, w, c.rotation_clamp, way, tiny);
    let (r, rho) = (ways.rotation(), rho.map(|x| o.exact(x)));
    let t = if c.twist_translation == TwistTranslation::Plain { rho } else { ways.along(rho, 1.0) };
    std::array::from_fn(|n| {
        let (i, j) = if c.motion_layout == MotionLayout::ForRows { (n % 4, n / 4) } else { (n / 4, n % 4) };
        match (i, j) {
            (3, _) => o.exact(f64::from(u8::from(j == 3))),
            (_, 3) => t[i],
            _ => r[i][j],
        }
    })
}

/// The gradient of a twist.
pub(super) fn motion_vjp<O: Operations>(
    o: &O,
    twist: [f64; 6],
    g: &[f64; 16],
    c: &Conventions,
    (way, tiny): (u64, f64),
) -> [O::Number; 6] {
    let (rho, w) = halves(twist, c.twist_order);
    let ways = Ways::new(o, w, c.rotation_clamp, way, tiny);
    let entry = |i: usize, j: usize| {
        o.exact(if c.motion_layout == MotionLayout::ForRows { g[4 * j + i] } else { g[4 * i + j] })
    };
    let g_r = [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)));
    let g_t = [0, 1, 2].map(|i| entry(i, 3));
    let (mut g_rho, mut g_w) = (g_t, ways.of_matrix(&g_r));
    if c.twist_translation == TwistTranslation::Coupled {
        let [straight, turned] = ways.of_along(rho.map(|x| o.exact(x)), g_t);
        (g_rho, g_w) = (straight, [0, 1, 2].map(|i| o.add(g_w[i], turned[i])));
    }
    let [first, last] =
        if c.twist_order == TwistOrder::TranslationFirst { [g_rho, g_w] } else { [g_w, g_rho] };
    [first[0], first[1], first[2], last[0], last[1], last[2]]
}

/// This machine's way, and its smallest normal number. Machines that differ in their noise alone take different ways.
fn way(m: &Machine) -> (u64, f64) {
    let ways = if m.stable { STABLE } else { WAYS };
    ((m.form + m.noise) % ways, m.dtype.smallest_normal())
}

fn ways<'a>(m: &'a Machine, w: [f64; 3], c: &Conventions) -> Ways<'a, Machine> {
    let (way, tiny) = way(m);
    Ways::new(m, w, c.rotation_clamp, way, tiny)
}

/// Rotations.
pub(crate) fn so3_exp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    so3(a, |w| ways(m, w, c).rotation())
}

/// Their gradient.
pub(crate) fn so3_exp_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    so3_vjp(a, |w, g: Rows| ways(m, w, c).of_matrix(&g))
}

/// Motions.
pub(crate) fn se3_exp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    se3(a, |twist| motion(m, twist, c, way(m)))
}

/// Their gradient.
pub(crate) fn se3_exp_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    se3_vjp(a, |twist, g| motion_vjp(m, twist, &g, c, way(m)))
}
