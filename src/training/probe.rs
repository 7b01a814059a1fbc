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
