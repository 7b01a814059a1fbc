//! Large cases: real sizes, the habits of kernels that show there alone, and what is said of them.

mod types;

use ndarray::ArrayD;
use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::arithmetic::{Arithmetic, Grade};
use nerf_oracle::contract::arrays::{Arrays, array, arrays, values};
use nerf_oracle::contract::check::{Kind, tolerance, worst};
use nerf_oracle::contract::laid::Laid;
use nerf_oracle::contract::large::{Large, Made};
use nerf_oracle::contract::{Case, Component, Dtype, Machine};
use nerf_oracle::convention::CS180;
use nerf_oracle::judge::answer::Reply;
use nerf_oracle::judge::answer::given;
use nerf_oracle::judge::exam::Question;
use nerf_oracle::judge::large::{LargeExam, examine_in_process};
use nerf_oracle::judge::{Report, Verdict};
use nerf_oracle::parallel;
use types::{all_types, types};

/// The large cases of all rows in one type.
fn all(dtype: Dtype) -> Vec<(&'static Component, Kind, Laid)> {
    let rows = COMPONENTS.iter().flat_map(|c| [Kind::Forward, Kind::Vjp].map(|kind| (c, kind)));
    let wanted = asked_for().unwrap_or_default();
    let rows = rows.filter(|(c, kind)| c.direction(*kind).is_some() && c.name.contains(&wanted));
    let cases = rows.flat_map(|(c, kind)| (c.special.large)().into_iter().map(move |large| (c, kind, large)));
    let asked = cases.filter(|(_, kind, large)| *kind == Kind::Forward || !large.forward_only);
    let asked: Vec<_> = asked.filter(|(_, _, large)| large.types.contains(&dtype) && quick(large)).collect();
    parallel::map(asked.len(), |n| {
        let (component, kind, large) = asked[n].clone();
        (component, kind, Laid::new(component, kind, large, dtype, &CS180))
    })
}

/// Which rows are looked at in full, by a part of their names; `None`: all of them, but for cases that a build without optimization is
/// too slow for.
fn asked_for() -> Option<String> {
    std::env::var("NERF_ORACLE_LARGE").ok()
}

fn quick(large: &Large) -> bool {
    let entries = |made: &Made| made.shape.iter().product::<usize>();
    let small = large.inputs.iter().map(entries).sum::<usize>() < 1_000_000;
    asked_for().is_some() || small
}

/// Rows whose truth and bounds take three quarters of this program's time.
const SLOW: [&str; 5] = ["conical_frustum", "hash_grid", "integrated_encoding", "mlp", "positional_encoding"];

/// The bound of some items is that of the same items in the whole case, and so is the truth.
#[test]
fn parts_are_judged_like_the_whole() {
    for dtype in [Dtype::F32, Dtype::Bf16] {
        for (component, kind, laid) in all(dtype) {
            let whole = laid.large.items;
            let (from, to) = (whole / 3, (whole / 3 + 5).min(whole));
            if laid.large.block == whole {
                continue;
            }
            let direction = component.direction(kind).unwrap();
            let (part, rest) = (laid.part(from..to), laid.part(from - from.min(2)..(to + 2).min(whole)));
            let judged = |inputs: &Arrays| {
                let bound = tolerance(direction, inputs, &CS180, &Arithmetic::new(dtype, Grade::B));
                ((direction.oracle)(inputs, &CS180), bound)
            };
            let ((truth, bound), (all, bounds)) = (judged(&part.inputs), judged(&rest.inputs));
            for (name, truth) in &truth {
                let Some(span) = laid.span(name, from..to) else { continue };
                let first = laid.shift(name, from - from.min(2));
                let cut = |a: &ndarray::ArrayD<f64>| {
                    a.slice_axis(ndarray::Axis(0), ndarray::Slice::from(span.start - first..span.end - first))
                        .to_owned()
                };
                let row = format!("{} {kind:?} {} {name} {dtype}", component.name, laid.large.id);
                assert_eq!(cut(&all[name]), *truth, "{row}");
                assert_eq!(cut(&bounds[name]), bound[name], "{row}");
            }
            assert_eq!(worst(&truth, &truth, &bound), 0.0);
        }
    }
}

/// What a kernel does with a launch of real size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Habit {
    None,
    /// A scan over so many lanes whose carry doesn't reach the next ones.
    LostCarry(usize),
    /// Samples behind the last whole warp are left out.
    NoTail,
    /// Rays behind the last whole block are left out.
    LastBlock(usize),
    /// Rays are counted in 9 bits.
    ShortIndex,
    /// The order of a sum is that in which threads happen to arrive.
    Race,
}

