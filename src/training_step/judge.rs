//! Somebody's training step, judged.

use super::arrays::{adam, batches, bounds, field, trained, usual};
use super::component::TRAINING_STEP;
use super::{Batch, Field, Trained};
use crate::contract::arrays::values;
use crate::convention::CS180;
use crate::judge::Door;
use crate::optimizer::Adam;

/// The signature of [`judge()`].
#[derive(Clone, Copy, Debug)]
pub struct Steps;

/// Judges some steps of training: (field, batches, (near, far), learning rates, Adam's numbers) -> what they leave behind. The first
/// array that is off tells where the mistake is.
///
/// ```
/// use nerf_oracle::convention::CS180;
/// use nerf_oracle::optimizer::Adam;
/// use nerf_oracle::training_step::{self, Field, State, filled, flat, pass, update};
/// training_step::judge(|field, batches, bounds, rates, adam| {
///     let params = flat(&field.net);
///     let zeros = vec![0.0; params.len()];
///     let mut states = vec![State { params, m: zeros.clone(), v: zeros }];
///     let mut passes = vec![];
///     for (k, batch) in batches.iter().enumerate() {
///         let net = filled(&field.net, &states[k].params);
///         passes.push(pass(&Field { net, ..field.clone() }, batch, bounds, &CS180));
///         let (gradient, adam) = (flat(&passes[k].gradient), Adam { lr: rates[k], ..*adam });
///         states.push(update(&states[k], &gradient, &adam, k as u64 + 1, &CS180));
///     }
///     let losses = passes.iter().map(|pass| pass.loss).collect();
///     let (first, last) = (states[1].clone(), states[batches.len()].clone());
///     training_step::Trained { pass: passes.swap_remove(0), losses, first, last }
/// })
/// .profile("cs180")
/// .assert_pass();
/// ```
///
/// # Panics
/// Not here: [`report`](Door::report) and [`assert_pass`](Door::assert_pass) say when they do.
pub fn judge<'a>(
    kernel: impl Fn(&Field, &[Batch], (f64, f64), &[f64], &Adam) -> Trained + Sync + 'a,
) -> Door<'a, Steps> {
    Door::whole(&TRAINING_STEP, move |of| {
        let (a, c) = (of.arrays, usual(&CS180));
        let out = trained(kernel(&field(a, &c), &batches(a), bounds(a), &values(a, "lr"), &adam(a)));
        TRAINING_STEP.outputs.iter().map(|port| out.get(port.name).cloned()).collect()
    })
}
