//! Somebody's networks, judged: whole batches, since a layer is a matrix product.

use ndarray::{Array2, ArrayD, ArrayView2};

use super::component::{MLP, NERF_MLP};
use super::nerf_mlp::NerfMlp;
use super::{Layer, arrays};
use crate::convention::CS180;
use crate::judge::Door;
use crate::judge::typed::{Output, Outputs};

/// The signature of [`judge()`].
#[derive(Clone, Copy, Debug)]
pub struct Field;

/// The signature of [`mlp()`].
#[derive(Clone, Copy, Debug)]
pub struct Plain;

/// Judges NeRF's network with its two encodings: (network, `positions` (M, 3), `directions` (M, 3)) -> (sigmas (M), rgbs (M, 3)).
///
/// ```
/// use nerf_oracle::convention::CS180;
/// use nerf_oracle::encoding::{Encoding, positional_encoding};
/// use nerf_oracle::field;
/// field::judge(|net, positions, directions| {
///     // The numbers of bands follow from the layers' widths.
///     let bands = |columns: usize| Encoding::new((columns - 3) / 6, &CS180);
///     let position = bands(net.trunk[0].w.ncols());
///     let direction = bands(net.color0.w.ncols() - net.feature.w.nrows());
///     let point = |(x, d): (&[f64; 3], &[f64; 3])| {
///         let (x, d) = (positional_encoding(x, &position), positional_encoding(d, &direction));
///         let out = net.forward(&x, &d, &CS180);
///         (out.sigma, out.rgb)
///     };
///     positions.iter().zip(directions).map(point).unzip::<f64, [f64; 3], Vec<_>, Vec<_>>()
/// })
/// .profile("cs180")
/// .in_f32()
/// .assert_pass();
/// ```
pub fn judge<'a, O: Outputs>(
    kernel: impl Fn(&NerfMlp, &[[f64; 3]], &[[f64; 3]]) -> O + Sync + 'a,
) -> Door<'a, Field> {
    Door::whole(&NERF_MLP, move |of| {
        let net = arrays::Nerf::of(of.arrays, &CS180).net;
        kernel(&net, of.get("positions"), of.get("directions")).into_arrays()
    })
}

impl<'a> Door<'a, Field> {
    /// With its gradient: (network, positions, directions, grad_sigmas, grad_rgbs) -> (grad_positions, the network's gradient).
    pub fn vjp(
        self,
        kernel: impl Fn(&NerfMlp, &[[f64; 3]], &[[f64; 3]], &[f64], &[[f64; 3]]) -> (Vec<[f64; 3]>, NerfMlp)
        + Sync
        + 'a,
    ) -> Self {
        self.whole_vjp(move |of| {
            let net = arrays::Nerf::of(of.arrays, &CS180).net;
            let (g_sigmas, g_rgbs) = (of.get("grad_sigmas"), of.get("grad_rgbs"));
            let (g_x, g_net) = kernel(&net, of.get("positions"), of.get("directions"), g_sigmas, g_rgbs);
            let layer = |(_, layer): (String, &Layer)| [weights(layer), biases(layer)];
            std::iter::once(g_x.into_array()).chain(g_net.layers().into_iter().flat_map(layer)).collect()
        })
    }
}

fn weights(layer: &Layer) -> Option<ArrayD<f64>> {
    Some(layer.w.clone().into_dyn())
}

fn biases(layer: &Layer) -> Option<ArrayD<f64>> {
    Some(layer.b.clone().into_dyn())
}

/// Judges a plain network with ReLU between its layers and a sigmoid behind the last one: (layers, `x` (M, D)) -> (M, O).
///
/// ```
/// use nerf_oracle::field::judge;
/// judge::mlp(|layers, x| {
///     let mut y = x.to_owned();
///     for (n, layer) in layers.iter().enumerate() {
///         let z = y.dot(&layer.w.t()) + &layer.b;
///         let last = n + 1 == layers.len();
///         y = z.mapv(|z| if last { 1.0 / (1.0 + (-z).exp()) } else { z.max(0.0) });
///     }
///     y
/// })
/// .in_f32()
/// .assert_pass();
/// ```
pub fn mlp<'a>(kernel: impl Fn(&[Layer], ArrayView2<f64>) -> Array2<f64> + Sync + 'a) -> Door<'a, Plain> {
    Door::whole(&MLP, move |of| vec![kernel(&arrays::network(of.arrays).layers, of.get("x")).into_array()])
}

impl<'a> Door<'a, Plain> {
    /// With its gradient: (layers, x, grad_y) -> (grad_x, the layers' gradients).
    pub fn vjp(
        self,
        kernel: impl Fn(&[Layer], ArrayView2<f64>, ArrayView2<f64>) -> (Array2<f64>, Vec<Layer>) + Sync + 'a,
    ) -> Self {
        self.whole_vjp(move |of| {
            let (x, g) = (of.get("x"), of.get("grad_y"));
            let (g_x, g_layers) = kernel(&arrays::network(of.arrays).layers, x, g);
            let all = g_layers.iter().map(weights).chain(g_layers.iter().map(biases));
            std::iter::once(g_x.into_array()).chain(all).collect()
        })
    }
}
