//! Where cameras look: sentences about what is seldom meant, for people who look at a scene.

use glam::{DMat3, DVec3};

use super::Frame;

/// A share of cameras that may look away from the others: an inside-out capture has a few by chance.
const AWAY: f64 = 0.1;
/// R R^T off the identity by this much turns a ray by as much: a pixel in ten thousand.
const RIGID: f64 = 1e-5;

/// What is wrong with one camera, if something is, and what is wrong with many of them.
pub(crate) fn doubts(frames: &[&Frame], focus: DVec3) -> (Vec<Option<String>>, Vec<String>) {
    let mut all = vec![];
    let away = |frame: &Frame| {
        let (center, axis) = (frame.camera.c2w.w_axis.truncate(), frame.camera.c2w.z_axis.truncate());
        (focus - center).dot(axis) <= 0.0
    };
    let off: Vec<f64> = frames.iter().map(|frame| off_rigid(frame)).collect();
    let one = |(frame, off): (&&Frame, &f64)| match (away(frame), *off > RIGID) {
        (_, true) => Some(format!("not rigid: R R^T is off the identity by {off:.1e}")),
        (true, _) => Some("looks away from where the others look".into()),
        _ => None,
    };
    let each = frames.iter().zip(&off).map(one).collect();
    let count = frames.iter().filter(|frame| away(frame)).count();
    if count as f64 > AWAY * frames.len() as f64 {
        all.push(format!(
            "{count} of {} cameras look away from the point that all axes pass closest to, {focus:.3}: are the axes those of the file's \
             convention (OpenGL looks along -z, OpenCV along z), and the poses camera to world?",
            frames.len()
        ));
    }
    let bent = off.iter().filter(|off| **off > RIGID).count();
    if let Some(worst) = (0..frames.len()).max_by(|&a, &b| off[a].total_cmp(&off[b])).filter(|_| bent > 0) {
        all.push(format!(
            "{bent} of {} poses aren't quite rigid; the worst, of {}, has R R^T off the identity by {:.1e}. Rays are bent by as much.",
            frames.len(),
            frames[worst].name,
            off[worst]
        ));
    }
    (each, all)
}

/// The largest entry of R R^T - 1.
fn off_rigid(frame: &Frame) -> f64 {
    let rotation = DMat3::from_mat4(frame.camera.c2w);
    let off = (rotation * rotation.transpose() - DMat3::IDENTITY).to_cols_array();
    off.into_iter().fold(0.0, |most, x| most.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::super::{Options, load};
    use super::*;

    #[test]
    fn turned_axes_and_bent_poses_are_told() {
        let scene = load("builtin:spheres,size=8", &Options::default()).unwrap();
        let frames: Vec<&Frame> = scene.train.iter().collect();
        let (each, all) = doubts(&frames, scene.focus);
        assert!(each.iter().all(Option::is_none) && all.is_empty(), "{all:?}");

        let mut turned = scene.train.clone();
        turned.iter_mut().for_each(|frame| frame.camera.c2w.z_axis = -frame.camera.c2w.z_axis);
        let (each, all) = doubts(&turned.iter().collect::<Vec<_>>(), scene.focus);
        assert!(each.iter().all(Option::is_some) && all.len() == 1, "{all:?}");
        let count = turned.len();
        assert!(all[0].contains(&format!("{count} of {count} cameras look away")), "{}", all[0]);

        let mut bent = scene.train.clone();
        bent[3].camera.c2w.x_axis *= 1.0 + 2e-4;
        let (each, all) = doubts(&bent.iter().collect::<Vec<_>>(), scene.focus);
        assert_eq!(each.iter().flatten().count(), 1);
        // (1 + 2e-4)^2 - 1, times the square of the axis' largest component.
        assert!(all[0].contains("train[3]") && all[0].contains("e-4"), "{}", all[0]);
    }
}
