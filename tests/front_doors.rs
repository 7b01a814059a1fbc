//! Front doors: every row has one, they take what the contract hands over, and a wrong kernel's panic names its mistake.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};

use nerf_oracle::contract::Dtype;
use nerf_oracle::convention::ProductEps;
use nerf_oracle::judge::{Door, Verdict};
use nerf_oracle::ndarray::{Array1, Array2, Array3, Axis};
use nerf_oracle::volume_rendering::{Rendering, backward};
use nerf_oracle::*;

/// What `assert_pass` panics with.
fn panic_of<Row>(door: Door<Row>) -> String {
    let panic = catch_unwind(AssertUnwindSafe(|| door.assert_pass())).expect_err("a wrong kernel passes");
    panic.downcast_ref::<String>().expect("a report").clone()
}

#[test]
fn every_row_has_a_front_door() {
    for component in COMPONENTS {
        let path = format!("{}/src/{}/judge.rs", env!("CARGO_MANIFEST_DIR"), component.folder);
        let text = fs::read_to_string(&path).unwrap_or_default();
        let row = component.name.to_uppercase();
        assert!(text.contains(&row), "{} has no front door: add one for {row} to {path}", component.name);
    }
}

/// No door asks for a type that the arrays of its row don't have: that would panic on the first case.
#[test]
fn doors_fit_the_contract() {
    // Answers nothing, which fails, after every input of every case has been handed over.
    macro_rules! nothing {
        ($($door:expr;)*) => { $(
            let report = $door.report();
            assert!(report.rows.iter().all(|row| row.verdict == Verdict::Fail), "{report}");
            assert!(report.rows.iter().all(|row| row.crashed.is_empty()), "{report}");
        )* };
    }
    nothing! {
        camera::judge(|_, _| ()).vjp(|_, _, _| ());
        camera::judge::judge_batch(|_, _| ()).vjp(|_, _, _| ());
        camera::judge::pixel_to_camera(|_, _, _| ()).vjp(|_, _, _, _| ());
        camera::judge::pixel_to_camera_batch(|_, _, _| ()).vjp(|_, _, _, _| ());
        ray::judge(|_, _, _| ()).vjp(|_, _, _, _, _| ());
        ray::judge::judge_batch(|_, _, _| ()).vjp(|_, _, _, _, _| ());
        ray::judge::image_rays(|_, _, _, _, _, _| ());
        sample::judge(|_, _, _, _, _| ());
        sample::judge::judge_batch(|_, _, _, _, _| ());
        sample::judge::step_sizes(|_, _, _| ());
        sample::judge::step_sizes_batch(|_, _, _| ());
        lens::judge(|_, _| ()).vjp(|_, _, _| ());
        lens::judge::judge_batch(|_, _| ()).vjp(|_, _, _| ());
        lens::judge::undistort(|_, _| ()).vjp(|_, _, _| ());
        lens::judge::undistort_batch(|_, _| ()).vjp(|_, _, _| ());
        fisheye::judge(|_, _| ()).vjp(|_, _, _| ());
        fisheye::judge::judge_batch(|_, _| ()).vjp(|_, _, _| ());
        fisheye::judge::undistort(|_, _| ()).vjp(|_, _, _| ());
        fisheye::judge::undistort_batch(|_, _| ()).vjp(|_, _, _| ());
        pose::judge(|_, _| ()).vjp(|_, _, _| ());
        pose::judge::judge_batch(|_, _| ()).vjp(|_, _, _| ());
        loss_scaling::judge(|_, _, _, _, _, _| ());
        loss_scaling::judge::unscale(|_, _| ());
        rigid_motion::judge(|_| ()).vjp(|_, _| ());
        rigid_motion::judge::judge_batch(|_| ()).vjp(|_, _| ());
        rigid_motion::judge::se3_exp(|_| ()).vjp(|_, _| ());
        rigid_motion::judge::se3_exp_batch(|_| ()).vjp(|_, _| ());
        ndc::judge(|_, _, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _| ());
        ndc::judge::judge_batch(|_, _, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _| ());
        conical_frustum::judge(|_, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _, _, _| ());
        conical_frustum::judge::judge_batch(|_, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _, _, _| ());
        contraction::judge(|_| ()).vjp(|_, _| ());
        contraction::judge::judge_batch(|_| ()).vjp(|_, _| ());
        gaussian_contraction::judge(|_, _| ()).vjp(|_, _, _, _| ());
        gaussian_contraction::judge::judge_batch(|_, _| ()).vjp(|_, _, _, _| ());
        encoding::judge(|_, _| ()).vjp(|_, _, _| ());
        encoding::judge::judge_batch(|_, _| ()).vjp(|_, _, _| ());
        integrated_encoding::judge(|_, _, _| ()).vjp(|_, _, _, _| ());
        integrated_encoding::judge::judge_batch(|_, _, _| ()).vjp(|_, _, _, _| ());
        field::judge(|_, _, _| ());
        spherical_harmonics::judge(|_, _| ()).vjp(|_, _, _| ());
        spherical_harmonics::judge::judge_batch(|_, _| ()).vjp(|_, _, _| ());
        trunc_exp::judge(|_| ()).vjp(|_, _| ());
        trunc_exp::judge::judge_batch(|_| ()).vjp(|_, _| ());
        volume_rendering::judge(|_, _, _| ()).vjp(|_, _, _, _, _, _, _| ());
        volume_rendering::judge::judge_batch(|_, _, _| ()).vjp(|_, _, _, _, _, _, _| ());
        volume_rendering::judge::volume_render_alpha(|_, _| ()).vjp(|_, _, _, _, _, _| ());
        volume_rendering::judge::volume_render_alpha_batch(|_, _| ()).vjp(|_, _, _, _, _, _| ());
        volume_rendering::judge::composite_background(|_, _, _| ()).vjp(|_, _, _, _| ());
        volume_rendering::judge::composite_background_batch(|_, _, _| ()).vjp(|_, _, _, _| ());
        volume_rendering::judge::depth(|_, _, _| ()).vjp(|_, _, _, _| ());
        volume_rendering::judge::depth_batch(|_, _, _| ()).vjp(|_, _, _, _| ());
        distortion::judge(|_, _| ()).vjp(|_, _, _| ());
        distortion::judge::judge_batch(|_, _| ()).vjp(|_, _, _| ());
        interlevel_loss::judge(|_, _, _, _, _| ()).vjp(|_, _, _, _, _, _| ());
        interlevel_loss::judge::judge_batch(|_, _, _, _, _| ()).vjp(|_, _, _, _, _, _| ());
        packed::judge(|_, _| ()).vjp(|_, _, _, _, _, _| ());
        packed::judge::pack_info(|_, _| ());
        packed::judge::accumulate_along_rays(|_, _, _| ()).vjp(|_, _, _, _| ());
        early_stop::judge(|_, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _, _| ());
        gaussian_covariance::judge(|_, _| ()).vjp(|_, _, _| ());
        gaussian_covariance::judge::judge_batch(|_, _| ()).vjp(|_, _, _| ());
        gaussian_projection::judge(|_, _, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _, _, _, _| ());
        gaussian_projection::judge::judge_batch(|_, _, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _, _, _, _| ());
        gaussian_alpha::judge(|_, _, _, _| ()).vjp(|_, _, _, _, _| ());
        gaussian_alpha::judge::judge_batch(|_, _, _, _| ()).vjp(|_, _, _, _, _| ());
        gaussian_color::judge(|_, _, _| ()).vjp(|_, _, _, _| ());
        gaussian_color::judge::judge_batch(|_, _, _| ()).vjp(|_, _, _, _| ());
        trace::judge(|_, _, _, _, _, _, _, _, _, _, _, _| ());
        loss::judge(|_, _| ()).vjp(|_, _, _| ());
        loss::judge::psnr(|_, _, _| ());
        loss::judge::to_uint8(|_| ());
        robust_loss::judge(|_, _, _| ()).vjp(|_, _, _, _| ());
        robust_loss::judge::charbonnier(|_, _, _| ()).vjp(|_, _, _, _| ());
        ssim::judge(|_, _, _| ()).vjp(|_, _, _, _| ());
        optimizer::judge(|_, _, _, _, _, _, _, _, _, _| ());
        optimizer::judge::judge_batch(|_, _, _, _, _, _, _, _, _, _| ());
        optimizer::judge::adamw(|_, _, _, _, _, _, _, _, _, _| ());
        optimizer::judge::adamw_batch(|_, _, _, _, _, _, _, _, _, _| ());
        gradient_clipping::judge(|_, _, _| ());
        gradient_clipping::judge::clip_by_value(|_, _| ());
        proposal_pdf::judge(|_, _, _, _| ());
        proposal_pdf::judge::judge_batch(|_, _, _, _| ());
        resample_edges::judge(|_, _, _| ());
        resample_edges::judge::judge_batch(|_, _, _| ());
        learning_rate::judge(|_, _, _, _| ());
        learning_rate::judge::cosine(|_, _, _, _, _| ());
        learning_rate::judge::log_linear(|_, _, _, _, _, _| ());
        importance_sampling::judge(|_, _, _, _| ()).vjp(|_, _, _, _, _| ());
        importance_sampling::judge::judge_batch(|_, _, _, _| ()).vjp(|_, _, _, _, _| ());
        ray_aabb::judge(|_, _, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _| ());
        ray_aabb::judge::judge_batch(|_, _, _, _, _, _| ()).vjp(|_, _, _, _, _, _, _, _| ());
        occupancy_grid::judge(|_, _, _, _, _, _| ());
        occupancy_grid::judge::grid_traversal(|_, _, _, _, _| ());
    }
}

