//! A lens as wrong code reads its coefficients, with the derivatives of what it then does.

use glam::{DMat2, DVec2};

/// What this is about, by name.
pub(super) const MISREAD: [&str; 20] = [
    "tangential_swapped",
    "tangential_missing",
    "radius_not_squared",
    "k3_third",
    "k4_in_the_numerator",
    "denominator_dropped",
    "k3_dropped",
    "k5_twice",
    "two_radial_coefficients",
    "every_power",
    "all_in_the_numerator",
    "radius_doubled",
    "coordinates_exchanged",
    "tangential_swapped_in_y",
    "p1_twice",
    "p2_twice",
    "tangential_negated",
    "tangential_stretched",
    "tangential_of_bent_point",
    "x_overwritten",
];

/// In which order a lens is put together.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    /// p radial + tangential(p).
    Sum,
    /// (p + tangential(p)) radial.
    Stretched,
    /// q + tangential(q) of q = p radial.
    Bent,
    /// y' by the x' that was just computed.
    Overwritten,
}

/// Where each of k1, k2, p1, p2, k3, k4, k5, k6 is read from, which powers of the radius they go with, and what the tangential terms are.
pub(super) struct WrongLens {
    k: [f64; 8],
    places: [Option<usize>; 8],
    powers: Powers,
    /// How much of x^2, x y and y^2 is in x' and in y', for p1 and for p2.
    terms: [[[f64; 3]; 2]; 2],
    order: Order,
}

/// The powers of the radius.
#[derive(Clone, Copy, PartialEq)]
enum Powers {
    /// Those of r^2, in a quotient.
    Even,
    /// Those of r, in a quotient.
    Root,
    /// r^2, r^3 and r^4 above, those of r^2 below.
    Every,
    /// Those of r^2, all of them above.
    Above,
}

/// The radial factor, its derivative with respect to r^2, and those with respect to k1, k2, k3, k4, k5, k6.
struct Radial {
    value: f64,
    slope: f64,
    of: [f64; 6],
}

/// Where the coefficients are read from.
fn places(has: impl Fn(&str) -> bool) -> [Option<usize>; 8] {
    let mut places = [0, 1, 2, 3, 4, 5, 6, 7].map(Some);
    if has("k3_third") {
        (places[2], places[3], places[4]) = (Some(3), Some(4), Some(2));
    }
    if has("tangential_swapped") {
        places.swap(2, 3);
    }
    if has("tangential_missing") {
        (places[2], places[3]) = (None, None);
    }
    if has("k3_dropped") {
        places[4] = None;
    }
    if has("k5_twice") {
        places[7] = Some(6);
    }
    if has("denominator_dropped") {
        places[5] = None;
    }
    if has("k4_in_the_numerator") || has("denominator_dropped") {
        (places[6], places[7]) = (None, None);
    }
    if has("two_radial_coefficients") {
        places[2..].fill(None);
    }
    places
}

/// How much of x^2, x y and y^2 is in x' and in y', for p1 and for p2.
fn terms(has: impl Fn(&str) -> bool) -> [[[f64; 3]; 2]; 2] {
    let mixed = [0.0, 2.0, 0.0];
    let (of_x, of_y, none) = ([3.0, 0.0, 1.0], [1.0, 0.0, 3.0], [0.0; 3]);
    match () {
        () if has("radius_doubled") => [[mixed, [2.0, 0.0, 3.0]], [[3.0, 0.0, 2.0], mixed]],
        () if has("coordinates_exchanged") => [[mixed, of_x], [of_y, mixed]],
        () if has("tangential_swapped_in_y") => [[mixed, mixed], [of_x, of_y]],
        () if has("p1_twice") => [[mixed, [1.0, 2.0, 3.0]], [of_x, none]],
        () if has("p2_twice") => [[none, of_y], [[3.0, 2.0, 1.0], mixed]],
        () if has("tangential_negated") => [[mixed, of_y], [of_x, mixed]].map(|of| of.map(|c| c.map(|c| -c))),
        () => [[mixed, of_y], [of_x, mixed]],
    }
}

