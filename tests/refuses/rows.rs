//! The table: for each public oracle function of several arrays, a right call and wrong ones.

use glam::{DMat4, DVec3};
use ndarray::{Array2, Array3, Array4};
use nerf_oracle::camera::{Camera, Intrinsics};
use nerf_oracle::convention::HarmonicForm::Sphere;
use nerf_oracle::convention::HarmonicSign::Plain;
use nerf_oracle::convention::{
    CS180, CharbonnierEps, Depth, EmptyDepth, GridDecay, GridUnseen, HuberSlope, LossReduction, OuterEdges,
    PixelCenter, ProductEps, PsnrFloor, PsnrOf,
};
use nerf_oracle::distortion;
use nerf_oracle::encoding::{self, Encoding};
use nerf_oracle::field::mlp::{self, Mlp, Output};
use nerf_oracle::field::nerf_mlp::{self, NerfMlp, Shape};
use nerf_oracle::field::{self, Layer};
use nerf_oracle::hash_grid::{self, Level};
use nerf_oracle::importance_sampling;
use nerf_oracle::integrated_encoding;
use nerf_oracle::interlevel_loss::{self, Histogram};
use nerf_oracle::loss;
use nerf_oracle::occupancy_grid::OccupancyGrid;
use nerf_oracle::optimizer::Adam;
use nerf_oracle::packed::{self, Scan};
use nerf_oracle::proposal_pdf;
use nerf_oracle::random::{Key, Purpose};
use nerf_oracle::ray::{PixelDraws, Ray, draw_pixel, sample_random_rays};
use nerf_oracle::resample_edges;
use nerf_oracle::robust_loss;
use nerf_oracle::spherical_harmonics;
use nerf_oracle::ssim;
use nerf_oracle::trace::trace_pixel;
use nerf_oracle::training::reference::{Field, Target, adam_layer, fine_samples, image_loss_and_gradient};
use nerf_oracle::training_step;
use nerf_oracle::volume_rendering::{self, Rendering, backward::Cotangent};
use nerf_oracle::{early_stop, volume_rendering::volume_render};

use super::Row;

const NONE: ProductEps = ProductEps::None;

/// All rows.
pub(crate) fn all() -> Vec<Row> {
    [rendering(), stopping(), packing(), images(), samples(), networks(), grids(), training(), steps()]
        .into_iter()
        .flatten()
        .collect()
}

fn row(name: &'static str, right: fn(), wrong: &[(&'static str, fn())]) -> Row {
    Row { name, right, wrong: wrong.to_vec() }
}

fn ones(n: usize) -> Vec<f64> {
    vec![1.0; n]
}

fn gray(n: usize) -> Vec<[f64; 3]> {
    vec![[0.5; 3]; n]
}

/// What `n` samples render to, and a cotangent for it.
fn forward(n: usize) -> Rendering {
    volume_render(&ones(n), &gray(n), &ones(n), NONE)
}

fn cotangent(n: usize) -> Cotangent {
    Cotangent { color: [1.0; 3], weights: ones(n), opacity: 1.0, transmittance: 1.0 }
}

