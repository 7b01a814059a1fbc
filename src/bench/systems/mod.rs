//! Trained models as [`super::system`] sees them, a file a kind of model.

use std::any::Any;

use super::system::System;
use crate::training::Model;
use crate::training::compact::CompactModel;
use crate::training::nerf::NerfModel;

mod compact;
mod nerf;

/// A trained model's ways to render; none for a pair of networks, which has no one number of samples to choose, and none in normalized
/// device coordinates, whose steps aren't even.
pub fn of(model: &mut dyn Model) -> Option<Box<dyn System + '_>> {
    let any: &mut dyn Any = model;
    if any.is::<CompactModel>() {
        return any.downcast_mut().map(|model| Box::new(compact::Trained::new(model)) as Box<dyn System>);
    }
    let alone = |model: &&mut NerfModel| model.fine.is_none() && model.settings.cube.is_none();
    let alone = any.downcast_mut::<NerfModel>().filter(alone)?;
    Some(Box::new(nerf::Trained::new(alone)))
}
