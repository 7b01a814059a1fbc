//! The components of a training step, run one after the other on named arrays: this is how honest and wrong steps are computed.

use ndarray::{ArrayD, Axis, IxDyn};

use super::arrays::{of_step, steps};
use crate::contract::arrays::{Arrays, array, arrays, input, number, scalar, threes, values};
use crate::contract::check::Kind;
use crate::contract::component::Component;
use crate::convention::{Conventions, Delta};
use crate::field::component::NERF_MLP;
use crate::loss::component::MSE;
use crate::optimizer::component::ADAM_STEP;
use crate::sample::component::{SAMPLE_ALONG_RAYS, STEP_SIZES};
use crate::volume_rendering::component::VOLUME_RENDER;

/// How a row is computed in one direction.
pub(super) type Run<'a> = &'a dyn Fn(Kind, &Component, &Arrays) -> Arrays;

/// How a step is stretched by the length of its ray's direction, where that is the convention.
pub(super) type Stretch<'a> = &'a dyn Fn(f64, [f64; 3]) -> f64;

/// delta |d|.
pub(super) fn plainly(delta: f64, d: [f64; 3]) -> f64 {
    delta * glam::DVec3::from(d).length()
}

/// A pass over the batch of one step.
pub(super) struct Pass {
    pub t: ArrayD<f64>,
    pub deltas: ArrayD<f64>,
    pub colors: ArrayD<f64>,
    pub loss: f64,
    /// Parameter by parameter.
    pub gradient: Vec<f64>,
}

/// Parameters and moments.
#[derive(Clone)]
pub(super) struct State {
    pub params: Arrays,
    pub m: Vec<f64>,
    pub v: Vec<f64>,
}

/// The names of the parameters' arrays, in the order in which they stand in a row.
pub(super) fn names(a: &Arrays) -> Vec<String> {
    let trunk = (0..).map(|n| format!("trunk{n}")).take_while(|name| a.contains_key(&format!("{name}_w")));
    let heads = ["sigma", "feature", "color0", "color1"].map(String::from);
    trunk.chain(heads).flat_map(|name| [format!("{name}_w"), format!("{name}_b")]).collect()
}

/// Arrays one after the other, each with this in front of its name.
fn row(a: &Arrays, names: &[String], prefix: &str) -> Vec<f64> {
    names.iter().flat_map(|name| values(a, &format!("{prefix}{name}"))).collect()
}

impl State {
    /// Before the first step.
    pub(super) fn new(a: &Arrays) -> State {
        let params: Arrays = names(a).into_iter().map(|name| (name.clone(), a[&name].clone())).collect();
        let count = params.values().map(|array| array.len()).sum();
        State { params, m: vec![0.0; count], v: vec![0.0; count] }
    }

    /// The parameters in a row.
    pub(super) fn row(&self) -> Vec<f64> {
        row(&self.params, &names(&self.params), "")
    }
}

/// Runs sample_along_rays, step_sizes, nerf_mlp, volume_render and mse, and the last three of them backwards. The rays are those of step
/// `batch`, the draws those of step `draws`.
pub(super) fn pass(
    a: &Arrays,
    params: &Arrays,
    [batch, draws]: [usize; 2],
    c: &Conventions,
    run: Run,
    stretch: Stretch,
) -> Pass {
    let (mut rays, [near, far]) = (of_step(a, batch), ["near", "far"].map(|name| input(a, name).clone()));
    rays.insert("u".into(), input(a, "u").index_axis(Axis(0), draws).to_owned());
    let (count, n) = (rays["u"].shape()[0], rays["u"].shape()[1]);
    rays.extend(arrays([("near", near.clone()), ("far", far.clone())]));
    let along = run(Kind::Forward, &SAMPLE_ALONG_RAYS, &rays);
    let ends = arrays([("t", along["t"].clone()), ("near", near), ("far", far)]);
    let mut deltas = run(Kind::Forward, &STEP_SIZES, &ends)["deltas"].clone();
    if c.delta == Delta::DifferencesTimesNorm {
        let d = threes(&rays, "rays_d");
        deltas.indexed_iter_mut().for_each(|(i, delta)| *delta = stretch(*delta, d[i[0]]));
    }
    let mut field = params.clone();
    field.insert("positions".into(), reshaped(&along["points"], &[count * n, 3]));
    field.insert("directions".into(), repeated(&rays["directions"], n));
    let seen = run(Kind::Forward, &NERF_MLP, &field);
    let mut ray = arrays([
        ("sigmas", reshaped(&seen["sigmas"], &[count, n])),
        ("rgbs", reshaped(&seen["rgbs"], &[count, n, 3])),
        ("deltas", deltas.clone()),
    ]);
    let colors = run(Kind::Forward, &VOLUME_RENDER, &ray)["colors"].clone();
    let mut loss = arrays([("prediction", colors.clone()), ("target", rays["target"].clone())]);
    let value = number(&run(Kind::Forward, &MSE, &loss), "value");
    loss.insert("grad_value".into(), scalar(1.0));
    let zeros = |shape: &[usize]| ArrayD::zeros(IxDyn(shape));
    ray.extend(arrays([
        ("grad_colors", run(Kind::Vjp, &MSE, &loss)["grad_prediction"].clone()),
        ("grad_weights", zeros(&[count, n])),
        ("grad_opacity", zeros(&[count])),
        ("grad_transmittance", zeros(&[count])),
    ]));
    let back = run(Kind::Vjp, &VOLUME_RENDER, &ray);
    field.insert("grad_sigmas".into(), reshaped(&back["grad_sigmas"], &[count * n]));
    field.insert("grad_rgbs".into(), reshaped(&back["grad_rgbs"], &[count * n, 3]));
    let gradient = row(&run(Kind::Vjp, &NERF_MLP, &field), &names(params), "grad_");
    Pass { t: along["t"].clone(), deltas, colors, loss: value, gradient }
}

