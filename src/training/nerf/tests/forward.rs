//! Normalized device coordinates: for which scenes they are chosen, and that a model in them is one field on all paths.

use glam::{DMat4, DVec2, DVec3};

use super::*;
use crate::camera::Lens;
use crate::convention::ProductEps;
use crate::training::nerf::forward::cube;
use crate::training::nerf::skipping::Skip;
use crate::volume_rendering::volume_render;

/// Cameras all around, small pictures.
fn around() -> Scene {
    scene::load("builtin:spheres,size=16,views=9", &scene::Options::default()).unwrap()
}

/// The built-in scene's pictures with cameras in a row, all of which look along z; one may be turned about y.
fn forward_scene(turned: f64) -> Scene {
    let mut scene = around();
    // Pictures whose borders aren't background.
    scene.background = [0.125, 0.5, 0.75];
    for (n, frame) in scene.train.iter_mut().enumerate() {
        let place = DMat4::from_translation(DVec3::new(0.1 * (n % 4) as f64, -0.05 * (n % 3) as f64, 0.0));
        let turn = if n == 0 { turned } else { 0.0 };
        frame.camera.c2w = place * DMat4::from_rotation_y(turn);
    }
    scene
}

fn in_cube(fine: usize, reference: bool, skip: Option<Skip>, scene: &Scene) -> NerfSettings {
    let mut settings = NerfSettings { skip, ..settings(fine, reference) };
    settings.choose_space(scene);
    assert!(settings.cube.is_some(), "{}", settings.space_reason);
    settings
}

fn rays(scene: &Scene) -> Vec<Ray> {
    let camera = &scene.train[1].camera;
    let at = |i: usize| DVec2::new(1.25 * i as f64 + 0.5, 1.25 * i as f64 + 1.25);
    (0..12).map(|i| camera_ray(camera, at(i)).unwrap()).collect()
}

#[test]
fn chosen_where_all_rays_go_one_way() {
    let mut chosen = settings(0, false);
    chosen.choose_space(&around());
    assert!(chosen.cube.is_none() && !chosen.space_reason.is_empty(), "cameras all around");
    chosen.choose_space(&forward_scene(0.0));
    assert!(chosen.cube.is_some(), "{}", chosen.space_reason);
    chosen.choose_space(&Scene { background: around().background, ..forward_scene(0.0) });
    assert!(chosen.cube.is_none(), "an object before a background");
    // A camera that looks aside is left to whoever asks for the cube; one that looks back makes it impossible.
    for (turned, possible) in [(0.9, true), (1.8, false)] {
        let scene = forward_scene(turned);
        let mut aside = settings(0, false);
        aside.choose_space(&scene);
        assert!(aside.cube.is_none(), "{turned}");
        assert_eq!(cube(&scene).is_ok(), possible, "{turned}: {:?}", cube(&scene));
    }
}

/// A picture that is larger than its fisheye's circle has no rays at its corners, by which nothing could be known of the others.
#[test]
fn lenses_without_corners_have_no_cube() {
    let mut scene = forward_scene(0.0);
    for frame in &mut scene.train {
        frame.camera.distortion = Some(Lens::Fisheye([0.0; 4]));
        (frame.camera.k.fx, frame.camera.k.fy) = (5.0, 5.0);
    }
    assert!(cube(&scene).unwrap_err().contains("corners"));
}

/// What is `near` away from any camera, in any direction, lies in front of the near plane, and the nearest of it on the plane.
#[test]
fn the_near_plane_is_before_all_that_is_seen() {
    let scene = forward_scene(0.0);
    let (cube, _) = cube(&scene).unwrap();
    let mut least = f64::INFINITY;
    for frame in &scene.train {
        let (w, h) = (frame.camera.width as f64, frame.camera.height as f64);
        for (i, j) in [(0.5, 0.5), (w - 0.5, 0.5), (0.5, h - 0.5), (w - 0.5, h - 0.5), (0.5 * w, 0.5 * h)] {
            let ray = camera_ray(&frame.camera, DVec2::new(i, j)).unwrap();
            assert!(cube.holds(&ray, scene.near + 1e-12) && cube.faces(&ray));
            least = least.min(cube.w2c.transform_point3(ray.at(scene.near)).z);
        }
    }
    assert!((least - cube.view.near).abs() < 1e-12, "{least} {}", cube.view.near);
}

/// A step, and pictures, in f32 and in f64; with the second network's samples too.
#[test]
fn fast_path_and_reference_agree_in_the_cube() {
    let scene = forward_scene(0.0);
    for fine in [0, 12] {
        let (fast, a) = trained(in_cube(fine, false, None, &scene), &scene, 2);
        let (oracle, b) = trained(in_cube(fine, true, None, &scene), &scene, 2);
        assert!((a.loss - b.loss).abs() < 1e-5 * b.loss, "{} {}", a.loss, b.loss);
        let rays = rays(&scene);
        for (x, y) in fast.render(&rays).iter().zip(oracle.render(&rays)) {
            assert!((0..3).all(|k| (x.rgb[k] - y.rgb[k]).abs() < 2e-4), "{x:?} {y:?}");
        }
    }
}

