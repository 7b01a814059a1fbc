//! Verdicts besides pass and fail: nothing proved, digits lost, other bits every time.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use nerf_oracle::contract::arrays::Arrays;
use nerf_oracle::contract::check::Kind;
use nerf_oracle::contract::{Dtype, Machine};
use nerf_oracle::convention::CS180;
use nerf_oracle::judge::answer::given;
use nerf_oracle::judge::judging::{EXP_ULP, judge_answers};
use nerf_oracle::judge::{Candidate, Exam, Report, Verdict, judge};
use nerf_oracle::ndarray::{ArrayD, Axis};
use nerf_oracle::{COMPONENTS, conical_frustum};

/// A deep network's gradient in bf16: of this case alone nothing shows that it isn't 0.
#[test]
fn right_answers_that_0_would_match_are_unproved() {
    let mut exam = Exam::of(&[("mlp", Kind::Vjp)], Dtype::Bf16, None).unwrap();
    let oracle = exam.questions[0].component.vjp.unwrap().oracle;
    exam.questions[0].cases.retain(|case| case.id == "wide");
    let answers = exam.questions[0].cases.iter().map(|case| Some(given(oracle(&case.inputs, &CS180))));
    let report = judge_answers(&exam, &[answers.collect()], EXP_ULP);
    let row = report.of("mlp", "vjp").unwrap();
    assert_eq!((row.verdict, report.exit_code()), (Verdict::Unproved, 1), "{report}");
    assert!(row.unproved.contains(&"grad_w1".to_string()), "{:?}", row.unproved);
    assert!(!row.unproved.contains(&"grad_b3".to_string()), "{:?}", row.unproved);
    assert_eq!(report.json()["components"][0]["verdict"], "unproved");
    assert_eq!(report.json()["components"][0]["unproved"][0], row.unproved[0].as_str());
    assert!(report.to_string().contains("UNPROVED mlp vjp"), "{report}");
}

/// In f64, all of it computed in f32; and a wrong formula of nearly the same size.
#[test]
fn lost_digits_are_told_apart_from_wrong_formulas() {
    let single = Machine::number(Dtype::F32, 8);
    for name in ["volume_render", "mlp", "pixel_to_ray"] {
        let component = COMPONENTS.iter().find(|component| component.name == name).unwrap();
        let honest = component.forward.honest;
        let candidate = Candidate::new().forward(name, |inputs| honest(inputs, &CS180, &single));
        let report = judge(&candidate, Dtype::F64).unwrap();
        let row = report.of(name, "forward").unwrap();
        assert_eq!((row.verdict, report.exit_code()), (Verdict::Imprecise, 1), "{report}");
        assert_eq!(report.exit_code_allowing(&[Verdict::Imprecise]), 0);
        assert!(row.lost_bits.is_some_and(|bits| (20..=30).contains(&bits)), "{report}");
        assert!(
            report.to_string().contains("computed in it on the way") || row.lost_bits < Some(24),
            "{report}"
        );
    }
    let off = composited(|_, out| out.into_iter().map(|(name, y)| (name, y * 1.0001)).collect());
    assert_eq!(off.of("composite_background", "forward").unwrap().verdict, Verdict::Fail, "{off}");
}

/// The answers of one candidate in f32.
fn in_f32(candidate: &Candidate) -> Report {
    judge(candidate, Dtype::F32).unwrap()
}

/// A factor that is off by so little that lost digits would do it, too, is still what it is; so is an eps that f32 nearly loses.
#[test]
fn what_is_off_by_little_is_named() {
    let off = composited(|_, out| out.into_iter().map(|(name, y)| (name, y * (1.0 + 1e-8))).collect());
    assert_eq!(off.of("composite_background", "forward").unwrap().verdict, Verdict::Fail, "{off}");
    let wrong = COMPONENTS.iter().find(|c| c.name == "volume_render").unwrap().forward.wrong;
    let report = in_f32(&Candidate::new().forward("volume_render", |inputs| {
        let out = wrong(inputs, &CS180, &["eps_in_product=1e-6"]);
        out.into_iter().map(|(name, y)| (name, y.mapv(|y| Dtype::F32.round(y)))).collect()
    }));
    assert_eq!(report.of("volume_render", "forward").unwrap().verdict, Verdict::Fail, "{report}");
    assert!(report.to_string().contains("eps_in_product (eps = 1e-6)"), "{report}");
}

/// The textbook's formula in f32, twists as (rho, w): below angles of 3e-4 1 - cos theta is 0, and V is I.
fn textbook_motion(twist: &[f64]) -> [f64; 16] {
    let [x, y, z, a, b, c] = [0, 1, 2, 3, 4, 5].map(|n| twist[n] as f32);
    let theta = (a * a + b * b + c * c).sqrt();
    let k = [[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]];
    let product = |i: usize, j: usize| (0..3).map(|n| k[i][n] * k[n][j]).sum::<f32>();
    let one = |i: usize, j: usize| f32::from(u8::from(i == j));
    let entry = |i: usize, j: usize, [p, q]: [f32; 2]| {
        if theta == 0.0 { one(i, j) } else { one(i, j) + p * k[i][j] + q * product(i, j) }
    };
    let falls = (1.0 - theta.cos()) / (theta * theta);
    let [of_r, of_v] =
        [[theta.sin() / theta, falls], [falls, (theta - theta.sin()) / (theta * theta * theta)]];
    let rho = [x, y, z];
    std::array::from_fn(|n| match (n / 4, n % 4) {
        (3, column) => f64::from(u8::from(column == 3)),
        (i, 3) => f64::from((0..3).map(|j| entry(i, j, of_v) * rho[j]).sum::<f32>()),
        (i, j) => f64::from(entry(i, j, of_r)),
    })
}