fn render(sigmas: &[f64], rgbs: &[[f64; 3]], deltas: &[f64]) -> Rendering {
    volume_rendering::volume_render(sigmas, rgbs, deltas, ProductEps::None)
}

/// Single rays and batches, whole structures and some outputs of them, gradients that rays share.
#[test]
fn right_kernels_pass() {
    let cotangent = |color, weights: &[f64], opacity, transmittance| backward::Cotangent {
        color,
        weights: weights.to_vec(),
        opacity,
        transmittance,
    };
    let report = volume_rendering::judge(render)
        .vjp(|s, c, d, g_color, g_weights, g_opacity, g_behind| {
            let g = cotangent(g_color, g_weights, g_opacity, g_behind);
            backward::volume_render(s, c, d, ProductEps::None, &render(s, c, d), &g)
        })
        .profile("cs180")
        .report();
    assert_eq!(report.exit_code(), 0, "{report}");
    assert!(
        report.rows.len() == 2 && report.rows.iter().all(|row| row.missing_outputs.is_empty()),
        "{report}"
    );

    // Transmittance alone, by ndarray.
    let batch = volume_rendering::judge::judge_batch(|sigmas, _, deltas| {
        ((), (), (), (&sigmas * &deltas).sum_axis(Axis(1)).mapv(|x| (-x).exp()))
    });
    let report = batch.in_f32().report();
    assert_eq!(report.exit_code(), 0, "{report}");
    assert_eq!(report.rows[0].missing_outputs, ["colors", "opacity", "weights"]);

    volume_rendering::judge::composite_background(|c, a, b| [0, 1, 2].map(|k| c[k] + (1.0 - a) * b[k]))
        .vjp(|_, a, b, g| (g, -(g[0] * b[0] + g[1] * b[1] + g[2] * b[2]), g.map(|g| (1.0 - a) * g)))
        .assert_pass();
    volume_rendering::judge::composite_background_batch(|c, a, b| {
        Array2::from_shape_fn(c.dim(), |(r, k)| c[[r, k]] + (1.0 - a[r]) * b[k])
    })
    .vjp(|c, a, b, g| {
        let g_a: Array1<f64> = (0..a.len()).map(|r| -(0..3).map(|k| g[[r, k]] * b[k]).sum::<f64>()).collect();
        let g_b = [0, 1, 2].map(|k| (0..c.nrows()).map(|r| g[[r, k]] * (1.0 - a[r])).sum::<f64>());
        (g.to_owned(), g_a, g_b)
    })
    .assert_pass();
    trunc_exp::judge(|x| x.exp() as f32).in_dtype(Dtype::Bf16).assert_pass();
    hash_grid::judge(|levels, x| {
        let rows: Vec<Vec<f64>> = x.iter().map(|x| hash_grid::encode(levels, *x)).collect();
        Array2::from_shape_fn((rows.len(), rows[0].len()), |(m, f)| rows[m][f])
    })
    .vjp(|levels, x, g| {
        let mut tables = levels.to_vec();
        tables.iter_mut().for_each(|level| level.table.fill(0.0));
        let g_x = x.iter().zip(g.rows());
        let g_x = g_x.map(|(x, g)| hash_grid::backward::encode(levels, *x, &g.to_vec(), &mut tables));
        (g_x.collect(), tables)
    })
    .assert_pass();
}

