//! Two and three mistakes at once, and what is neither, in conventions that are up to two away from the run's: what strangers' files have.

use nerf_oracle::judge::Verdict;
use nerf_oracle::judge::diagnosis::hypothesis::Hypothesis;
use nerf_oracle::judge::exam::Question;
use nerf_oracle::random::{Key, Purpose};

use super::*;

/// Draws of two mistakes, each row as often as any, and half as many of three: `NERF_ORACLE_DRAWS=100` for more.
fn draws() -> u64 {
    number("NERF_ORACLE_DRAWS", 4)
}

/// Draws that are judged at once.
const BATCH: usize = 16;

/// Mistakes of a row in conventions of its own.
struct Drawn {
    component: &'static Component,
    mistakes: Vec<&'static str>,
    c: Conventions,
    changed: Vec<(&'static str, &'static str)>,
    dtype: Dtype,
}

fn drawn(key: &Key, draw: u64, count: u64, usable: &[&'static Component]) -> Option<Drawn> {
    let pick = |n: usize, lane: u64| key.below(n as u64, draw, lane, 0) as usize;
    let component = usable[pick(usable.len(), 0)];
    let all: Vec<&Mistake> = component.mistakes.iter().filter(|m| !m.gradient).collect();
    // In proportion to how often they were seen, one more for each.
    let weights = || all.iter().map(|m| m.count as usize + 1);
    let chosen = |lane: u64| {
        let mut left = pick(weights().sum(), lane);
        let found = weights().position(|w| {
            let here = left < w;
            left = left.saturating_sub(w);
            here
        });
        all[found.expect("one of them")].name
    };
    let mistakes: Vec<&str> = (0..count).map(|n| chosen(20 + n)).collect();
    let (mut c, mut changed) = (CS180, vec![]);
    for lane in 0..pick(3, 3) as u64 {
        let Some(key) = (!component.conventions.is_empty())
            .then(|| component.conventions[pick(component.conventions.len(), 4 + 2 * lane)])
        else {
            break;
        };
        let (_, values) = CHOICES.iter().find(|(name, _)| *name == key).unwrap();
        let value = values[pick(values.len(), 5 + 2 * lane)];
        if c.get(key) != value && !changed.iter().any(|(other, _)| *other == key) {
            c = c.with(key, value).unwrap();
            changed.push((key, value));
        }
    }
    let dtype = [Dtype::F64, Dtype::F32][pick(2, 12)];
    let twice = |n: usize| mistakes[..n].contains(&mistakes[n]);
    (!(0..mistakes.len()).any(twice)).then_some(Drawn { component, mistakes, c, changed, dtype })
}

/// Whether fewer of them, in these conventions or any next to them, explain all: there is nothing to find then.
fn some_hide_others(question: &Question, d: &Drawn, answers: &Answers) -> bool {
    let alone =
        |set: &[&'static str], c| explains(question, &Hypothesis::new(set.to_vec(), c), answers, d.dtype);
    let in_any = |set: &[&'static str]| {
        alone(set, d.c)
            || d.changed.iter().any(|(key, _)| alone(set, d.c.with(key, &CS180.get(key)).unwrap()))
    };
    let without = |n: usize| {
        let mut set = d.mistakes.clone();
        set.remove(n);
        set
    };
    in_any(&[]) || (0..d.mistakes.len()).any(|n| in_any(&without(n)) || in_any(&[d.mistakes[n]]))
}

/// What is said of several mistakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Said {
    All,
    Some,
    Other,
    Nothing,
}

fn said(row: &Row, d: &Drawn) -> Said {
    let of_drawn = |e: &Explanation| names(e).iter().filter(|name| d.mistakes.contains(name)).count();
    // One more than there are is one that wasn't made.
    let right = |e: &Explanation| of_drawn(e) * usize::from(names(e).len() <= d.mistakes.len());
    let listed = row.diagnosis.iter().enumerate().filter(|(n, e)| *n == 0 || e.same_as_best);
    let most = listed.clone().map(|(_, e)| right(e)).max().unwrap_or(0);
    let wrong = row.diagnosis.first().is_some_and(|e| names(e).iter().any(|name| !d.mistakes.contains(name)));
    match most {
        _ if most == d.mistakes.len() => Said::All,
        _ if wrong => Said::Other,
        0 => Said::Nothing,
        _ => Said::Some,
    }
}

/// How many of the draws of so many mistakes are named, and the number of draws.
fn named_of(count: u64, draws: u64) -> [usize; 2] {
    let key = Key::new(number("NERF_ORACLE_SEED", 20_261_126), Purpose::Cases);
    let enough = |c: &&Component| c.mistakes.iter().filter(|m| !m.gradient).count() >= count as usize;
    let usable: Vec<&'static Component> = COMPONENTS.iter().filter(enough).collect();
    let judge = |draw: usize| {
        let d = drawn(&key, draw as u64, count, &usable)?;
        let exam = exam_of(d.component, d.dtype, None);
        let n = sheet_of(&exam, d.component, Kind::Forward);
        let question = &exam.questions[n];
        if !question.admits(&d.c) {
            return None;
        }
        let answers = wrong_answers(question, &d.c, &d.mistakes, d.dtype);
        if some_hide_others(question, &d, &answers) {
            return None;
        }
        let start = std::time::Instant::now();
        let row = judged(&exam, n, answers);
        let took = start.elapsed().as_secs_f64();
        (row.verdict != Verdict::Pass).then(|| {
            let what = said(&row, &d);
            let got: Vec<_> = row.diagnosis.iter().take(3).map(|e| (names(e), &e.conventions)).collect();
            (
                what,
                format!(
                    "{what:?} {took:.1} s {} {} {:?} {:?} {}: {got:?}",
                    d.dtype, d.component.name, d.mistakes, d.changed, row.verdict
                ),
            )
        })
    };
    let mut found = vec![];
    for first in (0..20 * draws as usize).step_by(BATCH) {
        let more = parallel::map(BATCH, |n| judge(first + n));
        found.extend(more.into_iter().flatten());
        if found.len() >= draws as usize {
            break;
        }
    }
    found.truncate(draws as usize);
    let of = |what| found.iter().filter(|(said, _)| *said == what).count();
    let [all, some, other, nothing] = [Said::All, Said::Some, Said::Other, Said::Nothing].map(of);
    for (what, line) in &found {
        if *what != Said::All {
            println!("{line}");
        }
    }
    println!(
        "{count} at once: {all} of {} named, {some} in part, {other} with another name, {nothing} unnamed",
        found.len()
    );
    [all, found.len()]
}

#[test]
fn two_mistakes_at_once_are_named() {
    let [named, all] = named_of(2, draws());
    assert!(all == draws() as usize && named as f64 >= 0.9 * all as f64, "{named} of {all}");
}

#[test]
fn three_mistakes_at_once_are_named() {
    let [named, all] = named_of(3, draws().div_ceil(2));
    assert!(all > 0 && named as f64 >= 0.5 * all as f64, "{named} of {all}");
}

/// What no catalogue has isn't explained by two or three of what it has: one row in 60, all with `NERF_ORACLE_UNKNOWN=1`.
#[test]
fn what_nobody_listed_is_no_pair() {
    let changes: [fn(f64, f64) -> f64; 2] =
        [|x, n| x * (1.0 + 0.03 * (7.0 * n).cos()), |x, _| x.abs().powf(1.05).copysign(x)];
    let rows: Vec<_> = COMPONENTS.iter().flat_map(|c| changes.iter().map(move |f| (c, f))).collect();
    let jobs: Vec<_> = rows.into_iter().step_by(number("NERF_ORACLE_UNKNOWN", 60) as usize).collect();
    let judge = |n: usize| {
        let (component, change) = jobs[n];
        let exam = exam_of(component, Dtype::F32, None);
        let at = sheet_of(&exam, component, Kind::Forward);
        let question = &exam.questions[at];
        let mut answers = wrong_answers(question, &CS180, &[], Dtype::F32);
        for (name, given) in answers.iter_mut().flatten().flatten() {
            if !component.output_entries(name).whole() {
                let each = given.values.iter_mut().enumerate();
                each.for_each(|(n, x)| *x = Dtype::F32.round(change(*x, n as f64)));
            }
        }
        let row = judged(&exam, at, answers);
        let whole =
            row.diagnosis.iter().filter(|e| e.unexplained.is_empty() && e.unexplained_cases.is_empty());
        let named: Vec<_> = whole.map(names).filter(|names| names.len() > 1).collect();
        (!named.is_empty()).then(|| format!("{}: {named:?}", component.name))
    };
    let found: Vec<String> = parallel::map(jobs.len(), judge).into_iter().flatten().collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}