#[test]
fn a_motion_whose_small_angles_cancel_has_lost_digits() {
    let report = in_f32(&Candidate::new().forward("se3_exp", |inputs| {
        let twists = &inputs["twists"];
        let all: Vec<f64> = twists
            .outer_iter()
            .flat_map(|twist| textbook_motion(&twist.to_owned().into_raw_vec_and_offset().0))
            .collect();
        [("motions".to_string(), ArrayD::from_shape_vec(vec![twists.shape()[0], 4, 4], all).unwrap())].into()
    }));
    assert_eq!(report.of("se3_exp", "forward").unwrap().verdict, Verdict::Imprecise, "{report}");
}

/// Equal pictures have no finite PSNR, or one that a small error would have: not any.
#[test]
fn equal_pictures_have_no_psnr_of_ones_own() {
    let oracle = COMPONENTS.iter().find(|c| c.name == "psnr").unwrap().forward.oracle;
    let verdict = |of_equal: f64| {
        let report = in_f32(&Candidate::new().forward("psnr", |inputs| {
            let out = oracle(inputs, &CS180);
            let finite = |y: f64| if y.is_finite() { y } else { of_equal };
            out.into_iter().map(|(name, y)| (name, y.mapv(finite))).collect()
        }));
        report.of("psnr", "forward").unwrap().verdict
    };
    assert_eq!([100.0, 80.0].map(verdict), [Verdict::Pass; 2]);
    assert_eq!([-1.0, 5.0].map(verdict), [Verdict::Edge; 2]);
}

/// The gradient of the loss itself, whatever comes back to it.
#[test]
fn a_cotangent_that_is_forgotten_is_told() {
    let oracle = COMPONENTS.iter().find(|c| c.name == "mse").unwrap().vjp.unwrap().oracle;
    let report = in_f32(&Candidate::new().vjp("mse", |inputs| {
        let mut inputs = inputs.clone();
        inputs.get_mut("grad_value").unwrap().fill(1.0);
        oracle(&inputs, &CS180)
    }));
    assert!(report.to_string().contains("grad_value taken for 1"), "{report}");
}

/// C + (1 - A) b of a candidate that may change its answers.
fn composited(change: impl Fn(&Arrays, Arrays) -> Arrays + Sync) -> Report {
    let oracle = COMPONENTS.iter().find(|c| c.name == "composite_background").unwrap().forward.oracle;
    let candidate = |inputs: &Arrays| change(inputs, oracle(inputs, &CS180));
    judge(&Candidate::new().forward("composite_background", candidate), Dtype::F64).unwrap()
}

#[test]
fn answers_that_change_from_call_to_call_are_told() {
    let calls = AtomicUsize::new(0);
    let noisy = |by: f64| {
        let factor = || 1.0 + if calls.fetch_add(1, Ordering::Relaxed) % 2 == 0 { by } else { 0.0 };
        composited(|_, out| out.into_iter().map(|(name, y)| (name, y.mapv(|y| y * factor()))).collect())
    };
    let row = |report: &Report| report.of("composite_background", "forward").unwrap().clone();
    let (little, much) = (noisy(f64::EPSILON / 2.0), noisy(1e-3));
    assert!(row(&little).findings.is_empty(), "half an ULP is no change: {little}");
    assert_eq!(row(&much).verdict, Verdict::Fail, "{much}");
    assert!(row(&much).faults[0].starts_with("not deterministic"), "{much}");
    assert_eq!(row(&much).faults.iter().filter(|said| said.contains("other bits")).count(), 1, "{much}");
    let little = noisy(f64::EPSILON);
    assert_eq!(row(&little).verdict, Verdict::Pass, "{little}");
    assert!(row(&little).findings[0].starts_with("not deterministic"), "{little}");
    // Rows of the buffer that the last call left behind.
    let last = AtomicUsize::new(0);
    let stale = composited(|inputs, mut out| {
        let rays = inputs["opacity"].len();
        if last.swap(rays, Ordering::Relaxed) > rays {
            out.get_mut("colors_out").unwrap()[[0, 0]] += 0.25;
        }
        out
    });
    assert_eq!(row(&stale).verdict, Verdict::Fail, "{stale}");
    assert!(row(&stale).faults[0].starts_with("stale state"), "{stale}");
    assert!(row(&composited(|_, out| out)).findings.is_empty());
}

