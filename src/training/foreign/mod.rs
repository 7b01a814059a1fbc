//! Networks that another program has trained: rendered as that program renders them, in its own conventions.
//!
//! A [`Mapping`] says which array is which layer. The arrays stay what they were, bit by bit, under their own names: a run keeps them, and
//! gives them back.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use self::mapping::Mapping;
use self::network::{Network, Reader, Real};
use super::checkpoint::{Checkpoint, RunFolder};
use super::model::{Model, Pixel, StepReport};
use super::probe::{Cells, Probe};
use super::reference::interval_edges;
use super::sound::FOREIGN;
use crate::convention::{Conventions, Delta, Directions, Grid, LastDelta, PixelCenter};
use crate::encoding::{Encoding, positional_encoding};
use crate::error::{Error, Result};
use crate::files::npz::{Array, Arrays};
use crate::importance_sampling::{sample, sample_snapped, union};
use crate::parallel;
use crate::ray::Ray;
use crate::sample::{rest_u, sample_along_ray, step_sizes};
use crate::scene::Scene;

use crate::volume_rendering::{Rendering, volume_render};

pub mod mapping;
mod network;

#[cfg(test)]
mod tests;

/// Rays that are rendered together.
const CHUNK: usize = 32;

/// One network, or two, in either type.
enum Networks {
    Fast { coarse: Network<f32>, fine: Option<Network<f32>> },
    Reference { coarse: Network<f64>, fine: Option<Network<f64>> },
}

/// A model that is rendered alone.
pub struct ForeignModel {
    mapping: Mapping,
    conventions: Conventions,
    reference: bool,
    /// Until they are restored there are none.
    networks: Option<Networks>,
    /// As they were imported, by their names in a checkpoint.
    arrays: Arrays,
}

impl std::fmt::Debug for ForeignModel {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("ForeignModel").finish_non_exhaustive()
    }
}

impl ForeignModel {
    /// The model of a mapping, without weights yet; in f64, or in f32.
    ///
    /// # Errors
    /// Where the mapping's conventions are impossible; `file` is named.
    pub fn new(mapping: Mapping, reference: bool, file: &str) -> Result<Self> {
        let conventions = mapping.conventions(file)?;
        Ok(ForeignModel { mapping, conventions, reference, networks: None, arrays: Arrays::new() })
    }

    /// Whether its pixels are where their numbers are, not half a pixel further.
    pub fn integer_pixels(&self) -> bool {
        self.conventions.pixel_center == PixelCenter::Integer
    }

    /// Takes the arrays that the mapping names, and returns the names of the others.
    ///
    /// # Errors
    /// Where one is missing or has another shape; `file` is named.
    pub fn take(&mut self, arrays: &Arrays, file: &str) -> Result<Vec<String>> {
        let (networks, taken) = if self.reference {
            let (coarse, fine, taken) = self.read(arrays, file)?;
            (Networks::Reference { coarse, fine }, taken)
        } else {
            let (coarse, fine, taken) = self.read(arrays, file)?;
            (Networks::Fast { coarse, fine }, taken)
        };
        self.networks = Some(networks);
        let mine = arrays.iter().filter(|(name, _)| taken.contains(*name));
        self.arrays = mine.map(|(name, array)| (format!("{FOREIGN}{name}"), array.clone())).collect();
        Ok(arrays.keys().filter(|name| !taken.contains(*name)).cloned().collect())
    }

    fn read<A: Real>(
        &self,
        arrays: &Arrays,
        file: &str,
    ) -> Result<(Network<A>, Option<Network<A>>, BTreeSet<String>)> {
        let mut taken = BTreeSet::new();
        let mut one = |prefix: &str| {
            let mut reader = Reader { arrays, mapping: &self.mapping, prefix, file, taken: vec![] };
            let network = Network::read(&mut reader, self.conventions)?;
            taken.extend(reader.taken);
            Ok(network)
        };
        let coarse = one(&self.mapping.networks.coarse)?;
        let fine = self.mapping.networks.fine.as_deref().map(&mut one).transpose()?;
        Ok((coarse, fine, taken))
    }

    /// Positions between two ends at rest: in the middle of intervals, or evenly with both ends.
    fn places(&self, near: f64, far: f64, n: usize) -> Vec<f64> {
        match self.conventions.grid {
            Grid::Intervals => {
                sample_along_ray(near, far, &vec![rest_u(self.conventions.rest); n], Grid::Intervals)
            }
            _ => sample_along_ray(near, far, &vec![0.0; n], Grid::EndsPlusSpacing),
        }
    }

    /// Samples of the second network beside those of the first, ascending.
    fn finer(&self, t: &[f64], weights: &[f64]) -> Vec<f64> {
        let (c, n) = (&self.conventions, t.len());
        let (edges, weights) = match c.grid {
            Grid::Intervals => (interval_edges(self.mapping.near, self.mapping.far, n), weights),
            _ => ((1..n).map(|i| 0.5 * (t[i - 1] + t[i])).collect(), &weights[1..n - 1]),
        };
        let u = self.places(0.0, 1.0, self.mapping.samples.fine);
        let padding = c.pdf_padding.value(0.0);
        let drawn = match c.pdf_division.faint() {
            None => sample(&edges, weights, padding, &u),
            Some(faint) => sample_snapped(&edges, weights, padding, &u, faint),
        };
        union(t, &drawn)
    }

    /// Steps of samples on a ray whose direction has a length.
    fn steps(&self, t: &[f64], length: f64, fine: bool) -> Vec<f64> {
        let (c, Mapping { near, far, .. }) = (&self.conventions, &self.mapping);
        // Samples that were drawn have no width.
        let (delta, last) = match c.delta {
            Delta::Width if fine => (Delta::Differences, LastDelta::ToFar),
            delta => (delta, c.last_delta),
        };
        let steps = step_sizes(t, *near, *far, delta, last);
        let factor = if delta == Delta::DifferencesTimesNorm { length } else { 1.0 };
        steps.into_iter().map(|step| factor * step).collect()
    }

