//! The catalogue is the test: every mistake is named first, alone and together with a convention.

#[path = "mistakes/any.rs"]
mod any;
#[path = "mistakes/elsewhere.rs"]
mod elsewhere;
#[path = "mistakes/pairs.rs"]
mod pairs;
mod types;

use ndarray::ArrayD;
use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::case::Draw;
use nerf_oracle::contract::check::Kind;
use nerf_oracle::contract::{Case, Component, Dtype, Mistake};
use nerf_oracle::convention::profiles::{self, PROFILES};
use nerf_oracle::convention::{CHOICES, CS180, Conventions};
use nerf_oracle::judge::answer::{Answer, Answers, Given};
use nerf_oracle::judge::diagnosis::evidence::Explanation;
use nerf_oracle::judge::diagnosis::hypothesis::Hypothesis;
use nerf_oracle::judge::exam::Question;
use nerf_oracle::judge::judging::{EXP_ULP, judge_answers};
use nerf_oracle::judge::mark::MarkOptions;
use nerf_oracle::judge::report::Row;
use nerf_oracle::judge::{Exam, Verdict};
use nerf_oracle::parallel;
use nerf_oracle::random::{Key, Purpose};
use types::{all_types, types};

/// What an implementation in `dtype` with this mistake answers: all inputs of a case off by the same half rounding (so that equal
/// ones stay equal, as in any arithmetic), each result by three. Bytes are whole.
fn wrong_answers(question: &Question, c: &Conventions, mistakes: &[&str], dtype: Dtype) -> Answers {
    let u = if dtype == Dtype::F64 { 0.0 } else { 0.5 * dtype.unit_roundoff() };
    answers_off_by(u, question, c, mistakes, dtype)
}

/// What an implementation answers whose inputs are off by `u` and results by `6 u`, before they are rounded.
fn answers_off_by(u: f64, question: &Question, c: &Conventions, mistakes: &[&str], dtype: Dtype) -> Answers {
    let direction = question.component.direction(question.kind).unwrap();
    // A byte, a cell or a bin is a step function of its input: a rounded input asks for another answer.
    let steps = ["to_uint8", "hash_grid", "occupancy_grid", "grid_traversal", "importance_sampling"];
    let of_inputs = if steps.contains(&question.component.name) { 0.0 } else { u };
    let answer = |case: &Case| {
        let mut draw = Draw::new(&case.id, 7);
        let factor = 1.0 + of_inputs * (2.0 * draw.unit() - 1.0);
        let mut inputs = case.inputs.clone();
        for array in inputs.values_mut().filter(|a| a.ndim() > 0) {
            // 0 and 1 are exact in any arithmetic, and mean something: empty, opaque, homogeneous.
            array.mapv_inplace(|x| if x == 1.0 { x } else { x * factor });
        }
        let mut noise = || 1.0 + 6.0 * u * (2.0 * draw.unit() - 1.0);
        let mut given = |(name, a): (String, ArrayD<f64>)| {
            let off = |x: f64| if name == "bytes" { x } else { dtype.round(x * noise()) };
            let values = a.mapv(off);
            (name, Given { values, dtype: "f64" })
        };
        Some((direction.wrong)(&inputs, c, mistakes).into_iter().map(&mut given).collect())
    };
    question.cases.iter().map(answer).collect()
}

/// The verdict on one question, with all others unanswered.
fn judged(exam: &Exam, n: usize, answers: Answers) -> Row {
    let mut all: Vec<Answers> =
        exam.questions.iter().map(|question| vec![None; question.cases.len()]).collect();
    all[n] = answers;
    let report = judge_answers(exam, &all, EXP_ULP);
    report.rows[n].clone()
}

fn exam_of(component: &Component, dtype: Dtype, profile: Option<&str>) -> Exam {
    Exam::new(component.name, dtype, profile.map(|name| profiles::find(name).unwrap())).unwrap()
}

fn sheet_of(exam: &Exam, component: &Component, kind: Kind) -> usize {
    exam.questions.iter().position(|s| s.component.name == component.name && s.kind == kind).unwrap()
}

fn names(e: &Explanation) -> Vec<&'static str> {
    e.mistakes.iter().map(|m| m.name).collect()
}

/// Named first, or as one of those that are the same on every case.
fn named(row: &Row, mistake: &Mistake) -> bool {
    row.diagnosis.iter().enumerate().any(|(n, e)| (n == 0 || e.same_as_best) && names(e) == [mistake.name])
}

