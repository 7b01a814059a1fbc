//! Honest projections: means by slopes, by K t or by way of [-1, 1]; covariances as (J R) Sigma (J R)^T or J (R Sigma R^T) J^T; inverses
//! divided or multiplied; gradients by the conic, by 1 / det^2 or by the determinant's.

use super::arrays::{form, forward, view, vjp};
use super::{Form, Splat, View};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, SplatCenter, SplatClamp, SplatClampGradient};

/// The number of ways to a splat.
pub(super) const WAYS: u64 = 12;

/// One of the picture's axes.
struct Axis<N> {
    f: N,
    center: N,
    size: N,
    /// Of the camera's three axes, the one along it.
    index: usize,
    /// f / z.
    scale: N,
    /// t_x/t_z, and the same clamped.
    slope: N,
    held: N,
    limits: Option<[N; 2]>,
}

/// A Gaussian on its way into a picture.
pub(super) struct Projected<'a, O: Operations> {
    o: &'a O,
    form: Form,
    way: u64,
    rotation: [[O::Number; 3]; 3],
    sigma: [O::Number; 6],
    t: [O::Number; 3],
    axes: [Axis<O::Number>; 2],
    /// The rows that the covariance goes through: of J R, or of J alone.
    rows: [[O::Number; 3]; 2],
    /// The covariance before the dilation, and with it.
    before: [O::Number; 3],
    after: [O::Number; 3],
    /// Determinants of both.
    dets: [O::Number; 2],
}

/// The results in this arithmetic: means, covariances, conics, depth, what is rounded up to the radius, compensation.
pub(super) struct Results<N> {
    pub mean: [N; 2],
    pub covariance: [N; 3],
    pub conic: [N; 3],
    pub depth: N,
    pub reach: N,
    pub compensation: N,
}

impl<'a, O: Operations> Projected<'a, O> {
    pub(super) fn new(o: &'a O, mean: [f64; 3], sigma: [f64; 6], view: &View, form: Form, way: u64) -> Self {
        let rotation = view.rotation.map(|row| row.map(|x| o.exact(x)));
        let mean = mean.map(|x| o.exact(x));
        let t = [0, 1, 2].map(|i| {
            let products = [0, 1, 2].map(|k| o.mul(rotation[i][k], mean[k]));
            o.sum(&[&products[..], &[o.exact(view.translation[i])]].concat())
        });
        let k = view.k;
        let axes =
            [(0, k.fx, k.cx, view.width), (1, k.fy, k.cy, view.height)].map(|(index, f, center, size)| {
                let (f, center, size) = (o.exact(f), o.exact(center), o.hyper(size));
                let (slope, limits) = (o.div(t[index], t[2]), limits(o, f, center, size, form.clamp));
                let held = limits.map_or(slope, |[low, high]| o.min(o.max(slope, low), high));
                Axis { f, center, size, index, scale: o.div(f, t[2]), slope, held, limits }
            });
        let sigma = sigma.map(|x| o.exact(x));
        let none = o.exact(0.0);
        let (rows, three) = ([[none; 3]; 2], [none; 3]);
        let mut it = Projected {
            o,
            form,
            way,
            rotation,
            sigma,
            t,
            axes,
            rows,
            before: three,
            after: three,
            dets: [none; 2],
        };
        if it.turns_first() {
            it.sigma = it.turned();
        }
        it.rows = [0, 1].map(|n| it.row(n));
        it.widen();
        it
    }

    /// Whether Sigma is turned to the camera's axes before J is applied.
    fn turns_first(&self) -> bool {
        self.way / 3 % 2 == 1
    }

    /// R Sigma R^T.
    fn turned(&self) -> [O::Number; 6] {
        let o = self.o;
        let products = self.rotation.map(|row| times(o, self.sigma, row));
        [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| o.dot(&self.rotation[i], &products[j]))
    }

    /// (J_00, J_02) or (J_11, J_12).
    fn jacobian(&self, n: usize) -> [O::Number; 2] {
        let (o, axis) = (self.o, &self.axes[n]);
        let along = if self.way % 2 == 0 {
            o.mul(axis.scale, axis.held)
        } else {
            let place = o.mul(axis.held, self.t[2]);
            o.div(o.mul(axis.f, place), o.mul(self.t[2], self.t[2]))
        };
        [axis.scale, o.neg(along)]
    }

