//! How the scene is laid into the unit box of tables and occupancy grid, and how samples follow one another along a ray.
//!
//! What is bounded fills the box as it is, in even steps. An unbounded scene is contracted as mip-NeRF 360 has it: its inner cube takes
//! the middle half of the box, the rest of the world what is around. Steps are even as far as the cube goes, and even in 1 / distance from
//! there on, as the contraction's cells are.

use super::CompactModel;
use super::settings::CompactSettings;
use super::step::optical_step;
use super::views::BoxRay;
use crate::occupancy_grid::fast::{MarchRay, Path, Steps, ray_box};

/// How far rays go in an unbounded scene, in half edges of the inner cube: what is farther would share the last cells of the grid.
pub(crate) const HORIZON: f64 = 100.0;

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

/// How samples follow one another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    winding: Winding,
    straight: bool,
    /// An even step, in the unit in which the network's densities are 1 / length.
    delta: f32,
}

impl Pace {
    /// `samples` even steps across the cube.
    pub(super) fn new(settings: &CompactSettings, samples: f64) -> Self {
        let (straight, even) = match settings.space {
            Space::Box => (true, f64::INFINITY),
            Space::Contracted { even } => (false, even),
        };
        let winding = Winding { length: (settings.size / samples) as f32, even: even as f32 };
        Pace { winding, straight, delta: optical_step(samples) }
    }

    /// Even steps of so much, in both units.
    #[cfg(test)]
    pub(super) fn even(length: f32, delta: f32) -> Self {
        Pace { winding: Winding { length, even: f32::INFINITY }, straight: true, delta }
    }

    /// The length of the step at a distance.
    #[inline(always)]
    pub(super) fn step(&self, t: f32) -> f32 {
        self.winding.length * (t / self.winding.even).max(1.0).powi(2)
    }

    /// The samples of rays in occupied cells.
    pub(super) fn march(&self, model: &CompactModel, march_rays: &[MarchRay], steps: &mut Steps) {
        if self.straight {
            model.occupancy.march(model.arch, march_rays, self.winding.length, steps);
        } else {
            model.occupancy.follow(&self.winding, march_rays, steps);
        }
    }

    /// Distances, step lengths and points of a ray's samples.
    #[inline(always)]
    pub(super) fn place(
        &self,
        ray: &MarchRay,
        k: &[f32],
        [t, delta]: [&mut Vec<f32>; 2],
        points: &mut Vec<[f32; 3]>,
    ) {
        let first = t.len();
        if self.straight {
            points.extend(k.iter().map(|&k| ray.at(k, self.winding.length)));
            t.extend(k.iter().map(|&k| (k + ray.u) * self.winding.length));
            delta.extend(k.iter().map(|_| self.delta));
            return;
        }
        points.extend(k.iter().map(|&k| self.winding.at(ray, k)));
        t.extend(k.iter().map(|&k| self.winding.t(k + ray.u)));
        let samples = t[first..].iter().zip(&points[first..]);
        delta.extend(samples.map(|(&t, &p)| self.delta * self.winding.stretch(t, p)));
    }

    /// All points of a ray between two distances, occupied or not.
    pub(super) fn everywhere(&self, ray: &BoxRay, [near, far]: [f32; 2]) -> Vec<[f32; 3]> {
        let (enter, leave) = if self.straight { ray_box(ray.o, ray.d) } else { (0.0, f32::INFINITY) };
        let (near, far) = (enter.max(near), leave.min(far));
        let point = |t: f32| std::array::from_fn(|a| ray.o[a] + t * ray.d[a]);
        let Winding { length, .. } = self.winding;
        if self.straight {
            let count = ((far - near) / length).max(0.0) as usize;
            return (0..count).map(|k| point(near + (k as f32 + 0.5) * length)).collect();
        }
        let from = self.winding.s(near);
        let count = (self.winding.s(far) - from).max(0.0) as usize;
        (0..count).map(|k| contracted(point(self.winding.t(from + k as f32 + 0.5)))).collect()
    }
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

    /// How much longer the step at a sample is than an even one, over how much thinner a density there is than in the cube: by r^2, r
    /// the size of its largest coordinate, so that a cell of the grid is as deep anywhere. `p` is the sample in the unit box.
    #[inline(always)]
    pub(super) fn stretch(&self, t: f32, p: [f32; 3]) -> f32 {
        let inverse = p.into_iter().fold(1.0, |least: f32, x| least.min(2.0 - (4.0 * x - 2.0).abs()));
        let longer = (t / self.even).max(1.0) * inverse;
        longer * longer
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