fn rendering() -> Vec<Row> {
    fn render(sigmas: usize, rgbs: usize, deltas: usize) {
        volume_render(&ones(sigmas), &gray(rgbs), &ones(deltas), NONE);
    }
    fn alpha(alphas: usize, rgbs: usize) {
        volume_rendering::volume_render_alpha(&ones(alphas), &gray(rgbs), NONE);
    }
    fn render_vjp(n: [usize; 3], seen: &Rendering, weights: usize) {
        let (sigmas, rgbs, deltas, g) = (ones(n[0]), gray(n[1]), ones(n[2]), cotangent(weights));
        volume_rendering::backward::volume_render(&sigmas, &rgbs, &deltas, NONE, seen, &g);
    }
    fn alpha_vjp(n: [usize; 2], seen: &Rendering, weights: usize) {
        let (alphas, rgbs, g) = (ones(n[0]), gray(n[1]), cotangent(weights));
        volume_rendering::backward::volume_render_alpha(&alphas, &rgbs, NONE, seen, &g);
    }
    fn depth(weights: usize, t: usize) {
        volume_rendering::depth(&ones(weights), &ones(t), 6.0, Depth::Plain, EmptyDepth::Far);
    }
    fn depth_vjp(weights: usize, t: usize) {
        volume_rendering::backward::depth(&ones(weights), &ones(t), 6.0, Depth::Plain, EmptyDepth::Far, 1.0);
    }
    fn trace(u: usize, sigmas: usize, rgbs: usize) {
        let k = Intrinsics { fx: 4.0, fy: 4.0, cx: 2.0, cy: 1.0 };
        let camera = Camera { width: 4, height: 2, k, c2w: DMat4::IDENTITY, distortion: None };
        trace_pixel(&camera, (1, 0), (2.0, 4.0), &ones(u), &ones(sigmas), &gray(rgbs), [0.0; 3], &CS180);
    }
    /// `forward(2)` with one transmittance too few.
    fn dark() -> Rendering {
        Rendering { transmittance: ones(2), ..forward(2) }
    }
    vec![
        row(
            "volume_rendering::volume_render",
            || render(2, 2, 2),
            &[
                ("sigmas and deltas", || render(1, 1, 2)),
                ("sigmas and deltas", || render(2, 2, 1)),
                ("sigmas and rgbs", || render(2, 3, 2)),
                ("sigmas and rgbs", || render(2, 1, 2)),
                ("sigmas and deltas", || render(1, 3, 2)),
            ],
        ),
        row(
            "volume_rendering::volume_render_alpha",
            || alpha(2, 2),
            &[("alphas and rgbs", || alpha(2, 3)), ("alphas and rgbs", || alpha(2, 1))],
        ),
        row(
            "volume_rendering::depth",
            || depth(2, 2),
            &[("weights and t", || depth(2, 3)), ("weights and t", || depth(3, 2))],
        ),
        row(
            "volume_rendering::backward::volume_render",
            || render_vjp([2; 3], &forward(2), 2),
            &[
                ("sigmas and deltas", || render_vjp([2, 2, 3], &forward(2), 2)),
                ("sigmas and rgbs", || render_vjp([2, 3, 2], &forward(2), 2)),
                ("forward.weights and samples", || render_vjp([2; 3], &forward(3), 2)),
                ("forward.transmittance and samples", || render_vjp([2; 3], &dark(), 2)),
                ("g.weights and samples", || render_vjp([2; 3], &forward(2), 3)),
            ],
        ),
        row(
            "volume_rendering::backward::volume_render_alpha",
            || alpha_vjp([2; 2], &forward(2), 2),
            &[
                ("alphas and rgbs", || alpha_vjp([2, 3], &forward(2), 2)),
                ("forward.weights and samples", || alpha_vjp([2; 2], &forward(3), 2)),
                ("forward.transmittance and samples", || alpha_vjp([2; 2], &dark(), 2)),
                ("g.weights and samples", || alpha_vjp([2; 2], &forward(2), 3)),
            ],
        ),
        row(
            "volume_rendering::backward::depth",
            || depth_vjp(2, 2),
            &[("weights and t", || depth_vjp(2, 3)), ("weights and t", || depth_vjp(3, 2))],
        ),
        row(
            "trace::trace_pixel",
            || trace(2, 2, 2),
            &[
                ("sigmas and u", || trace(2, 3, 2)),
                ("rgbs and u", || trace(2, 2, 3)),
                ("sigmas and u", || trace(3, 2, 2)),
            ],
        ),
    ]
}

/// Results of a scan of `n` samples, and its cotangents.
fn scan_of(n: usize) -> Scan {
    packed::scan(&ones(n), &[0, n])
}

