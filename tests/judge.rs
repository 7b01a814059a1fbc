//! The judge against right, wrong and hostile candidates. The first test is the example to copy.

mod types;

use ndarray::ArrayD;
use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::arrays::{Arrays, array, arrays, input};
use nerf_oracle::contract::check::Kind;
use nerf_oracle::contract::{Dtype, Grade, Machine};
use nerf_oracle::convention::profiles::PROFILES;
use nerf_oracle::convention::{CS180, Conventions};
use nerf_oracle::judge::answer::{Answer, Answers, Given, given};
use nerf_oracle::judge::judging::{EXP_ULP, judge_answers};
use nerf_oracle::judge::mark::{MarkOptions, mark};
use nerf_oracle::judge::{Candidate, Exam, Report, Verdict, judge, statistics};
use types::types;

/// A typical implementation of volume rendering in f32: a running product, the textbook's alpha.
fn my_volume_render(inputs: &Arrays) -> Arrays {
    let (sigmas, rgbs, deltas) = (input(inputs, "sigmas"), input(inputs, "rgbs"), input(inputs, "deltas"));
    let (rays, samples) = (sigmas.shape()[0], sigmas.shape()[1]);
    let (mut colors, mut weights) = (vec![0.0; rays * 3], vec![]);
    for r in 0..rays {
        let mut transmittance = 1.0_f32;
        for i in 0..samples {
            let alpha = 1.0 - (-(sigmas[[r, i]] as f32) * deltas[[r, i]] as f32).exp();
            let weight = transmittance * alpha;
            for k in 0..3 {
                colors[3 * r + k] += weight * rgbs[[r, i, k]] as f32;
            }
            transmittance *= 1.0 - alpha;
            weights.push(f64::from(weight));
        }
    }
    let colors = colors.into_iter().map(f64::from).collect();
    arrays([("colors", array(&[rays, 3], colors)), ("weights", array(&[rays, samples], weights))])
}

#[test]
fn an_example_to_copy() {
    let report = judge(&Candidate::new().forward("volume_render", my_volume_render), Dtype::F32).unwrap();
    println!("{report}");
    let row = report.of("volume_render", "forward").unwrap();
    assert_eq!(row.verdict, Verdict::Pass);
    // The textbook's 1 - exp(-x) is right, but not as sharp as -expm1(-x): grade B.
    assert_eq!(format!("{:?}", row.grade), "Some(B)");
    assert_eq!(row.missing_outputs, ["opacity", "transmittance"]);
    // Case by case: thick samples have the stable formula's digits.
    let of = |grade: Grade| row.grades.values().filter(|g| **g == grade).count();
    assert!(of(Grade::A) > 0 && of(Grade::B) > 0, "{:?}", row.grades);
    assert!(row.over_honest().is_some_and(|times| 0.1 < times && times < 10.0), "{:?}", row.over_honest());
}

/// The best honest form is once itself, and no machine is better than the best of four.
#[test]
fn errors_are_told_in_those_of_the_best_honest_form() {
    let exam = Exam::new("volume_render", Dtype::F32, Some(&PROFILES[0])).unwrap();
    let over = [8, 10, 12, 14].map(|n| {
        let machine = Machine::number(Dtype::F32, n);
        let answers = answer_all(&exam, |n, inputs| {
            let question = &exam.questions[n];
            (question.component.direction(question.kind).unwrap().honest)(inputs, &CS180, &machine)
        });
        let report = judge_answers(&exam, &answers, EXP_ULP);
        let row = report.of("volume_render", "forward").unwrap();
        assert!(row.grades.values().all(|grade| *grade == Grade::A), "{:?}", row.grades);
        row.over_honest().unwrap()
    });
    assert!(over.iter().all(|times| *times >= 1.0) && over.contains(&1.0), "{over:?}");
}

