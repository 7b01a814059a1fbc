//! A lens as wrong code reads its coefficients, with the derivatives of what it then does.

use glam::{DMat2, DVec2};

/// Where each of k1, k2, p1, p2, k3, k4, k5, k6 is read from, and which powers of the radius they go with.
pub(super) struct WrongLens {
    k: [f64; 8],
    places: [Option<usize>; 8],
    root: bool,
    polynomial: bool,
}

/// The radial factor, its derivative with respect to r^2, and those with respect to k1, k2, k3, k4, k5, k6.
struct Radial {
    value: f64,
    slope: f64,
    of: [f64; 6],
}

impl WrongLens {
    /// Given coefficients, with mistakes.
    pub(super) fn new(given: &[f64], wrong: &[&str]) -> WrongLens {
        let has = |name: &str| wrong.contains(&name);
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
        let polynomial = has("k4_in_the_numerator");
        if has("denominator_dropped") {
            places[5] = None;
        }
        if polynomial || has("denominator_dropped") {
            (places[6], places[7]) = (None, None);
        }
        let k = places.map(|place| place.and_then(|n| given.get(n).copied()).unwrap_or(0.0));
        WrongLens { k, places, root: has("radius_not_squared"), polynomial }
    }

    fn radial(&self, p: DVec2) -> Radial {
        let [k1, k2, _, _, k3, k4, k5, k6] = self.k;
        let r2 = p.length_squared();
        let q = if self.root { r2.sqrt() } else { r2 };
        let dq = if !self.root { 1.0 } else { 0.5 / q.max(f64::MIN_POSITIVE) };
        let (q2, q3) = (q * q, q * q * q);
        let numerator = 1.0 + k1 * q + k2 * q2 + k3 * q3;
        let of_numerator = k1 + 2.0 * k2 * q + 3.0 * k3 * q2;
        if self.polynomial {
            let slope = (of_numerator + 4.0 * k4 * q3) * dq;
            return Radial { value: numerator + k4 * q2 * q2, slope, of: [q, q2, q3, q2 * q2, 0.0, 0.0] };
        }
        let denominator = 1.0 + k4 * q + k5 * q2 + k6 * q3;
        let of_denominator = k4 + 2.0 * k5 * q + 3.0 * k6 * q2;
        let value = numerator / denominator;
        let of = [q, q2, q3, -value * q, -value * q2, -value * q3].map(|x| x / denominator);
        Radial { value, slope: (of_numerator - value * of_denominator) / denominator * dq, of }
    }

    pub(super) fn distort(&self, p: DVec2) -> DVec2 {
        let (value, r2) = (self.radial(p).value, p.length_squared());
        let [_, _, p1, p2, ..] = self.k;
        DVec2::new(
            p.x * value + 2.0 * p1 * p.x * p.y + p2 * (r2 + 2.0 * p.x * p.x),
            p.y * value + p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * p2 * p.x * p.y,
        )
    }

    fn jacobian(&self, p: DVec2) -> DMat2 {
        let Radial { value, slope, .. } = self.radial(p);
        let [_, _, p1, p2, ..] = self.k;
        let mixed = 2.0 * (slope * p.x * p.y + p1 * p.x + p2 * p.y);
        DMat2::from_cols(
            DVec2::new(value + 2.0 * slope * p.x * p.x + 2.0 * p1 * p.y + 6.0 * p2 * p.x, mixed),
            DVec2::new(mixed, value + 2.0 * slope * p.y * p.y + 6.0 * p1 * p.y + 2.0 * p2 * p.x),
        )
    }

    /// Newton's method, to the end.
    pub(super) fn undistort(&self, target: DVec2) -> DVec2 {
        (0..30).fold(target, |p, _| p - self.jacobian(p).inverse() * (self.distort(p) - target))
    }

    /// The gradients of the point and of the coefficients, at the places where they were read.
    pub(super) fn backward(&self, p: DVec2, g: DVec2) -> (DVec2, [f64; 8]) {
        let (s, twice, r2) = (p.x * g.x + p.y * g.y, 2.0 * p.x * p.y, p.length_squared());
        let of = self.radial(p).of.map(|of| s * of);
        let g_p1 = twice * g.x + (r2 + 2.0 * p.y * p.y) * g.y;
        let g_p2 = (r2 + 2.0 * p.x * p.x) * g.x + twice * g.y;
        let own = [of[0], of[1], g_p1, g_p2, of[2], of[3], of[4], of[5]];
        let mut g_k = [0.0; 8];
        for (place, g) in self.places.iter().zip(own) {
            if let Some(n) = place {
                g_k[*n] += g;
            }
        }
        (self.jacobian(p) * g, g_k)
    }

    /// The same of the inverse, at the point that it found.
    pub(super) fn inverse_backward(&self, p: DVec2, g: DVec2) -> (DVec2, [f64; 8]) {
        let h = self.jacobian(p).inverse() * g;
        (h, self.backward(p, h).1.map(|g| -g))
    }
}