impl WrongLens {
    /// Given coefficients, with mistakes.
    pub(super) fn new(given: &[f64], wrong: &[&str]) -> WrongLens {
        let has = |name: &str| wrong.contains(&name);
        let places = places(has);
        let k = places.map(|place| place.and_then(|n| given.get(n).copied()).unwrap_or(0.0));
        let powers = match () {
            () if has("radius_not_squared") => Powers::Root,
            () if has("every_power") => Powers::Every,
            () if has("k4_in_the_numerator") || has("all_in_the_numerator") => Powers::Above,
            () => Powers::Even,
        };
        let order = match () {
            () if has("tangential_stretched") => Order::Stretched,
            () if has("tangential_of_bent_point") => Order::Bent,
            () if has("x_overwritten") => Order::Overwritten,
            () => Order::Sum,
        };
        WrongLens { k, places, powers, terms: terms(has), order }
    }

    fn radial(&self, p: DVec2) -> Radial {
        let [k1, k2, _, _, k3, k4, k5, k6] = self.k;
        let r2 = p.length_squared();
        let r = r2.sqrt();
        let of_root = 0.5 / r.max(f64::MIN_POSITIVE);
        let (q, dq) = if self.powers == Powers::Root { (r, of_root) } else { (r2, 1.0) };
        let (q2, q3) = (q * q, q * q * q);
        if self.powers == Powers::Above {
            let of = [q, q2, q3, q2 * q2, q2 * q3, q3 * q3];
            let (all, mut value, mut slope) = ([k1, k2, k3, k4, k5, k6], 1.0, 0.0);
            for (n, k) in all.into_iter().enumerate() {
                value += k * of[n];
                slope += (n + 1) as f64 * k * if n == 0 { 1.0 } else { of[n - 1] };
            }
            return Radial { value, slope, of };
        }
        let (above, of_numerator) = match self.powers {
            Powers::Every => ([q, q * r, q2], k1 + 1.5 * k2 * r + 2.0 * k3 * q),
            _ => ([q, q2, q3], k1 + 2.0 * k2 * q + 3.0 * k3 * q2),
        };
        let numerator = 1.0 + k1 * above[0] + k2 * above[1] + k3 * above[2];
        let denominator = 1.0 + k4 * q + k5 * q2 + k6 * q3;
        let of_denominator = k4 + 2.0 * k5 * q + 3.0 * k6 * q2;
        let value = numerator / denominator;
        let of =
            [above[0], above[1], above[2], -value * q, -value * q2, -value * q3].map(|x| x / denominator);
        Radial { value, slope: (of_numerator - value * of_denominator) / denominator * dq, of }
    }

    /// p radial, and its Jacobian.
    fn bent(&self, p: DVec2) -> (DVec2, DMat2) {
        let Radial { value, slope, .. } = self.radial(p);
        let jacobian = DMat2::from_cols(2.0 * slope * p.x * p, 2.0 * slope * p.y * p);
        (p * value, jacobian + value * DMat2::IDENTITY)
    }

    /// The tangential terms for p1 = 1 and for p2 = 1.
    fn each_tangential(&self, p: DVec2) -> [DVec2; 2] {
        let of = [p.x * p.x, p.x * p.y, p.y * p.y];
        let sum = |c: [f64; 3]| c[0] * of[0] + c[1] * of[1] + c[2] * of[2];
        self.terms.map(|[x, y]| DVec2::new(sum(x), sum(y)))
    }