/// Answers to all of an exam by a function of (component, kind, inputs).
fn answer_all(exam: &Exam, f: impl Fn(usize, &Arrays) -> Arrays) -> Vec<Answers> {
    let question =
        |n: usize| exam.questions[n].cases.iter().map(|case| Some(given(f(n, &case.inputs)))).collect();
    (0..exam.questions.len()).map(question).collect()
}

fn failures(report: &Report) -> Vec<String> {
    let failed = report.rows.iter().filter(|row| row.verdict != Verdict::Pass);
    failed.map(|row| format!("{} {} {:?} {:?}", row.name, row.kind, row.budget_used, row.faults)).collect()
}

#[test]
fn right_implementations_pass_in_every_dtype() {
    for &dtype in types(&[Dtype::F64, Dtype::Bf16], &Dtype::ALL) {
        let exam = Exam::new("", dtype, None).unwrap();
        for &n in types(&[13], &[0, 13]) {
            let machine = Machine::number(dtype, n);
            let answers = answer_all(&exam, |n, inputs| {
                let question = &exam.questions[n];
                (question.component.direction(question.kind).unwrap().honest)(inputs, &CS180, &machine)
            });
            let report = judge_answers(&exam, &answers, EXP_ULP);
            assert_eq!(failures(&report), [""; 0], "{dtype} {machine:?}");
            assert_eq!(report.exit_code(), 0);
        }
    }
}

#[test]
fn other_conventions_pass_without_a_profile_and_fail_with_another() {
    for profile in PROFILES.iter().step_by(types(&[2], &[1])[0]) {
        let exam = Exam::new("", Dtype::F64, None).unwrap();
        let right = |n: usize, inputs: &Arrays| {
            let question = &exam.questions[n];
            (question.component.direction(question.kind).unwrap().oracle)(inputs, &profile.conventions)
        };
        // A gradient's cotangent has the default's shape: where a profile changes a shape, its VJP needs --profile.
        let fits = |n: usize| {
            let question = &exam.questions[n];
            if !question.admits(&profile.conventions) {
                return false;
            }
            let shapes = |c| {
                question
                    .cases
                    .iter()
                    .map(|case| {
                        (question.component.forward.oracle)(&case.inputs, c)
                            .into_values()
                            .map(|a| a.shape().to_vec())
                            .collect::<Vec<_>>()
                    })
                    .collect::<Vec<_>>()
            };
            question.kind == Kind::Forward || shapes(&CS180) == shapes(&profile.conventions)
        };
        let mut answers: Vec<Answers> =
            exam.questions.iter().map(|question| vec![None; question.cases.len()]).collect();
        for n in (0..exam.questions.len()).filter(|&n| fits(n)) {
            answers[n] =
                exam.questions[n].cases.iter().map(|case| Some(given(right(n, &case.inputs)))).collect();
        }
        let report = judge_answers(&exam, &answers, EXP_ULP);
        let wrong = report.count(Verdict::Fail) + report.count(Verdict::Unproved);
        assert_eq!(wrong, 0, "{}: {:?}", profile.name, failures(&report));
        println!("{} found as: {}", profile.name, report.profile);
        // Two profiles may agree on all that the components depend on: the assignment counts.
        let differs = report.assignment.iter().find(|(key, value)| profile.conventions.get(key) != **value);
        assert_eq!(differs, None, "{}", profile.name);
    }
}

/// Without the identity an encoding is narrower, and so is its cotangent: questions in the default's shape can't be judged.
#[test]
fn a_gradient_asked_in_the_shapes_of_other_conventions_is_not_judged_and_says_so() {
    let c = CS180.with("identity", "false").unwrap();
    let exam = Exam::new("positional_encoding", Dtype::F64, None).unwrap();
    let answers = answer_all(&exam, |n, inputs| match exam.questions[n].kind {
        Kind::Forward => (exam.questions[n].component.forward.oracle)(inputs, &c),
        Kind::Vjp => arrays([("grad_x", inputs["x"].clone())]),
    });
    let report = judge_answers(&exam, &answers, EXP_ULP);
    assert_eq!(report.of("positional_encoding", "forward").unwrap().verdict, Verdict::Pass);
    let row = report.of("positional_encoding", "vjp").unwrap();
    assert_eq!(row.verdict, Verdict::Unproved);
    assert!(row.faults[0].contains("asked in the shapes of cs180"), "{:?}", row.faults);
}

