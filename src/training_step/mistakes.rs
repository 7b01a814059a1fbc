//! Training steps, wrong on purpose: the mistakes of the loop and of the loss, between rows that are right. Those of the optimizer are told
//! by `adam_step`.

use super::arrays::{steps, usual};
use super::chain::{Pass, State, names, outputs, pass, plainly, update};
use crate::contract::arrays::{Arrays, values};
use crate::contract::check::Kind;
use crate::contract::component::{Component, Mistake};
use crate::convention::Conventions;

/// The loss is a sum.
const SUM: &str = "sum_for_mean";
/// The loss is divided by the number of rays.
const BY_RAYS: &str = "mean_over_rays";

/// Mistakes of a training step.
pub(crate) const TRAINING_STEP: &[Mistake] = &[
    Mistake::new(
        "gradients_accumulate",
        "gradients are never cleared: each step adds its own to those of all steps before",
        "steps in directions of long ago; training circles around the solution",
        "clear the gradients before each backward pass (optimizer.zero_grad())",
        "hand-written training loops",
        0,
    ),
    Mistake::new(
        "rate_of_next_step",
        "the schedule moves on before the optimizer does: each step has the learning rate of the next",
        "the first learning rate is never used",
        "optimizer.step(), then scheduler.step()",
        "PyTorch warns of it since 1.1",
        0,
    ),
    Mistake::new(
        "rate_of_step_before",
        "the schedule lags by a step: the first learning rate is used twice",
        "a warm-up that begins a step late",
        "set the rate of a step before the step",
        "hand-written schedules",
        0,
    ),
    Mistake::new(
        "moments_forgotten",
        "the optimizer is built anew in each step",
        "every step is lr sign(g): no averaging, and noise of the size of lr",
        "build the optimizer once, before the loop",
        "hand-written training loops",
        0,
    ),
    Mistake::new(
        "weights_detached",
        "the weights of the samples are constants of the loss: colors learn, densities don't",
        "fog: the density stays as it was at the start",
        "differentiate through transmittance and opacity",
        "hand-written backward passes",
        0,
    ),
    Mistake::new(
        "one_half_after_the_other",
        "the color layers move first, and the gradient of the others is taken after that",
        "losses that jump where the learning rate is large",
        "take the whole gradient before the first parameter moves",
        "two optimizers in a row",
        0,
    ),
    Mistake::new(
        "biases_left_out",
        "the biases aren't handed to the optimizer",
        "black can't be learned",
        "hand all parameters to the optimizer",
        "hand-written optimizers",
        0,
    ),
    Mistake::new(
        "first_batch_for_ever",
        "every step sees the rays of the first",
        "a few pixels are learned by heart",
        "take a batch of its own for each step",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "first_draws_for_ever",
        "every step has the draws of the first",
        "stripes, and detail that the grid can't see",
        "draw u anew in each step",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "loss_after_step",
        "the loss that is reported is that of the parameters after the step",
        "curves that are a step ahead of others'",
        "report the loss whose gradient is taken",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        SUM,
        "the squared differences are summed, not averaged",
        "the loss grows with the batch; Adam's eps weighs less",
        "divide by the number of entries",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        BY_RAYS,
        "the sum over colors is divided by the number of rays, not of entries",
        "loss three times too large, PSNR 4.77 dB too low",
        "divide by all entries, channels too",
        "never; cheap to keep",
        0,
    ),
];

/// The layers whose parameters move first, where one half does.
const COLOR_LAYERS: [&str; 2] = ["color0", "color1"];

