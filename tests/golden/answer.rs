//! The reference's answer to a fixture's case: through the registry, several components in a row, kornia's quirks added.

use std::borrow::Cow;

use ndarray::{ArrayD, Axis, IxDyn};
use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::Component;
use nerf_oracle::contract::arrays::{Arrays, number, scalar};
use nerf_oracle::convention::{CS180, Conventions, Directions};
use nerf_oracle::proof::golden::Golden;

/// Fixtures of several components in a row.
pub(crate) const SYSTEMS: &[&str] = &["loss_gradient", "adam", "loss_curve"];

const HYPER: [&str; 5] = ["lr", "beta1", "beta2", "eps", "weight_decay"];

/// What is changed on purpose.
pub(crate) enum Change<'a> {
    /// Nothing.
    None,
    /// This known difference is left out: a convention `key=value` or a quirk.
    Without(&'a str),
}

/// A component by its name.
pub(crate) fn component(name: &str) -> Option<&'static Component> {
    COMPONENTS.iter().find(|component| component.name == name)
}

/// The reference's outputs for a case.
pub(crate) fn answer(name: &str, case: &Golden, change: &Change) -> Arrays {
    let mut case = Cow::Borrowed(case);
    if let Change::Without(difference) = change {
        let case = case.to_mut();
        case.quirks.remove(*difference);
        if let Some((key, _)) = difference.split_once('=') {
            case.conventions = case.conventions.with(key, &CS180.get(key)).unwrap();
        }
    }
    match name {
        "loss_gradient" => loss_gradient(&case.inputs, case.vjp),
        "adam" => adam(&case.inputs),
        "loss_curve" => loss_curve(&case.inputs),
        _ => with_quirks(name, &case),
    }
}

/// One component, forward or backward. Cotangents that a case doesn't give are 0.
fn run(name: &str, inputs: &Arrays, c: &Conventions, vjp: bool) -> Arrays {
    let component =
        component(name).unwrap_or_else(|| panic!("{name} has fixtures, but no row in COMPONENTS"));
    if !vjp {
        return (component.forward.oracle)(inputs, c);
    }
    let mut inputs = inputs.clone();
    for (output, value) in (component.forward.oracle)(&inputs, c) {
        inputs.entry(format!("grad_{output}")).or_insert_with(|| ArrayD::zeros(value.shape()));
    }
    (component.vjp.as_ref().expect("a VJP case of a component with gradients").oracle)(&inputs, c)
}

/// One component with kornia's differences: see the fixture's known differences.
fn with_quirks(name: &str, case: &Golden) -> Arrays {
    let mut inputs = case.inputs.clone();
    if case.quirks.contains_key("ray0_spacing") {
        let first = inputs["deltas"].index_axis(Axis(0), 0).to_owned();
        inputs.get_mut("deltas").unwrap().outer_iter_mut().for_each(|mut row| row.assign(&first));
    }
    let scale = 1.0 + case.quirks.get("homogeneous_eps").map_or(0.0, |eps| eps.as_f64().unwrap());
    if case.quirks.contains_key("origin_from_w2c") {
        return rays_from_w2c(&inputs, scale);
    }
    let mut out = run(name, &inputs, &case.conventions, case.vjp);
    if let Some(range) = case.quirks.get("rays_from_near_to_far") {
        let (near, far) = (range[0].as_f64().unwrap(), range[1].as_f64().unwrap());
        let from = (&out["rays_o"] + &out["rays_d"] * near) / scale;
        let along = &out["rays_d"] * (far - near) / scale;
        out.extend([("rays_o".into(), from), ("rays_d".into(), along)]);
    }
    out
}

/// Rays from o' = -R^T o through x_w / scale, where x_w = o + d lies at depth 1.
fn rays_from_w2c(inputs: &Arrays, scale: f64) -> Arrays {
    let depth_one = Conventions { directions: Directions::Depth, ..CS180 };
    let mut out = run("pixel_to_ray", inputs, &depth_one, false);
    for m in 0..out["rays_o"].shape()[0] {
        let (o, d) = (row(&out["rays_o"], m), row(&out["rays_d"], m));
        let entry = |i: usize, j: usize| inputs["c2w"][[m, i, j]];
        let wrong: [f64; 3] = std::array::from_fn(|j| -(0..3).map(|i| entry(i, j) * o[i]).sum::<f64>());
        let along: [f64; 3] = std::array::from_fn(|i| (o[i] + d[i]) / scale - wrong[i]);
        let length = along.iter().map(|v| v * v).sum::<f64>().sqrt();
        for i in 0..3 {
            out.get_mut("rays_o").unwrap()[[m, i]] = wrong[i];
            out.get_mut("rays_d").unwrap()[[m, i]] = along[i] / length;
        }
    }
    out
}

/// Row m of an (M,3) array.
fn row(array: &ArrayD<f64>, m: usize) -> [f64; 3] {
    std::array::from_fn(|i| array[[m, i]])
}

/// The named arrays of a map.
fn pick(arrays: &Arrays, names: &[&str]) -> Arrays {
    names.iter().map(|&name| (name.to_string(), arrays[name].clone())).collect()
}

/// The network's parameters in a map.
fn parameters(arrays: &Arrays) -> Arrays {
    let is = |name: &str| name.ends_with("_w") || name.ends_with("_b");
    arrays.iter().filter(|(name, _)| is(name)).map(|(name, value)| (name.clone(), value.clone())).collect()
}

