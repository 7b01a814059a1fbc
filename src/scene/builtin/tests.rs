use approx::assert_relative_eq;

use super::*;

/// Rays toward the scene from all sides, some of which miss it.
fn rays() -> Vec<Ray> {
    let mut rays = Vec::new();
    for i in 0..40 {
        let a = 2.4 * f64::from(i);
        let away = DVec3::new(a.cos(), a.sin(), 0.05 * f64::from(i) - 1.0).normalize();
        let target = DVec3::new((3.0 * a).sin(), (5.0 * a).cos(), (7.0 * a).sin()) * 0.5;
        let o = away * 4.0;
        rays.push(Ray { o, d: (target - o).normalize() });
    }
    rays
}

#[test]
fn light_through_each_scene_is_the_closed_form_s() {
    // The midpoint rule with N samples is off by about L^3 / (24 N^2) sigma'': the tolerance is that at N = 20,000.
    for (name, tolerance) in [("slab", 1e-13), ("blob", 1e-7), ("spheres", 1e-7)] {
        let medium = Medium::named(name).unwrap();
        let mut hit = 0;
        for ray in rays() {
            let seen = render(&medium, &ray, 2.0, 6.0, 20_000);
            let exact = exp(-medium.optical_depth(&ray, 2.0, 6.0));
            assert_relative_eq!(*seen.transmittance.last().unwrap(), exact, epsilon = tolerance);
            hit += usize::from(exact < 0.9);
        }
        assert!(hit >= 8, "{name}: {hit} rays meet it");
    }
}

#[test]
fn a_slab_through_its_middle_is_one_minus_e_to_the_minus_sigma_l() {
    let slab = Medium::named("slab").unwrap();
    let ray = Ray { o: DVec3::new(0.1, 0.2, 4.0), d: -DVec3::Z };
    let seen = render(&slab, &ray, 2.0, 6.0, 64);
    assert_relative_eq!(seen.opacity, -crate::math::expm1(-2.0 * 0.6), max_relative = 64.0 * f64::EPSILON);
}

#[test]
fn a_blob_through_its_center_is_a_full_gaussian() {
    let blob = Medium::named("blob").unwrap();
    let ray = Ray { o: DVec3::new(0.0, 4.0, 0.0), d: -DVec3::Y };
    // density s sqrt(2 pi), cut at two units, which is eight deviations.
    let full = 8.0 * 0.25 * std::f64::consts::TAU.sqrt();
    assert_relative_eq!(blob.optical_depth(&ray, 2.0, 6.0), full, max_relative = 1e-14);
    assert_relative_eq!(blob.optical_depth(&ray, 2.0, 4.0), full / 2.0, max_relative = 1e-14);
}

#[test]
fn a_soft_sphere_through_its_center_is_sixteen_fifteenths_of_radius_times_density() {
    let color = [0.5; 3];
    let ball = Body::SoftSphere { center: DVec3::ZERO, radius: 0.5, density: 3.0, color };
    let ray = Ray { o: DVec3::new(-4.0, 0.0, 0.0), d: DVec3::X };
    assert_relative_eq!(ball.optical_depth(&ray, 0.0, 8.0), 16.0 / 15.0 * 0.5 * 3.0, max_relative = 1e-14);
    assert_relative_eq!(ball.optical_depth(&ray, 4.0, 8.0), 8.0 / 15.0 * 0.5 * 3.0, max_relative = 1e-14);
}

#[test]
fn colors_stay_in_range_and_highlights_move_with_the_eye() {
    let spheres = Medium::named("spheres").unwrap();
    let mut moved: f64 = 0.0;
    for ray in rays() {
        for i in 0..50 {
            let x = ray.at(2.5 + 0.06 * f64::from(i));
            let (a, b) = (spheres.color(x, ray.d), spheres.color(x, -ray.d));
            for k in 0..3 {
                assert!((0.0..=1.0).contains(&a[k]), "{a:?} at {x}");
                moved = moved.max((a[k] - b[k]).abs());
            }
        }
    }
    assert!(moved > 0.2, "the largest change between opposite views is {moved}");
}

#[test]
fn a_loaded_scene_shows_its_object_from_every_side() {
    for name in NAMES {
        let scene = crate::scene::load(&format!("builtin:{name}"), &Default::default()).unwrap();
        assert_eq!((scene.train.len(), scene.val.len(), scene.near, scene.far), (24, 4, 2.0, 6.0));
        assert!(scene.focus.length() < 1e-12, "the cameras look at the origin");
        for frame in scene.train.iter().chain(&scene.val) {
            let image = frame.image.as_ref().unwrap();
            let lit = image.colors().flatten().filter(|&c| c > 0.1).count() as f64 / (3 * image.len()) as f64;
            assert!((0.05..0.9).contains(&lit), "{name}, {}: {lit} of it is lit", frame.name);
        }
    }
}
