//! A small renderer in f32, as a project may have one. It knows nothing of nerf-oracle: its tests do.

/// Color and weights along a ray.
pub fn march(sigmas: &[f32], rgbs: &[[f32; 3]], deltas: &[f32]) -> ([f32; 3], Vec<f32>) {
    let (mut color, mut through, mut weights) = ([0.0; 3], 1.0, vec![]);
    for ((sigma, rgb), delta) in sigmas.iter().zip(rgbs).zip(deltas) {
        let weight = -through * (-sigma * delta).exp_m1();
        (0..3).for_each(|a| color[a] += weight * rgb[a]);
        through *= (-sigma * delta).exp();
        weights.push(weight);
    }
    (color, weights)
}

/// The gradient of a loss with respect to the colors of the samples, from that with respect to the ray's color.
pub fn march_back(sigmas: &[f32], rgbs: &[[f32; 3]], deltas: &[f32], grad_color: [f32; 3]) -> Vec<[f32; 3]> {
    let (_, weights) = march(sigmas, rgbs, deltas);
    weights.iter().map(|weight| grad_color.map(|g| weight * g)).collect()
}

/// A color in front of a background.
pub fn over(color: [f32; 3], opacity: f32, background: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|a| color[a] + (1.0 - opacity) * background[a])
}
