//! Numbers that broke real libraries: each is a named case, finite in the reference, and within its bound on the fast paths.

use std::collections::BTreeSet;

use nerf_oracle::COMPONENTS;
use nerf_oracle::bench::suites::SUITES;
use nerf_oracle::bench::{Promise, Suite};
use nerf_oracle::contract::arithmetic::{Arithmetic, Dtype, Grade};
use nerf_oracle::contract::arrays::{Arrays, array, scalar, values};
use nerf_oracle::contract::case::Case;
use nerf_oracle::contract::check::{Kind, tolerance, worst};
use nerf_oracle::contract::component::Component;
use nerf_oracle::convention::CS180;
use nerf_oracle::random::{Key, Purpose};
use nerf_oracle::volume_rendering::fast::{Weights, density_gradient};
use pulp::Arch;

/// Hard cases by their numbers, and the components that have them. Not here: PE5, VR8 and CG6 concern components that the crate doesn't
/// have; CG5 (a lens without inverse), ME2 (SSIM) and TR4 (no gradient) are tests of functions that are no rows.
const HARD: &[(&str, &[&str])] = &[
    ("VR1", &["volume_render"]),
    ("VR2", &["volume_render", "early_stop"]),
    ("VR3", &["volume_render"]),
    ("VR4", &["volume_render_alpha"]),
    ("VR5", &["early_stop"]),
    ("VR6", &["trunc_exp"]),
    ("VR7", &["depth"]),
    ("VR9", &["volume_render", "volume_render_alpha", "early_stop"]),
    ("VR10", &["volume_render"]),
    ("SA1", &["importance_sampling"]),
    ("SA2", &["importance_sampling"]),
    ("SA3", &["importance_sampling"]),
    ("SA4", &["sample_along_rays", "step_sizes"]),
    ("PE1", &["positional_encoding"]),
    ("PE2", &["positional_encoding"]),
    ("PE3", &["positional_encoding"]),
    ("PE6", &["hash_grid"]),
    ("PE7", &["spherical_harmonics"]),
    ("CG1", &["ray_aabb"]),
    ("CG2", &["ray_aabb"]),
    ("CG3", &["grid_traversal", "occupancy_grid"]),
    ("CG9", &["transform", "pixel_to_ray", "image_rays", "sample_along_rays", "ray_aabb"]),
    ("TR1", &["mlp", "nerf_mlp"]),
    ("TR3", &["adam_step"]),
    ("ME1", &["mse", "psnr"]),
];

/// Cases whose real-number answer, or whose place in f64, is infinite.
const INFINITE: &[&str] = &["psnr ME1_equal", "trunc_exp VR6_f64"];

fn find(name: &str) -> &'static Component {
    COMPONENTS.iter().find(|c| c.name == name).unwrap_or_else(|| panic!("no component {name}"))
}

#[test]
fn every_hard_case_is_a_named_case() {
    let mut named = BTreeSet::new();
    for (hard, components) in HARD {
        for name in *components {
            let cases = (find(name).cases)();
            let found = cases.iter().filter(|case| case.id.split('_').next() == Some(hard));
            let ids: Vec<String> = found.map(|case| format!("{name} {}", case.id)).collect();
            assert!(!ids.is_empty(), "{name} has no case {hard}");
            named.extend(ids);
        }
    }
    // And none has a number that isn't in the list.
    for component in COMPONENTS {
        for case in
            (component.cases)().iter().filter(|case| case.id.starts_with(|c: char| c.is_ascii_uppercase()))
        {
            let id = format!("{} {}", component.name, case.id);
            assert!(named.contains(&id), "{id} isn't listed");
        }
    }
}

/// Values and gradients are finite in every case, hard or not, where the real numbers are.
#[test]
fn the_reference_is_finite_in_every_case() {
    let mut infinite = BTreeSet::new();
    for component in COMPONENTS {
        for kind in [Kind::Forward, Kind::Vjp] {
            let Some(pass) = component.pass(kind) else { continue };
            for case in component.cases_of(kind, &CS180) {
                let id = format!("{} {}", component.name, case.id);
                for (name, output) in (pass.oracle)(&case.inputs, &CS180) {
                    assert!(!output.iter().any(|y| y.is_nan()), "{id} {kind:?}: {name} holds NaN");
                    if output.iter().any(|y| y.is_infinite()) {
                        infinite.insert(id.clone());
                    }
                }
            }
        }
    }
    assert_eq!(infinite, INFINITE.iter().map(|id| id.to_string()).collect(), "infinite outputs");
}