    fn row(&self, n: usize) -> [O::Number; 3] {
        let (o, [own, along]) = (self.o, self.jacobian(n));
        if self.turns_first() {
            let mut row = [o.exact(0.0); 3];
            (row[n], row[2]) = (own, along);
            return row;
        }
        [0, 1, 2].map(|k| o.dot(&[own, along], &[self.rotation[n][k], self.rotation[2][k]]))
    }

    /// The covariance in the picture, its dilation and their determinants.
    fn widen(&mut self) {
        let (o, [p, q], h) = (self.o, self.rows, self.o.hyper(self.form.dilation.value()));
        let (of_p, of_q) = (times(o, self.sigma, p), times(o, self.sigma, q));
        self.before = [o.dot(&p, &of_p), o.dot(&p, &of_q), o.dot(&q, &of_q)];
        self.after = [o.add(self.before[0], h), self.before[1], o.add(self.before[2], h)];
        let det = |[a, b, c]: [O::Number; 3]| o.sub(o.mul(a, c), o.mul(b, b));
        self.dets = [det(self.before), det(self.after)];
    }

    fn mean(&self, n: usize) -> O::Number {
        let (o, axis, t) = (self.o, &self.axes[n], &self.t);
        let integer = self.form.center == SplatCenter::Integer;
        let shifted = |x| if integer { o.sub(x, o.exact(0.5)) } else { x };
        match self.way % 3 {
            0 => shifted(o.add(o.mul(axis.f, axis.slope), axis.center)),
            1 => shifted(o.div(o.dot(&[axis.f, axis.center], &[t[axis.index], t[2]]), t[2])),
            _ => {
                let focal = o.div(o.times(2.0, axis.f), axis.size);
                let center = o.sub(o.div(o.times(2.0, axis.center), axis.size), o.exact(1.0));
                let ndc = o.div(o.dot(&[focal, center], &[t[axis.index], t[2]]), t[2]);
                let pixels = o.mul(o.add(ndc, o.exact(1.0)), axis.size);
                o.times(0.5, if integer { o.sub(pixels, o.exact(1.0)) } else { pixels })
            }
        }
    }

    fn conic(&self) -> [O::Number; 3] {
        let (o, [a, b, c], det) = (self.o, self.after, self.dets[1]);
        let inverse = o.div(o.exact(1.0), det);
        [c, o.neg(b), a].map(|x| if self.way % 2 == 0 { o.div(x, det) } else { o.mul(x, inverse) })
    }

    /// sqrt(det before / det after), at least the floor.
    fn compensation(&self) -> O::Number {
        let (o, [before, after]) = (self.o, self.held_up());
        let floor = o.hyper(self.form.compensation.value());
        o.max(o.sqrt(o.max(o.div(before, after), o.exact(0.0))), floor)
    }

    /// The determinants, at least their floor.
    fn held_up(&self) -> [O::Number; 2] {
        let least = self.form.compensation.determinant();
        self.dets.map(|det| if least > 0.0 { self.o.max(det, self.o.hyper(least)) } else { det })
    }

    /// `x` where this determinant isn't at its floor.
    fn learns(&self, det: O::Number, x: O::Number) -> O::Number {
        let least = self.form.compensation.determinant();
        if least > 0.0 { self.o.above(det, self.o.hyper(least), x) } else { x }
    }

    /// Three deviations along the long axis.
    fn reach(&self) -> O::Number {
        let (o, [a, b, c]) = (self.o, self.after);
        let middle = o.times(0.5, o.add(a, c));
        let apart = if self.way % 2 == 0 {
            o.sub(o.mul(middle, middle), self.dets[1])
        } else {
            let half = o.times(0.5, o.sub(a, c));
            o.add(o.mul(half, half), o.mul(b, b))
        };
        let root = o.sqrt(o.max(apart, o.hyper(self.form.radius.value())));
        o.times(3.0, o.sqrt(o.add(middle, root)))
    }

    pub(super) fn results(&self) -> Results<O::Number> {
        Results {
            mean: [self.mean(0), self.mean(1)],
            covariance: self.after,
            conic: self.conic(),
            depth: self.t[2],
            reach: self.reach(),
            compensation: self.compensation(),
        }
    }