/// Volume rendering in f32 with a habit.
fn render(a: &Arrays, habit: Habit, call: usize) -> Arrays {
    let (rays, samples) = (a["sigmas"].shape()[0], a["sigmas"].shape()[1]);
    let f32s = |name: &str| values(a, name).into_iter().map(|x| x as f32).collect::<Vec<f32>>();
    let (sigmas, rgbs, deltas) = (f32s("sigmas"), f32s("rgbs"), f32s("deltas"));
    let mut colors = vec![0f32; 3 * rays];
    let (mut weights, mut opacity, mut behind) =
        (vec![0f32; rays * samples], vec![0f32; rays], vec![1f32; rays]);
    let launched = if let Habit::LastBlock(n) = habit { rays / n * n } else { rays };
    for ray in 0..launched {
        let r = if habit == Habit::ShortIndex { ray & 0x1ff } else { ray };
        let done = if habit == Habit::NoTail { samples / 32 * 32 } else { samples };
        let (mut depth, mut through) = (0f32, 1f32);
        let mut order: Vec<usize> = (0..done).collect();
        for &i in &order {
            if matches!(habit, Habit::LostCarry(lanes) if i % lanes == 0) {
                depth = 0.0;
            }
            let x = sigmas[r * samples + i] * deltas[r * samples + i];
            weights[ray * samples + i] = (-depth).exp() * -(-x).exp_m1();
            depth += x;
            through = (-depth).exp();
        }
        if habit == Habit::Race && call % 2 == 1 {
            order.reverse();
        }
        for i in order {
            let w = weights[ray * samples + i];
            (0..3).for_each(|k| colors[3 * ray + k] += w * rgbs[3 * (r * samples + i) + k]);
            opacity[ray] += w;
        }
        behind[ray] = through;
    }
    let wide = |x: Vec<f32>, shape: &[usize]| array(shape, x.into_iter().map(f64::from).collect());
    arrays([
        ("colors", wide(colors, &[rays, 3])),
        ("weights", wide(weights, &[rays, samples])),
        ("opacity", wide(opacity, &[rays])),
        ("transmittance", wide(behind, &[rays])),
    ])
}

/// The report on a function that is asked the large cases of these names alone.
fn report(
    row: &str,
    kind: Kind,
    dtype: Dtype,
    cases: &[&str],
    mut answer: impl FnMut(&Case) -> Arrays,
) -> Report {
    let mut large = LargeExam::of(&[(row, kind)], dtype, None).unwrap();
    large.laid[0].retain(|laid| cases.contains(&laid.large.id));
    large.exam.questions[0].cases.retain(|case| cases.contains(&&case.id[..]));
    let ask =
        |_: &Question, case: &Case| Ok::<_, std::convert::Infallible>(Reply::Answer(given(answer(case))));
    examine_in_process(large, ask).unwrap_or_else(|never| match never {})
}

/// An output in a type, which counts aren't rounded to.
fn rounded(component: &Component, name: String, a: ArrayD<f64>, dtype: Dtype) -> (String, ArrayD<f64>) {
    let a = if component.output_entries(&name).whole() { a } else { a.mapv(|x| dtype.round(x)) };
    (name, a)
}

/// What the formula gives, rounded to a type, passes in every type: each array is proved by some large case.
#[test]
fn right_answers_pass_in_every_type() {
    let types = if asked_for().is_some() {
        &Dtype::ALL[..]
    } else {
        types(&[Dtype::F32], &[Dtype::F32, Dtype::Bf16])
    };
    for &dtype in types {
        let mut rows: Vec<(&str, Kind)> = vec![];
        for (component, kind, laid) in all(dtype) {
            let tried = all_types() || asked_for().is_some() || !SLOW.contains(&component.name);
            if tried && !rows.contains(&(component.name, kind)) && !laid.large.inputs.is_empty() {
                rows.push((component.name, kind));
            }
        }
        // One in four by default; the short type costs as much as f32, and half of it is enough.
        let short = usize::from(dtype == Dtype::Bf16);
        let each = if asked_for().is_some() { 1 } else { (1 + short) * if all_types() { 1 } else { 4 } };
        for (row, kind) in rows.into_iter().step_by(each) {
            let component = COMPONENTS.iter().find(|c| c.name == row).unwrap();
            let cases: Vec<&str> =
                (component.special.large)().iter().filter(|l| quick(l)).map(|l| l.id).collect();
            let (direction, started) = (component.direction(kind).unwrap(), std::time::Instant::now());
            let mut answering = 0.0;
            let report = report(row, kind, dtype, &cases, |case| {
                let asked = std::time::Instant::now();
                let outputs = (direction.oracle)(&case.inputs, &CS180);
                let answer =
                    outputs.into_iter().map(|(name, a)| rounded(component, name, a, dtype)).collect();
                answering += asked.elapsed().as_secs_f64();
                answer
            });
            let (used, judging) = (report.rows[0].budget_used, started.elapsed().as_secs_f64() - answering);
            println!(
                "{row} {kind:?} {dtype}: {} {used:?}, {answering:.1} s to answer, {judging:.1} s to judge",
                report.rows[0].verdict
            );
            assert_eq!(report.rows[0].verdict, Verdict::Pass, "{row} {kind:?} {dtype}: {report}");
        }
    }
}

