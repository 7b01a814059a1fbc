//! Pictures out of the model, and pictures with opacity into it.

use super::{ball, trained};
use crate::files::photo::Photo;
use crate::training::Model;
use crate::training::compact::chunk::Ray;
use crate::training::compact::reference::Reference;
use crate::training::compact::views::Behind;
use crate::training::compact::{CompactModel, Overrides, Part};

/// Pictures, which are rendered in rounds, have the colors and opacities of all samples at once in f64.
#[test]
fn pictures_agree_with_the_reference() {
    let (most, worst) = differences(&trained(40));
    assert!(most > 3 * 8, "{most} samples: several rounds");
    assert!(worst < 2e-5, "{worst}");
}

/// The most samples of a ray of the ball's picture, and by how much a color or an opacity differs from the reference's.
pub(super) fn differences(model: &CompactModel) -> (usize, f64) {
    let rays = crate::evaluation::camera_rays(&ball().val[0].camera).unwrap();
    let reference = Reference::new(model);
    let samples = model.settings.samples_at_rest(model.step);
    let (mut most, mut worst) = (0, 0.0f64);
    for (ray, seen) in rays.iter().zip(model.render(&rays)) {
        let truth = reference.render(ray, samples, 0.0);
        most = most.max(truth.samples);
        let colors = (0..3).map(|k| f64::from(seen.rgb[k]) - truth.color[k]);
        worst = colors.chain([f64::from(seen.opacity) - truth.opacity]).map(f64::abs).fold(worst, f64::max);
    }
    (most, worst)
}

/// Clear pixels are learned over all backgrounds, if the picture's opacity is known and nobody asked for the scene's.
#[test]
fn clear_pixels_are_learned_over_all_backgrounds() {
    let mut scene = ball();
    scene.background = [0.25, 0.5, 1.0];
    for frame in &mut scene.train {
        let pixels = (0..24 * 24).map(|n| [200, 100, 0, if n % 2 == 0 { 255 } else { 0 }]).collect();
        frame.image = Some(Photo::cut(24, 24, pixels, [0.25, 0.5, 1.0]));
    }
    let rays = |without: Vec<Part>| {
        let mut model = CompactModel::new(&scene, &Overrides { without, ..Overrides::default() }).unwrap();
        model.step(&scene, 1).unwrap();
        model.chunks.iter().flat_map(|chunk| chunk.rays.clone()).collect::<Vec<_>>()
    };
    let drawn = rays(vec![]);
    assert!(drawn.len() > 100);
    for Ray { pixel, target, .. } in drawn {
        let clear = pixel % 2 == 1;
        assert_eq!(target.behind, Behind::Anything { clear: if clear { 1.0 } else { 0.0 } });
        assert_eq!(target.color == [0.0; 3], clear);
    }
    let fixed = rays(vec![Part::RandomBackgrounds]);
    assert!(fixed.iter().all(|ray| ray.target.behind == Behind::Color([0.25, 0.5, 1.0])));
}