    /// Gradients of the mean and of the covariance.
    pub(super) fn gradients(&self, g: &Splat) -> ([O::Number; 3], [O::Number; 6]) {
        let (o, z) = (self.o, self.t[2]);
        let g_covariance = self.of_covariance(g);
        let mut of_z = vec![o.exact(g.depth)];
        let mut g_t = [o.exact(0.0); 3];
        for (n, g_jacobian) in self.of_rows(g_covariance).into_iter().enumerate() {
            let (axis, [own, along]) = (&self.axes[n], g_jacobian);
            let by_depth = o.div(axis.scale, z);
            let through = |x| match axis.limits {
                Some([low, high]) => o.above(axis.slope, low, o.above(high, axis.slope, x)),
                None => x,
            };
            let (g_mean, moved) = (o.exact(g.mean[n]), o.mul(by_depth, along));
            g_t[n] = o.sub(o.mul(axis.scale, g_mean), through(moved));
            let tilted = o.mul(moved, axis.held);
            let held = self.form.clamp_gradient == SplatClampGradient::Held;
            let second = if held { tilted } else { through(tilted) };
            let of_mean = o.mul(o.mul(axis.scale, axis.slope), g_mean);
            of_z.extend([o.neg(o.mul(by_depth, own)), tilted, second, o.neg(of_mean)]);
        }
        g_t[2] = o.sum(&of_z);
        let g_mean = [0, 1, 2].map(|k| o.dot(&[0, 1, 2].map(|i| self.rotation[i][k]), &g_t));
        (g_mean, self.of_sigma(g_covariance))
    }

    /// Gradient of the covariance with its dilation.
    fn of_covariance(&self, g: &Splat) -> [O::Number; 3] {
        let (o, [a, b, c], [before, after]) = (self.o, self.after, self.held_up());
        let conic = self.of_conic(g.conic.map(|g| o.exact(g)));
        let ratio = o.div(before, after);
        let compensation = self.compensation();
        let g_ratio = o.div(o.exact(g.compensation), o.times(2.0, compensation));
        let floor = o.hyper(self.form.compensation.value());
        let g_held = o.above(compensation, floor, o.div(g_ratio, after));
        let (g_before, g_after) =
            (self.learns(self.dets[0], g_held), self.learns(self.dets[1], o.mul(ratio, g_held)));
        let of_dets = |x: usize, y: O::Number| o.sub(o.mul(g_before, self.before[x]), o.mul(g_after, y));
        let cross = o.times(-2.0, o.mul(b, o.sub(g_before, g_after)));
        let own = g.covariance.map(|g| o.exact(g));
        [
            o.sum(&[own[0], conic[0], of_dets(2, c)]),
            o.sum(&[own[1], conic[1], cross]),
            o.sum(&[own[2], conic[2], of_dets(0, a)]),
        ]
    }

    /// What the conic passes to the covariance.
    fn of_conic(&self, [x, y, z]: [O::Number; 3]) -> [O::Number; 3] {
        let (o, [a, b, c], det) = (self.o, self.after, self.dets[1]);
        let three = |u, v, w| o.sum(&[u, v, w]);
        match self.way / 2 % 3 {
            0 => {
                let [p, q, r] = self.conic();
                let m = |a, b, g| o.neg(o.mul(o.mul(a, b), g));
                let cross = o.add(o.mul(p, r), o.mul(q, q));
                [
                    three(m(p, p, x), m(p, q, y), m(q, q, z)),
                    three(o.times(2.0, m(p, q, x)), o.neg(o.mul(cross, y)), o.times(2.0, m(q, r, z))),
                    three(m(q, q, x), m(q, r, y), m(r, r, z)),
                ]
            }
            1 => {
                let inverse = o.div(o.exact(1.0), o.mul(det, det));
                let rest = o.sub(det, o.mul(a, c));
                let m = |a, b, g| o.mul(o.mul(a, b), g);
                let cross = o.neg(o.add(det, o.times(2.0, o.mul(b, b))));
                [
                    three(o.neg(m(c, c, x)), m(b, c, y), o.mul(rest, z)),
                    three(o.times(2.0, m(b, c, x)), o.mul(cross, y), o.times(2.0, m(a, b, z))),
                    three(o.mul(rest, x), m(a, b, y), o.neg(m(a, a, z))),
                ]
                .map(|sum| o.mul(inverse, sum))
            }
            _ => {
                let conic = self.conic();
                let g_det = o.neg(o.div(o.dot(&conic, &[x, y, z]), det));
                [
                    o.add(o.div(z, det), o.mul(g_det, c)),
                    o.sub(o.neg(o.div(y, det)), o.times(2.0, o.mul(g_det, b))),
                    o.add(o.div(x, det), o.mul(g_det, a)),
                ]
            }
        }
    }

