//! Numbers that broke real libraries: each is a named case, finite in the reference, and within its bound on the fast paths.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use nerf_oracle::COMPONENTS;
use nerf_oracle::bench::suites::SUITES;
use nerf_oracle::bench::{Suite, Tolerance};
use nerf_oracle::contract::arithmetic::{Arithmetic, Dtype, Grade};
use nerf_oracle::contract::arrays::{Arrays, array, scalar, values};
use nerf_oracle::contract::case::Case;
use nerf_oracle::contract::check::{Kind, tolerance, worst};
use nerf_oracle::contract::component::Component;
use nerf_oracle::contract::hazard::HAZARDS;
use nerf_oracle::convention::CS180;
use nerf_oracle::random::{Key, Purpose};
use nerf_oracle::volume_rendering::fast::{RayWeights, density_gradient};
use pulp::Arch;

/// Hazards (explained in `contract/hazard.rs`), and the components that have cases of them.
const HARD: &[(&str, &[&str])] = &[
    ("VR1", &["volume_render"]),
    ("VR2", &["volume_render", "early_stop"]),
    ("VR3", &["volume_render"]),
    ("VR4", &["volume_render_alpha", "packed_scan"]),
    ("VR5", &["early_stop"]),
    ("VR6", &["trunc_exp"]),
    ("VR7", &["depth"]),
    ("VR8", &["distortion_loss"]),
    ("VR9", &["volume_render", "volume_render_alpha", "early_stop"]),
    ("VR10", &["volume_render"]),
    ("VR11", &["distortion_loss"]),
    ("PK1", &["pack_info", "packed_scan", "accumulate_along_rays"]),
    ("SA1", &["importance_sampling", "proposal_pdf", "resample_edges"]),
    ("SA2", &["importance_sampling", "proposal_pdf", "resample_edges"]),
    ("SA3", &["importance_sampling", "proposal_pdf", "resample_edges"]),
    ("SA4", &["sample_along_rays", "step_sizes"]),
    ("PE1", &["positional_encoding"]),
    ("PE2", &["positional_encoding"]),
    ("PE3", &["positional_encoding"]),
    ("PE5", &["conical_frustum"]),
    ("PE6", &["hash_grid"]),
    ("PE7", &["spherical_harmonics"]),
    ("CG1", &["ray_aabb"]),
    ("CG2", &["ray_aabb"]),
    ("CG3", &["grid_traversal", "occupancy_grid"]),
    ("CG6", &["contraction", "contract_gaussians"]),
    ("CG7", &["contraction", "contract_gaussians"]),
    ("CG8", &["contraction", "contract_gaussians"]),
    (
        "CG9",
        &[
            "contraction",
            "contract_gaussians",
            "pose_from_colmap",
            "ndc_rays",
            "transform",
            "pixel_to_ray",
            "image_rays",
            "sample_along_rays",
            "ray_aabb",
        ],
    ),
    ("CG10", &["ndc_rays"]),
    ("CG11", &["so3_exp", "se3_exp"]),
    ("GS1", &["gaussian_covariance"]),
    ("GS2", &["gaussian_covariance", "gaussian_projection", "gaussian_alpha"]),
    ("GS3", &["gaussian_projection"]),
    ("GS4", &["gaussian_projection"]),
    ("GS5", &["gaussian_alpha"]),
    ("GS6", &["gaussian_color"]),
    ("LE1", &["lens_distort", "lens_undistort", "fisheye_distort", "fisheye_undistort"]),
    ("LE2", &["lens_distort", "lens_undistort", "fisheye_distort", "fisheye_undistort"]),
    ("LE3", &["lens_undistort", "fisheye_undistort"]),
    ("TR1", &["mlp", "nerf_mlp"]),
    ("TR3", &["adam_step", "adamw_step"]),
    ("ME1", &["mse", "psnr"]),
    ("ME2", &["ssim"]),
];

/// Hazards of functions that are no rows: the files of the tests that are named after them.
const OF_FUNCTIONS: &[(&str, &str)] = &[("CG5", "src/lens/tests.rs")];

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
    // And no case has a hazard that isn't in the list, or an id that looks like one and isn't in the glossary.
    for component in COMPONENTS {
        for case in
            (component.cases)().iter().filter(|case| case.id.starts_with(|c: char| c.is_ascii_uppercase()))
        {
            let id = format!("{} {}", component.name, case.id);
            assert!(named.contains(&id), "{id}: add its hazard and component to HARD in tests/hard_cases.rs");
        }
    }
}