fn reshaped(array: &ArrayD<f64>, shape: &[usize]) -> ArrayD<f64> {
    array.to_shape(shape).expect("the same number of entries").into_owned()
}

/// Each row `n` times.
fn repeated(array: &ArrayD<f64>, n: usize) -> ArrayD<f64> {
    let index: Vec<usize> = (0..array.shape()[0] * n).map(|i| i / n).collect();
    array.select(Axis(0), &index)
}

/// Runs adam_step with the learning rate of step `rate`; `step` counts from 1.
pub(super) fn update(
    a: &Arrays,
    before: &State,
    gradient: &[f64],
    [rate, step]: [usize; 2],
    run: Run,
) -> State {
    let one = |x: &[f64]| array(&[x.len()], x.to_vec());
    let mut inputs = arrays([
        ("params", one(&before.row())),
        ("grad", one(gradient)),
        ("m", one(&before.m)),
        ("v", one(&before.v)),
        ("step", scalar(step as f64)),
        ("lr", scalar(values(a, "lr")[rate])),
    ]);
    for name in ["beta1", "beta2", "eps", "weight_decay"] {
        inputs.insert(name.into(), input(a, name).clone());
    }
    let out = run(Kind::Forward, &ADAM_STEP, &inputs);
    let (moved, mut params, mut used) = (values(&out, "params_out"), before.params.clone(), 0);
    for name in names(&before.params) {
        let array = params.get_mut(&name).expect("a parameter");
        array.iter_mut().zip(&moved[used..]).for_each(|(x, y)| *x = *y);
        used += array.len();
    }
    State { params, m: values(&out, "m_out"), v: values(&out, "v_out") }
}

/// The outputs, of the first pass and of what each step leaves behind.
pub(super) fn outputs(first: Pass, losses: Vec<f64>, states: &[State]) -> Arrays {
    let one = |x: Vec<f64>| array(&[x.len()], x);
    let (after_one, last) = (&states[0], &states[states.len() - 1]);
    arrays([
        ("t", first.t),
        ("deltas", first.deltas),
        ("colors", first.colors),
        ("losses", one(losses)),
        ("grad", one(first.gradient)),
        ("params_1", one(after_one.row())),
        ("m_1", one(after_one.m.clone())),
        ("v_1", one(after_one.v.clone())),
        ("params_last", one(last.row())),
        ("m_last", one(last.m.clone())),
        ("v_last", one(last.v.clone())),
    ])
}

/// All steps.
pub(super) fn chain(a: &Arrays, c: &Conventions, run: Run, stretch: Stretch) -> Arrays {
    let (mut states, mut losses, mut first) = (vec![], vec![], None);
    let mut state = State::new(a);
    for k in 0..steps(a) {
        let passed = pass(a, &state.params, [k, k], c, run, stretch);
        state = update(a, &state, &passed.gradient, [k, k + 1], run);
        losses.push(passed.loss);
        states.push(state.clone());
        first.get_or_insert(passed);
    }
    outputs(first.expect("at least one step"), losses, &states)
}
