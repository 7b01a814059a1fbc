//! The reference's own error, measured against the real-number truth of the mpmath fixtures.
//!
//! `tests/golden` fails when a measured error exceeds its limit, and when a limit is looser than twice the measured error.

/// The largest error of a component over all its fixtures, in ULP of the largest term that an element sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnError {
    /// The component, or several in a row.
    pub component: &'static str,
    /// Limit of the outputs' error.
    pub forward: f64,
    /// Limit of the gradients' error; 0 where there are none.
    pub vjp: f64,
}

const fn row(component: &'static str, forward: f64, vjp: f64) -> OwnError {
    OwnError { component, forward, vjp }
}

/// Limits in pipeline order, about 1.3 times what is measured.
///
/// Single operations stay within 4 ULP, and so do sums and products along a ray, which are compensated; the
/// gradients of deep networks sum errors of many paths, while the unit is that of the largest term alone.
pub const OWN_ERRORS: &[OwnError] = &[
    row("transform", 1.3, 0.9),
    row("pixel_to_camera", 1.4, 1.9),
    row("lens_distort", 2.0, 2.7),
    row("lens_undistort", 4.1, 27.6),
    row("fisheye_distort", 1.3, 4.0),
    row("fisheye_undistort", 2.5, 11.8),
    row("pose_from_colmap", 3.4, 6.1),
    row("so3_exp", 2.7, 7.8),
    row("se3_exp", 4.0, 5.8),
    row("pixel_to_ray", 1.6, 4.7),
    row("image_rays", 2.1, 0.0),
    row("ndc_rays", 4.0, 4.0),
    row("sample_along_rays", 1.5, 0.0),
    row("step_sizes", 0.5, 0.0),
    row("conical_frustum", 3.7, 5.8),
    row("contraction", 1.7, 4.2),
    row("contract_gaussians", 9.2, 11.7),
    row("positional_encoding", 1.6, 2.9),
    row("integrated_encoding", 2.3, 2.8),
    row("mlp", 1.3, 12.0),
    row("nerf_mlp", 1.9, 24.0),
    row("hash_grid", 2.7, 5.9),
    row("spherical_harmonics", 3.3, 4.9),
    row("trunc_exp", 0.8, 1.1),
    row("volume_render", 2.3, 7.1),
    row("volume_render_alpha", 1.6, 4.5),
    row("composite_background", 0.7, 0.8),
    row("depth", 1.1, 2.0),
    row("pack_info", 0.0, 0.0),
    row("packed_scan", 0.7, 3.6),
    row("accumulate_along_rays", 1.1, 1.8),
    row("early_stop", 1.7, 3.5),
    row("gaussian_covariance", 8.9, 11.6),
    row("gaussian_projection", 10.1, 12.3),
    row("gaussian_alpha", 2.4, 3.6),
    row("gaussian_color", 2.6, 7.3),
    row("render_trace", 2.2, 0.0),
    row("distortion_loss", 0.6, 3.5),
    row("interlevel_loss", 3.0, 1.9),
    row("mse", 0.5, 1.4),
    row("huber", 1.0, 1.5),
    row("charbonnier", 0.6, 2.0),
    row("psnr", 1.2, 0.0),
    row("to_uint8", 0.0, 0.0),
    row("ssim", 1.5, 3.5),
    row("linear_to_srgb", 1.9, 5.0),
    row("loss_scale_update", 0.0, 0.0),
    row("unscale_gradients", 0.6, 0.0),
    row("clip_by_global_norm", 1.3, 0.0),
    row("clip_by_value", 0.0, 0.0),
    row("lr_exponential", 0.7, 0.0),
    row("lr_cosine", 1.0, 0.0),
    row("lr_log_linear", 1.1, 0.0),
    row("adam_step", 1.9, 0.0),
    row("adamw_step", 1.5, 0.0),
    row("training_step", 11.0, 0.0),
    row("loss_gradient", 1.8, 16.0),
    row("adam", 3.2, 0.0),
    row("loss_curve", 17.0, 0.0),
    row("importance_sampling", 1.0, 1.8),
    row("proposal_pdf", 1.6, 0.0),
    row("resample_edges", 1.5, 0.0),
    row("ray_aabb", 0.6, 1.9),
    row("occupancy_grid", 0.6, 0.0),
    row("grid_traversal", 1.5, 0.0),
];

impl OwnError {
    fn limit(&self, vjp: bool) -> f64 {
        if vjp { self.vjp } else { self.forward }
    }
}

fn find(component: &str) -> Option<&'static OwnError> {
    OWN_ERRORS.iter().find(|row| row.component == component)
}

/// The limit of a component, or of several in a row, in one direction.
///
/// # Panics
/// Where the table lacks the name.
pub fn limit(component: &str, vjp: bool) -> f64 {
    let row = find(component);
    row.unwrap_or_else(|| panic!("{component} has no row in OWN_ERRORS (src/proof/own_error.rs)")).limit(vjp)
}

/// What is wrong with the table, given an error that was measured: no row, a limit that is exceeded, or one that is looser than twice
/// the error; with the limit to write.
pub fn fault(component: &str, vjp: bool, measured: f64) -> Option<String> {
    let direction = if vjp { "vjp" } else { "forward" };
    let wrong = match find(component).map(|row| row.limit(vjp)) {
        None => "no row yet".to_string(),
        Some(limit) if measured > limit => format!("the limit {limit} is exceeded"),
        Some(limit) if limit > 2.0 * measured => format!("the limit {limit} is looser than twice the error"),
        Some(_) => return None,
    };
    Some(format!("{component} {direction}: {wrong}; measured {measured:.3}, so write {:.1}", 1.3 * measured))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_says_what_to_write() {
        let fault = |name: &str, times: f64| fault(name, false, times * OWN_ERRORS[0].forward);
        let known = OWN_ERRORS[0].component;
        assert_eq!((fault(known, 1.0), fault(known, 0.5)), (None, None));
        assert!(fault(known, 1.01).unwrap().contains("is exceeded"));
        assert!(fault(known, 0.49).unwrap().contains("is looser"));
        assert_eq!(fault("new", 0.0).unwrap(), "new forward: no row yet; measured 0.000, so write 0.0");
        assert_eq!(
            super::fault("new", true, 2.0).unwrap(),
            "new vjp: no row yet; measured 2.000, so write 2.6"
        );
    }

    #[test]
    #[should_panic(expected = "new has no row in OWN_ERRORS")]
    fn a_limit_needs_its_row() {
        limit("new", false);
    }
}
