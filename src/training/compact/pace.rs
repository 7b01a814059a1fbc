//! How the samples of a model's rays follow one another: straight through a box, or winding through contracted space.

use pulp::Arch;

use super::settings::CompactSettings;
use super::space::{Space, Winding, contracted, optical_step};
use super::views::BoxRay;
use crate::occupancy_grid::fast::{MarchRay, Occupancy, Path, Steps, ray_box};

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
        self.winding.length * self.winding.longer(t)
    }

    /// The samples of rays in occupied cells.
    pub(super) fn march(&self, grid: &Occupancy, arch: Arch, march_rays: &[MarchRay], steps: &mut Steps) {
        if self.straight {
            grid.march(arch, march_rays, self.winding.length, steps);
        } else {
            grid.follow(&self.winding, march_rays, steps);
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