/// A skip into another layer needs weights of other shapes: the search for conventions leaves it out.
#[test]
fn conventions_that_the_cases_do_not_fit_are_not_tried() {
    let component = COMPONENTS.iter().find(|component| component.name == "training_step").unwrap();
    let wrong = |inputs: &Arrays| (component.forward.wrong)(inputs, &CS180, &["gradients_accumulate"]);
    let report = alone("training_step", Dtype::F32, |inputs| given(wrong(inputs)));
    let row = report.of("training_step", "forward").unwrap();
    let names: Vec<_> =
        row.diagnosis.iter().take(1).flat_map(|e| e.mistakes.iter().map(|m| m.name)).collect();
    assert_eq!((row.verdict, names), (Verdict::Fail, vec!["gradients_accumulate"]), "{report}");
}

#[test]
fn nothing_easy_passes() {
    for dtype in Dtype::ALL {
        let exam = Exam::new("", dtype, None).unwrap();
        let oracle = |n: usize, inputs: &Arrays| {
            let question = &exam.questions[n];
            (question.component.direction(question.kind).unwrap().oracle)(inputs, &CS180)
        };
        let fill = |x: f64| {
            answer_all(&exam, |n, i| oracle(n, i).into_iter().map(|(k, a)| (k, a.mapv(|_| x))).collect())
        };
        let mut easiest = answer_all(&exam, oracle);
        easiest.iter_mut().for_each(|question| question.iter_mut().skip(1).for_each(|answer| *answer = None));
        let options = MarkOptions { dtype, exp_ulp: EXP_ULP };
        for (name, answers) in [("zero", fill(0.0)), ("NaN", fill(f64::NAN)), ("easiest", easiest)] {
            for (question, answers) in exam.questions.iter().zip(&answers) {
                let whole = name == "easiest" && question.cases.len() == 1;
                let passes = |grade| mark(question, answers, &CS180, &options, grade).pass();
                let passed = if question.statistics() {
                    statistics::mark(question, answers, &CS180).pass()
                } else {
                    passes(Grade::B)
                };
                assert!(
                    whole || !passed,
                    "{dtype} {name}: {} {} passes",
                    question.component.name,
                    question.kind_name()
                );
            }
        }
    }
}

#[test]
fn the_answers_themselves_are_checked() {
    let exam = Exam::new("composite_background", Dtype::F64, None).unwrap();
    let question = exam.questions.iter().position(|s| s.component.name == "composite_background").unwrap();
    let right = |n: usize, inputs: &Arrays| {
        let question = &exam.questions[n];
        (question.component.direction(question.kind).unwrap().oracle)(inputs, &CS180)
    };
    let with = |change: &dyn Fn(&mut Given)| {
        let mut answers = answer_all(&exam, right);
        change(answers[question][0].as_mut().unwrap().get_mut("colors_out").unwrap());
        let report = judge_answers(&exam, &answers, EXP_ULP);
        let row = report.of("composite_background", "forward").unwrap().clone();
        assert_eq!(row.verdict, Verdict::Fail);
        row.faults.join("; ")
    };
    assert!(with(&|a| a.dtype = "f32").contains("too narrow"));
    assert!(with(&|a| a.values[[0, 0]] = f64::NAN).contains("NaN"));
    assert!(with(&|a| a.values = ndarray::ArrayD::zeros(ndarray::IxDyn(&[7]))).contains("wrong shape"));
    assert!(
        with(&|a| a.values = a.values.clone().reversed_axes()).is_empty(),
        "3 rays of 3 channels, transposed: other numbers"
    );
    let first_ray =
        |a: &mut Given| a.values = a.values.clone().slice_axis(ndarray::Axis(0), (..1).into()).to_owned();
    assert!(with(&first_ray).contains("wrong shape"));
    let nothing: Vec<Answers> =
        exam.questions.iter().map(|question| vec![None; question.cases.len()]).collect();
    assert_eq!(judge_answers(&exam, &nothing, EXP_ULP).exit_code(), 2);
    assert!(judge(&Candidate::new().forward("no_such_thing", Clone::clone), Dtype::F64).is_err());
    assert!(!COMPONENTS.is_empty());
}

