//! Scenes by formula: density, color and the optical depth of any ray in closed form, so that a picture needs no file and a
//! rendering has an exact answer.

use glam::DVec3;

use crate::error::{Error, Input, Result};
use crate::math::{erf, exp, pow, sin_pi};
use crate::ray::Ray;

mod views;

#[cfg(test)]
mod tests;

pub use views::{load, render};

/// The names after `builtin:`.
pub const NAMES: [&str; 3] = ["slab", "blob", "spheres"];

/// One body of a built-in scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Body {
    /// Constant density between two corners.
    Slab {
        /// Half of each side.
        half: DVec3,
        /// sigma inside.
        density: f64,
    },
    /// A Gaussian: sigma(x) = density e^(-|x|^2 / (2 s^2)).
    Blob {
        /// s, the standard deviation.
        deviation: f64,
        /// sigma at the center.
        density: f64,
    },
    /// A ball that fades out: sigma(x) = density (1 - |x - c|^2 / R^2)^2 inside, 0 outside; the density and its slope are continuous.
    SoftSphere {
        /// c.
        center: DVec3,
        /// R.
        radius: f64,
        /// sigma at the center.
        density: f64,
        /// Its color in plain light.
        color: [f64; 3],
    },
}

/// A built-in scene: bodies whose densities add up and whose colors mix by density.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Its bodies.
    pub bodies: Vec<Body>,
    /// The box that holds all of it (a blob: to six standard deviations, where e^-18 of its density is left).
    pub bounds: (DVec3, DVec3),
}

impl Medium {
    /// A built-in scene by name.
    ///
    /// # Errors
    /// Where there is none of this name.
    pub fn named(name: &str) -> Result<Medium> {
        let bodies = match name {
            "slab" => vec![Body::Slab { half: DVec3::new(0.9, 0.9, 0.3), density: 2.0 }],
            "blob" => vec![Body::Blob { deviation: 0.25, density: 8.0 }],
            "spheres" => spheres(),
            _ => {
                let names = NAMES.map(|name| format!("builtin:{name}")).join(", ");
                let remedy = "builtin:card is a picture, no scene.";
                return Err(Error::input(Input {
                    file: format!("builtin:{name}"),
                    field: "name",
                    found: name,
                    expected: names,
                    remedy,
                }));
            }
        };
        let half = match bodies[0] {
            Body::Slab { half, .. } => half,
            Body::Blob { deviation, .. } => DVec3::splat(6.0 * deviation),
            Body::SoftSphere { .. } => DVec3::splat(1.2),
        };
        Ok(Medium { bodies, bounds: (-half, half) })
    }

    /// sigma(x), in 1 / length.
    pub fn density(&self, x: DVec3) -> f64 {
        let mut sigma = 0.0;
        for body in &self.bodies {
            sigma += body.density(x);
        }
        sigma
    }

    /// c(x, d) in [0, 1], seen along unit direction `d`: the bodies' colors weighted by their densities; black where the density is 0.
    pub fn color(&self, x: DVec3, d: DVec3) -> [f64; 3] {
        let (mut sum, mut weight) = ([0.0; 3], 0.0);
        for body in &self.bodies {
            let sigma = body.density(x);
            if sigma > 0.0 {
                let color = body.color(x, d);
                sum = std::array::from_fn(|k| sum[k] + sigma * color[k]);
                weight += sigma;
            }
        }
        if weight > 0.0 { sum.map(|c| c / weight) } else { sum }
    }

    /// The integral of sigma along the ray from `near` to `far`, exact: the light that passes is e^-this.
    ///
    /// ```
    /// use glam::DVec3;
    /// use nerf_oracle::{ray::Ray, scene::Medium};
    /// let slab = Medium::named("slab").unwrap();
    /// let down = Ray { o: DVec3::new(0.0, 0.0, 4.0), d: -DVec3::Z };
    /// assert!((slab.optical_depth(&down, 2.0, 6.0) - 2.0 * 0.6).abs() < 1e-15);
    /// ```
    pub fn optical_depth(&self, ray: &Ray, near: f64, far: f64) -> f64 {
        let mut depth = 0.0;
        for body in &self.bodies {
            depth += body.optical_depth(ray, near, far);
        }
        depth
    }
}

/// Five overlapping balls of different colors.
fn spheres() -> Vec<Body> {
    let ball = |x: f64, y: f64, z: f64, radius: f64, color: [f64; 3]| {
        let center = DVec3::new(x, y, z);
        Body::SoftSphere { center, radius, density: 20.0, color }
    };
    vec![
        ball(0.0, 0.0, 0.1, 0.65, [0.85, 0.25, 0.2]),
        ball(0.55, 0.2, -0.25, 0.5, [0.2, 0.65, 0.3]),
        ball(-0.45, 0.45, -0.3, 0.5, [0.2, 0.4, 0.85]),
        ball(-0.2, -0.6, -0.2, 0.45, [0.9, 0.7, 0.2]),
        ball(0.25, -0.15, 0.7, 0.35, [0.7, 0.35, 0.75]),
    ]
}

