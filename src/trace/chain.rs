//! The components of a trace, run one after the other on named arrays: this is how honest and wrong traces are computed.

use super::arrays::size;
use crate::contract::arrays::{Arrays, arrays, input, threes};
use crate::contract::component::Component;
use crate::convention::{Backdrop, Conventions, Delta, LastSample, OpacitySum};
use crate::volume_rendering::mistakes::ALPHA_ERROR;
use crate::{ray, sample, volume_rendering};

/// delta |d|.
pub(super) fn plainly(delta: f64, d: [f64; 3]) -> f64 {
    delta * glam::DVec3::from(d).length()
}

/// A trace has a background of its own, whatever `volume_render` puts behind a ray, and all of a ray in front of it.
pub(super) fn without_backdrop(c: &Conventions) -> Conventions {
    Conventions {
        backdrop: Backdrop::None,
        opacity_sum: OpacitySum::All,
        last_sample: LastSample::AsItIs,
        ..*c
    }
}

/// Runs image_rays, sample_along_rays, step_sizes, volume_render and composite_background with `run`, each with the outputs of the
/// ones before. `stretch` multiplies a step by the length of its ray's direction, where that is the convention.
pub(super) fn chain(
    a: &Arrays,
    c: &Conventions,
    run: impl Fn(&Component, &Arrays) -> Arrays,
    stretch: impl Fn(f64, [f64; 3]) -> f64,
) -> Arrays {
    let [h, w, n] = size(a);
    let reshaped = |array: &ndarray::ArrayD<f64>, shape: &[usize]| {
        array.to_shape(shape).expect("the same number of entries").into_owned()
    };
    let mut out = run(&ray::component::IMAGE_RAYS, a);
    let [rays_o, rays_d] = ["rays_o", "rays_d"].map(|name| reshaped(&out[name], &[h * w, 3]));
    let [near, far] = ["near", "far"].map(|name| input(a, name).clone());
    let u = reshaped(input(a, "u"), &[h * w, n]);
    let along = arrays([
        ("rays_o", rays_o),
        ("rays_d", rays_d),
        ("near", near.clone()),
        ("far", far.clone()),
        ("u", u),
    ]);
    let t = run(&sample::component::SAMPLE_ALONG_RAYS, &along)["t"].clone();
    let steps = arrays([("t", t.clone()), ("near", near), ("far", far)]);
    let mut deltas = run(&sample::component::STEP_SIZES, &steps)["deltas"].clone();
    if c.delta == Delta::DifferencesTimesNorm {
        let d = threes(&out, "rays_d");
        deltas.indexed_iter_mut().for_each(|(i, delta)| *delta = stretch(*delta, d[i[0]]));
    }
    let mut rays = arrays([
        ("sigmas", reshaped(input(a, "sigmas"), &[h * w, n])),
        ("rgbs", reshaped(input(a, "rgbs"), &[h * w, n, 3])),
        ("deltas", deltas.clone()),
    ]);
    rays.extend(a.get(ALPHA_ERROR).map(|e| (ALPHA_ERROR.to_string(), reshaped(e, &[h * w, n]))));
    let rendered = run(&volume_rendering::component::VOLUME_RENDER, &rays);
    let over = arrays([
        ("colors", rendered["colors"].clone()),
        ("opacity", rendered["opacity"].clone()),
        ("background", input(a, "background").clone()),
    ]);
    let colors = run(&volume_rendering::component::COMPOSITE_BACKGROUND, &over)["colors_out"].clone();
    out.insert("t".into(), reshaped(&t, &[h, w, n]));
    out.insert("deltas".into(), reshaped(&deltas, &[h, w, n]));
    out.insert("weights".into(), reshaped(&rendered["weights"], &[h, w, n]));
    out.insert("colors".into(), reshaped(&colors, &[h, w, 3]));
    out
}
