//! Where cameras, points and box don't fit one another: sentences for people, before they wait for a training.

use glam::DVec3;

use super::{Cloud, Scene};

/// Reprojected points may be off by so many times what the program that found them says, and by so many pixels in any case.
const OFF: (f64, f64) = (1.5, 1.0);

/// What of the points may lie behind cameras that show them; outside of the box; nearer than near or beyond far.
const BEHIND: f64 = 0.01;
const OUTSIDE: f64 = 0.25;

/// All doubts about a scene.
pub(super) fn doubts(scene: &Scene) -> Vec<String> {
    let mut doubts = vec![];
    if let Some((low, high)) = scene.bounds {
        let inside = |p: &DVec3| p.cmpge(low).all() && p.cmple(high).all();
        if !inside(&scene.focus) {
            let [focus, low, high] = [scene.focus, low, high].map(shown);
            doubts.push(format!(
                "The point that the cameras look at, {focus}, is outside of the scene's box, {low} to {high}."
            ));
        }
        if let Some(share) =
            scene.cloud.as_ref().map(|cloud| share(&cloud.points, |p| !inside(p))).filter(|s| *s > OUTSIDE)
        {
            doubts.push(format!("{:.0}% of the points are outside of the scene's box.", 100.0 * share));
        }
    }
    if let Some(cloud) = &scene.cloud {
        doubts.extend(of_cloud(scene, cloud));
    }
    doubts
}

fn of_cloud(scene: &Scene, cloud: &Cloud) -> Vec<String> {
    let mut doubts = vec![];
    let (near, far) = (scene.near, scene.far);
    let beyond = share(&cloud.distances, |t| !(near..=far).contains(t));
    if beyond > OUTSIDE {
        let percent = 100.0 * beyond;
        doubts.push(format!(
            "{percent:.0}% of the points that photographs show are nearer than {near:.3} or farther than {far:.3}, where samples are taken."
        ));
    }
    if let Some(fit) = cloud.reprojection {
        let behind = fit.behind as f64 / fit.sights as f64;
        if behind > BEHIND {
            let percent = 100.0 * behind;
            doubts.push(format!(
                "{percent:.0}% of the points lie behind the cameras whose photographs show them."
            ));
        }
        if fit.pixels > OFF.0 * fit.stated && fit.pixels > OFF.1 {
            doubts.push(format!(
                "Cameras and points don't fit: projected, points are {:.2} pixels off on average, {:.2} as the file says.",
                fit.pixels, fit.stated
            ));
        }
    }
    doubts
}

/// The share of a list that is such.
fn share<T>(list: &[T], is: impl Fn(&T) -> bool) -> f64 {
    list.iter().filter(|x| is(x)).count() as f64 / list.len().max(1) as f64
}

fn shown(p: DVec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", p.x, p.y, p.z)
}