/// The outcome for a mistake: `None` where it is below the bound, or what was named instead of it.
fn outcome(
    exam: &Exam,
    component: &Component,
    mistake: &Mistake,
    dtype: Dtype,
) -> Option<Result<(), String>> {
    let n = sheet_of(exam, component, if mistake.gradient { Kind::Vjp } else { Kind::Forward });
    let row = judged(exam, n, wrong_answers(&exam.questions[n], &CS180, &[mistake.name], dtype));
    let label = format!("{dtype} {} {}", component.name, mistake.name);
    if row.verdict == Verdict::Pass {
        println!("{label}: below the bound ({:.1e})", row.budget_used.unwrap());
        assert_ne!(dtype, Dtype::F64, "{label} passes");
        return None;
    }
    if row.verdict == Verdict::Imprecise {
        // What is seen then is this test's own noise: without it the mistake is below the bound.
        let exact = answers_off_by(0.0, &exam.questions[n], &CS180, &[mistake.name], dtype);
        let row = judged(exam, n, exact);
        println!("{label}: below the bound ({:.1e})", row.budget_used.unwrap());
        assert_ne!(dtype, Dtype::F64, "{label} is a matter of digits");
        return match row.verdict {
            Verdict::Pass => None,
            verdict => Some(Err(format!("{label} is called imprecise, and {verdict} without noise"))),
        };
    }
    let got: Vec<_> = row.diagnosis.iter().map(|e| (names(e), &e.conventions)).collect();
    if got.len() > 1 && row.diagnosis[1].same_as_best {
        println!("{label}: the same on every case: {got:?}");
    }
    if named(&row, mistake) {
        return Some(Ok(()));
    }
    Some(Err(format!(
        "{label}, {}: {got:?} {}",
        row.verdict,
        unexplained(&exam.questions[n], mistake, dtype)
    )))
}

#[test]
fn every_mistake_is_named_first() {
    // One in ten; with `NERF_ORACLE_TYPES=all` all of them, in f64 too.
    let types = types(&[Dtype::F32], &[Dtype::F64, Dtype::F32]);
    let pairs: Vec<_> = types.iter().flat_map(|&dtype| COMPONENTS.iter().map(move |c| (dtype, c))).collect();
    let exams = parallel::map(pairs.len(), |n| exam_of(pairs[n].1, pairs[n].0, Some("cs180")));
    let each = if all_types() { 1 } else { 10 };
    let jobs: Vec<_> = (0..pairs.len())
        .flat_map(|n| pairs[n].1.mistakes.iter().map(move |m| (n, m)))
        .step_by(each)
        .collect();
    let outcomes = parallel::map(jobs.len(), |k| {
        let (n, mistake) = jobs[k];
        outcome(&exams[n], pairs[n].1, mistake, pairs[n].0)
    });
    let total = outcomes.iter().flatten().count();
    let failures: Vec<String> = outcomes.into_iter().flatten().filter_map(Result::err).collect();
    println!("{} of {total} named first", total - failures.len());
    assert!(total * each > 600 && failures.is_empty(), "{}", failures.join("\n"));
}

/// The cases that the mistake alone doesn't explain.
fn unexplained(question: &Question, mistake: &Mistake, dtype: Dtype) -> String {
    let h = Hypothesis::new(vec![mistake.name], CS180);
    let options = MarkOptions { dtype, exp_ulp: EXP_ULP };
    let answers = wrong_answers(question, &CS180, &[mistake.name], dtype);
    let used = |(case, answer): (&Case, &Option<Answer>)| {
        let residual = h.residual(question, case, answer.as_ref()?, &options);
        (!h.explains(question, case, answer.as_ref()?, &options))
            .then(|| format!("{} {residual:.2}", case.id))
    };
    question.cases.iter().zip(&answers).filter_map(used).collect::<Vec<_>>().join(", ")
}

/// The number that a variable asks for, or the usual one.
fn number(variable: &str, usual: u64) -> u64 {
    let given = std::env::var(variable).ok();
    given.map_or(usual, |n| n.parse().unwrap_or_else(|_| panic!("{variable} is a number")))
}

/// Draws of one convention and one mistake: `NERF_ORACLE_PAIRS=2000` for more.
fn pairs() -> u64 {
    number("NERF_ORACLE_PAIRS", 8)
}