    /// Densities and colors of one network along rays, each with its own samples, one after the other.
    fn field<A: Real>(
        &self,
        network: &Network<A>,
        rays: &[Ray],
        t: &[Vec<f64>],
    ) -> (Vec<f64>, Vec<[f64; 3]>) {
        let (position, direction) = self.mapping.encodings(&self.conventions);
        let of_view = |ray: &Ray, encoding: &Encoding| {
            positional_encoding(&(ray.d / ray.d.length()).to_array(), encoding)
        };
        let (mut positions, mut directions) = (vec![], vec![]);
        for (ray, t) in rays.iter().zip(t) {
            let view = direction.as_ref().map(|encoding| of_view(ray, encoding)).unwrap_or_default();
            for &t in t {
                positions.extend(positional_encoding(&ray.at(t).to_array(), &position));
                directions.extend(&view);
            }
        }
        network.forward(&positions, &directions, t.iter().map(Vec::len).sum())
    }

    /// The same, rendered.
    fn along<A: Real>(
        &self,
        network: &Network<A>,
        rays: &[Ray],
        t: &[Vec<f64>],
        fine: bool,
    ) -> Vec<Rendering> {
        let (sigmas, rgbs) = self.field(network, rays, t);
        let mut from = 0;
        let one = |(ray, t): (&Ray, &Vec<f64>)| {
            let of = from..from + t.len();
            from = of.end;
            let deltas = self.steps(t, ray.d.length(), fine);
            volume_render(&sigmas[of.clone()], &rgbs[of], &deltas, self.conventions.product_eps)
        };
        rays.iter().zip(t).map(one).collect()
    }

    fn pixels<A: Real>(&self, coarse: &Network<A>, fine: Option<&Network<A>>, rays: &[Ray]) -> Vec<Pixel> {
        let Mapping { near, far, samples, .. } = &self.mapping;
        let mut t = vec![self.places(*near, *far, samples.coarse); rays.len()];
        let mut seen = self.along(coarse, rays, &t, false);
        if let Some(fine) = fine {
            t = t.iter().zip(&seen).map(|(t, seen)| self.finer(t, &seen.weights)).collect();
            seen = self.along(fine, rays, &t, true);
        }
        let pixel = |n: usize| {
            let Rendering { color, opacity, weights, .. } = &seen[n];
            let weighted = weights.iter().zip(&t[n]).map(|(w, t)| w * t).sum::<f64>() * rays[n].d.length();
            let depth = if *opacity > 0.0 { weighted / opacity } else { *far };
            Pixel { rgb: color.map(|c| c as f32), opacity: *opacity as f32, depth: depth as f32 }
        };
        (0..rays.len()).map(pixel).collect()
    }
}

impl Model for ForeignModel {
    fn step(&mut self, _: &Scene, _: u64) -> Result<StepReport> {
        Err(Error::usage(
            "model",
            "imported weights",
            "a model of this program: imported ones are rendered alone",
        ))
    }

    fn directions(&self) -> Directions {
        self.conventions.directions
    }

    fn render(&self, rays: &[Ray]) -> Vec<Pixel> {
        let chunks: Vec<&[Ray]> = rays.chunks(CHUNK).collect();
        let one = |n: usize| match self.networks.as_ref().expect("weights were taken or restored") {
            Networks::Fast { coarse, fine } => self.pixels(coarse, fine.as_ref(), chunks[n]),
            Networks::Reference { coarse, fine } => self.pixels(coarse, fine.as_ref(), chunks[n]),
        };
        parallel::map(chunks.len(), one).concat()
    }

    fn probe(&self, rays: &[(Ray, Vec<f64>)]) -> Vec<Vec<Probe>> {
        let networks = self.networks.as_ref().expect("weights were taken or restored");
        parallel::map(rays.len(), |n| {
            let (ray, t) = (std::slice::from_ref(&rays[n].0), std::slice::from_ref(&rays[n].1));
            let (sigmas, rgbs) = match networks {
                Networks::Fast { coarse, fine } => self.field(fine.as_ref().unwrap_or(coarse), ray, t),
                Networks::Reference { coarse, fine } => self.field(fine.as_ref().unwrap_or(coarse), ray, t),
            };
            sigmas.into_iter().zip(rgbs).map(|(density, rgb)| Probe { density, rgb }).collect()
        })
    }

    fn cells(&self) -> Option<Cells> {
        None
    }

    fn arrays(&self) -> Box<dyn Iterator<Item = (String, Array)> + '_> {
        Box::new(self.arrays.clone().into_iter())
    }

    fn restore(&mut self, state: &Arrays, file: &str) -> Result<()> {
        self.take(&own(state), file).map(|_| ())
    }

    fn settings(&self) -> Map<String, Value> {
        let mapping = serde_json::to_value(&self.mapping).expect("plain data");
        mapping.as_object().expect("an object").clone()
    }
}

/// The imported arrays of a checkpoint's state, under their own names.
pub fn own(state: &Arrays) -> Arrays {
    let own =
        |(name, array): (&String, &_)| Some((name.strip_prefix(FOREIGN)?.to_string(), Clone::clone(array)));
    state.iter().filter_map(own).collect()
}

/// Writes the only checkpoint of a run that isn't trained.
///
/// # Errors
/// Where a file can't be written.
pub fn keep(folder: &RunFolder, model: &ForeignModel) -> Result<()> {
    folder.begin_log()?;
    folder.save(Checkpoint { state: model.arrays(), step: 0, seconds: 0.0, samples: 0 })
}