fn packing() -> Vec<Row> {
    fn loss(weights: usize, t: usize) {
        distortion::distortion(&ones(weights), &ones(t));
    }
    fn loss_vjp(weights: usize, t: usize) {
        distortion::backward::distortion(&ones(weights), &ones(t), 1.0);
    }
    const INTERLEVEL: interlevel_loss::Form =
        interlevel_loss::Form { eps: 0.5, edges: OuterEdges::Inside, reduction: LossReduction::Mean };
    fn interlevel([w, t, v, s]: [usize; 4]) {
        let arrays = [w, t, v, s].map(ones);
        let fine = Histogram { weights: &arrays[0], t: &arrays[1] };
        interlevel_loss::interlevel(fine, Histogram { weights: &arrays[2], t: &arrays[3] }, INTERLEVEL);
    }
    fn interlevel_vjp([w, t, v, s]: [usize; 4]) {
        let arrays = [w, t, v, s].map(ones);
        let fine = Histogram { weights: &arrays[0], t: &arrays[1] };
        let proposal = Histogram { weights: &arrays[2], t: &arrays[3] };
        interlevel_loss::backward::interlevel(fine, proposal, INTERLEVEL, 1.0);
    }
    fn scan(x: usize, offsets: &[usize]) {
        packed::scan(&ones(x), offsets);
    }
    fn scan_vjp(x: usize, offsets: &[usize], forward: usize, g: usize) {
        packed::backward::scan(&ones(x), offsets, &scan_of(forward), &scan_of(g));
    }
    fn sums(weights: usize, values: usize, offsets: &[usize]) {
        packed::accumulate(&ones(weights), &gray(values), offsets);
    }
    fn sums_vjp(weights: usize, values: usize, offsets: &[usize], g: usize) {
        packed::backward::accumulate(&ones(weights), &gray(values), offsets, &gray(g));
    }
    vec![
        row("distortion::distortion", || loss(2, 3), &[("weights and t", || loss(2, 2))]),
        row("distortion::backward::distortion", || loss_vjp(2, 3), &[("weights and t", || loss_vjp(3, 3))]),
        row(
            "interlevel_loss::interlevel",
            || interlevel([2, 3, 4, 5]),
            &[
                ("fine weights and t", || interlevel([2, 2, 4, 5])),
                ("proposal weights and t", || interlevel([2, 3, 4, 4])),
            ],
        ),
        row(
            "interlevel_loss::backward::interlevel",
            || interlevel_vjp([2, 3, 4, 5]),
            &[
                ("fine weights and t", || interlevel_vjp([3, 3, 4, 5])),
                ("proposal weights and t", || interlevel_vjp([2, 3, 5, 5])),
            ],
        ),
        row(
            "packed::scan",
            || scan(3, &[0, 1, 1, 3]),
            &[
                ("one more than rays", || scan(0, &[])),
                ("offsets and samples: from 0", || scan(3, &[1, 3])),
                ("offsets and samples: to their number", || scan(3, &[0, 2])),
                ("never falling", || scan(3, &[0, 2, 1, 3])),
            ],
        ),
        row(
            "packed::accumulate",
            || sums(2, 2, &[0, 2]),
            &[
                ("weights and values", || sums(2, 3, &[0, 2])),
                ("offsets and samples", || sums(2, 2, &[0, 1])),
            ],
        ),
        row(
            "packed::backward::scan",
            || scan_vjp(2, &[0, 2], 2, 2),
            &[
                ("offsets and samples", || scan_vjp(3, &[0, 2], 3, 3)),
                ("forward and x", || scan_vjp(2, &[0, 2], 3, 2)),
                ("g and x", || scan_vjp(2, &[0, 2], 2, 3)),
            ],
        ),
        row(
            "packed::backward::accumulate",
            || sums_vjp(2, 2, &[0, 2], 1),
            &[
                ("weights and values", || sums_vjp(2, 1, &[0, 2], 1)),
                ("offsets and samples", || sums_vjp(2, 2, &[0, 1], 1)),
                ("g and offsets", || sums_vjp(2, 2, &[0, 2], 2)),
            ],
        ),
    ]
}

fn stopping() -> Vec<Row> {
    fn live(sigmas: usize, deltas: usize) {
        early_stop::live_samples(&ones(sigmas), &ones(deltas), 0.1);
    }
    fn packed(sigmas: usize, rgbs: usize, deltas: usize, offsets: &[usize]) {
        early_stop::render_packed(&ones(sigmas), &gray(rgbs), &ones(deltas), offsets, 0.0);
    }
    fn packed_vjp(n: [usize; 3], offsets: &[usize], rays: usize, g: usize) {
        let rays = vec![forward(1); rays];
        let g = vec![cotangent(1); g];
        let (sigmas, rgbs, deltas) = (ones(n[0]), gray(n[1]), ones(n[2]));
        early_stop::backward::render_packed(&sigmas, &rgbs, &deltas, offsets, &rays, &g);
    }
    vec![
        row(
            "early_stop::live_samples",
            || live(2, 2),
            &[("sigmas and deltas", || live(2, 3)), ("sigmas and deltas", || live(3, 2))],
        ),
        row(
            "early_stop::render_packed",
            || packed(2, 2, 2, &[0, 1, 2]),
            &[
                ("sigmas and deltas", || packed(2, 2, 3, &[0, 1, 2])),
                ("sigmas and rgbs", || packed(2, 3, 2, &[0, 1, 2])),
                ("offsets", || packed(2, 2, 2, &[])),
                // A slice's own refusal.
                ("out of range", || packed(2, 2, 2, &[0, 1, 3])),
            ],
        ),
        row(
            "early_stop::backward::render_packed",
            || packed_vjp([2; 3], &[0, 1, 2], 2, 2),
            &[
                ("sigmas and deltas", || packed_vjp([2, 2, 3], &[0, 1, 2], 2, 2)),
                ("sigmas and rgbs", || packed_vjp([2, 3, 2], &[0, 1, 2], 2, 2)),
                ("offsets and rays", || packed_vjp([2; 3], &[0, 1, 2, 2], 2, 2)),
                ("offsets and rays", || packed_vjp([2; 3], &[0, 1, 2], 1, 2)),
                ("g and rays", || packed_vjp([2; 3], &[0, 1, 2], 2, 1)),
            ],
        ),
    ]
}