    /// The tangential terms, and their Jacobian.
    fn tangential(&self, p: DVec2) -> (DVec2, DMat2) {
        let [_, _, p1, p2, ..] = self.k;
        let [one, two] = self.each_tangential(p);
        let slopes = self.terms.map(|of| {
            let [x, y] = of.map(|c| DVec2::new(2.0 * c[0] * p.x + c[1] * p.y, c[1] * p.x + 2.0 * c[2] * p.y));
            DMat2::from_cols(x, y).transpose()
        });
        (p1 * one + p2 * two, p1 * slopes[0] + p2 * slopes[1])
    }

    /// Where a point lands, and the Jacobian.
    fn both(&self, p: DVec2) -> (DVec2, DMat2) {
        let ((q, of_q), (t, of_t)) = (self.bent(p), self.tangential(p));
        match self.order {
            Order::Sum => (q + t, of_q + of_t),
            Order::Stretched => {
                let Radial { value, slope, .. } = self.radial(p);
                let moved = p + t;
                let by_radius = DMat2::from_cols(2.0 * slope * p.x * moved, 2.0 * slope * p.y * moved);
                (moved * value, value * (DMat2::IDENTITY + of_t) + by_radius)
            }
            Order::Bent => {
                let (t, of_t) = self.tangential(q);
                (q + t, (DMat2::IDENTITY + of_t) * of_q)
            }
            Order::Overwritten => {
                let (x, of_x) = (q.x + t.x, of_q.row(0) + of_t.row(0));
                let (t, of_t) = self.tangential(DVec2::new(x, p.y));
                let of_y = of_q.row(1) + of_t.row(1).x * of_x + DVec2::new(0.0, of_t.row(1).y);
                (DVec2::new(x, q.y + t.y), DMat2::from_cols(of_x, of_y).transpose())
            }
        }
    }

    pub(super) fn distort(&self, p: DVec2) -> DVec2 {
        self.both(p).0
    }

    /// Newton's method, to the end.
    pub(super) fn undistort(&self, target: DVec2) -> DVec2 {
        (0..30).fold(target, |p, _| {
            let (found, jacobian) = self.both(p);
            p - jacobian.inverse() * (found - target)
        })
    }

    /// The gradients of the point and of the coefficients, at the places where they were read.
    pub(super) fn backward(&self, p: DVec2, g: DVec2) -> (DVec2, [f64; 8]) {
        let (q, t) = (self.bent(p).0, self.tangential(p).0);
        // What reaches p radial or what stands in its place, that, and where x' and y' have their tangential terms from.
        let (g_q, stretched, at) = match self.order {
            Order::Sum => (g, p, [p, p]),
            Order::Stretched => (g, p + t, [p, p]),
            Order::Bent => (g + self.tangential(q).1.transpose() * g, p, [q, q]),
            Order::Overwritten => {
                let at = DVec2::new(q.x + t.x, p.y);
                (DVec2::new(g.x + self.tangential(at).1.row(1).x * g.y, g.y), p, [p, at])
            }
        };
        let Radial { value, of, .. } = self.radial(p);
        let of = of.map(|of| of * stretched.dot(g_q));
        let times = if self.order == Order::Stretched { value } else { 1.0 };
        let g_t = if self.order == Order::Bent { g } else { g_q };
        let [first, last] = at.map(|at| self.each_tangential(at));
        let [g_p1, g_p2] = [0, 1].map(|n| times * (first[n].x * g_t.x + last[n].y * g_t.y));
        let own = [of[0], of[1], g_p1, g_p2, of[2], of[3], of[4], of[5]];
        let mut g_k = [0.0; 8];
        for (place, g) in self.places.iter().zip(own) {
            if let Some(n) = place {
                g_k[*n] += g;
            }
        }
        (self.both(p).1.transpose() * g, g_k)
    }

    /// The same of the inverse, at the point that it found.
    pub(super) fn inverse_backward(&self, p: DVec2, g: DVec2) -> (DVec2, [f64; 8]) {
        let h = self.both(p).1.transpose().inverse() * g;
        (h, self.backward(p, h).1.map(|g| -g))
    }
}