    /// Gradients of J's entries.
    fn of_rows(&self, [g_a, g_b, g_c]: [O::Number; 3]) -> [[O::Number; 2]; 2] {
        let (o, [p, q]) = (self.o, self.rows);
        let (of_p, of_q) = (times(o, self.sigma, p), times(o, self.sigma, q));
        let row = |n: usize, own: [O::Number; 3], g_own: O::Number, other: [O::Number; 3]| {
            let twice = o.times(2.0, g_own);
            let g = [0, 1, 2].map(|k| o.dot(&[twice, g_b], &[own[k], other[k]]));
            if self.turns_first() {
                return [g[n], g[2]];
            }
            [n, 2].map(|i| o.dot(&self.rotation[i], &g))
        };
        [row(0, of_p, g_a, of_q), row(1, of_q, g_c, of_p)]
    }

    /// Gradient of Sigma's six numbers.
    fn of_sigma(&self, [g_a, g_b, g_c]: [O::Number; 3]) -> [O::Number; 6] {
        let (o, [p, q]) = (self.o, self.rows);
        let half = o.times(0.5, g_b);
        let g: [[O::Number; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let cross = o.mul(half, o.add(o.mul(p[i], q[j]), o.mul(p[j], q[i])));
                o.sum(&[o.mul(g_a, o.mul(p[i], p[j])), cross, o.mul(g_c, o.mul(q[i], q[j]))])
            })
        });
        let g = if self.turns_first() { self.turned_back(g) } else { g };
        [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
            .map(|(i, j)| if i == j { g[i][i] } else { o.add(g[i][j], g[j][i]) })
    }

    /// R^T g R.
    fn turned_back(&self, g: [[O::Number; 3]; 3]) -> [[O::Number; 3]; 3] {
        let (o, r) = (self.o, self.rotation);
        let column = |k: usize| [r[0][k], r[1][k], r[2][k]];
        let right: [[O::Number; 3]; 3] = g.map(|row| [0, 1, 2].map(|k| o.dot(&row, &column(k))));
        std::array::from_fn(|i| {
            [0, 1, 2].map(|j| o.dot(&column(i), &[right[0][j], right[1][j], right[2][j]]))
        })
    }
}

/// Sigma v, of a symmetric matrix by its upper triangle.
fn times<O: Operations>(o: &O, s: [O::Number; 6], v: [O::Number; 3]) -> [O::Number; 3] {
    [[s[0], s[1], s[2]], [s[1], s[3], s[4]], [s[2], s[4], s[5]]].map(|row| o.dot(&row, &v))
}

/// The least and the largest slope.
fn limits<O: Operations>(
    o: &O,
    f: O::Number,
    center: O::Number,
    size: O::Number,
    clamp: SplatClamp,
) -> Option<[O::Number; 2]> {
    let half = o.div(o.times(0.5, size), f);
    let margin = |factor: f64| o.mul(o.hyper(factor), half);
    match clamp {
        SplatClamp::Picture => Some([
            o.neg(o.add(o.div(center, f), margin(0.3))),
            o.add(o.div(o.sub(size, center), f), margin(0.3)),
        ]),
        SplatClamp::Centered => Some([o.neg(margin(1.3)), margin(1.3)]),
        SplatClamp::None => None,
    }
}

/// Which way a machine takes.
fn way(m: &Machine) -> u64 {
    (2 * m.form + u64::from(m.stable)) % WAYS
}

/// Projections.
pub(crate) fn projection(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, c, |mean, sigma| {
        let results = Projected::new(m, mean, sigma, &view(a), form(c), way(m)).results();
        Splat {
            mean: results.mean,
            covariance: results.covariance,
            conic: results.conic,
            depth: results.depth,
            radius: results.reach.ceil(),
            compensation: results.compensation,
        }
    })
}

/// Their gradients.
pub(crate) fn projection_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, c, |mean, sigma, g| Projected::new(m, mean, sigma, &view(a), form(c), way(m)).gradients(g))
}