fn images() -> Vec<Row> {
    fn mse(prediction: &[f64], target: &[f64]) {
        loss::mse(prediction, target);
    }
    fn huber(p: usize, t: usize) {
        robust_loss::huber(&ones(p), &ones(t), 1.0, HuberSlope::Delta, LossReduction::Mean);
    }
    fn huber_vjp(p: usize, t: usize) {
        let (slope, reduction) = (HuberSlope::Delta, LossReduction::Mean);
        robust_loss::backward::huber(&ones(p), &ones(t), 1.0, slope, reduction, 1.0);
    }
    fn charbonnier(p: usize, t: usize) {
        robust_loss::charbonnier(&ones(p), &ones(t), 1.0, CharbonnierEps::Square, LossReduction::Mean);
    }
    fn charbonnier_vjp(p: usize, t: usize) {
        let (form, reduction) = (CharbonnierEps::Square, LossReduction::Mean);
        robust_loss::backward::charbonnier(&ones(p), &ones(t), 1.0, form, reduction, 1.0);
    }
    fn psnr(predictions: &[&[f64]], targets: &[&[f64]]) {
        loss::psnr_of_images(predictions, targets, 1.0, PsnrOf::Images, PsnrFloor::None);
    }
    fn ssim(a: [usize; 3], b: [usize; 3]) {
        ssim::ssim(Array3::ones(a).view(), Array3::ones(b).view(), 1.0, ssim::Form::default());
    }
    fn ssim_vjp(a: [usize; 3], b: [usize; 3]) {
        ssim::backward::ssim(Array3::ones(a).view(), Array3::ones(b).view(), 1.0, ssim::Form::default(), 1.0);
    }
    fn draw(channels: usize) {
        draw_pixel(Array4::ones((1, 2, 2, channels)).view(), [0.5; 3], PixelCenter::Half);
    }
    fn rays(channels: usize) {
        sample_random_rays(
            Array4::ones((1, 2, 2, channels)).view(),
            PixelDraws::Pool,
            &gray(2),
            PixelCenter::Half,
        );
    }
    vec![
        row(
            "loss::mse",
            || mse(&[0.0, 3.0], &[0.0, 1.0]),
            &[
                ("prediction and target", || mse(&[0.0, 3.0], &[0.0])),
                ("prediction and target", || mse(&[0.0], &[0.0, 3.0])),
            ],
        ),
        row(
            "loss::backward::mse",
            || drop(loss::backward::mse(&[0.0, 3.0], &[0.0, 1.0], 1.0)),
            &[
                ("prediction and target", || drop(loss::backward::mse(&[0.0, 3.0], &[0.0], 1.0))),
                ("prediction and target", || drop(loss::backward::mse(&[0.0], &[0.0, 3.0], 1.0))),
            ],
        ),
        row(
            "loss::psnr_of_images",
            || psnr(&[&[0.0], &[1.0, 1.0]], &[&[1.0], &[0.0, 1.0]]),
            &[
                ("predictions and targets", || psnr(&[&[0.0], &[1.0]], &[&[1.0]])),
                ("predictions and targets", || psnr(&[&[0.0]], &[&[1.0], &[1.0]])),
                ("prediction and target", || psnr(&[&[0.0]], &[&[1.0, 1.0]])),
            ],
        ),
        row("robust_loss::huber", || huber(2, 2), &[("prediction and target", || huber(2, 3))]),
        row(
            "robust_loss::charbonnier",
            || charbonnier(2, 2),
            &[("prediction and target", || charbonnier(3, 2))],
        ),
        row(
            "robust_loss::backward::huber",
            || huber_vjp(2, 2),
            &[("prediction and target", || huber_vjp(3, 2))],
        ),
        row(
            "robust_loss::backward::charbonnier",
            || charbonnier_vjp(2, 2),
            &[("prediction and target", || charbonnier_vjp(2, 3))],
        ),
        row(
            "ssim::ssim",
            || ssim([11, 12, 3], [11, 12, 3]),
            &[
                ("a and b", || ssim([11, 12, 3], [12, 11, 3])),
                ("at least 11 x 11", || ssim([11, 10, 3], [11, 10, 3])),
            ],
        ),
        row(
            "ssim::backward::ssim",
            || ssim_vjp([11, 12, 3], [11, 12, 3]),
            &[
                ("a and b", || ssim_vjp([11, 12, 3], [12, 11, 3])),
                ("at least 11 x 11", || ssim_vjp([10, 11, 3], [10, 11, 3])),
            ],
        ),
        row("ray::random::draw_pixel", || draw(3), &[("images: (I, H, W, 3)", || draw(4))]),
        row("ray::random::sample_random_rays", || rays(3), &[("images: (I, H, W, 3)", || rays(1))]),
    ]
}