#[test]
fn one_convention_and_one_mistake_are_named() {
    let key = Key::new(20_261_121, Purpose::Cases);
    let usable: Vec<_> = COMPONENTS
        .iter()
        .filter(|c| !c.conventions.is_empty() && c.mistakes.iter().any(|m| !m.gradient))
        .collect();
    let (mut total, mut right, mut failures, mut draw) = (0, 0, vec![], 0);
    while total < pairs() && draw < 20 * pairs() {
        draw += 1;
        let pick = |n: usize, lane: u64| key.below(n as u64, draw, lane, 0) as usize;
        let component = usable[pick(usable.len(), 0)];
        let convention = component.conventions[pick(component.conventions.len(), 1)];
        let (_, values) = CHOICES.iter().find(|(name, _)| *name == convention).unwrap();
        let value = values[pick(values.len(), 2)];
        let mistake = &component.mistakes[pick(component.mistakes.len(), 3)];
        if CS180.get(convention) == value || mistake.gradient {
            continue;
        }
        let c = CS180.with(convention, value).unwrap();
        let dtype = [Dtype::F64, Dtype::F32][pick(2, 4)];
        let exam = exam_of(component, dtype, None);
        let n = sheet_of(&exam, component, Kind::Forward);
        if !exam.questions[n].admits(&c) {
            continue;
        }
        let row = judged(&exam, n, wrong_answers(&exam.questions[n], &c, &[mistake.name], dtype));
        // Where the two together are right in some conventions, or the mistake hides the convention, there is nothing to find.
        if row.verdict == Verdict::Pass || hidden(&exam.questions[n], &c, mistake, dtype) {
            continue;
        }
        total += 1;
        let hit = row.diagnosis.iter().enumerate().any(|(k, e)| {
            (k == 0 || e.same_as_best)
                && names(e) == [mistake.name]
                && e.conventions.get(convention) == Some(&value)
        });
        right += u64::from(hit);
        if !hit {
            let got: Vec<_> = row.diagnosis.iter().map(|e| (names(e), &e.conventions)).collect();
            failures
                .push(format!("{dtype} {} {} {convention}={value}: {got:?}", component.name, mistake.name));
        }
    }
    println!(
        "{right} of {total} pairs named ({:.1}%)\n{}",
        100.0 * right as f64 / total as f64,
        failures.join("\n")
    );
    assert_eq!(total, pairs(), "draws whose mistake doesn't hide the convention");
    assert!(right as f64 >= 0.98 * total as f64, "{right} of {total}:\n{}", failures.join("\n"));
}

/// Whether the mistake makes the convention invisible, or the convention the mistake: no figure differs, or the judge itself takes the
/// mistake alone for all that was done, in every case within the bounds.
fn hidden(question: &Question, c: &Conventions, mistake: &Mistake, dtype: Dtype) -> bool {
    let both = wrong_answers(question, c, &[mistake.name], dtype);
    let same = |other: Answers| {
        both.iter().flatten().zip(other.iter().flatten()).all(|(a, b)| {
            a.iter().all(|(name, a)| {
                let b = &b[name].values;
                a.values.shape() == b.shape()
                    && a.values.iter().zip(b).all(|(x, y)| {
                        x == y || (x - y).abs() <= 1e3 * dtype.unit_roundoff() * x.abs().max(1.0)
                    })
            })
        })
    };
    same(wrong_answers(question, &CS180, &[mistake.name], dtype))
        || same(wrong_answers(question, c, &[], dtype))
        || explains(question, &Hypothesis::new(vec![mistake.name], CS180), &both, dtype)
}

fn explains(question: &Question, h: &Hypothesis, answers: &Answers, dtype: Dtype) -> bool {
    let options = MarkOptions { dtype, exp_ulp: EXP_ULP };
    let explained = |(case, answer): (&Case, &Option<Answer>)| {
        answer.as_ref().is_some_and(|answer| h.explains(question, case, answer, &options))
    };
    question.cases.iter().zip(answers).all(explained)
}

#[test]
fn a_mistake_that_is_somebodys_convention_is_reported_as_the_pair() {
    for component in COMPONENTS {
        for mistake in component.mistakes.iter().filter(|m| !m.gradient) {
            let exam = exam_of(component, Dtype::F64, Some("cs180"));
            let n = sheet_of(&exam, component, Kind::Forward);
            let question = &exam.questions[n];
            for profile in PROFILES.iter().filter(|profile| question.admits(&profile.conventions)) {
                let equal = question.cases.iter().all(|case| {
                    let right = (component.forward.oracle)(&case.inputs, &profile.conventions);
                    right == (component.forward.wrong)(&case.inputs, &CS180, &[mistake.name])
                });
                if !equal {
                    continue;
                }
                let row = judged(&exam, n, wrong_answers(question, &CS180, &[mistake.name], Dtype::F64));
                let convention = row.diagnosis.iter().any(|e| e.mistakes.is_empty());
                assert!(
                    convention && named(&row, mistake),
                    "{} {} is {}",
                    component.name,
                    mistake.name,
                    profile.name
                );
            }
        }
    }
}
