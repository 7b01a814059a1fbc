//! The interface of a trainable field, as the training loop uses it.

use std::any::Any;

use serde_json::{Map, Value};

use crate::convention::Directions;
use crate::error::Result;
use crate::files::npz::{Array, Arrays};
use crate::ray::Ray;
use crate::scene::Scene;
use crate::training::probe::{Cells, Probe};

/// The result of one optimizer step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// The loss of the batch, before the step.
    pub loss: f64,
    /// Mean squared error over the batch of the colors that a picture would show: the loss, unless regularizers are added to that.
    pub mse: f64,
    /// Points that went forward and backward through the field.
    pub samples: u64,
    /// Whether no parameter got a gradient.
    pub still: bool,
}

/// A rendered ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Premultiplied color, without background.
    pub rgb: [f32; 3],
    /// A.
    pub opacity: f32,
    /// Expected distance; far on an empty ray.
    pub depth: f32,
}

/// A field with its parameters, its optimizer's state, and its settings. `Any`, so that `bench` can downcast to one kind of model.
pub trait Model: Any + Sync + Send {
    /// One optimizer step, number `step` counted from 1: a function of step, seed and scene, never of the clock or of threads.
    fn step(&mut self, scene: &Scene, step: u64) -> Result<StepReport>;

    /// Renders rays in evaluation mode: nothing random.
    fn render(&self, rays: &[Ray]) -> Vec<Pixel>;

    /// Density and color at positions t along rays, computed by the f64 reference.
    fn probe(&self, rays: &[(Ray, Vec<f64>)]) -> Vec<Vec<Probe>>;

    /// The cells that it takes for occupied, where it keeps a grid.
    fn cells(&self) -> Option<Cells>;

    /// The length of the directions whose multiples t are: those that a ray of depth 1 has, for models that measure along the camera's axis.
    fn directions(&self) -> Directions {
        Directions::Unit
    }

    /// The whole state by name, as a checkpoint stores it.
    fn state(&self) -> Arrays {
        self.arrays().collect()
    }

    /// The same array by array, so that a large model's needn't be copied all at once.
    fn arrays(&self) -> Box<dyn Iterator<Item = (String, Array)> + '_>;

    /// Loads the state of a checkpoint.
    ///
    /// # Errors
    /// Where an array is missing or has another shape; `file` is named in the message.
    fn restore(&mut self, state: &Arrays, file: &str) -> Result<()>;

    /// Every setting, given or derived, with the reason where it was derived.
    fn settings(&self) -> Map<String, Value>;

    /// Steps until its pictures must show more than one color does, or the run is given up.
    fn start(&self) -> u64 {
        1000
    }

    /// Whether pictures with opacity are learned over all backgrounds, and not over the scene's.
    fn any_background(&self) -> bool {
        false
    }

    /// A warning for the user, e.g. that the density head died (TR1). Called at every validation.
    fn warning(&self) -> Option<String> {
        None
    }
}
