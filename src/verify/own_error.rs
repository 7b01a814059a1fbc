//! The reference's own error, measured against the real-number truth of the mpmath fixtures.
//!
//! `tests/golden` fails when a measured error exceeds its limit, and when a limit is looser than twice the measured error.

/// The largest error of a component over all its fixtures, in ULP of the largest term behind an element.
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

/// Limits, in pipeline order.
pub const OWN_ERRORS: &[OwnError] = &[
    row("transform", 1.0, 1.0),
    row("pixel_to_camera", 1.0, 1.0),
    row("pixel_to_ray", 1.0, 1.0),
    row("image_rays", 1.0, 0.0),
    row("sample_along_rays", 1.0, 0.0),
    row("step_sizes", 1.0, 0.0),
    row("positional_encoding", 1.0, 1.0),
    row("mlp", 1.0, 1.0),
    row("nerf_mlp", 1.0, 1.0),
    row("volume_render", 1.0, 1.0),
    row("volume_render_alpha", 1.0, 1.0),
    row("composite_background", 1.0, 1.0),
    row("depth", 1.0, 1.0),
    row("render_trace", 1.0, 0.0),
    row("mse", 1.0, 1.0),
    row("psnr", 1.0, 0.0),
    row("to_uint8", 0.0, 0.0),
    row("adam_step", 1.0, 0.0),
    row("training_step", 1.0, 1.0),
    row("adam", 1.0, 0.0),
    row("loss_curve", 1.0, 0.0),
];

/// The limit of a component, or of several in a row, in one direction.
///
/// # Panics
/// Where the table lacks the name.
pub fn limit(component: &str, vjp: bool) -> f64 {
    let row = OWN_ERRORS.iter().find(|row| row.component == component);
    let row = row.unwrap_or_else(|| panic!("{component} has no row in OWN_ERRORS (src/verify/own_error.rs)"));
    if vjp { row.vjp } else { row.forward }
}
