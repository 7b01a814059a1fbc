//! A model that works only where its scene has something: when the grid is looked after, and what a checkpoint holds of it.

use ndarray::{ArrayD, IxDyn};
use serde_json::{Map, Value, json};

use super::grid::{self, Grid};
use super::{NerfModel, find};
use crate::error::{Error, Result};
use crate::field::fast::{Rays, Skipping};
use crate::files::npz::{Array, Arrays};
use crate::random::{Key, Purpose};
use crate::scene::Scene;

/// A ray ends where less light than this comes through.
const STOP: f32 = 0.01;

/// Names in a checkpoint.
const BOX: &str = "occupancy_box";
const DENSITY: &str = "occupancy_density";

/// What is left out where so many samples are live; nothing where no grid says.
pub(super) fn skipping(live: Option<&[bool]>) -> Skipping<'_> {
    Skipping { live, stop: if live.is_some() { STOP } else { 0.0 } }
}

impl NerfModel {
    /// Before a step: fills the grid when it is time, and looks after it now and then.
    pub(super) fn look(&mut self, scene: &Scene, step: u64) -> Result<()> {
        if !self.settings.skip || self.fine.is_some() || step <= grid::FROM {
            return Ok(());
        }
        let key = Key::new(self.settings.seed, Purpose::Occupancy);
        let length = self.step_length();
        let ask = |points: &[f64]| self.coarse.densities(points);
        if let Some(grid) = &mut self.grid {
            if (step - grid::FROM - 1).is_multiple_of(grid::EVERY) {
                grid.update(&key, step, length, &ask);
            }
        } else {
            let mut grid = Grid::new(scene, self.settings.near, self.settings.far)?;
            grid.fill(&key, step, length, &ask);
            self.grid = Some(grid);
        }
        Ok(())
    }

    /// The samples that may have a density; none of this without a grid.
    pub(super) fn mask(&self, rays: &Rays) -> Option<Vec<bool>> {
        self.grid.as_ref().map(|grid| grid.mask(rays))
    }

    pub(super) fn step_length(&self) -> f64 {
        (self.settings.far - self.settings.near) / self.settings.samples as f64
    }

    /// What a checkpoint holds of the grid.
    pub(super) fn grid_state(&self) -> Arrays {
        let mut state = Arrays::new();
        if let Some(grid) = &self.grid {
            let shape = [grid::RESOLUTION; 3];
            let density = ArrayD::from_shape_vec(IxDyn(&shape), grid.densities().to_vec());
            let corners = ArrayD::from_shape_vec(IxDyn(&[2, 3]), grid.corners().to_vec());
            state.insert(DENSITY.into(), Array::F32(density.expect("a value a cell")));
            state.insert(BOX.into(), Array::F64(corners.expect("two corners")));
        }
        state
    }

    /// Takes what [`Self::grid_state`] gave; a checkpoint from before the grid was filled has none.
    pub(super) fn restore_grid(&mut self, state: &Arrays, file: &str) -> Result<()> {
        self.grid = None;
        if self.settings.skip && [BOX, DENSITY].iter().any(|name| state.contains_key(*name)) {
            let corners: Vec<f64> = find(state, BOX, &[2, 3], file)?.into_iter().collect();
            let density = find(state, DENSITY, &[grid::RESOLUTION; 3], file)?;
            let density = density.into_iter().map(|x| x as f32).collect();
            let wrong = || {
                let advice = "Use the checkpoint of this very run, or train it again.";
                Error::input(file, BOX, format!("{corners:?}"), "a lower and an upper corner", advice)
            };
            let whole =
                (0..3).all(|a| corners[a] < corners[3 + a] && (corners[3 + a] - corners[a]).is_finite());
            self.grid = whole.then(|| Grid::from_parts(&corners, density, self.step_length())).flatten();
            self.grid.as_ref().ok_or_else(wrong)?;
        }
        Ok(())
    }

    /// What `run.json` says of it.
    pub(super) fn skipping_settings(&self) -> Map<String, Value> {
        let settings = if self.settings.skip {
            json!({
                "skip": true, "skip_from_step": grid::FROM + 1, "skip_update_every": grid::EVERY,
                "occupancy": grid::RESOLUTION, "occupancy_opacity": grid::OPACITY, "stop": STOP,
            })
        } else {
            json!({"skip": false})
        };
        settings.as_object().expect("an object literal").clone()
    }
}
