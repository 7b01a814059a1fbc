//! What a trainable field is to the training loop, whatever is inside.

use std::any::Any;

use serde_json::{Map, Value};

use crate::error::Result;
use crate::files::npz::Arrays;
use crate::ray::Ray;
use crate::scene::Scene;

/// What one optimizer step did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// What was minimized over the batch, before the step.
    pub loss: f64,
    /// Mean squared error over the batch of the colors that a picture would show: the loss, where nothing is added to it.
    pub mse: f64,
    /// Points that went forward and backward through the field.
    pub samples: u64,
}

/// What a ray sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Premultiplied color, without background.
    pub rgb: [f32; 3],
    /// A.
    pub opacity: f32,
    /// Expected distance; far where nothing is met.
    pub depth: f32,
}

/// A field with its parameters, its optimizer's state, and its settings. `Any`, so that whoever measures one kind of model can ask for it.
pub trait Model: Any + Sync + Send {
    /// One optimizer step, number `step` counted from 1: a function of step, seed and scene, never of the clock or of threads.
    fn step(&mut self, scene: &Scene, step: u64) -> Result<StepReport>;

    /// Renders rays in evaluation mode: nothing random.
    fn render(&self, rays: &[Ray]) -> Vec<Pixel>;

    /// All state, by name: what a checkpoint holds.
    fn state(&self) -> Arrays;

    /// Takes the state of a checkpoint.
    ///
    /// # Errors
    /// Where an array is missing or has another shape; `file` is named in the message.
    fn restore(&mut self, state: &Arrays, file: &str) -> Result<()>;

    /// Every setting, given or derived, with the reason where it was derived.
    fn settings(&self) -> Map<String, Value>;

    /// Something that a user should hear about, e.g. a density head that died (TR1). Asked at every validation.
    fn warning(&self) -> Option<String> {
        None
    }
}
