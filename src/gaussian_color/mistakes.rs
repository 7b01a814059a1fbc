//! Splats' colors, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{form, forward, vjp};
use super::{Form, backward, color as oracle, degree, direction, sum};
use crate::contract::arrays::{Arrays, threes, values};
use crate::contract::component::Mistake;
use crate::convention::{Conventions, HarmonicForm, SplatColor};
use crate::spherical_harmonics::harmonics;

pub(crate) mod laws;

const OFF_LENGTH: Mistake = Mistake::new(
    "eps_in_length",
    "d / (|d| + eps)",
    "directions are too short, those of near splats most of all",
    "divide by |d|, or by max(|d|, eps)",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-3, [1e-8, 1.0]);

/// Mistakes of splats' colors.
pub(crate) const GAUSSIAN_COLOR: &[Mistake] = &[
    Mistake::new(
        "direction_reversed",
        "center - mean",
        "highlights are on the far side of what they belong to",
        "mean - center",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "direction_not_normalized",
        "the harmonics of mean - center as it is",
        "colors explode with the distance",
        "divide by the length",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "half_forgotten",
        "max(sum, 0)",
        "pictures are too dark: what should be gray is black",
        "1/2 before the clamp",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "constant_forgotten",
        "the first coefficient as the color, without 1 / sqrt(4 pi)",
        "colors are 3.5 times too strong",
        "f_0 Y_0: (rgb - 1/2) / 0.28209 where a color is given",
        "viewers that show f_dc of a PLY file as it is",
        0,
    ),
    Mistake::new(
        "channels_first",
        "f_rest read as all of red, all of green, all of blue, or written so",
        "colors change with the direction as nothing does",
        "(coefficient, channel) after transposing what a PLY file has by channels",
        "readers of 3D Gaussian splatting's PLY files, which are by channels",
        0,
    ),
    Mistake::new(
        "clamped_at_one",
        "clamp(sum + 1/2, 0, 1)",
        "bright splats have no gradient, and stay as bright as they are",
        "clamp below alone",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_gradient_dropped",
        "the direction is held constant",
        "means don't learn from how colors change with the direction; poses neither",
        "g_d through the length to the mean",
        "brush#448; gsplat before 1.0 (gsplat#147, #183); taichi_3d_gaussian_splatting#169",
        3,
    )
    .of_gradient(),
    Mistake::new(
        "normalization_not_differentiated",
        "the gradient of d / |d| as that of the mean",
        "means are pulled along their rays, and far ones too strongly",
        "(g - (g . u) u) / |d|",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "clamp_not_differentiated",
        "gradients pass where a channel is clamped",
        "black splats drift without an effect that one could see",
        "0 where the sum and 1/2 is below 0",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "mean_gradient_negated",
        "the gradient of the camera's center as that of the mean",
        "means move away from where their colors would fit",
        "d = mean - center: plus g_d",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "first_band_alone",
        "the first harmonic alone, whatever coefficients there are",
        "splats have one color from all sides: highlights are baked into the scene",
        "all bands that a splat has coefficients of",
        "1 public implementation's fallback where its kernel isn't built; viewers",
        1,
    ),
    Mistake::new(
        "length_in_the_harmonics",
        "3D Gaussian splatting's polynomials of mean - center as it is: band l grows with the l-th power of the distance",
        "colors explode with the distance",
        "divide by the length",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "length_of_all",
        "all differences divided by one length: a norm without its axis",
        "colors depend on the other splats, and on how many there are",
        "a length for each splat",
        "a generative splat code: torch.norm(rays_d)",
        1,
    ),
    Mistake::new(
        "length_along_splats",
        "x, y and z divided by the lengths of their columns: a norm over the wrong axis",
        "colors depend on the other splats",
        "a length for each splat",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "length_of_the_farthest",
        "all differences divided by the largest distance",
        "near splats hardly change with the direction",
        "a length for each splat",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "length_squared",
        "divided by the squared length: the root is forgotten",
        "colors that fade to the first band's with the distance",
        "divide by the length",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "color_through_sigmoid",
        "sigmoid(sum) in the place of sum + 1/2",
        "washed-out pictures of splats that were trained with the shift",
        "max(sum + 1/2, 0), or a sigmoid in training too",
        "Plenoxels' and PlenOctrees' color; never seen here",
        0,
    ),
    Mistake::new(
        "shifted_through_sigmoid",
        "sigmoid(sum + 1/2)",
        "nothing is darker than gray",
        "the shift or the sigmoid, not both",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "third_band_left_out",
        "bands 0 to 2 alone, of coefficients that have more",
        "colors change less with the direction than they were trained to",
        "all bands that there are coefficients of",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "band_1_by_axes",
        "x, y, z for y, z, x in band 1",
        "a splat's sheen leans to another side",
        "y, z, x: m = -1, 0, 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "direction_in_other_axes",
        "(x, -y, -z): the direction in OpenGL's camera axes",
        "a splat's sheen turned around",
        "the direction in the world, in the axes of the training",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "direction_upside_down",
        "(x, -y, z) for the direction",
        "a splat's sheen mirrored",
        "the direction in the world, in the axes of the training",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "direction_with_z_up",
        "(x, z, y) for the direction",
        "a splat's sheen turned around",
        "the direction in the world, in the axes of the training",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "rest_by_channels",
        "all coefficients but the first read as if they were stored channel by channel",
        "rainbow noise that turns with the camera",
        "(degree, channel), or transpose what a .ply file has",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "constant_twice",
        "the first coefficient times 0.282 twice",
        "all splats nearly gray",
        "once",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "absolute_value",
        "|sum + 1/2|",
        "dark splats shine",
        "max(0, sum + 1/2)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "second_band_left_out",
        "bands 0 and 1 alone, of coefficients that have more",
        "colors change less with the direction than they were trained to",
        "all bands that there are coefficients of",
        "a renderer in Metal, one in Rust",
        2,
    ),
    Mistake::new(
        "band_1_signs",
        "the signs of x and y in band 1 are those of the other convention, all other bands' are not",
        "a splat's sheen leans to the other side in one band of four",
        "one convention for all bands: (-1)^m, or none",
        "1 public implementation",
        1,
    ),
];

