//! The cube of normalized device coordinates in the world: the view of a camera that stands anywhere, from a near plane to infinity.
//! NeRF (Mildenhall et al. 2020), appendix C: that camera's coordinates, then [`ndc_ray`] and [`ndc_point`].
//!
//! Places in the world and distances along rays have the scene's unit, whatever the length of a ray's direction; the cube is [-1, 1] wide.
//! Letters: n the near plane's depth, z a point's depth, s = 1 - n / z its place on a ray, from 0 on the near plane to 1 at infinity.

use glam::{DMat4, DVec3};

use super::{View, ndc_point, ndc_ray};
use crate::ray::Ray;

/// The depth that a unit direction must gain, at least: a ray of less is across the view, and has no place in the cube.
const FORWARD: f64 = 0.05;

/// A cube, by the camera whose view it is.
///
/// ```
/// use glam::{DMat4, DVec3};
/// use nerf_oracle::{convention::NdcDepth, ndc::{View, cube::Cube}, ray::Ray};
/// let view = View { width: 2.0, height: 2.0, focal: 1.0, near: 1.0, depth: NdcDepth::Positive };
/// let cube = Cube { w2c: DMat4::IDENTITY, view };
/// let ray = Ray { o: DVec3::ZERO, d: DVec3::Z };
/// // Straight ahead: from the near plane, half of the way at depth 2, to infinity.
/// assert_eq!(cube.ends(&ray), [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]);
/// assert_eq!((cube.distance(&ray, 0.5), cube.point([0.0, 0.0, 2.0])), (2.0, [0.0; 3]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    /// World to that camera.
    pub w2c: DMat4,
    /// Its picture, near plane and axes.
    pub view: View,
}

impl Cube {
    /// Origin and direction in that camera's coordinates.
    fn seen(&self, ray: &Ray) -> ([f64; 3], [f64; 3]) {
        let (o, d) = (self.w2c.transform_point3(ray.o), self.w2c.transform_vector3(ray.d));
        (o.to_array(), d.to_array())
    }

    /// z at the ray's origin, and what it gains on a way of 1.
    fn depth(&self, ray: &Ray) -> (f64, f64) {
        let (o, d) = self.seen(ray);
        (self.view.sign() * o[2], self.view.sign() * d[2])
    }

    /// Whether a ray goes forward, from the near plane to infinity.
    pub fn faces(&self, ray: &Ray) -> bool {
        self.depth(ray).1 > FORWARD * ray.d.length()
    }

    /// Whether the point at a distance along a ray that faces forward lies in front of the near plane.
    pub fn holds(&self, ray: &Ray, t: f64) -> bool {
        let (z, gain) = self.depth(ray);
        z + t * gain >= self.view.near
    }

    /// The distance along a ray of its place s: z = n / (1 - s). Infinity itself is as far as 2^52 near planes.
    pub fn distance(&self, ray: &Ray, s: f64) -> f64 {
        let (z, gain) = self.depth(ray);
        (self.view.near / (1.0 - s).max(f64::EPSILON) - z) / gain
    }

    /// A point of the world in the cube.
    pub fn point(&self, x: [f64; 3]) -> [f64; 3] {
        ndc_point(self.w2c.transform_point3(DVec3::from(x)).to_array(), &self.view)
    }

    /// Where a ray begins and ends in the cube: on the near plane, and at infinity.
    pub fn ends(&self, ray: &Ray) -> [[f64; 3]; 2] {
        let (o, d) = self.seen(ray);
        let (o, d) = ndc_ray(o, d, &self.view);
        [o, [0, 1, 2].map(|a| o[a] + d[a])]
    }

    /// The length of a ray's way through the cube, |d'|: steps are shares of it, and densities 1 / length.
    pub fn length(&self, ray: &Ray) -> f64 {
        let [from, to] = self.ends(ray).map(DVec3::from);
        (to - from).length()
    }

    /// The length in the cube of a short way along a ray, over that in the world: ds/dt times the whole, with ds/dt = n dz/dt / z^2.
    pub fn stretch(&self, ray: &Ray, t: f64) -> f64 {
        let (z, gain) = self.depth(ray);
        self.length(ray) * self.view.near * gain / (z + t * gain).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::convention::NdcDepth::{self, Negative, Positive};

    fn cube(depth: NdcDepth) -> Cube {
        let c2w = DMat4::from_rotation_translation(
            glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.4, 0.5),
            DVec3::new(1.0, -2.0, 0.5),
        );
        let view = View { width: 40.0, height: 24.0, focal: 36.0, near: 1.5, depth };
        Cube { w2c: c2w.inverse(), view }
    }

    /// A ray near that camera, by a place and a direction of its own.
    fn ray(cube: &Cube, o: [f64; 3], d: [f64; 3]) -> Ray {
        let c2w = cube.w2c.inverse();
        let d = [d[0], d[1], cube.view.sign() * d[2]];
        Ray { o: c2w.transform_point3(DVec3::from(o)), d: c2w.transform_vector3(DVec3::from(d)) }
    }

    /// The place s of a ray is the point that far on its way through the cube.
    #[test]
    fn places_are_even_on_the_way_through_the_cube() {
        for depth in [Negative, Positive] {
            let cube = cube(depth);
            let ray = ray(&cube, [0.2, -0.1, 0.3], [0.3, 0.2, 0.9]);
            let [from, to] = cube.ends(&ray);
            for s in [0.0, 0.25, 0.5, 0.984375] {
                let t = cube.distance(&ray, s);
                let x = cube.point(ray.at(t).to_array());
                for a in 0..3 {
                    let expected = from[a] + s * (to[a] - from[a]);
                    assert!((x[a] - expected).abs() < 1e-12, "{depth:?} {s} {a}: {} {expected}", x[a]);
                }
                // Half a millionth of the way farther on and back.
                let step = 1e-6 * (1.0 + t.abs());
                let [after, before] =
                    [t + step, t - step].map(|t| DVec3::from(cube.point(ray.at(t).to_array())));
                assert_relative_eq!(
                    cube.stretch(&ray, t),
                    (after - before).length() / (2.0 * step),
                    max_relative = 1e-6
                );
                assert!(cube.holds(&ray, t + step) && (s > 0.0 || !cube.holds(&ray, t - step)));
            }
            assert_relative_eq!(cube.length(&ray), DVec3::from(to).distance(DVec3::from(from)));
        }
    }

    #[test]
    fn rays_across_or_backward_have_no_place() {
        let cube = cube(Positive);
        let faces = |d| cube.faces(&ray(&cube, [0.0; 3], d));
        assert!(faces([0.0, 0.0, 1.0]) && faces([0.9, 0.0, 0.1]) && faces([90.0, 0.0, 10.0]));
        assert!(!faces([1.0, 0.0, 0.01]) && !faces([0.0, 0.6, -0.8]));
        // However long the direction is.
        assert!(!faces([100.0, 0.0, 1.0]) && !faces([0.0; 3]));
    }
}
