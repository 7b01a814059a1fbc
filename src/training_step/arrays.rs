//! The oracle of this folder on named arrays, and what turns these into its types and back.

use glam::DVec3;
use ndarray::{ArrayD, Axis};

use super::{Batch, Field, Trained, flat, train};
use crate::contract::arrays::{Arrays, array, arrays, input, number, rows, threes, values};
use crate::convention::{
    Activation, Backdrop, Bands, CS180, ColorOrder, Conventions, Cosine, IdentityPlace, LastSample,
    OpacitySum, ProductEps, SigmaRelu,
};
use crate::field::arrays::Nerf;
use crate::optimizer::Adam;
use crate::ray::Ray;

/// The network is the paper's and nothing lies behind a ray: what else programs do there is the matter of `nerf_mlp` and `volume_render`.
pub(super) fn usual(c: &Conventions) -> Conventions {
    Conventions {
        identity: true,
        network_identity: IdentityPlace::First,
        bands: Bands::Octaves,
        cosine: Cosine::Own,
        columns: CS180.columns,
        last_trunk: Activation::Relu,
        feature: Activation::None,
        color_order: ColorOrder::FeatureFirst,
        product_eps: ProductEps::None,
        sigma_relu: SigmaRelu::None,
        backdrop: Backdrop::None,
        opacity_sum: OpacitySum::All,
        last_sample: LastSample::AsItIs,
        ..*c
    }
}

/// The field of the parameters' arrays.
pub(super) fn field(a: &Arrays, c: &Conventions) -> Field {
    let Nerf { net, position, direction } = Nerf::of(a, c);
    Field { net, position, direction }
}

/// Step k of the arrays that have one row a step.
pub(super) fn of_step(a: &Arrays, k: usize) -> Arrays {
    let row = |name: &str| input(a, name).index_axis(Axis(0), k).to_owned();
    arrays(["rays_o", "rays_d", "directions", "u", "target"].map(|name| (name, row(name))))
}

/// The batches of all steps.
pub(super) fn batches(a: &Arrays) -> Vec<Batch> {
    let batch = |k: usize| {
        let a = of_step(a, k);
        let rays = threes(&a, "rays_o").into_iter().zip(threes(&a, "rays_d"));
        Batch {
            rays: rays.map(|(o, d)| Ray { o: DVec3::from(o), d: DVec3::from(d) }).collect(),
            directions: threes(&a, "directions"),
            u: rows(&a, "u"),
            target: threes(&a, "target"),
        }
    };
    (0..steps(a)).map(batch).collect()
}

/// Their number.
pub(super) fn steps(a: &Arrays) -> usize {
    input(a, "lr").len()
}

/// Adam's numbers, but for the learning rate, which each step has its own of.
pub(super) fn adam(a: &Arrays) -> Adam {
    Adam {
        lr: 0.0,
        beta1: number(a, "beta1"),
        beta2: number(a, "beta2"),
        eps: number(a, "eps"),
        weight_decay: number(a, "weight_decay"),
    }
}

/// Where rays begin and end.
pub(super) fn bounds(a: &Arrays) -> (f64, f64) {
    (number(a, "near"), number(a, "far"))
}

/// What was trained, as arrays.
pub(super) fn trained(out: Trained) -> Arrays {
    let (rays, samples) = (out.pass.t.len(), out.pass.t.first().map_or(0, Vec::len));
    let one = |x: Vec<f64>| -> ArrayD<f64> { array(&[x.len()], x) };
    arrays([
        ("t", array(&[rays, samples], out.pass.t.concat())),
        ("deltas", array(&[rays, samples], out.pass.deltas.concat())),
        ("colors", array(&[rays, 3], out.pass.colors.concat())),
        ("losses", one(out.losses)),
        ("grad", one(flat(&out.pass.gradient))),
        ("params_1", one(out.first.params)),
        ("m_1", one(out.first.m)),
        ("v_1", one(out.first.v)),
        ("params_last", one(out.last.params)),
        ("m_last", one(out.last.m)),
        ("v_last", one(out.last.v)),
    ])
}

pub(super) fn training_step(a: &Arrays, c: &Conventions) -> Arrays {
    let c = &usual(c);
    trained(train(&field(a, c), &batches(a), bounds(a), &values(a, "lr"), &adam(a), c))
}