fn samples() -> Vec<Row> {
    fn draw(edges: usize, weights: usize) {
        importance_sampling::sample(&ones(edges), &ones(weights), 0.0, &[0.5]);
    }
    fn draw_vjp(edges: usize, weights: usize, u: usize, g: usize) {
        importance_sampling::backward::sample(&ones(edges), &ones(weights), 0.0, &ones(u), &ones(g));
    }
    fn shares(edges: usize, weights: usize) {
        let form = proposal_pdf::Form::default();
        proposal_pdf::proposal_pdf(&ones(edges), &ones(weights), 0.5, 0.0, form);
    }
    fn resample(edges: usize, weights: usize, u: usize) {
        let form = resample_edges::Form::default();
        resample_edges::resample_edges(&ones(edges), &ones(weights), &ones(u), form);
    }
    fn encode_vjp(g: usize) {
        encoding::backward::positional_encoding(&[0.5; 2], &Encoding::new(3, &CS180), &ones(g));
    }
    fn integrate(means: usize, variances: usize) {
        let encoding = Encoding { identity: false, ..Encoding::new(3, &CS180) };
        integrated_encoding::integrated_encoding(&ones(means), &ones(variances), &encoding);
    }
    fn integrate_vjp(means: usize, variances: usize, g: usize) {
        let encoding = Encoding { identity: false, ..Encoding::new(3, &CS180) };
        integrated_encoding::backward::integrated_encoding(
            &ones(means),
            &ones(variances),
            &encoding,
            &ones(g),
        );
    }
    fn harmonics_vjp(degree: usize, g: usize) {
        spherical_harmonics::backward::harmonics([0.0, 0.0, 1.0], degree, Sphere, Plain, &ones(g));
    }
    vec![
        row(
            "importance_sampling::sample",
            || draw(3, 2),
            &[
                ("edges and weights", || draw(2, 2)),
                ("edges and weights", || draw(4, 2)),
                ("at least one bin", || draw(1, 0)),
            ],
        ),
        row(
            "importance_sampling::backward::sample",
            || draw_vjp(3, 2, 4, 4),
            &[
                ("edges and weights", || draw_vjp(4, 2, 4, 4)),
                ("g_t and u", || draw_vjp(3, 2, 4, 5)),
                ("g_t and u", || draw_vjp(3, 2, 4, 3)),
                ("at least one bin", || draw_vjp(1, 0, 4, 4)),
            ],
        ),
        row(
            "proposal_pdf::proposal_pdf",
            || shares(3, 2),
            &[
                ("edges and weights", || shares(2, 2)),
                ("edges and weights", || shares(4, 2)),
                ("at least one bin", || shares(1, 0)),
            ],
        ),
        row(
            "resample_edges::resample_edges",
            || resample(3, 2, 2),
            &[
                ("edges and weights", || resample(2, 2, 2)),
                ("edges and weights", || resample(4, 2, 2)),
                ("at least one bin", || resample(1, 0, 2)),
                ("at least two samples", || resample(3, 2, 1)),
                ("at least two samples", || resample(3, 2, 0)),
            ],
        ),
        row(
            "encoding::backward::positional_encoding",
            || encode_vjp(14),
            &[
                ("g_out and the encoding of x", || encode_vjp(13)),
                ("g_out and the encoding of x", || encode_vjp(15)),
            ],
        ),
        row(
            "integrated_encoding::integrated_encoding",
            || integrate(2, 2),
            &[("means and variances", || integrate(2, 3)), ("means and variances", || integrate(3, 2))],
        ),
        row(
            "integrated_encoding::backward::integrated_encoding",
            || integrate_vjp(2, 2, 12),
            &[
                ("means and variances", || integrate_vjp(2, 3, 12)),
                ("g_out and the encoding", || integrate_vjp(2, 2, 13)),
                ("g_out and the encoding", || integrate_vjp(2, 2, 11)),
            ],
        ),
        row(
            "spherical_harmonics::harmonics",
            || drop(spherical_harmonics::harmonics([0.0, 0.0, 1.0], 4, Sphere, Plain)),
            &[("out of bounds", || drop(spherical_harmonics::harmonics([0.0, 0.0, 1.0], 5, Sphere, Plain)))],
        ),
        row(
            "spherical_harmonics::backward::harmonics",
            || harmonics_vjp(2, 9),
            &[
                ("g_out and the harmonics", || harmonics_vjp(2, 8)),
                ("g_out and the harmonics", || harmonics_vjp(2, 10)),
                ("out of bounds", || harmonics_vjp(5, 36)),
            ],
        ),
    ]
}