/// The case as a workload of the suite, whose kernels are written for one shape: none where they can't hold its numbers.
fn workload(suite: &Suite, case: &Case) -> Option<Arrays> {
    let mut inputs = case.inputs.clone();
    match suite.component {
        "volume_render" if inputs["sigmas"].is_empty() => return None,
        // The kernels of `bench` have no weight decay.
        "adam_step" if inputs["weight_decay"] != scalar(0.0) => return None,
        "volume_render" | "adam_step" => {}
        "spherical_harmonics" => {
            inputs.insert("degree".into(), scalar(3.0));
        }
        "positional_encoding" => {
            let mut x = values(&inputs, "x");
            x.resize(x.len().next_multiple_of(3), 0.25);
            inputs = [("x".to_string(), array(&[x.len() / 3, 3], x)), ("L".into(), scalar(10.0))].into();
        }
        "sample_along_rays" => {
            let rays = inputs["u"].shape()[0];
            let u = Key::new(7, Purpose::Cases).uniforms(0, 0, rays * 64);
            let u = u.into_iter().map(|u| f64::from(u as f32).min(0.984375)).collect();
            inputs.insert("u".into(), array(&[rays, 64], u));
        }
        _ => return None,
    }
    Some(inputs)
}

/// Every variant that promises the component's f32 bound keeps it on all cases, not on its own workload alone.
#[test]
fn fast_paths_keep_their_bound_on_hard_numbers() {
    let mut checked = BTreeSet::new();
    for suite in SUITES.iter().filter(|suite| suite.judged) {
        let component = find(suite.component);
        let bound = Arithmetic::new(Dtype::F32, Grade::B);
        for case in component.cases_of(Kind::Forward, &CS180).iter().filter(|case| case.exists_in(Dtype::F32))
        {
            let Some(inputs) = workload(suite, case) else { continue };
            let expected = (component.forward.oracle)(&inputs, &CS180);
            let allowed = tolerance(&component.forward, &inputs, &CS180, &bound);
            for variant in suite.variants.iter().filter(|variant| variant.promise == Promise::f32()) {
                let mut kernel = (variant.prepare)(&inputs);
                kernel.run();
                let used = worst(&kernel.read(), &expected, &allowed);
                let label = format!("{} {} {}", suite.component, variant.name, case.id);
                assert!(used <= 1.0, "{label}: {used} of the bound");
                checked.insert((suite.component, case.id.clone()));
            }
        }
    }
    let hard = |name: &str| {
        checked.iter().filter(|(c, id)| *c == name && id.starts_with(char::is_uppercase)).count()
    };
    for (name, least) in [
        ("volume_render", 6),
        ("positional_encoding", 4),
        ("adam_step", 2),
        ("sample_along_rays", 2),
        ("spherical_harmonics", 1),
    ] {
        assert!(hard(name) >= least, "{name}: {} hard cases", hard(name));
    }
}

/// The densities' gradient of the fast path, on the same numbers: what the reference's bound in f32 allows.
#[test]
fn the_fast_gradient_keeps_its_bound_on_hard_numbers() {
    let component = find("volume_render");
    let pass = component.vjp.expect("a gradient");
    let mut hard = 0;
    for case in component.cases_of(Kind::Forward, &CS180).iter().filter(|case| case.exists_in(Dtype::F32)) {
        let shape = case.inputs["sigmas"].shape().to_vec();
        let (rays, n) = (shape[0], shape[1]);
        if n == 0 {
            continue;
        }
        let mut inputs = case.inputs.clone();
        let g = [1.0, -0.5, 0.75];
        inputs.insert("grad_colors".into(), array(&[rays, 3], g.repeat(rays)));
        inputs.insert("grad_weights".into(), array(&[rays, n], vec![0.0; rays * n]));
        inputs.insert("grad_opacity".into(), array(&[rays], vec![0.0; rays]));
        inputs.insert("grad_transmittance".into(), array(&[rays], vec![0.0; rays]));
        let expected = (pass.oracle)(&inputs, &CS180);
        let allowed = tolerance(&pass, &inputs, &CS180, &Arithmetic::new(Dtype::F32, Grade::B));
        let single = |name| values(&inputs, name).iter().map(|&x| x as f32).collect::<Vec<f32>>();
        let (sigmas, deltas, rgbs) = (single("sigmas"), single("deltas"), single("rgbs"));
        let mut weights = Weights::default();
        weights.compute(Arch::new(), &sigmas, &deltas, n);
        let mut got: Vec<f32> = rgbs.chunks(3).map(|c| c[0] - 0.5 * c[1] + 0.75 * c[2]).collect();
        for r in (0..rays * n).step_by(n) {
            let ray = r..r + n;
            let (w, behind) = (&weights.weights[ray.clone()], &weights.behind[ray.clone()]);
            density_gradient(w, behind, &deltas[ray.clone()], 0.0, &mut got[ray]);
        }
        let got = array(&shape, got.into_iter().map(f64::from).collect());
        let one = |a: &Arrays| Arrays::from([("grad_sigmas".to_string(), a["grad_sigmas"].clone())]);
        let used = worst(&Arrays::from([("grad_sigmas".to_string(), got)]), &one(&expected), &one(&allowed));
        assert!(used <= 1.0, "{}: {used} of the bound", case.id);
        hard += usize::from(case.id.starts_with(char::is_uppercase));
    }
    assert!(hard >= 6, "{hard} hard cases");
}
