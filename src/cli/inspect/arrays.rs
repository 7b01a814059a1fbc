//! What `rays.npz` holds.

use image::RgbImage;
use ndarray::{Array1, Array2, Array3, Array4};

use super::drawn::{Drawn, Seen};
use crate::camera::Camera;
use crate::files::npz::{Array, Arrays};
use crate::scene::Scene;

/// F frames (training, then validation), R rays, N samples:
/// `c2ws` (F,4,4) with OpenCV axes, `intrinsics` (F,4) fx fy cx cy, `sizes` (F,2) width height, `size` (2) that of the first,
/// `is_val` (F), `thumbnails` (F,h,w,3),
/// `rays_frame` (R), `rays_uv` (R,2), `rays_rgb` (R,3), `rays_o` (R,3), `rays_d` (R,3), `rays_hit` (R) whether the scene's box is met,
/// `t` (R,N), `deltas` (R,N), `points` (R,N,3), `near`, `far`; and where a field is known, of a run or of a formula, `sigmas` (R,N),
/// `rgbs` (R,N,3), `alphas` (R,N), `transmittances` (R,N) in front of each sample, `weights` (R,N), `opacities` (R), and `colors`
/// (R,3) over the background.
pub(super) fn of(scene: &Scene, shown: &[(Camera, RgbImage)], drawn: &[Drawn]) -> Arrays {
    let named = |(name, array): (&str, Array)| (name.to_string(), array);
    let frames = of_frames(scene, shown).into_iter().map(named);
    frames
        .chain(of_rays(scene, drawn).into_iter().map(named))
        .chain(of_field(drawn).into_iter().map(named))
        .collect()
}

fn of_frames(scene: &Scene, shown: &[(Camera, RgbImage)]) -> [(&'static str, Array); 6] {
    let f = shown.len();
    let (width, height) = scene.size();
    let k = |f: usize| shown[f].0.k;
    let (w, h) = (shown[0].1.width() as usize, shown[0].1.height() as usize);
    let thumbnails = Array4::from_shape_fn((f, h, w, 3), |(f, j, i, c)| shown[f].1[(i as u32, j as u32)][c]);
    let intrinsics = Array2::from_shape_fn((f, 4), |(f, i)| [k(f).fx, k(f).fy, k(f).cx, k(f).cy][i]);
    let sizes = Array2::from_shape_fn((f, 2), |(f, i)| [shown[f].0.width, shown[f].0.height][i] as i64);
    [
        ("c2ws", Array3::from_shape_fn((f, 4, 4), |(f, i, j)| shown[f].0.c2w.col(j)[i]).into()),
        ("intrinsics", intrinsics.into()),
        ("sizes", sizes.into()),
        ("size", Array1::from_vec(vec![width as i64, height as i64]).into()),
        ("is_val", Array1::from_shape_fn(f, |f| u8::from(f >= scene.train.len())).into()),
        ("thumbnails", thumbnails.into()),
    ]
}

fn of_rays(scene: &Scene, drawn: &[Drawn]) -> [(&'static str, Array); 11] {
    let (r, n) = (drawn.len(), drawn[0].t.len());
    let scalar = |x: f64| ndarray::arr0(x).into();
    let points = Array3::from_shape_fn((r, n, 3), |(r, i, k)| drawn[r].ray.at(drawn[r].t[i])[k]);
    [
        ("rays_frame", Array1::from_shape_fn(r, |r| drawn[r].pixel.image as i64).into()),
        ("rays_uv", Array2::from_shape_fn((r, 2), |(r, i)| drawn[r].pixel.uv[i]).into()),
        ("rays_rgb", Array2::from_shape_fn((r, 3), |(r, i)| drawn[r].pixel.rgb[i]).into()),
        ("rays_o", Array2::from_shape_fn((r, 3), |(r, i)| drawn[r].ray.o[i]).into()),
        ("rays_d", Array2::from_shape_fn((r, 3), |(r, i)| drawn[r].ray.d[i]).into()),
        ("rays_hit", Array1::from_shape_fn(r, |r| u8::from(drawn[r].hit)).into()),
        ("t", Array2::from_shape_fn((r, n), |(r, i)| drawn[r].t[i]).into()),
        ("deltas", Array2::from_shape_fn((r, n), |(r, i)| drawn[r].deltas[i]).into()),
        ("points", points.into()),
        ("near", scalar(scene.near)),
        ("far", scalar(scene.far)),
    ]
}

/// Nothing where nothing is known of the field.
fn of_field(drawn: &[Drawn]) -> Vec<(&'static str, Array)> {
    let Some(seen) = drawn.iter().map(|drawn| drawn.seen.as_ref()).collect::<Option<Vec<&Seen>>>() else {
        return vec![];
    };
    let (r, n) = (drawn.len(), drawn[0].t.len());
    let each = |value: &dyn Fn(&Seen, usize) -> f64| {
        Array2::from_shape_fn((r, n), |(r, i)| value(seen[r], i)).into()
    };
    vec![
        ("sigmas", each(&|seen, i| seen.probes[i].density)),
        ("rgbs", Array3::from_shape_fn((r, n, 3), |(r, i, k)| seen[r].probes[i].rgb[k]).into()),
        ("alphas", each(&|seen, i| seen.alphas[i])),
        ("transmittances", each(&|seen, i| seen.rendering.transmittance[i])),
        ("weights", each(&|seen, i| seen.rendering.weights[i])),
        ("opacities", Array1::from_shape_fn(r, |r| seen[r].rendering.opacity).into()),
        ("colors", Array2::from_shape_fn((r, 3), |(r, k)| seen[r].color[k]).into()),
    ]
}
