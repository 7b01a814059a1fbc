//! How the scene is laid into the unit box of tables and occupancy grid, and how samples follow one another along a ray.
//!
//! What is bounded fills the box as it is, in even steps. An unbounded scene is contracted as mip-NeRF 360 has it: its inner cube takes
//! the middle half of the box, the rest of the world what is around. Steps are even as far as the cube goes, and even in 1 / distance from
//! there on, as the contraction's cells are.

use crate::occupancy_grid::fast::{MarchRay, Path};

/// The part of space that a model holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Space {
    /// The cube alone.
    Box,
    /// Everything around the cube too; steps are even up to the distance `even`.
    Contracted { even: f64 },
}

impl Space {
    /// For `run.json`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Space::Box => "box",
            Space::Contracted { .. } => "contracted",
        }
    }

    /// Edges of the cube that the unit box is wide: a cell of the grid inside of the cube is larger by this.
    pub(crate) fn width(self) -> f64 {
        match self {
            Space::Box => 1.0,
            Space::Contracted { .. } => 2.0,
        }
    }
}

/// The box's edge in the unit in which densities are 1 / length: a network that starts at density 1 starts with e^-3 of the light coming
/// through, whatever the scene's unit.
pub(crate) const OPTICAL_SIZE: f64 = 3.0;

/// The step length in that unit.
pub(crate) fn optical_step(samples: f64) -> f32 {
    (OPTICAL_SIZE / samples) as f32
}

/// A ray's way through the contracted box: sample k at the distance [`Winding::t`] of k + u.
#[derive(Clone, Copy, Debug)]
pub(super) struct Winding {
    /// The length of an even step.
    pub length: f32,
    /// Distance up to which steps are even.
    pub even: f32,
}

impl Winding {
    /// Distance of a place along the ray, in steps: x = l s up to e = even, then e / (2 - x / e), so that a step is l (t / e)^2 long.
    #[inline(always)]
    pub(super) fn t(&self, s: f32) -> f32 {
        let t = s * self.length;
        if t <= self.even { t } else { self.even / (2.0 - t / self.even) }
    }

    /// The inverse: steps to a distance.
    #[inline(always)]
    pub(super) fn s(&self, t: f32) -> f32 {
        let even = if t <= self.even { t } else { self.even * (2.0 - self.even / t) };
        even / self.length
    }

    /// How many times an even step's length the step at a distance is long.
    #[inline(always)]
    pub(super) fn longer(&self, t: f32) -> f32 {
        (t / self.even).max(1.0).powi(2)
    }

    /// What a sample's density is multiplied by in even steps: the step is longer, and a density thinner than in the cube, by r^2, r
    /// the size of its largest coordinate, so that a cell of the grid is as deep anywhere. `p` is the sample in the unit box.
    #[inline(always)]
    pub(super) fn stretch(&self, t: f32, p: [f32; 3]) -> f32 {
        let inverse = p.into_iter().fold(1.0, |least: f32, x| least.min(2.0 - (4.0 * x - 2.0).abs()));
        self.longer(t) * inverse.powi(2)
    }
}

/// A point in units of the inner cube, contracted as [`crate::contraction::contract`] has it with its largest coordinate and the unit box.
#[inline(always)]
pub(super) fn contracted(x: [f32; 3]) -> [f32; 3] {
    let v = x.map(|x| 2.0 * x - 1.0);
    let r = v[0].abs().max(v[1].abs()).max(v[2].abs());
    let scale = if r <= 1.0 { 1.0 } else { (2.0 - 1.0 / r) / r };
    v.map(|v| (0.25 * scale * v + 0.5).clamp(0.0, 1.0))
}

/// The ray's point at a distance, in units of the inner cube.
#[inline(always)]
fn along(ray: &MarchRay, t: f32) -> [f32; 3] {
    std::array::from_fn(|a| ray.o[a] + t * ray.d[a])
}

impl Path for Winding {
    #[inline(always)]
    fn ends(&self, ray: &MarchRay) -> [f32; 2] {
        [(self.s(ray.near) - ray.u).ceil().max(0.0), self.s(ray.far) - ray.u]
    }

    #[inline(always)]
    fn at(&self, ray: &MarchRay, k: f32) -> [f32; 3] {
        contracted(along(ray, self.t(k + ray.u)))
    }

    /// With v = 2 x - 1 and r the size of its largest coordinate, a coordinate of p changes by (4/r - 3/r^2) / 4 of what v does at the
    /// most: by a third anywhere, by 2/r as long as r hasn't fallen to its half.
    #[inline(always)]
    fn within(&self, ray: &MarchRay, k: f32, distance: f32) -> f32 {
        let t = self.t(k + ray.u);
        let r = along(ray, t).into_iter().fold(0.0, |most: f32, x| most.max((2.0 * x - 1.0).abs()));
        let speed = ray.d.into_iter().fold(0.0, |most: f32, d| most.max(2.0 * d.abs()));
        let further = distance / speed * (0.5 * r).max(3.0);
        self.s(t + further) - ray.u - k
    }
}