fn key() -> Key {
    Key::new(1, Purpose::Cases)
}

const SHAPE: Shape = Shape { position: 9, direction: 3, width: 4, depth: 6, color: 2 };

fn plain() -> Mlp {
    Mlp::initial(2, 3, 1, 1, &key())
}

fn net() -> NerfMlp {
    NerfMlp::initial(&SHAPE, &CS180, &key())
}

fn networks() -> Vec<Row> {
    fn layer(x: usize, biases: usize) {
        Layer { b: ones(biases).into(), ..Layer::zeros(2, 3) }.forward(&ones(x));
    }
    fn layer_vjp(x: usize, g: usize, mut gradient: Layer) {
        field::backward::layer(&Layer::zeros(2, 3), &ones(x), &ones(g), &mut gradient);
    }
    fn mlp_vjp(tape: &mlp::Tape, g: usize, mut gradient: Vec<Layer>) {
        field::backward::mlp(&plain(), tape, &ones(g), &mut gradient);
    }
    fn tape() -> mlp::Tape {
        plain().forward(&[1.0; 2])
    }
    fn nerf(position: usize, direction: usize) -> nerf_mlp::Tape {
        net().forward(&ones(position), &ones(direction), &CS180)
    }
    fn nerf_vjp(tape: &nerf_mlp::Tape, mut gradient: NerfMlp) {
        field::backward::nerf_mlp(&net(), tape, &CS180, 1.0, [1.0; 3], &mut gradient);
    }
    vec![
        row(
            "field::Layer::forward",
            || layer(2, 3),
            &[
                ("x and the columns of w", || layer(1, 3)),
                ("x and the columns of w", || layer(3, 3)),
                ("b and the rows of w", || layer(2, 4)),
            ],
        ),
        row(
            "field::backward::layer",
            || layer_vjp(2, 3, Layer::zeros(2, 3)),
            &[
                ("x and the columns of w", || layer_vjp(3, 3, Layer::zeros(2, 3))),
                ("g_z and the rows of w", || layer_vjp(2, 4, Layer::zeros(2, 3))),
                ("gradient.w and w", || layer_vjp(2, 3, Layer::zeros(3, 3))),
                ("gradient.b and the rows of w", || {
                    layer_vjp(2, 3, Layer { b: ones(4).into(), ..Layer::zeros(2, 3) });
                }),
            ],
        ),
        row(
            "field::backward::relu",
            || drop(field::backward::relu(&ones(2), &ones(2))),
            &[
                ("z and g", || drop(field::backward::relu(&ones(2), &ones(3)))),
                ("z and g", || drop(field::backward::relu(&ones(2), &ones(1)))),
            ],
        ),
        row(
            "field::mlp::Mlp::forward",
            || drop(tape()),
            &[
                ("x and the columns of w", || drop(plain().forward(&[1.0; 3]))),
                ("x and the columns of w", || {
                    let layers = vec![Layer::zeros(2, 3), Layer::zeros(4, 1)];
                    Mlp { layers, output: Output::Linear }.forward(&[1.0; 2]);
                }),
            ],
        ),
        row(
            "field::backward::mlp",
            || mlp_vjp(&tape(), 1, plain().layers),
            &[
                ("g_y and y", || mlp_vjp(&tape(), 2, plain().layers)),
                ("gradient and net", || mlp_vjp(&tape(), 1, plain().layers[..1].to_vec())),
                ("tape and net", || {
                    mlp_vjp(&Mlp::initial(2, 3, 2, 1, &key()).forward(&[1.0; 2]), 1, plain().layers)
                }),
                ("gradient.w and w", || mlp_vjp(&tape(), 1, Mlp::initial(3, 3, 1, 1, &key()).layers)),
            ],
        ),
        row(
            "field::nerf_mlp::NerfMlp::forward",
            || drop(nerf(9, 3)),
            &[
                ("x and the columns of w", || drop(nerf(8, 3))),
                ("x and the columns of w", || drop(nerf(9, 4))),
                ("x and the columns of w", || drop(nerf(10, 3))),
            ],
        ),
        row(
            "field::backward::nerf_mlp",
            || nerf_vjp(&nerf(9, 3), net()),
            &[
                ("gradient.trunk and net.trunk", || {
                    nerf_vjp(&nerf(9, 3), NerfMlp::initial(&Shape { depth: 5, ..SHAPE }, &CS180, &key()));
                }),
                ("gradient.w and w", || {
                    nerf_vjp(&nerf(9, 3), NerfMlp::initial(&Shape { width: 5, ..SHAPE }, &CS180, &key()))
                }),
                ("tape and net.trunk", || {
                    let deeper = NerfMlp::initial(&Shape { depth: 7, ..SHAPE }, &CS180, &key());
                    nerf_vjp(&deeper.forward(&ones(9), &ones(3), &CS180), net());
                }),
                ("x and the columns of w", || {
                    nerf_vjp(&nerf_mlp::Tape { hidden: ones(3), ..nerf(9, 3) }, net())
                }),
            ],
        ),
    ]
}