/// Probed densities are those of the world: integrated over distances, they give what the model renders in its cube.
#[test]
fn what_is_probed_is_what_is_rendered() {
    let scene = forward_scene(0.0);
    let mut settings = in_cube(0, false, None, &scene);
    settings.samples = 2048;
    let (model, _) = trained(NerfSettings { rays: 4, ..settings }, &scene, 1);
    let (cube, rays) = (settings.cube.unwrap(), rays(&scene));
    // The way to a thousand near planes, in steps that grow with the distance.
    let edges = |ray: &Ray| -> Vec<f64> {
        (0..=4000).map(|i| cube.distance(ray, 1.0 - 1000f64.powf(-f64::from(i) / 4000.0))).collect()
    };
    let middles = |edges: &[f64]| edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect::<Vec<_>>();
    let asked: Vec<(Ray, Vec<f64>)> = rays.iter().map(|ray| (*ray, middles(&edges(ray)))).collect();
    let mut met = false;
    for ((pixel, probes), ray) in model.render(&rays).iter().zip(model.probe(&asked)).zip(&rays) {
        let (sigmas, rgbs): (Vec<f64>, Vec<[f64; 3]>) = probes.iter().map(|p| (p.density, p.rgb)).unzip();
        let deltas: Vec<f64> = edges(ray).windows(2).map(|e| e[1] - e[0]).collect();
        let seen = volume_render(&sigmas, &rgbs, &deltas, ProductEps::None);
        met |= seen.opacity > 0.02;
        assert!((seen.opacity - f64::from(pixel.opacity)).abs() < 4e-3, "{} {pixel:?}", seen.opacity);
        (0..3).for_each(|k| assert!((seen.color[k] - f64::from(pixel.rgb[k])).abs() < 4e-3, "{pixel:?}"));
    }
    assert!(met, "empty rays agree with anything");
    let before: Vec<f64> = vec![0.5 * cube.distance(&rays[0], 0.0)];
    assert_eq!(model.probe(&[(rays[0], before)])[0][0].density, 0.0, "nothing before the near plane");
}

/// Rays across and backward see nothing, wherever they stand among others.
#[test]
fn rays_that_have_no_place_are_empty() {
    let scene = forward_scene(0.0);
    let (model, _) = trained(in_cube(0, false, None, &scene), &scene, 1);
    let seen = rays(&scene);
    let back = Ray { o: seen[0].o, d: -seen[0].d };
    let across = Ray { o: seen[0].o, d: DVec3::X };
    let mixed = model.render(&[seen[0], back, seen[1], across, seen[2]]);
    let alone = model.render(&seen[..3]);
    assert_eq!([mixed[0], mixed[2], mixed[4]], [alone[0], alone[1], alone[2]]);
    for n in [1, 3] {
        assert_eq!((mixed[n].rgb, mixed[n].opacity, mixed[n].depth), ([0.0; 3], 0.0, 6.0));
    }
}

/// The occupancy grid's cells are the cube's, and leave out nothing that is seen.
#[test]
fn a_grid_over_the_cube() {
    let scene = forward_scene(0.0);
    let skip = Skip { after: 1, every: 8, resolution: 32 };
    let (model, report) = trained(in_cube(0, false, Some(skip), &scene), &scene, 3);
    let grid = model.grid.as_ref().unwrap();
    let corners = grid.corners();
    assert!((corners[2] + 1.0).abs() < 1e-9 && (corners[5] - 1.0).abs() < 1e-9, "{corners:?}");
    assert!(report.samples > 0 && model.cells().is_none());
    let (seen, places) = (rays(&scene), (0..8).map(|i| (f64::from(i) + 0.5) / 8.0).collect::<Vec<_>>());
    let [origins, directions] = [|ray: &Ray| ray.o, |ray: &Ray| ray.d]
        .map(|of| seen.iter().flat_map(|ray| of(ray).to_array()).collect::<Vec<f64>>());
    let samples = model.coarse_samples(places.repeat(seen.len()), &origins, &directions);
    let rays = samples.rays(&origins, &directions);
    let positions: Vec<f64> = (0..8 * seen.len()).flat_map(|n| rays.position(n)).collect();
    let (live, densities) = (grid.mask(&rays), model.coarse.densities(&positions));
    // A cell was looked at in a few points; what it has elsewhere is hardly more.
    let most = densities.iter().zip(&live).filter(|(_, live)| !**live).map(|(sigma, _)| sigma / 32.0);
    assert!(most.fold(0.0, f32::max) < 0.02, "{densities:?} {live:?}");
    assert!(live.contains(&true) && live.contains(&false));
}