/// The coefficients as if read by channels.
fn by_channels(f: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let (flat, width) = (f.as_flattened(), f.len());
    (0..width).map(|k| [0, 1, 2].map(|channel| flat[channel * width + k])).collect()
}

/// What x, y and z of a direction are divided by, where that isn't its length.
fn wrong_length(d: [f64; 3], all: &[[f64; 3]], wrong: &[&str]) -> Option<[f64; 3]> {
    let has = |name: &str| wrong.contains(&name);
    let square = |d: &[f64; 3]| d.iter().map(|x| x * x).sum::<f64>();
    if let Some(eps) = OFF_LENGTH.among(wrong) {
        return Some([square(&d).sqrt() + eps; 3]);
    }
    match () {
        () if has("length_in_the_harmonics") => Some([1.0; 3]),
        () if has("length_of_all") => Some([all.iter().map(square).sum::<f64>().sqrt(); 3]),
        () if has("length_along_splats") => {
            Some([0, 1, 2].map(|k| all.iter().map(|d| d[k] * d[k]).sum::<f64>().sqrt()))
        }
        () if has("length_of_the_farthest") => Some([all.iter().map(square).fold(0.0, f64::max).sqrt(); 3]),
        () if has("length_squared") => Some([square(&d); 3]),
        () => None,
    }
}

/// The harmonics of a direction that isn't of length 1 as 3D Gaussian splatting's polynomials have them: homogeneous up to band 3.
/// Band 4, which others have added, is that of the unit sphere.
fn of_any_length(d: [f64; 3], degree: usize, form: Form) -> Vec<f64> {
    let mut y = harmonics(d, degree, HarmonicForm::Homogeneous, form.sign);
    if degree > 3 {
        let last = harmonics(d, degree, HarmonicForm::Sphere, form.sign);
        y[16..].copy_from_slice(&last[16..]);
    }
    y
}