fn grids() -> Vec<Row> {
    fn levels(features: &[usize]) -> Vec<Level> {
        features.iter().map(|&features| Level::zeros(1, 8, features)).collect()
    }
    fn encode(entries: usize) {
        let level = Level { table: Array2::zeros([entries, 2]), ..Level::zeros(1, 8, 2) };
        hash_grid::encode(&[level], [0.5; 3]);
    }
    fn encode_vjp(g: usize, mut g_tables: Vec<Level>) {
        hash_grid::backward::encode(&levels(&[2, 3]), [0.5; 3], &ones(g), &mut g_tables);
    }
    fn grid(cells: usize) -> OccupancyGrid {
        OccupancyGrid { resolution: 2, density: ones(cells), threshold: 0.5 }
    }
    fn update(cells: usize, points: usize, sigmas: usize) {
        grid(cells).update(0.5, &gray(points), &ones(sigmas), GridDecay::Touched, GridUnseen::Kept);
    }
    fn occupied(cells: usize) {
        grid(cells).occupied([0.5; 3]);
    }
    fn march(cells: usize) {
        grid(cells).samples([0.0; 3], [1.0, 0.5, 0.25], 0.0, 1.0, 0.25, 0.5);
    }
    vec![
        row("hash_grid::encode", || encode(8), &[("table: at least one entry", || encode(0))]),
        row(
            "hash_grid::backward::encode",
            || encode_vjp(5, levels(&[2, 3])),
            &[
                ("g_out and the levels' features", || encode_vjp(4, levels(&[2, 3]))),
                ("g_out and the levels' features", || encode_vjp(6, levels(&[2, 3]))),
                ("g_tables and levels: one each", || encode_vjp(5, levels(&[2]))),
                ("g_tables and levels: as many entries", || encode_vjp(5, levels(&[2, 2]))),
                ("g_tables and levels: as many entries", || {
                    encode_vjp(5, vec![Level::zeros(1, 8, 2), Level::zeros(2, 27, 3)]);
                }),
            ],
        ),
        row(
            "occupancy_grid::OccupancyGrid::update",
            || update(8, 3, 3),
            &[
                ("points and sigmas", || update(8, 3, 2)),
                ("points and sigmas", || update(8, 3, 4)),
                ("density and cells", || update(9, 3, 3)),
            ],
        ),
        row(
            "occupancy_grid::OccupancyGrid::occupied",
            || occupied(8),
            &[("density and cells", || occupied(9))],
        ),
        row(
            "occupancy_grid::OccupancyGrid::samples",
            || march(8),
            &[("density and cells", || march(7)), ("density and cells", || march(9))],
        ),
    ]
}