/// Plain networks by matrix products, and NeRF's by the reference, with their gradients.
#[test]
fn networks_pass() {
    use field::{Layer, backward, mlp::Mlp, mlp::Output};
    let zeros = |layers: &[Layer]| -> Vec<Layer> {
        layers.iter().map(|layer| Layer::zeros(layer.w.ncols(), layer.w.nrows())).collect()
    };
    let net = |layers: &[Layer]| Mlp { layers: layers.to_vec(), output: Output::Sigmoid };
    let rows = |rows: Vec<Vec<f64>>| Array2::from_shape_fn((rows.len(), rows[0].len()), |(m, n)| rows[m][n]);
    field::judge::mlp(|layers, x| {
        rows(x.rows().into_iter().map(|x| net(layers).forward(&x.to_vec()).y).collect())
    })
    .vjp(|layers, x, g| {
        let (net, mut gradient) = (net(layers), zeros(layers));
        let point = |(x, g): (Array1<f64>, Array1<f64>)| {
            backward::mlp(&net, &net.forward(&x.to_vec()), &g.to_vec(), &mut gradient)
        };
        let points =
            x.rows().into_iter().map(|x| x.to_owned()).zip(g.rows().into_iter().map(|g| g.to_owned()));
        (rows(points.map(point).collect()), gradient)
    })
    .assert_pass();
}