/// Trains for all steps.
pub(crate) fn training_step(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let c = &usual(c);
    // A search asks for the right answer thousands of times; that it is the rows' one after the other is for a test.
    if wrong.is_empty() {
        return super::arrays::training_step(a, c);
    }
    let rows = |kind: Kind, component: &Component, a: &Arrays| row(kind, component, a, c, wrong);
    let is = |name: &str| wrong.contains(&name);
    let (mut state, mut states, mut losses, mut first) = (State::new(a), vec![], vec![], None::<Pass>);
    let last = steps(a) - 1;
    let mut sum = vec![0.0; state.m.len()];
    for k in 0..=last {
        let seen = ["first_batch_for_ever", "first_draws_for_ever"].map(|name| if is(name) { 0 } else { k });
        let rate = match () {
            () if is("rate_of_next_step") => (k + 1).min(last),
            () if is("rate_of_step_before") => k.saturating_sub(1),
            () => k,
        };
        let step = if is("moments_forgotten") { 1 } else { k + 1 };
        let mut passed = pass(a, &state.params, seen, c, &rows, &plainly);
        if is("one_half_after_the_other") {
            let moved = update(a, &state, &passed.gradient, [rate, step], &rows);
            let halfway = joined(&moved.params, &state.params);
            let later = pass(a, &halfway, seen, c, &rows, &plainly).gradient;
            passed.gradient = in_halves(&state.params, &passed.gradient, &later);
        }
        if is("gradients_accumulate") {
            sum.iter_mut().zip(&passed.gradient).for_each(|(sum, g)| *sum += g);
            passed.gradient.clone_from(&sum);
        }
        if is("moments_forgotten") {
            (state.m, state.v) = (vec![0.0; sum.len()], vec![0.0; sum.len()]);
        }
        let mut moved = update(a, &state, &passed.gradient, [rate, step], &rows);
        if is("biases_left_out") {
            keep_biases(&mut moved, &state);
        }
        state = moved;
        losses.push(match is("loss_after_step") {
            true => pass(a, &state.params, seen, c, &rows, &plainly).loss,
            false => passed.loss,
        });
        states.push(state.clone());
        first.get_or_insert(passed);
    }
    outputs(first.expect("at least one step"), losses, &states)
}

/// A row as it is computed by somebody who makes these mistakes.
fn row(kind: Kind, component: &Component, a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let direction = component.direction(kind).expect("rows that are differentiated");
    let mut out = (direction.oracle)(a, c);
    if component.name == "mse" {
        let entries = a["prediction"].len() as f64;
        let factors = [(SUM, entries), (BY_RAYS, 3.0)];
        for (_, factor) in factors.into_iter().filter(|(name, _)| wrong.contains(name)) {
            out.values_mut().for_each(|x| *x *= factor);
        }
    }
    if component.name == "volume_render" && kind == Kind::Vjp && wrong.contains(&"weights_detached") {
        out.get_mut("grad_sigmas").expect("a gradient").fill(0.0);
    }
    out
}

fn of_colors(name: &str) -> bool {
    COLOR_LAYERS.iter().any(|layer| name.starts_with(layer))
}

/// The color layers of one network, the others of another.
fn joined(colors: &Arrays, others: &Arrays) -> Arrays {
    let pick = |name: &String| if of_colors(name) { &colors[name] } else { &others[name] };
    others.keys().map(|name| (name.clone(), pick(name).clone())).collect()
}

/// The gradient of the color layers from one row, that of the others from another.
fn in_halves(params: &Arrays, colors: &[f64], others: &[f64]) -> Vec<f64> {
    let from: Vec<bool> =
        names(params).iter().flat_map(|name| vec![of_colors(name); params[name].len()]).collect();
    (0..from.len()).map(|i| if from[i] { colors[i] } else { others[i] }).collect()
}

/// Biases stay what they were, and nothing is remembered of their gradients.
fn keep_biases(moved: &mut State, before: &State) {
    let mut used = 0;
    for name in names(&before.params) {
        let count = values(&before.params, &name).len();
        if name.ends_with("_b") {
            moved.params.insert(name.clone(), before.params[&name].clone());
            moved.m[used..used + count].copy_from_slice(&before.m[used..used + count]);
            moved.v[used..used + count].copy_from_slice(&before.v[used..used + count]);
        }
        used += count;
    }
}