/// Right answers in `c` to one component's forward cases, changed by `change`; the report on them alone.
fn laid_out(component: &str, c: &Conventions, change: impl Fn(&mut Answer)) -> Report {
    let exam = Exam::new(component, Dtype::F64, None).unwrap();
    let forward =
        |n: usize| exam.questions[n].component.name == component && exam.questions[n].kind == Kind::Forward;
    let answers = |n: usize| -> Answers {
        let question = &exam.questions[n];
        let answer = |inputs: &Arrays| {
            let mut answer = given((question.component.forward.oracle)(inputs, c));
            change(&mut answer);
            answer
        };
        question.cases.iter().map(|case| forward(n).then(|| answer(&case.inputs))).collect()
    };
    judge_answers(&exam, &(0..exam.questions.len()).map(answers).collect::<Vec<_>>(), EXP_ULP)
}

#[test]
fn layouts_pass_and_are_reported() {
    let flat = laid_out("image_rays", &CS180, |answer| {
        for given in answer.values_mut() {
            let (rows, columns) = (given.values.len() / given.values.shape()[2], given.values.shape()[2]);
            given.values = given.values.clone().into_shape_with_order(vec![rows, columns]).unwrap();
        }
    });
    let swapped = laid_out("image_rays", &CS180, |answer| {
        let (o, d) = (answer.remove("rays_o").unwrap(), answer.remove("rays_d").unwrap());
        answer.insert("rays_o".into(), d);
        answer.insert("rays_d".into(), o);
    });
    // All columns from the last to the first.
    let after = laid_out("positional_encoding", &CS180.with("frequency", "two_pi").unwrap(), |answer| {
        let given = answer.get_mut("encoding").unwrap();
        let width = given.values.shape()[1];
        given.values = given.values.select(ndarray::Axis(1), &(0..width).rev().collect::<Vec<_>>());
    });
    for (report, says) in
        [(flat, "flattened"), (swapped, "each other's place"), (after, "an order of their own")]
    {
        assert_eq!(report.exit_code(), 0, "{report}");
        assert!(report.to_string().contains(says), "{report}");
    }
}

/// Who lays an encoding out in an order of their own is given its gradient in that order, in either encoding's row.
#[test]
fn a_gradient_comes_in_the_forward_answers_order() {
    // Theirs begins with our second column and ends with our first.
    let rolled = |array: &ArrayD<f64>, by: usize| {
        let width = array.shape()[1];
        array.select(ndarray::Axis(1), &(0..width).map(|n| (n + by) % width.max(1)).collect::<Vec<_>>())
    };
    for name in ["positional_encoding", "integrated_encoding"] {
        let component = COMPONENTS.iter().find(|c| c.name == name).unwrap();
        let forward = |inputs: &Arrays| {
            let mut all = (component.forward.oracle)(inputs, &CS180);
            all.insert("encoding".into(), rolled(&all["encoding"], 1));
            all
        };
        let verdict = |rolls_back: bool, factor: f64| {
            let vjp = |inputs: &Arrays| {
                let mut inputs = inputs.clone();
                let width = inputs["grad_encoding"].shape()[1].max(1);
                let by = if rolls_back { width - 1 } else { 0 };
                inputs.insert("grad_encoding".into(), rolled(&inputs["grad_encoding"], by));
                let mut all = (component.vjp.unwrap().oracle)(&inputs, &CS180);
                all.values_mut().for_each(|g| *g *= factor);
                all
            };
            let candidate = Candidate::new().forward(name, forward).vjp(name, vjp);
            let report = judge(&candidate, Dtype::F64).unwrap();
            let verdict = |kind| report.of(name, kind).unwrap().verdict;
            assert_eq!(verdict("forward"), Verdict::Pass, "{report}");
            if verdict("vjp") == Verdict::Pass && rolls_back {
                assert!(report.to_string().contains("in the order of the forward answers"), "{report}");
            }
            verdict("vjp")
        };
        assert_eq!(verdict(true, 1.0), Verdict::Pass);
        assert_eq!(verdict(false, 1.0), Verdict::Pass, "in the contract's, as a port of the name says it");
        assert_eq!(verdict(true, 2.0), Verdict::Fail);
    }
}

