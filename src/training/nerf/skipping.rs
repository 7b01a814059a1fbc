//! Skipping empty space: when the occupancy grid is updated, and its part of a checkpoint.

use ndarray::{ArrayD, IxDyn};
use serde_json::{Map, Value, json};

use super::grid::{self, Grid};
use super::{NerfModel, find};
use crate::error::{Error, Input, Result};
use crate::field::fast::{Rays, Skipping};
use crate::files::npz::{Array, Arrays};
use crate::random::{Key, Purpose};
use crate::scene::Scene;

/// When a model begins to leave samples out, and the resolution of its grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skip {
    /// Steps at which every sample is computed: until then densities are the initial network's.
    pub after: u64,
    /// Steps between updates of the grid.
    pub every: u64,
    /// Cells of the grid along an edge, a multiple of 16.
    pub resolution: usize,
}

impl Default for Skip {
    fn default() -> Self {
        Skip { after: 256, every: 64, resolution: 64 }
    }
}

/// A ray ends where less light than this comes through.
const STOP: f32 = 0.01;

/// Names in a checkpoint.
const BOX: &str = "occupancy_box";
const DENSITY: &str = "occupancy_density";

/// What is left out, given the live samples; nothing without a grid.
pub(crate) fn skipping(live: Option<&[bool]>) -> Skipping<'_> {
    Skipping { live, stop: if live.is_some() { STOP } else { 0.0 } }
}

impl NerfModel {
    /// Before a step: fills the grid when it is time, and updates it now and then.
    pub(super) fn update_grid(&mut self, scene: &Scene, step: u64) -> Result<()> {
        let Some(skip) = self.settings.skip.filter(|skip| self.fine.is_none() && step > skip.after) else {
            return Ok(());
        };
        let key = Key::new(self.settings.seed, Purpose::Occupancy);
        let length = self.step_length();
        let density_at = |points: &[f64]| self.coarse.densities(points);
        if let Some(grid) = &mut self.grid {
            let since = step - skip.after - 1;
            if since.is_multiple_of(skip.every) {
                grid.update(&key, (step, since / skip.every), length, &density_at);
            }
        } else {
            let mut grid = Grid::new(scene, &|ray| self.settings.ends(ray), skip.resolution)?;
            grid.fill(&key, step, length, &density_at);
            self.grid = Some(grid);
        }
        Ok(())
    }

    /// The samples that may have a density; `None` without a grid.
    pub(super) fn mask(&self, rays: &Rays) -> Option<Vec<bool>> {
        self.grid.as_ref().map(|grid| grid.mask(rays))
    }

    /// Rays end where less light than this comes through.
    pub(crate) fn skipping_stop(&self) -> f64 {
        if self.grid.is_some() { f64::from(STOP) } else { 0.0 }
    }

    /// A 64th of the way from near to far, over which cells are judged: a step of the paper's, whatever the samples here. A way
    /// through the cube of normalized device coordinates is at least 2 long.
    pub(crate) fn step_length(&self) -> f64 {
        let way = self.settings.far - self.settings.near;
        self.settings.cube.map_or(way, |_| 2.0) / 64.0
    }

    /// The grid's part of a checkpoint.
    pub(super) fn grid_state(&self) -> Arrays {
        let mut state = Arrays::new();
        if let Some(grid) = &self.grid {
            let density = ArrayD::from_shape_vec(IxDyn(&[grid.resolution(); 3]), grid.densities().to_vec());
            let corners = ArrayD::from_shape_vec(IxDyn(&[2, 3]), grid.corners().to_vec());
            state.insert(DENSITY.into(), Array::F32(density.expect("a value a cell")));
            state.insert(BOX.into(), Array::F64(corners.expect("two corners")));
        }
        state
    }

    /// Loads what [`Self::grid_state`] returned; a checkpoint from before the grid was filled has none.
    pub(super) fn restore_grid(&mut self, state: &Arrays, file: &str) -> Result<()> {
        self.grid = None;
        let present = [BOX, DENSITY].iter().any(|name| state.contains_key(*name));
        if let Some(Skip { resolution, .. }) = self.settings.skip.filter(|_| present) {
            let corners: Vec<f64> = find(state, BOX, &[2, 3], file)?.into_iter().collect();
            let density = find(state, DENSITY, &[resolution; 3], file)?;
            let density = density.into_iter().map(|x| x as f32).collect();
            let wrong = || {
                let remedy = "Use the checkpoint of this very run, or train it again.";
                Error::input(Input {
                    file,
                    field: BOX,
                    found: format!("{corners:?}"),
                    expected: "a lower and an upper corner",
                    remedy,
                })
            };
            let whole =
                (0..3).all(|a| corners[a] < corners[3 + a] && (corners[3 + a] - corners[a]).is_finite());
            self.grid =
                whole.then(|| Grid::from_parts(&corners, resolution, density, self.step_length())).flatten();
            self.grid.as_ref().ok_or_else(wrong)?;
        }
        Ok(())
    }

    /// The settings for `run.json`.
    pub(super) fn skipping_settings(&self) -> Map<String, Value> {
        let settings = if let Some(Skip { after, every, resolution }) = self.settings.skip {
            json!({
                "skip_samples": true, "skip_after_step": after, "skip_update_every": every, "occupancy": resolution,
                "occupancy_opacity": grid::OPACITY, "stop": STOP,
                "reasons": {
                    "skip_samples": "asked for: cells where the opacity of a 64th of the way is below occupancy_opacity have density 0, not evaluated",
                    "skip_after_step": "before it densities are still the initial network's",
                    "stop": "a color moves by at most this",
                },
            })
        } else {
            let why =
                "not asked for: every sample is evaluated, as in the paper; `skip` leaves empty space out";
            json!({"skip_samples": false, "reasons": {"skip_samples": why}})
        };
        settings.as_object().expect("an object literal").clone()
    }
}
