//! What a trained field holds in space, for people who look into it: densities and colors along rays, and the cells that aren't empty.

use glam::DVec3;

/// A field at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Probe {
    /// sigma, in 1 / length of the scene; 0 where the model doesn't look because it takes space for empty.
    pub density: f64,
    /// Color in [0, 1].
    pub rgb: [f64; 3],
}

/// A grid that says which part of a box may hold something.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// The box.
    pub low: DVec3,
    /// Its other corner.
    pub high: DVec3,
    /// Cells along an edge.
    pub resolution: usize,
    /// Whether a cell is occupied, x fastest.
    pub occupied: Vec<bool>,
}

impl Cells {
    /// The same with at most `most` cells along an edge, each occupied where any of those that it stands for is.
    ///
    /// ```
    /// use nerf_oracle::{glam::DVec3, training::probe::Cells};
    /// let mut occupied = vec![false; 64];
    /// occupied[4 * 4 * 3] = true; // x 0, y 0, z 3
    /// let cells = Cells { low: DVec3::ZERO, high: DVec3::ONE, resolution: 4, occupied }.coarser(2);
    /// assert_eq!((cells.resolution, cells.occupied), (2, vec![false, false, false, false, true, false, false, false]));
    /// ```
    pub fn coarser(self, most: usize) -> Cells {
        let r = self.resolution;
        let side = r.div_ceil(most.max(1)).max(1);
        // Only whole steps, so that the box stays the same.
        let side = (side..=r).find(|side| r.is_multiple_of(*side)).unwrap_or(1);
        let resolution = r / side;
        let mut occupied = vec![false; resolution.pow(3)];
        for (cell, _) in self.occupied.iter().enumerate().filter(|(_, occupied)| **occupied) {
            let [x, y, z] = [cell % r, cell / r % r, cell / r / r].map(|i| i / side);
            occupied[(z * resolution + y) * resolution + x] = true;
        }
        Cells { resolution, occupied, ..self }
    }
}

#[cfg(test)]
mod tests {
    use crate::convention::ProductEps;
    use crate::field::nerf_mlp::Shape;
    use crate::ray::{Ray, camera_ray};
    use crate::scene::{self, Options, Scene};
    use crate::training::Model;
    use crate::training::compact::{CompactModel, Overrides};
    use crate::training::nerf::{NerfModel, NerfSettings};
    use crate::volume_rendering::volume_render;

    /// What is probed along a ray in `n` steps, rendered, is what the model renders: densities have the scene's unit, colors their place.
    fn agrees(model: &dyn Model, scene: &Scene, n: usize, most: f64) {
        let camera = &scene.train[0].camera;
        let rays: Vec<Ray> =
            [2.5, 4.0, 5.5].map(|at| camera_ray(camera, glam::DVec2::splat(at)).unwrap()).to_vec();
        let delta = (scene.far - scene.near) / n as f64;
        let t: Vec<f64> = (0..n).map(|i| scene.near + (i as f64 + 0.5) * delta).collect();
        let asked: Vec<(Ray, Vec<f64>)> = rays.iter().map(|ray| (*ray, t.clone())).collect();
        let mut met = false;
        for (pixel, probes) in model.render(&rays).iter().zip(model.probe(&asked)) {
            let sigmas: Vec<f64> = probes.iter().map(|probe| probe.density).collect();
            let rgbs: Vec<[f64; 3]> = probes.iter().map(|probe| probe.rgb).collect();
            let seen = volume_render(&sigmas, &rgbs, &vec![delta; n], ProductEps::None);
            met |= seen.opacity > 0.02;
            assert!((seen.opacity - f64::from(pixel.opacity)).abs() < most, "{seen:?} {pixel:?}");
            (0..3).for_each(|k| assert!((seen.color[k] - f64::from(pixel.rgb[k])).abs() < most, "{pixel:?}"));
        }
        assert!(met, "empty rays agree with anything");
    }

    #[test]
    fn what_is_probed_is_what_is_rendered() {
        let scene = scene::load("builtin:spheres,size=8,views=3", &Options::default()).unwrap();
        let mut compact = CompactModel::new(&scene, &Overrides::default()).unwrap();
        for step in 1..40 {
            compact.step(&scene, step).unwrap();
        }
        // The model marches in steps of its own.
        agrees(&compact, &scene, 1024, 0.04);
        let cells = compact.cells().unwrap();
        assert_eq!(cells.occupied.len(), cells.resolution.pow(3));
        assert!(cells.occupied.contains(&true) && cells.occupied.contains(&false));

        let shape = Shape { width: 16, color: 8, ..Shape::PAPER };
        let settings = NerfSettings::new(scene.near, scene.far, scene.background);
        let mut nerf = NerfModel::new(NerfSettings { shape, rays: 64, samples: 128, ..settings });
        // The first step sees to it that there are densities.
        nerf.step(&scene, 1).unwrap();
        agrees(&nerf, &scene, 128, 1e-3);
        assert!(nerf.cells().is_none());
    }
}