/// What is wrong in an encoding that is laid out in an order of its own is found all the same.
#[test]
fn a_mistake_is_named_in_an_order_of_its_own() {
    for (name, mistake) in [
        ("positional_encoding", "another_base"),
        ("positional_encoding", "linear_ladder"),
        ("integrated_encoding", "half_forgotten"),
    ] {
        let component = COMPONENTS.iter().find(|c| c.name == name).unwrap();
        let forward = |inputs: &Arrays| {
            let mut all = (component.forward.wrong)(inputs, &CS180, &[mistake]);
            // From behind, with the middle in front.
            let encoding = &all["encoding"];
            let width = encoding.shape()[1];
            let mut order: Vec<usize> = (0..width).rev().collect();
            order.rotate_left(width / 2);
            let encoding = encoding.select(ndarray::Axis(1), &order);
            all.insert("encoding".into(), encoding);
            all
        };
        let report = judge(&Candidate::new().forward(name, forward), Dtype::F32).unwrap();
        let row = report.of(name, "forward").unwrap();
        assert_eq!(row.verdict, Verdict::Fail, "{report}");
        assert_eq!(row.diagnosis[0].mistakes[0].name, mistake, "{report}");
        assert!(report.to_string().contains("an order of their own"), "{report}");
    }
}

/// A march that ends early, with the gradient of what it looked at: that differs from the right one in a few opaque cases alone, none of
/// which is among the smallest.
#[test]
fn a_gradient_of_a_march_that_ends_early_is_named() {
    let component = COMPONENTS.iter().find(|c| c.name == "volume_render").unwrap();
    let forward = |inputs: &Arrays| (component.forward.wrong)(inputs, &CS180, &["given_up_early=0.0001"]);
    // Samples without a length are as good as none.
    let behind_the_end = |inputs: &Arrays| -> Vec<(usize, usize)> {
        let (sigmas, deltas) = (&inputs["sigmas"], &inputs["deltas"]);
        let (rays, samples) = (sigmas.shape()[0], sigmas.shape()[1]);
        let of_ray = |r: usize| {
            let in_front = |i: usize| (0..i).map(|j| sigmas[[r, j]] * deltas[[r, j]]).sum::<f64>();
            let end = (0..samples).find(|&i| (-in_front(i)).exp() < 1e-4).unwrap_or(samples);
            (end..samples).map(move |i| (r, i))
        };
        (0..rays).flat_map(of_ray).collect()
    };
    let vjp = |inputs: &Arrays| {
        let unseen = behind_the_end(inputs);
        let mut inputs = inputs.clone();
        unseen.iter().for_each(|&(r, i)| inputs.get_mut("deltas").unwrap()[[r, i]] = 0.0);
        let mut all = (component.vjp.unwrap().oracle)(&inputs, &CS180);
        unseen.iter().for_each(|&(r, i)| all.get_mut("grad_deltas").unwrap()[[r, i]] = 0.0);
        all
    };
    let candidate = Candidate::new().forward(component.name, forward).vjp(component.name, vjp);
    let report = judge(&candidate, Dtype::F32).unwrap();
    let row = report.of(component.name, "forward").unwrap();
    assert_eq!(row.diagnosis[0].mistakes[0].name, "given_up_early", "{report}");
    let said = "another formula: an end in front of a sample where T < 1e-4";
    assert_eq!(report.of(component.name, "vjp").unwrap().verdict, Verdict::Fail, "{report}");
    assert!(report.to_string().contains(said), "{report}");
}