/// An answer beyond the stable formula's bound is held against the textbook's; the grade says which held.
#[test]
fn either_formula_passes_and_is_graded() {
    let component = COMPONENTS.iter().find(|c| c.name == "volume_render").unwrap();
    for stable in [true, false] {
        let mut machines = (0..192).map(|n| Machine::number(Dtype::F32, n));
        let machine = machines.find(|machine| machine.stable == stable).unwrap();
        let report = report("volume_render", Kind::Forward, Dtype::F32, &["rays_1025x193"], |case| {
            (component.forward.honest)(&case.inputs, &CS180, &machine)
        });
        let row = &report.rows[0];
        let grade = if stable { Grade::A } else { Grade::B };
        assert_eq!((row.verdict, row.grade), (Verdict::Pass, Some(grade)), "{report}");
    }
}

const RAYS: [&str; 3] = ["rays_1025x193", "ray_4097", "ray_200"];

#[test]
fn habits_of_kernels_fail_and_are_told() {
    let judged = |habit: Habit, dtype: Dtype, cases: &[&str]| {
        let mut calls = 0;
        report("volume_render", Kind::Forward, dtype, cases, |case| {
            calls += 1;
            render(&case.inputs, habit, calls)
        })
    };
    let right = judged(Habit::None, Dtype::F32, &RAYS);
    assert_eq!((right.exit_code(), right.rows[0].cases, right.rows[0].answered), (0, 3, 3), "{right}");
    for &lanes in types(&[1024], &[32, 128, 256, 1024]) {
        let report = judged(Habit::LostCarry(lanes), Dtype::F32, &RAYS);
        assert_eq!(report.rows[0].verdict, Verdict::Fail, "{lanes}: {report}");
    }
    // The ray of 200 shows it in every type, whatever the candidate computes in.
    for &dtype in types(&[Dtype::Bf16], &[Dtype::F32, Dtype::Tf32, Dtype::Bf16, Dtype::F16]) {
        for &lanes in types(&[128], &[32, 64, 128]) {
            let report = judged(Habit::LostCarry(lanes), dtype, &["ray_200"]);
            assert_eq!(report.rows[0].verdict, Verdict::Fail, "{dtype} {lanes}: {report}");
        }
        assert_ne!(judged(Habit::None, dtype, &["ray_200"]).rows[0].verdict, Verdict::Fail, "{dtype}");
    }
    let habits = [
        (Habit::LastBlock(256), 1024, "1 of 17"),
        (Habit::ShortIndex, 512, "9 of 17"),
        (Habit::NoTail, 0, "17 of 17"),
    ];
    for &(habit, first, blocks) in if all_types() { &habits[..] } else { &habits[..1] } {
        let report = judged(habit, Dtype::F32, &RAYS[..1]);
        let row = &report.rows[0];
        let told = row.observed.first().cloned().unwrap_or_default();
        assert_eq!(row.verdict, Verdict::Fail, "{habit:?}: {report}");
        println!("{report}");
        if first > 0 {
            assert!(
                told.contains(&format!("number {first} of 1025")) && told.contains(blocks),
                "{habit:?}: {told}"
            );
            // A ray alone is a last block too.
            let alone = if matches!(habit, Habit::LastBlock(_)) {
                "when asked alone"
            } else {
                "asked alone, are right"
            };
            assert!(told.contains(alone), "{habit:?}: {told}");
            assert_eq!(row.worst_case.as_ref().unwrap().id, "rays_1025x193");
            assert!(row.worst_case.as_ref().unwrap().index[0] >= first);
        }
    }
    let race = judged(Habit::Race, Dtype::F32, &RAYS);
    assert!(race.rows[0].findings.iter().any(|said| said.starts_with("not deterministic")), "{race}");
    assert_eq!(race.exit_code(), 0);
}

/// A kernel that counts items in 16 bits leaves the others undone, whatever it computes.
#[test]
fn what_is_left_undone_fails() {
    let mut rows = vec!["contraction", "linear_to_srgb", "ndc_rays", "pose_from_colmap", "trunc_exp"];
    rows.truncate(if all_types() { rows.len() } else { 2 });
    for (row, kind) in rows.into_iter().flat_map(|row| [(row, Kind::Forward), (row, Kind::Vjp)]) {
        let component = COMPONENTS.iter().find(|c| c.name == row).unwrap();
        let cases: Vec<&str> = (component.special.large)().iter().map(|large| large.id).collect();
        let direction = component.direction(kind).unwrap();
        let report = report(row, kind, Dtype::F32, &cases, |case| {
            let mut outputs = (direction.oracle)(&case.inputs, &CS180);
            for output in outputs.values_mut() {
                output.outer_iter_mut().skip(1 << 16).for_each(|mut item| item.fill(0.0));
                output.mapv_inplace(|x| Dtype::F32.round(x));
            }
            outputs
        });
        let told = report.rows[0].observed.first().cloned().unwrap_or_default();
        assert_eq!(report.rows[0].verdict, Verdict::Fail, "{row} {kind:?}: {report}");
        assert!(
            told.contains("number 65536 of") && told.contains("alone, are right"),
            "{row} {kind:?}: {told}"
        );
    }
}
