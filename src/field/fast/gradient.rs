//! Gradients of a batch, from chunks that any number of threads work through.
//!
//! The batch is cut into chunks and the chunks into at most [`GROUPS`] groups, by the size of the batch alone. A group adds
//! up its chunks one after the other, the groups are added up in order: the same bits on any number of threads.

use std::sync::Mutex;

use crate::parallel;

/// The largest number of partial gradients of a batch: enough to balance threads, few enough to add up quickly.
const GROUPS: usize = 16;

/// The gradient of a batch, with the memory to compute it, kept from step to step.
#[derive(Debug, Default)]
pub struct Gradient {
    /// The gradient, flat, in the order of the parameters.
    pub values: Vec<f32>,
    /// Points with a forward pass in the last step.
    pub forward_points: usize,
    /// Points with a backward pass in the last step.
    pub backward_points: usize,
    groups: Vec<Group>,
}

/// One group's share.
#[derive(Debug, Default)]
pub(super) struct Group {
    index: usize,
    /// Its partial gradient.
    pub partial: Vec<f32>,
    /// Its share of the loss.
    pub loss: f64,
    pub forward_points: usize,
    pub backward_points: usize,
}

impl Gradient {
    /// Runs `work(chunk, group)` for all chunks, and folds partial gradients of `len` entries and losses in order.
    pub(super) fn accumulate(
        &mut self,
        len: usize,
        chunks: usize,
        work: impl Fn(usize, &mut Group) + Sync,
    ) -> f64 {
        let size = chunks.div_ceil(GROUPS).max(1);
        self.groups.resize_with(chunks.div_ceil(size), Group::default);
        for (index, group) in self.groups.iter_mut().enumerate() {
            let partial = std::mem::take(&mut group.partial);
            *group = Group { index, partial, ..Group::default() };
        }
        parallel::for_each(&mut self.groups, |group| {
            group.partial.clear();
            group.partial.resize(len, 0.0);
            for chunk in group.index * size..chunks.min((group.index + 1) * size) {
                work(chunk, group);
            }
        });
        self.values.resize(len, 0.0);
        let groups = &self.groups;
        parallel::for_chunks(&mut self.values, 1 << 14, |n, values| {
            values.fill(0.0);
            for group in groups {
                let partial = &group.partial[n << 14..];
                for (value, partial) in values.iter_mut().zip(partial) {
                    *value += partial;
                }
            }
        });
        self.forward_points = groups.iter().map(|g| g.forward_points).sum();
        self.backward_points = groups.iter().map(|g| g.backward_points).sum();
        groups.iter().map(|g| g.loss).sum()
    }
}

/// A pool of buffers, so that each thread keeps reusing its own.
#[derive(Debug)]
pub(super) struct Pool<T>(Mutex<Vec<T>>);

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Pool(Mutex::new(vec![]))
    }
}

impl<T: Default> Pool<T> {
    /// Runs `work` with a buffer that no other thread uses.
    pub(super) fn with<U>(&self, work: impl FnOnce(&mut T) -> U) -> U {
        let mut item = self.0.lock().expect("no holder panics").pop().unwrap_or_default();
        let result = work(&mut item);
        self.0.lock().expect("no holder panics").push(item);
        result
    }
}