/// A number that programs choose freely: any constant is told and passes, what varies fails.
#[test]
fn a_last_step_of_ones_own_is_told() {
    let c = CS180.with("delta", "differences").unwrap();
    let last = |step: fn(f64) -> f64| {
        laid_out("step_sizes", &c, |answer| {
            for mut deltas in answer.get_mut("deltas").unwrap().values.rows_mut() {
                let n = deltas.len() - 1;
                deltas[n] = step(deltas[0]);
            }
        })
    };
    for (step, says) in [(233.0, "2.33e2"), (1e25, "1e25")] {
        let report = match step {
            233.0 => last(|_| 233.0),
            _ => last(|_| 1e25),
        };
        assert_eq!(report.exit_code(), 0, "{report}");
        assert!(report.to_string().contains(&format!("the last step is {says} in all cases")), "{report}");
    }
    let first = last(|first| 2.0 * first);
    assert_eq!(first.exit_code(), 1, "{first}");
    let negative = last(|_| -1.0);
    assert_eq!(negative.exit_code(), 1, "{negative}");
    // The last sample is taken away.
    let nothing = last(|_| 0.0);
    assert_eq!(nothing.exit_code(), 1, "{nothing}");
}

#[test]
fn a_run_that_contradicts_itself_fails() {
    let opengl = CS180.with("axes", "opengl").unwrap();
    let oracle = |name: &str, c: Conventions| {
        let component = COMPONENTS.iter().find(|component| component.name == name).unwrap();
        move |inputs: &Arrays| (component.forward.oracle)(inputs, &c)
    };
    let candidate = Candidate::new()
        .forward("pixel_to_ray", oracle("pixel_to_ray", CS180))
        .forward("render_trace", oracle("render_trace", CS180))
        .forward("image_rays", oracle("image_rays", opengl));
    let report = judge(&candidate, Dtype::F64).unwrap();
    let row = report.of("image_rays", "forward").unwrap();
    assert_eq!((report.exit_code(), row.verdict), (1, Verdict::Fail), "{report}");
    assert_eq!(row.contradiction.get("axes"), Some(&"opengl"), "{report}");
    // With pinned conventions, the answer is unambiguous.
    let pinned =
        Candidate::new().forward("image_rays", oracle("image_rays", opengl)).profile("cs180").unwrap();
    let report = judge(&pinned, Dtype::F64).unwrap();
    let best = &report.of("image_rays", "forward").unwrap().diagnosis[0];
    assert!(best.mistakes.is_empty() && best.conventions.get("axes") == Some(&"opengl"), "{report}");
}

#[test]
fn vacuous_elements_use_no_budget_and_still_have_to_fit() {
    let exam = Exam::new("positional_encoding", Dtype::F32, None).unwrap();
    let question = &exam.questions[0];
    let options = MarkOptions { dtype: Dtype::F32, exp_ulp: EXP_ULP };
    let oracle = |inputs: &Arrays| given((question.component.forward.oracle)(inputs, &CS180));
    let answers: Answers = question.cases.iter().map(|case| Some(oracle(&case.inputs))).collect();
    let right = mark(question, &answers, &CS180, &options, Grade::B);
    // An element that proves nothing, and one that does.
    let find = |vacuous: bool| {
        let places = question.cases.iter().enumerate().flat_map(|(n, case)| {
            let truth = options.truth(question, case, &CS180, Grade::B);
            let (expected, bound) = (&truth.expected, &truth.bound);
            let pairs = expected["encoding"].iter().zip(&bound["encoding"]).enumerate();
            let all: Vec<_> = pairs.map(|(i, (&e, &b))| (n, i, e, b)).collect();
            all.into_iter()
                .filter(move |(_, _, e, b)| *b > 0.0 && b.is_finite() && (*b >= e.abs()) == vacuous)
        });
        places.into_iter().next().unwrap()
    };
    let moved = |(n, i, e, b): (usize, usize, f64, f64), by: f64| {
        let mut answers = answers.clone();
        let values = &mut answers[n].as_mut().unwrap().get_mut("encoding").unwrap().values;
        *values.iter_mut().nth(i).unwrap() = e + by * b;
        mark(question, &answers, &CS180, &options, Grade::B)
    };
    let (empty, proving) = (find(true), find(false));
    let within = moved(empty, 0.9);
    assert_eq!((within.budget_used, within.vacuous, within.pass()), (right.budget_used, right.vacuous, true));
    assert!((moved(proving, 0.9).budget_used - 0.9).abs() < 1e-3);
    assert!(!moved(empty, 1.1).pass() && !moved(proving, 1.1).pass());
}