/// Kernels that are right about each whole case: one takes its rays from where the first call with as many had them, one forgets the last
/// ray of an odd number but where that number is a case's own.
#[test]
fn rays_that_stand_alone_are_asked_in_another_order_and_in_tiles() {
    let first: Mutex<Vec<Arrays>> = Mutex::default();
    let remembering = composited(|inputs, out| {
        let mut known = first.lock().unwrap();
        let sorted = |x: &Arrays| {
            let mut all: Vec<u64> = x["colors"].iter().map(|x| x.to_bits()).collect();
            all.sort_unstable();
            all
        };
        let same = known.iter().position(|x| sorted(x) == sorted(inputs));
        let Some(n) = same else {
            known.push(inputs.clone());
            return out;
        };
        let oracle = COMPONENTS.iter().find(|c| c.name == "composite_background").unwrap().forward.oracle;
        oracle(&known[n], &CS180)
    });
    let row = |report: &Report| report.of("composite_background", "forward").unwrap().clone();
    assert_eq!(row(&remembering).verdict, Verdict::Fail, "{remembering}");
    assert!(row(&remembering).faults[0].starts_with("depends on the order"), "{remembering}");
    assert!(row(&remembering).diagnosis.is_empty(), "{remembering}");
    let exam = Exam::of(&[("composite_background", Kind::Forward)], Dtype::F64, None).unwrap();
    let whole: Vec<_> = exam.questions[0].cases.iter().map(|case| case.inputs["opacity"].len()).collect();
    let tiled = composited(|inputs, mut out| {
        let rays = inputs["opacity"].len();
        if !whole.contains(&rays) {
            out.get_mut("colors_out").unwrap()[[rays - 1, 0]] += 0.25;
        }
        out
    });
    assert_eq!(row(&tiled).verdict, Verdict::Fail, "{tiled}");
    assert!(row(&tiled).faults[0].starts_with("depends on the tile"), "{tiled}");
    let fixed = composited(|inputs, out| {
        assert!(whole.contains(&inputs["opacity"].len()), "another number of rays");
        out
    });
    assert_eq!((row(&fixed).verdict, row(&fixed).crashed.len()), (Verdict::Pass, 0), "{fixed}");
    assert!(row(&fixed).findings[0].starts_with("refuses a tile of 2 of the"), "{fixed}");
    // Digits lost plainly, wrong in tiles.
    let single = composited(|inputs, out| {
        let worse = if whole.contains(&inputs["opacity"].len()) { 0.0 } else { 0.25 };
        out.into_iter().map(|(name, y)| (name, y.mapv(|y| f64::from(y as f32) + worse))).collect()
    });
    assert_eq!(row(&single).verdict, Verdict::Fail, "{single}");
    assert!(row(&single).faults[0].starts_with("depends on the tile"), "{single}");
}

/// An axis of length one in front: rays are still told apart in another order and in tiles.
#[test]
fn answers_with_another_axis_pass_in_every_order() {
    let batched =
        |out: Arrays| -> Arrays { out.into_iter().map(|(name, y)| (name, y.insert_axis(Axis(0)))).collect() };
    let report = composited(|_, out| batched(out));
    let row = report.of("composite_background", "forward").unwrap();
    assert_eq!((row.verdict, row.layouts.is_empty()), (Verdict::Pass, false), "{report}");
}

/// Explaining a wrong answer moves the inputs by roundings, in bf16 by more than a sample of 64: what is counted stays.
#[test]
fn wrong_answers_of_packed_rays_fail_in_every_type() {
    let scaled = |inputs: &Arrays| -> Arrays {
        let scan = COMPONENTS.iter().find(|c| c.name == "packed_scan").expect("a row");
        let right = (scan.forward.oracle)(inputs, &CS180);
        right.into_iter().map(|(name, y)| (name, y.mapv(|y| 1.5 * y))).collect()
    };
    for dtype in Dtype::ALL {
        let report = judge(&Candidate::new().forward("packed_scan", scaled), dtype).unwrap();
        assert_eq!(report.rows[0].verdict, Verdict::Fail, "{dtype}: {report}");
    }
}

/// What one integrates a cone's moments to, in powers of the ends: noise where an interval is short, which no mistake's name explains.
#[test]
fn a_cone_s_moments_by_powers_of_the_ends_do_not_pass() {
    let kernel = |o: [f64; 3], d: [f64; 3], radius: f64, start: f64, end: f64| {
        let power = |n: i32| end.powi(n) - start.powi(n);
        let t = 3.0 * power(4) / (4.0 * power(3));
        let along = 3.0 / 5.0 * power(5) / power(3) - t * t;
        let across = radius * radius * (3.0 / 20.0 * power(5) / power(3));
        let length: f64 = d.iter().map(|d| d * d).sum();
        let variance = d.map(|d| along * d * d + across * (1.0 - d * d / length));
        (t, along, across, [0, 1, 2].map(|i| o[i] + t * d[i]), variance)
    };
    let report = conical_frustum::judge(kernel).report();
    assert_eq!(report.rows[0].verdict, Verdict::Fail, "{report}");
    assert!(report.rows[0].diagnosis.is_empty(), "{report}");
}
