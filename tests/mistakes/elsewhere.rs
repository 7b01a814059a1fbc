//! One mistake as strangers make it: in conventions of their own, with a number of their own, of which some outputs are answered.

use nerf_oracle::random::{Key, Purpose};

use super::*;

/// The share of draws that are named.
const NAMED: f64 = 0.97;

/// One in so many mistakes, and in fewer with `NERF_ORACLE_TYPES=all`. `NERF_ORACLE_EACH=1` tries every one.
const EACH: [u64; 2] = [24, 2];

/// Which number of a range, in decades beside the usual one.
const DECADES: f64 = 0.7;

/// A mistake in a run of somebody's.
struct Run {
    component: &'static Component,
    mistake: &'static Mistake,
    /// Its name, with a number of two digits where it has one.
    name: String,
    c: Conventions,
    /// All outputs, or one.
    kept: Vec<&'static str>,
}

fn run(key: &Key, n: u64, component: &'static Component, mistake: &'static Mistake) -> Run {
    let pick = |of: usize, lane: u64| key.below(of as u64, n, lane, 0) as usize;
    // Each convention with a chance of a third is any of its values.
    let c = component.conventions.iter().zip(10..).fold(CS180, |c, (convention, lane)| {
        let (_, values) = CHOICES.iter().find(|(name, _)| name == convention).unwrap();
        let value = values[pick(values.len(), 100 + lane)];
        if pick(3, lane) == 0 { c.with(convention, value).unwrap() } else { c }
    });
    let name = mistake.number.map_or(mistake.name.to_string(), |number| {
        let decades = DECADES * (pick(2001, 0) as f64 / 1000.0 - 1.0);
        let x = (number.usual * 10f64.powf(decades)).clamp(number.range[0], number.range[1]);
        format!("{}={x:.1e}", mistake.name)
    });
    let outputs: Vec<&str> = component.outputs.iter().map(|port| port.name).collect();
    let one = outputs[pick(outputs.len(), 1)];
    let kept = if pick(2, 2) == 0 || one.ends_with('*') { outputs } else { vec![one] };
    Run { component, mistake, name, c, kept }
}

/// What the judge says of it: `None` where there is nothing to find, or whether it is named, in words if not.
fn outcome(run: &Run) -> Option<Result<(), String>> {
    let exam = exam_of(run.component, Dtype::F32, None);
    let n = sheet_of(&exam, run.component, Kind::Forward);
    let question = &exam.questions[n];
    if !question.admits(&run.c) {
        return None;
    }
    let answers = |mistakes: &[&str]| {
        let mut all = answers_off_by(0.0, question, &run.c, mistakes, Dtype::F32);
        let kept = |name: &String| {
            run.component.outputs.iter().any(|p| p.covers(name) && run.kept.contains(&p.name))
        };
        all.iter_mut().flatten().for_each(|answer| answer.retain(|name, _| kept(name)));
        all
    };
    let row = judged(&exam, n, answers(&[&run.name]));
    let label = || {
        let changed = run.component.conventions.iter().filter(|key| run.c.get(key) != CS180.get(key));
        let changed: Vec<String> = changed.map(|key| format!("{key} = {}", run.c.get(key))).collect();
        format!("{} {}, {} of {:?} in {changed:?}", run.component.name, run.name, row.verdict, run.kept)
    };
    // Nothing is seen, or no more than rounding.
    if matches!(row.verdict, Verdict::Pass | Verdict::Imprecise | Verdict::Unproved) {
        println!("{}", label());
        return None;
    }
    let got: Vec<_> = row.diagnosis.iter().map(names).collect();
    // One output needn't tell it from what resembles it: it is listed.
    let listed = run.kept.len() < run.component.outputs.len() && got.contains(&vec![run.mistake.name]);
    Some(if listed || named(&row, run.mistake) { Ok(()) } else { Err(format!("{}: {got:?}", label())) })
}

#[test]
fn a_mistake_is_named_in_any_conventions_with_any_number_and_of_one_output() {
    let key = Key::new(20_261_127, Purpose::Cases);
    let each = number("NERF_ORACLE_EACH", EACH[usize::from(all_types())]) as usize;
    let forward = |c: &'static Component| c.mistakes.iter().filter(|m| !m.gradient).map(move |m| (c, m));
    // A trace's mistakes are those of its stages.
    let rows = COMPONENTS.iter().filter(|c| c.name != "render_trace");
    let all: Vec<_> = rows.flat_map(forward).step_by(each).collect();
    let outcomes = parallel::map(all.len(), |n| outcome(&run(&key, n as u64, all[n].0, all[n].1)));
    let total = outcomes.iter().flatten().count();
    let failures: Vec<String> = outcomes.into_iter().flatten().filter_map(Result::err).collect();
    println!("{} of {total} named\n{}", total - failures.len(), failures.join("\n"));
    assert!(total * each > 700, "{total} mistakes are seen");
    assert!((total - failures.len()) as f64 >= NAMED * total as f64, "{}", failures.join("\n"));
}