/// One component's forward answers alone, with nothing pinned.
fn alone(component: &str, dtype: Dtype, answer: impl Fn(&Arrays) -> Answer) -> Report {
    let exam = Exam::new(component, dtype, None).unwrap();
    let forward =
        |n: usize| exam.questions[n].component.name == component && exam.questions[n].kind == Kind::Forward;
    let answers = |n: usize| -> Answers {
        exam.questions[n].cases.iter().map(|case| forward(n).then(|| answer(&case.inputs))).collect()
    };
    judge_answers(&exam, &(0..exam.questions.len()).map(answers).collect::<Vec<_>>(), EXP_ULP)
}

#[test]
fn a_failing_row_is_shown_in_the_conventions_next_to_its_answers() {
    let nerf2020 = PROFILES.iter().find(|profile| profile.name == "nerf2020").unwrap().conventions;
    let component = |name: &str| COMPONENTS.iter().find(|component| component.name == name).unwrap();
    let expect = |row: &nerf_oracle::judge::report::Row, report: &Report, pairs: &[(&str, &str)]| {
        for (key, value) in pairs {
            assert_eq!(row.shown_in.get(key), Some(value), "{report}");
        }
        assert!(report.to_string().contains("shown in the conventions next to these answers"), "{report}");
    };
    // A known mistake: its conventions are found with it.
    let wrong = component("render_trace").forward.wrong;
    let moved = CS180.with("grid", "ends_between_midpoints").unwrap();
    let report = alone("render_trace", Dtype::F64, |inputs| {
        given(wrong(inputs, &moved, &["inclusive_transmittance"]))
    });
    let row = report.of("render_trace", "trace").unwrap();
    let names: Vec<_> =
        row.diagnosis.iter().take(1).flat_map(|e| e.mistakes.iter().map(|m| m.name)).collect();
    assert_eq!((row.verdict, names), (Verdict::Fail, vec!["inclusive_transmittance"]), "{report}");
    expect(row, &report, &[("grid", "ends_between_midpoints")]);
    // An unknown one: the conventions in which most elements agree.
    let report = alone("image_rays", Dtype::F64, |inputs| {
        let mut answer = given((component("image_rays").forward.oracle)(inputs, &nerf2020));
        answer.get_mut("rays_d").unwrap().values[[0, 0, 0]] += 0.125;
        answer
    });
    let row = report.of("image_rays", "forward").unwrap();
    assert!(row.diagnosis.is_empty() && row.verdict == Verdict::Fail, "{report}");
    expect(row, &report, &[("axes", "opengl"), ("directions", "depth"), ("pixel_center", "integer")]);
    let worst = row.worst_case.as_ref().unwrap();
    assert_eq!((&worst.output[..], &worst.index[..]), ("rays_d", &[0, 0, 0][..]));
}