#[test]
fn a_wrong_panic_names_the_mistake() {
    let inclusive = panic_of(volume_rendering::judge(|sigmas, rgbs, deltas| {
        let (mut color, mut through) = ([0.0; 3], 1.0);
        for i in 0..sigmas.len() {
            let x = sigmas[i] * deltas[i];
            through *= (-x).exp();
            (0..3).for_each(|a| color[a] += through * -(-x).exp_m1() * rgbs[i][a]);
        }
        color
    }));
    assert!(inclusive.contains("inclusive_transmittance"), "{inclusive}");
    assert!(inclusive.contains("FAIL volume_render forward") && inclusive.contains("to fix"), "{inclusive}");

    let root = panic_of(optimizer::judge(|p, g, m, v, step, lr, beta1, beta2, eps, decay| {
        let g = g + decay * p;
        let (m, v) = (beta1 * m + (1.0 - beta1) * g, beta2 * v + (1.0 - beta2) * g * g);
        let correction = |beta: f64| -(step as f64 * beta.ln()).exp_m1();
        (p - lr * (m / correction(beta1)) / (v / correction(beta2) + eps).sqrt(), m, v)
    }));
    assert!(root.contains("eps_inside_root"), "{root}");

    let mean =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.len() as f64;
    let halved = panic_of(
        loss::judge(mean)
            .vjp(|a, b, g| a.iter().zip(b).map(|(x, y)| g * (x - y) / a.len() as f64).collect::<Vec<_>>()),
    );
    assert!(halved.contains("factor_two_missing") && halved.contains("FAIL mse vjp"), "{halved}");

    let picture = panic_of(loss::judge::to_uint8(|image| {
        let (h, w, _) = image.dim();
        Array3::from_shape_fn((h, w, 3), |(j, i, k)| {
            (255.0 * image[[j, i, 2 - k]].clamp(0.0, 1.0)).round() as u8
        })
    }));
    assert!(picture.contains("red_and_blue_exchanged"), "{picture}");
}

/// A pinned profile fails what would otherwise be found and told; nobody gets another type's verdict.
#[test]
fn profile_and_type_count() {
    let spaced = || {
        sample::judge::step_sizes(|t, _, _| {
            let next = t.iter().skip(1).chain([&f64::INFINITY]);
            t.iter().zip(next).map(|(a, b)| (b - a).min(1e10)).collect::<Vec<_>>()
        })
    };
    spaced().assert_pass();
    assert!(panic_of(spaced().profile("cs180")).contains("FAIL step_sizes"));
    assert!(catch_unwind(|| spaced().profile("cs181").report()).is_err(), "no such profile");
    let short = || trunc_exp::judge(|x: f64| f64::from(x.exp() as f32));
    short().in_f32().assert_pass();
    assert!(panic_of(short().in_f64()).contains("FAIL trunc_exp"));
}