fn training() -> Vec<Row> {
    fn field() -> Field {
        let (position, direction) = (Encoding::new(1, &CS180), Encoding::new(0, &CS180));
        Field { net: net(), position, direction, cube: None, conventions: CS180 }
    }
    fn target(t: usize, deltas: usize) -> Target {
        let ray = Ray { o: DVec3::ZERO, d: DVec3::Z };
        Target { ray, t: ones(t), deltas: ones(deltas), rgb: [0.5; 3] }
    }
    fn render(t: usize, deltas: usize) {
        field().render(&target(0, 0).ray, &ones(t), &ones(deltas));
    }
    fn step(t: usize, deltas: usize) {
        field().loss_and_gradient(&[target(2, 2), target(t, deltas)], [0.0; 3]);
    }
    fn fine(t: usize, edges: usize, weights: usize) {
        fine_samples(&ones(t), &ones(edges), &ones(weights), &[0.5], 2.0);
    }
    fn pixels(pixels: usize, targets: usize) {
        let encoding = Encoding::new(0, &CS180);
        let net = Mlp::initial(2, 3, 1, 3, &key());
        image_loss_and_gradient(&net, &encoding, &vec![[0.5; 2]; pixels], &gray(targets));
    }
    fn adam(m: Layer, v: Layer, g: Layer) {
        let (mut m, mut v) = (m, v);
        adam_layer(&Adam::default(), 1, &mut Layer::zeros(2, 3), &mut m, &mut v, &g);
    }
    fn right() -> Layer {
        Layer::zeros(2, 3)
    }
    fn wide() -> Layer {
        Layer::zeros(3, 3)
    }
    vec![
        row(
            "training::reference::Field::render",
            || render(2, 2),
            &[("t and deltas", || render(2, 3)), ("t and deltas", || render(3, 2))],
        ),
        row(
            "training::reference::Field::loss_and_gradient",
            || step(1, 1),
            &[("t and deltas", || step(1, 2)), ("t and deltas", || step(2, 1))],
        ),
        row(
            "training::reference::fine_samples",
            || fine(2, 3, 2),
            &[
                ("t and weights", || fine(3, 3, 2)),
                ("edges and weights", || fine(2, 2, 2)),
                ("edges and weights", || fine(2, 4, 2)),
                ("at least one bin", || fine(0, 1, 0)),
            ],
        ),
        row(
            "training::reference::image_loss_and_gradient",
            || pixels(2, 2),
            &[("pixels and targets", || pixels(2, 3)), ("pixels and targets", || pixels(3, 2))],
        ),
        row(
            "training::reference::adam_layer",
            || adam(right(), right(), right()),
            &[
                ("m and params", || adam(wide(), right(), right())),
                ("v and params", || adam(right(), wide(), right())),
                ("g and params", || adam(right(), right(), wide())),
                ("g and params", || adam(right(), right(), Layer { b: ones(4).into(), ..right() })),
            ],
        ),
    ]
}

fn steps() -> Vec<Row> {
    fn net() -> NerfMlp {
        let shape = Shape { position: 9, direction: 9, width: 2, depth: 1, color: 2 };
        NerfMlp::initial(&shape, &CS180, &key())
    }
    fn count() -> usize {
        training_step::flat(&net()).len()
    }
    fn field() -> training_step::Field {
        let encoding = Encoding::new(1, &CS180);
        training_step::Field { net: net(), position: encoding, direction: encoding }
    }
    fn batch(rays: usize, directions: usize, u: usize, target: usize) -> training_step::Batch {
        let ray = Ray { o: DVec3::ZERO, d: DVec3::Z };
        training_step::Batch {
            rays: vec![ray; rays],
            directions: gray(directions),
            u: vec![ones(2); u],
            target: gray(target),
        }
    }
    fn pass(n: [usize; 4]) {
        training_step::pass(&field(), &batch(n[0], n[1], n[2], n[3]), (1.0, 2.0), &CS180);
    }
    fn update(params: usize, m: usize, v: usize, g: usize) {
        let state = training_step::State { params: ones(params), m: ones(m), v: ones(v) };
        training_step::update(&state, &ones(g), &Adam::default(), 1, &CS180);
    }
    fn train(batches: usize, rates: usize) {
        let batches = vec![batch(1, 1, 1, 1); batches];
        training_step::train(&field(), &batches, (1.0, 2.0), &ones(rates), &Adam::default(), &CS180);
    }
    fn filled(params: usize) {
        training_step::filled(&net(), &ones(params));
    }
    vec![
        row(
            "training_step::filled",
            || filled(count()),
            &[
                ("as many as the network has", || filled(count() - 1)),
                ("as many as the network has", || filled(count() + 1)),
            ],
        ),
        row(
            "training_step::pass",
            || pass([2; 4]),
            &[
                ("directions and rays", || pass([2, 1, 2, 2])),
                ("u and rays", || pass([2, 2, 3, 2])),
                ("target and rays", || pass([2, 2, 2, 1])),
            ],
        ),
        row(
            "training_step::update",
            || update(2, 2, 2, 2),
            &[
                ("gradient and params", || update(2, 2, 2, 3)),
                ("m and params", || update(2, 1, 2, 2)),
                ("v and params", || update(2, 2, 3, 2)),
            ],
        ),
        row(
            "training_step::train",
            || train(2, 2),
            &[
                ("batches and rates", || train(2, 1)),
                ("batches and rates", || train(1, 2)),
                ("at least one", || train(0, 0)),
            ],
        ),
    ]
}