#[test]
fn what_the_textbook_loses_may_be_magnified_by_a_mistake() {
    // 1 - exp(-x) is off by a rounding of 1; C / A on a thin ray magnifies it by thousands.
    let textbook = |inputs: &Arrays| {
        let (sigmas, rgbs) = (input(inputs, "sigmas"), input(inputs, "rgbs"));
        let depths = sigmas * input(inputs, "deltas");
        let (rays, samples) = (sigmas.shape()[0], sigmas.shape()[1]);
        let mut colors = vec![];
        for r in 0..rays {
            let (mut t, mut c, mut a) = (1.0_f32, [0.0_f32; 3], 0.0_f32);
            for i in 0..samples {
                let alpha = 1.0 - (-(depths[[r, i]] as f32)).exp();
                (0..3).for_each(|k| c[k] += t * alpha * rgbs[[r, i, k]] as f32);
                a += t * alpha;
                t *= 1.0 - alpha;
            }
            colors.extend(c.map(|c| f64::from(c / a)));
        }
        given(arrays([("colors", array(&[rays, 3], colors))]))
    };
    let report = alone("volume_render", Dtype::F32, textbook);
    let best = report.of("volume_render", "forward").unwrap().diagnosis.first();
    assert!(best.is_some_and(|best| best.mistakes[0].name == "divided_by_opacity"), "{report}");
}

/// Rays of height, width, focal length and pose: the center is the middle, as in most of the world's `get_rays`.
#[test]
fn a_center_in_the_middle_is_asked_what_it_can_answer() {
    let get_rays = |inputs: &Arrays| {
        let mut inputs = inputs.clone();
        for (center, size) in [("cx", "width"), ("cy", "height")] {
            inputs.insert(center.into(), input(&inputs, size) / 2.0);
        }
        let component = COMPONENTS.iter().find(|c| c.name == "image_rays").unwrap();
        (component.forward.oracle)(&inputs, &CS180)
    };
    let candidate = || Candidate::new().forward("image_rays", get_rays);
    let report = judge(&candidate(), Dtype::F32).unwrap();
    assert_eq!(report.exit_code(), 1, "asked everything, it is wrong: {report}");
    let taking = candidate().takes("image_rays", &["height", "width", "focal", "c2w"]);
    let report = judge(&taking, Dtype::F32).unwrap();
    assert_eq!(report.exit_code(), 0, "{report}");
    assert!(report.rows[0].left_out.contains_key("random_0_f32"), "{report}");
    let unknown = candidate().takes("image_rays", &["heigth"]);
    assert!(judge(&unknown, Dtype::F32).unwrap_err().to_string().contains("heigth"));
}

/// A renderer of colors alone: its gradient goes through them, and the other cotangents are 0.
#[test]
fn a_gradient_through_colors_alone_is_judged() {
    let component = COMPONENTS.iter().find(|c| c.name == "volume_render").unwrap();
    let through_colors = |inputs: &Arrays| {
        let mut inputs = inputs.clone();
        for name in ["grad_weights", "grad_opacity", "grad_transmittance"] {
            inputs.get_mut(name).unwrap().fill(0.0);
        }
        (component.vjp.unwrap().oracle)(&inputs, &CS180)
    };
    let candidate = || Candidate::new().vjp("volume_render", through_colors);
    assert_eq!(judge(&candidate(), Dtype::F32).unwrap().exit_code(), 1);
    let report = judge(&candidate().returns("volume_render", &["colors"]), Dtype::F32).unwrap();
    assert_eq!(report.exit_code(), 0, "{report}");
}

#[test]
fn a_panic_is_its_cases_result() {
    let careless = |inputs: &Arrays| {
        assert!(input(inputs, "sigmas").shape()[1] > 0, "no samples");
        my_volume_render(inputs)
    };
    let report = judge(&Candidate::new().forward("volume_render", careless), Dtype::F32).unwrap();
    let row = report.of("volume_render", "forward").unwrap();
    assert_eq!(row.crashed["VR9_no_samples"], "no samples");
    assert_eq!((row.verdict, &row.edge_cases[..]), (Verdict::Edge, &["no samples"][..]), "{report}");
    assert_eq!(row.answered, row.cases - 1);
}