/// The same entries in another shape.
fn reshape(array: &ArrayD<f64>, shape: &[usize]) -> ArrayD<f64> {
    array.to_shape(IxDyn(shape)).unwrap().to_owned().into_dyn()
}

/// samples -> field -> rendering -> loss, and back to the parameters.
fn loss_gradient(inputs: &Arrays, vjp: bool) -> Arrays {
    let c = &CS180;
    let (rays, samples) = (inputs["u"].shape()[0], inputs["u"].shape()[1]);
    let sampled = run("sample_along_rays", inputs, c, false);
    let direction = |n: usize, i: usize| inputs["rays_d"][[n / samples, i]];
    let directions = ArrayD::from_shape_fn(IxDyn(&[rays * samples, 3]), |at| direction(at[0], at[1]));
    let mut field = parameters(inputs);
    field.insert("positions".into(), reshape(&sampled["points"], &[rays * samples, 3]));
    field.insert("directions".into(), directions);
    let seen = run("nerf_mlp", &field, c, false);
    let mut ray = pick(inputs, &["near", "far"]);
    ray.insert("t".into(), sampled["t"].clone());
    ray = run("step_sizes", &ray, c, false);
    ray.insert("sigmas".into(), reshape(&seen["sigmas"], &[rays, samples]));
    ray.insert("rgbs".into(), reshape(&seen["rgbs"], &[rays, samples, 3]));
    let colors = run("volume_render", &ray, c, false)["colors"].clone();
    let mut loss = pick(inputs, &["target"]);
    loss.insert("prediction".into(), colors.clone());
    if !vjp {
        let mut out = run("mse", &loss, c, false);
        out.insert("colors".into(), colors);
        return out;
    }
    // Backward: the cotangent of the colors comes through the loss alone, or is given.
    loss.insert("grad_value".into(), inputs["grad_value"].clone());
    let mut grad_colors = run("mse", &loss, c, true)["grad_prediction"].clone();
    if let Some(given) = inputs.get("grad_colors") {
        grad_colors += given;
    }
    ray.insert("grad_colors".into(), grad_colors);
    let back = run("volume_render", &ray, c, true);
    field.insert("grad_sigmas".into(), reshape(&back["grad_sigmas"], &[rays * samples]));
    field.insert("grad_rgbs".into(), reshape(&back["grad_rgbs"], &[rays * samples, 3]));
    run("nerf_mlp", &field, c, true)
}

/// One step of Adam for a whole map: `state` holds params, m and v of every name.
fn adam_step(settings: &Arrays, step: usize, state: &[Arrays; 3], grads: &Arrays) -> [Arrays; 3] {
    let mut next = [Arrays::new(), Arrays::new(), Arrays::new()];
    for (name, grad) in grads {
        let shape = grad.shape();
        let mut inputs = settings.clone();
        inputs.insert("step".into(), scalar(step as f64));
        for (key, array) in [("params", &state[0]), ("m", &state[1]), ("v", &state[2]), ("grad", grads)] {
            inputs.insert(key.into(), reshape(&array[name], &[grad.len()]));
        }
        let out = run("adam_step", &inputs, &CS180, false);
        for (next, key) in next.iter_mut().zip(["params_out", "m_out", "v_out"]) {
            next.insert(name.clone(), reshape(&out[key], shape));
        }
    }
    next
}

/// Parameters with moments of 0.
fn start(params: Arrays) -> [Arrays; 3] {
    let zeros: Arrays = params.iter().map(|(name, p)| (name.clone(), ArrayD::zeros(p.shape()))).collect();
    [params, zeros.clone(), zeros]
}

/// The parameters after every step, the gradients given.
fn adam(inputs: &Arrays) -> Arrays {
    let settings = pick(inputs, &HYPER);
    let mut state = start([("p".to_string(), inputs["params"].clone())].into());
    let mut history = ArrayD::zeros(inputs["grads"].shape());
    for (n, grad) in inputs["grads"].outer_iter().enumerate() {
        state = adam_step(&settings, n + 1, &state, &[("p".to_string(), grad.to_owned())].into());
        history.index_axis_mut(Axis(0), n).assign(&state[0]["p"]);
    }
    [("params_out".to_string(), history)].into()
}

/// The loss before every step, and the parameters at the end.
fn loss_curve(inputs: &Arrays) -> Arrays {
    let settings = pick(inputs, &HYPER);
    let mut state = start(parameters(inputs));
    let mut losses = Vec::new();
    for (n, u) in inputs["u"].outer_iter().enumerate() {
        let mut step = inputs.clone();
        step.extend(state[0].clone());
        step.extend([("u".to_string(), u.to_owned()), ("grad_value".to_string(), scalar(1.0))]);
        losses.push(number(&loss_gradient(&step, false), "value"));
        let grads = loss_gradient(&step, true);
        let grads = parameters(&grads).into_iter().map(|(name, g)| (name.replace("grad_", ""), g)).collect();
        state = adam_step(&settings, n + 1, &state, &grads);
    }
    let [mut out, ..] = state;
    out.insert("losses".into(), ArrayD::from_shape_vec(IxDyn(&[losses.len()]), losses).unwrap());
    out
}