impl Body {
    /// sigma(x).
    pub fn density(&self, x: DVec3) -> f64 {
        match *self {
            Body::Slab { half, density } => {
                if x.abs().cmple(half).all() {
                    density
                } else {
                    0.0
                }
            }
            Body::Blob { deviation, density } => {
                density * exp(-x.length_squared() / (2.0 * deviation * deviation))
            }
            Body::SoftSphere { center, radius, density, .. } => {
                let inside = 1.0 - (x - center).length_squared() / (radius * radius);
                if inside > 0.0 { density * inside * inside } else { 0.0 }
            }
        }
    }

    /// c(x, d): waves across the slab, a gradient in the blob, on a ball, diffuse light and a highlight that moves with the eye.
    pub fn color(&self, x: DVec3, d: DVec3) -> [f64; 3] {
        match *self {
            Body::Slab { .. } => [0.5 + 0.4 * sin_pi(2.0 * x.x), 0.5 + 0.4 * sin_pi(2.0 * x.y), 0.6],
            Body::Blob { .. } => {
                (DVec3::splat(0.5) + x.clamp(DVec3::splat(-0.45), DVec3::splat(0.45))).to_array()
            }
            Body::SoftSphere { center, color, .. } => lit(x - center, d, color),
        }
    }

    /// The integral of sigma along the ray from `near` to `far`.
    fn optical_depth(&self, ray: &Ray, near: f64, far: f64) -> f64 {
        match *self {
            Body::Slab { half, density } => match ray_box(ray, (-half, half), near, far) {
                Some((enter, leave)) => density * (leave - enter),
                None => 0.0,
            },
            // |o + t d|^2 = b^2 + (t - m)^2: a Gaussian in t, whose integral is the error function.
            Body::Blob { deviation, density } => {
                let (m, b2) = closest(ray, DVec3::ZERO);
                let scale = deviation * std::f64::consts::SQRT_2;
                let peak = density * exp(-b2 / (scale * scale));
                let across = erf((far - m) / scale) - erf((near - m) / scale);
                peak * scale * std::f64::consts::PI.sqrt() / 2.0 * across
            }
            // With q = 1 - b^2 / R^2 and s = t - m, sigma is density (q - s^2 / R^2)^2 for |s| < R sqrt q: a polynomial.
            Body::SoftSphere { center, radius, density, .. } => {
                let (m, b2) = closest(ray, center);
                let r2 = radius * radius;
                let q = 1.0 - b2 / r2;
                if q <= 0.0 {
                    return 0.0;
                }
                let reach = radius * q.sqrt();
                let integral = |t: f64| {
                    let s = (t - m).clamp(-reach, reach);
                    s * (q * q - s * s / r2 * (2.0 * q / 3.0 - s * s / (5.0 * r2)))
                };
                density * (integral(far) - integral(near))
            }
        }
    }
}

/// Where a ray of unit direction passes closest to `center`: t there, and the square of the distance.
fn closest(ray: &Ray, center: DVec3) -> (f64, f64) {
    let m = (center - ray.o).dot(ray.d);
    (m, (ray.at(m) - center).length_squared())
}

/// Half ambient, half diffuse light, and a highlight (Blinn 1977: the half vector between light and eye, to the power 20).
fn lit(from_center: DVec3, d: DVec3, color: [f64; 3]) -> [f64; 3] {
    let light = DVec3::new(0.48, 0.36, 0.8);
    let normal = from_center.normalize_or_zero();
    let diffuse = 0.5 + 0.5 * normal.dot(light).max(0.0);
    let highlight = 0.5 * pow(normal.dot((light - d).normalize_or_zero()).max(0.0), 20.0);
    color.map(|c| (c * diffuse + highlight).min(1.0))
}

/// The part of [near, far] in which the ray is inside a box; `None` where there is none.
fn ray_box(ray: &Ray, (low, high): (DVec3, DVec3), near: f64, far: f64) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (near, far);
    for k in 0..3 {
        if ray.d[k] == 0.0 {
            if ray.o[k] < low[k] || ray.o[k] > high[k] {
                return None;
            }
            continue;
        }
        let (a, b) = ((low[k] - ray.o[k]) / ray.d[k], (high[k] - ray.o[k]) / ray.d[k]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter < leave).then_some((enter, leave))
}
