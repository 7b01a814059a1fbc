//! The model as named arrays, for checkpoints: everything that the next step depends on.

use ndarray::{ArrayD, IxDyn};

use super::CompactModel;
use super::networks::{NAMES, Weights};
use crate::error::{Error, Input, Result};
use crate::files::npz::{Array, Arrays};
use crate::occupancy_grid::fast::Occupancy;

/// What is kept of every parameter: itself, Adam's running means, its own.
const KINDS: [&str; 4] = ["param", "m", "v", "mean"];

const REMEDY: &str = "Train the run again, or use the checkpoint of this very run.";

fn f32s(shape: &[usize], values: &[f32]) -> Array {
    Array::F32(
        ArrayD::from_shape_vec(IxDyn(shape), values.to_vec()).expect("as many values as the shape says"),
    )
}

fn i64s(values: Vec<i64>) -> Array {
    Array::I64(ArrayD::from_shape_vec(IxDyn(&[values.len()]), values).expect("a flat array"))
}

fn wrong(file: &str, name: &str, found: impl ToString, expected: impl ToString) -> Error {
    Error::input(Input { file, field: name, found, expected, remedy: REMEDY })
}

/// Copies array `name` into `out`, whose length it must have.
fn copy(state: &Arrays, name: &str, file: &str, out: &mut [f32]) -> Result<()> {
    let expected = format!("{} f32 values", out.len());
    match state.get(name) {
        Some(Array::F32(array)) if array.len() == out.len() => {
            out.iter_mut().zip(array).for_each(|(out, x)| *out = *x);
            Ok(())
        }
        Some(array) => Err(wrong(file, name, format!("{} {:?}", array.dtype(), array.shape()), expected)),
        None => Err(wrong(file, name, "no such array", expected)),
    }
}

fn whole(state: &Arrays, name: &str, file: &str) -> Result<Vec<i64>> {
    match state.get(name) {
        Some(Array::I64(array)) => Ok(array.iter().copied().collect()),
        Some(array) => Err(wrong(file, name, array.dtype(), "i64 values")),
        None => Err(wrong(file, name, "no such array", "i64 values")),
    }
}

impl CompactModel {
    fn weights(&self) -> [&Weights; 4] {
        let nets = &self.nets;
        [&nets.weights, &nets.m, &nets.v, &nets.mean]
    }

    fn weights_mut(&mut self) -> [&mut Weights; 4] {
        let nets = &mut self.nets;
        [&mut nets.weights, &mut nets.m, &mut nets.v, &mut nets.mean]
    }

    pub(super) fn to_arrays(&self) -> Arrays {
        let mut out = Arrays::new();
        for (l, level) in self.levels.iter().enumerate() {
            for (kind, entries) in KINDS.into_iter().zip(level.state()) {
                out.insert(format!("level{l}_{kind}"), f32s(&[entries.len(), 4], entries.as_flattened()));
            }
        }
        for (kind, weights) in KINDS.into_iter().zip(self.weights()) {
            for (name, part) in NAMES.into_iter().zip(weights.parts()) {
                out.insert(format!("{name}_{kind}"), f32s(&[part.len()], part));
            }
        }
        let r = self.occupancy.resolution;
        out.insert("occupancy_density".into(), f32s(&[r, r, r], &self.occupancy.density));
        out.insert("occupancy_found".into(), f32s(&[r, r, r], &self.occupancy.found));
        for (name, bits) in ["occupancy_bits", "occupancy_opaque"].into_iter().zip(self.occupancy.bits()) {
            out.insert(name.into(), i64s(bits.into_iter().map(|b| b as i64).collect()));
        }
        out.insert("compact_again".into(), i64s(self.again.iter().map(|&pixel| i64::from(pixel)).collect()));
        out.insert("compact_progress".into(), i64s(vec![self.step as i64, self.rays as i64]));
        out
    }

    pub(super) fn take_arrays(&mut self, state: &Arrays, file: &str) -> Result<()> {
        // A checkpoint from before there was a mean: that begins as the parameters.
        let averaged = state.contains_key("level0_mean");
        let source = |kind: &'static str| if kind == "mean" && !averaged { "param" } else { kind };
        for (l, level) in self.levels.iter_mut().enumerate() {
            for (kind, entries) in KINDS.into_iter().zip(level.state_mut()) {
                copy(state, &format!("level{l}_{}", source(kind)), file, entries.as_flattened_mut())?;
            }
        }
        for (kind, weights) in KINDS.into_iter().zip(self.weights_mut()) {
            for (name, part) in NAMES.into_iter().zip(weights.parts_mut()) {
                copy(state, &format!("{name}_{}", source(kind)), file, part)?;
            }
        }
        self.nets.transpose();
        let resolution =
            state.get("occupancy_density").and_then(|array| array.shape().first().copied()).unwrap_or(0);
        if ![super::occupancy::FIRST_RESOLUTION, self.settings.occupancy].contains(&resolution) {
            let expected = format!("a cubic grid of {} cells an edge", self.settings.occupancy);
            return Err(wrong(file, "occupancy_density", format!("{resolution} cells an edge"), expected));
        }
        let mut density = vec![0.0; resolution.pow(3)];
        copy(state, "occupancy_density", file, &mut density)?;
        let bits = |name| Ok(whole(state, name, file)?.into_iter().map(|b| b as u64).collect::<Vec<_>>());
        let occupied = bits("occupancy_bits")?;
        // A checkpoint from before rays ended behind opaque cells has no such cells, and no rays to draw again.
        let known = state.contains_key("occupancy_opaque");
        let opaque = if known { bits("occupancy_opaque")? } else { vec![0; occupied.len()] };
        self.occupancy = Occupancy::from_parts(resolution, density, &occupied, &opaque).ok_or_else(|| {
            wrong(file, "occupancy_bits or occupancy_opaque", "another length", "64 cells a word")
        })?;
        // Neither did an older one tell what it had found from what it knew.
        if state.contains_key("occupancy_found") {
            copy(state, "occupancy_found", file, &mut self.occupancy.found)?;
        }
        let again = if known { whole(state, "compact_again", file)? } else { vec![] };
        self.again = again
            .into_iter()
            .map(|pixel| u32::try_from(pixel).ok().filter(|&pixel| self.views.has(pixel as usize)))
            .collect::<Option<_>>()
            .ok_or_else(|| {
                wrong(file, "compact_again", "other numbers", "pixels of the training pictures")
            })?;
        let [step, rays] = whole(state, "compact_progress", file)?[..] else {
            return Err(wrong(file, "compact_progress", "another length", "step and rays"));
        };
        (self.step, self.rays) = (step.max(0) as u64, rays.max(1) as usize);
        Ok(())
    }
}