/// The glossary explains every hazard that a case has, and no others.
#[test]
fn the_glossary_has_the_hazards_of_the_cases() {
    let used: BTreeSet<&str> = HARD.iter().map(|(id, _)| *id).collect();
    let tested: BTreeSet<&str> = OF_FUNCTIONS.iter().map(|(id, _)| *id).collect();
    for (id, file) in OF_FUNCTIONS {
        let tests = fs::read_to_string(root().join(file)).expect("a readable file");
        assert!(tests.contains(&format!("fn {}_", id.to_lowercase())), "{file} has no test of {id}");
    }
    let explained: Vec<&str> = HAZARDS.iter().map(|hazard| hazard.id).collect();
    assert_eq!(explained.len(), used.len() + tested.len(), "each is explained once: {explained:?}");
    assert_eq!(explained.into_iter().collect::<BTreeSet<_>>(), &used | &tested);
}

/// Whoever reads an id in a comment, a fixture or a page finds it in the glossary.
#[test]
fn every_hazard_that_is_named_is_in_the_glossary() {
    let mut files = vec![root().join("README.md"), root().join("CHANGELOG.md")];
    for folder in ["src", "tests", "tools", "benches", "fixtures"] {
        files_below(&root().join(folder), &mut files);
    }
    let (mut found, mut unknown) = (0, vec![]);
    for file in files {
        let text = fs::read_to_string(&file).expect("readable text");
        for word in text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| looks_like_a_hazard(word))
        {
            found += 1;
            if !HAZARDS.iter().any(|hazard| hazard.id == word) {
                unknown.push(format!("{}: {word}", file.display()));
            }
        }
    }
    assert!(found > 200, "{found} hazards are named: were the files found?");
    assert!(unknown.is_empty(), "not in src/contract/hazard.rs: {unknown:#?}");
}

/// The letters of a kind of hazard, and a number.
fn looks_like_a_hazard(word: &str) -> bool {
    let kinds = ["VR", "SA", "PE", "CG", "TR", "ME"];
    let number = |rest: &str| !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit());
    kinds.iter().any(|kind| word.strip_prefix(kind).is_some_and(number))
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Sources, scripts, pages and the notes of fixtures.
fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() && !path.ends_with("target") {
            files_below(&path, files);
        } else if path
            .extension()
            .is_some_and(|e| ["rs", "py", "md", "json", "c"].iter().any(|known| e == *known))
        {
            files.push(path);
        }
    }
}

/// Values and gradients are finite in every case, hard or not, where the real numbers are.
#[test]
fn the_reference_is_finite_in_every_case() {
    let mut infinite = BTreeSet::new();
    for component in COMPONENTS {
        for kind in [Kind::Forward, Kind::Vjp] {
            let Some(direction) = component.direction(kind) else { continue };
            for case in component.cases_of(kind, &CS180) {
                let id = format!("{} {}", component.name, case.id);
                for (name, output) in (direction.oracle)(&case.inputs, &CS180) {
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

/// The case as a workload of the suite, whose kernels are written for one shape: `None` where they can't represent its numbers.
fn workload(suite: &Suite, case: &Case) -> Option<Arrays> {
    let mut inputs = Arrays::clone(&case.inputs);
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

/// Every variant that states the component's f32 bound keeps it on all cases, not on its own workload alone.
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
            for variant in suite.variants.iter().filter(|variant| variant.tolerance == Tolerance::f32()) {
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
    let direction = component.vjp.expect("a gradient");
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
        let expected = (direction.oracle)(&inputs, &CS180);
        let allowed = tolerance(&direction, &inputs, &CS180, &Arithmetic::new(Dtype::F32, Grade::B));
        let single = |name| values(&inputs, name).iter().map(|&x| x as f32).collect::<Vec<f32>>();
        let (sigmas, deltas, rgbs) = (single("sigmas"), single("deltas"), single("rgbs"));
        let mut weights = RayWeights::default();
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
