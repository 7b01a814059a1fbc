//! The color behind what opaque pictures show: their borders', where those have one.

use serde_json::Value;

use super::{Options, Photo, Scene};

/// How much of the borders must have that color, and how near a channel must be to it.
const SHARE: f64 = 0.95;
const NEAR: f32 = 0.02;

/// Sets the background of a scene whose pictures have no transparent pixels, unless it is given.
pub(super) fn settle(scene: &mut Scene, options: &Options) {
    let pictures: Vec<&Photo> = scene.train.iter().filter_map(|frame| frame.image.as_ref()).collect();
    let all =
        scene.train.iter().chain(&scene.val).chain(&scene.test).filter_map(|frame| frame.image.as_ref());
    // What shines through has a background already.
    if options.background.is_some() || all.into_iter().any(Photo::seen_through) {
        return;
    }
    let border: Vec<[f32; 3]> = pictures.iter().flat_map(|picture| picture.border()).collect();
    let Some(color) = median(&border) else { return };
    let alike = |c: &&[f32; 3]| (0..3).all(|k| (c[k] - color[k]).abs() <= NEAR);
    let share = border.iter().filter(alike).count() as f64 / border.len() as f64;
    if share < SHARE || color == [0.0; 3] {
        return;
    }
    scene.background = color.map(f64::from);
    let why = format!("{:.0}% of the pictures' borders have this color", 100.0 * share);
    scene.reasons.insert("background".into(), Value::from(why));
}

/// The median of each channel.
fn median(colors: &[[f32; 3]]) -> Option<[f32; 3]> {
    (!colors.is_empty()).then(|| {
        std::array::from_fn(|k| {
            let mut channel: Vec<f32> = colors.iter().map(|color| color[k]).collect();
            channel.sort_by(f32::total_cmp);
            channel[channel.len() / 2]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::load;
    use super::*;

    /// White pictures with a dark middle, but for a few pixels of their borders.
    fn scene(others: usize) -> Scene {
        let mut scene = load("builtin:spheres,size=16,views=3", &Options::default()).unwrap();
        for frame in &mut scene.train {
            let color = |(j, i, _): (usize, usize, usize)| match (j, i) {
                (0, i) if i < others => 0.4,
                (4..12, 4..12) => 0.1,
                _ => 0.99,
            };
            frame.image = Some(ndarray::Array3::from_shape_fn((16, 16, 3), color).into());
        }
        scene.background = [0.0; 3];
        scene
    }

    #[test]
    fn borders_of_one_color_are_the_background() {
        let settled = |others: usize, given: Option<[f64; 3]>| {
            let mut scene = scene(others);
            settle(&mut scene, &Options { background: given, ..Options::default() });
            scene.background
        };
        let white = f64::from(0.99f32);
        assert_eq!(settled(0, None), [white; 3]);
        assert_eq!(settled(2, None), [white; 3], "62 of 64");
        assert_eq!(settled(8, None), [0.0; 3], "55 of 64");
        assert_eq!(settled(0, Some([0.0; 3])), [0.0; 3], "given");
    }
}