/// A color with what is wrong about it; `all` are the differences of all means from the center.
fn wrong_color(
    mean: [f64; 3],
    center: [f64; 3],
    f: &[[f64; 3]],
    all: &[[f64; 3]],
    form: Form,
    wrong: &[&str],
) -> [f64; 3] {
    let has = |name: &str| wrong.contains(&name);
    let d = if has("direction_reversed") { direction(center, mean) } else { direction(mean, center) };
    let d = match () {
        () if has("direction_in_other_axes") => [d[0], -d[1], -d[2]],
        () if has("direction_upside_down") => [d[0], -d[1], d[2]],
        () if has("direction_with_z_up") => [d[0], d[2], d[1]],
        () => d,
    };
    let mut y = match wrong_length(d, all, wrong) {
        _ if has("direction_not_normalized") => harmonics(d, degree(f), HarmonicForm::Sphere, form.sign),
        None => harmonics(d, degree(f), HarmonicForm::Normalized, form.sign),
        Some(length) => of_any_length(std::array::from_fn(|k| d[k] / length[k]), degree(f), form),
    };
    if has("constant_forgotten") {
        y[0] = 1.0;
    }
    if has("band_1_by_axes") && y.len() > 1 {
        (y[1], y[2], y[3]) = (y[3], y[1], y[2]);
    }
    if has("band_1_signs") && y.len() > 1 {
        (y[1], y[3]) = (-y[1], -y[3]);
    }
    if has("third_band_left_out") {
        y.iter_mut().skip(9).for_each(|y| *y = 0.0);
    }
    if has("second_band_left_out") {
        y.iter_mut().skip(4).for_each(|y| *y = 0.0);
    }
    if has("first_band_alone") {
        y[1..].fill(0.0);
    }
    let rest = |f: &[[f64; 3]]| [&f[..1], &by_channels(&f[1..])].concat();
    let f = &if has("rest_by_channels") { rest(f) } else { f.to_vec() };
    if has("constant_twice") {
        y[0] *= y[0];
    }
    let f = if has("channels_first") { by_channels(f) } else { f.to_vec() };
    let shift = if has("half_forgotten") || has("color_through_sigmoid") || form.color == SplatColor::Sum {
        0.0
    } else {
        0.5
    };
    sum(&y, &f).map(|sum| {
        let x = sum + shift;
        if has("color_through_sigmoid") || has("shifted_through_sigmoid") {
            return crate::field::sigmoid(x);
        }
        if has("absolute_value") {
            return x.abs();
        }
        let x = if form.color == SplatColor::Clamped { x.max(0.0) } else { x };
        if has("clamped_at_one") { x.clamp(0.0, 1.0) } else { x }
    })
}

/// Colors.
pub(crate) fn color(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let center = values(a, "camera_center");
    let from = |mean: [f64; 3]| direction(mean, [center[0], center[1], center[2]]);
    let all: Vec<[f64; 3]> = threes(a, "means").into_iter().map(from).collect();
    forward(a, |mean, center, f| match wrong {
        [] => oracle(mean, center, f, form(c)),
        wrong => wrong_color(mean, center, f, &all, form(c), wrong),
    })
}

/// Their gradients.
pub(crate) fn color_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let form = form(c);
    vjp(a, |mean, center, f, g| {
        let has = |name: &str| wrong.contains(&name);
        let form = match has("clamp_not_differentiated") {
            true => Form { color: SplatColor::Shifted, ..form },
            false => form,
        };
        let (g_mean, g_f) = backward::color(mean, center, f, form, g);
        let g_mean = match () {
            () if has("mean_gradient_dropped") => [0.0; 3],
            () if has("normalization_not_differentiated") => of_unit(mean, center, f, form, g, &g_f),
            () => g_mean,
        };
        (if has("mean_gradient_negated") { g_mean.map(|g| -g) } else { g_mean }, g_f)
    })
}

/// The gradient of the unit direction.
fn of_unit(
    mean: [f64; 3],
    center: [f64; 3],
    f: &[[f64; 3]],
    form: Form,
    g: [f64; 3],
    g_f: &[[f64; 3]],
) -> [f64; 3] {
    let d = direction(mean, center);
    let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    // The first harmonic isn't 0: where its gradient is, the channel was clamped.
    let kept = [0, 1, 2].map(|channel| if g_f[0][channel] == 0.0 { 0.0 } else { g[channel] });
    let g_y: Vec<f64> = f.iter().map(|f| (0..3).map(|channel| kept[channel] * f[channel]).sum()).collect();
    let of_harmonics = crate::spherical_harmonics::backward::harmonics;
    of_harmonics(d.map(|x| x / length), degree(f), HarmonicForm::Homogeneous, form.sign, &g_y)
}
