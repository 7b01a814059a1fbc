//! Slips that explain answers which no mistake of the catalogue explains: one, by itself or beside one catalogued mistake.

use std::collections::{BTreeMap, BTreeSet};

use ndarray::{ArrayD, Axis};

use super::super::super::answer::{Answer, Answers, beside};
use super::super::super::assignment::small_cases;
use super::super::super::exam::Question;
use super::super::super::mark::MarkOptions;
use super::super::evidence::{Explanation, real_numbers};
use super::super::hypothesis::Hypothesis;
use super::changes::{SHORT, groups, lengths, of_axes};
use super::columns;
use super::each::{By, EACH, rounded};
use super::slip::{ArraySlip, Change, Slip};
use super::slipping::{conventions, explanations, was_done};
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::component::Entries;
use crate::convention::Conventions;
use crate::parallel;

/// Elements that all hypotheses together may compute on the smallest case; in the short types, where nothing can be rejected before its
/// bound is known.
const WORK: [usize; 2] = [6_000_000, 400_000];

/// Mistakes beside which slips are looked for.
const BESIDE: usize = 64;

/// Numbers of an array that are many.
const MANY: usize = 64;

/// Cases that are wrong, at least, where most are right.
const SEVERAL: usize = 2;

/// What a slip is tried with.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Beside {
    /// It is all that is wrong.
    Nothing,
    /// One mistake of the catalogue.
    Mistake,
}

/// The slips that explain every answer, the simplest first.
pub(crate) fn slipped(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
    beside: Beside,
) -> Vec<Explanation> {
    let cases = small_cases(question, answers);
    let Some((case, answer)) = cases.first() else { return vec![] };
    let conventions = conventions(question, answers, base, options);
    let forward = question.kind == Kind::Forward;
    let mut rows: Vec<_> = question.component.mistakes.iter().filter(|m| m.gradient != forward).collect();
    // What is seen most often has company most often.
    rows.sort_by_key(|m| std::cmp::Reverse(m.count));
    rows.truncate(BESIDE);
    let sets: Vec<Vec<&str>> = match beside {
        Beside::Nothing => vec![vec![]],
        Beside::Mistake => rows.iter().map(|m| vec![m.name]).collect(),
    };
    let mut slips = slips(question, &cases, &conventions[0]);
    // Beside a mistake of the catalogue only what happens to whole arrays.
    slips.retain(|slip| beside == Beside::Nothing || !slip.change.of_one());
    // What is seen in many numbers, as in a network's weights, is tried after all else.
    let many = |slip: &ArraySlip| {
        let given = answer.get(&slip.array).map(|given| given.values.len());
        case.inputs.get(&slip.array).map(|a| a.len()).or(given).is_some_and(|n| n > MANY)
    };
    slips.sort_by_key(|slip| (slip.change.rank(), many(slip)));
    let mut plain = vec![];
    for mistakes in sets {
        // Beside a mistake in the likeliest conventions alone.
        let tried =
            if mistakes.is_empty() { &conventions[..] } else { &conventions[..conventions.len().min(2)] };
        plain.extend(tried.iter().map(|c| Hypothesis::new(mistakes.clone(), *c)));
    }
    let wrong = parallel::map(plain.len(), |n| {
        cases.iter().filter(|(case, answer)| !plain[n].explains(question, case, answer, options)).count()
    });
    // Of a few odd cases a slip says little: it could be anything that shows in none of the others. But long axes are in few cases.
    let (plain, odd): (Vec<_>, Vec<_>) =
        plain.iter().zip(&wrong).partition(|(_, wrong)| 2 * **wrong >= cases.len());
    let plain: Vec<&Hypothesis> = plain.into_iter().map(|(plain, _)| plain).collect();
    let odd = odd.into_iter().filter(|(_, wrong)| **wrong >= SEVERAL).map(|(plain, _)| plain);
    let with =
        |h: &Hypothesis, slip: &ArraySlip| Hypothesis { slip: Some(Slip::Array(slip.clone())), ..h.clone() };
    let fitted = plain.iter().flat_map(|h| {
        let all = fitted(h, question, &cases).into_iter();
        all.map(|slip| with(h, &slip)).collect::<Vec<_>>()
    });
    let mut fitted: Vec<Hypothesis> = fitted.collect();
    let orders: Vec<&ArraySlip> =
        slips.iter().filter(|slip| matches!(slip.change, Change::Regrouped { .. })).collect();
    // Of bits some columns or others explain a few cases by chance.
    for h in odd.filter(|_| real_numbers(question, answers)) {
        fitted.extend(
            of_columns(h, question, &cases).iter().chain(orders.iter().copied()).map(|slip| with(h, slip)),
        );
    }
    let cost = question.cost(case) + answer.values().map(|a| a.values.len()).sum::<usize>();
    let most = (WORK[usize::from(options.dtype.bits() < 24)] / cost).saturating_sub(fitted.len());
    // The likelier slips in all conventions before the others in any.
    let all = slips.iter().flat_map(|slip| plain.iter().map(move |h| with(h, slip)));
    let hypotheses: Vec<Hypothesis> = all.take(most).chain(fitted).collect();
    let fits = parallel::map(hypotheses.len(), |n| was_done(&hypotheses[n], question, answers, options));
    let found = hypotheses.into_iter().zip(fits).filter(|(_, fits)| *fits).map(|(h, _)| h).collect();
    explanations(found, question, answers, base, options)
}

/// All slips of a row's arrays.
fn slips(question: &Question, cases: &[(&Case, &Answer)], c: &Conventions) -> Vec<ArraySlip> {
    let (case, answer) = cases[0];
    let component = question.component;
    // Counts and offsets say how long arrays are.
    let real = |name: &&String| component.input_entries(name) == Entries::Real;
    let mut all = vec![];
    let direction = component.direction(question.kind).expect("a question has its direction");
    let expected = (direction.oracle)(&case.inputs, c);
    for (input, arrays) in [(false, &expected), (true, &case.inputs)] {
        for name in arrays.keys().filter(|name| if input { real(name) } else { answer.contains_key(*name) }) {
            let shape = arrays[name].shape();
            // Numbers by themselves are sizes and limits, but for cotangents: they are only taken for one another.
            let size = input && shape.is_empty() && !name.starts_with("grad_");
            let each = if size { 0 } else { EACH.len() };
            let mut changes: Vec<Change> = (0..each).map(|n| Change::All(By::Each(n))).collect();
            changes.extend(of_axes(shape));
            let like = arrays.iter().filter(|(other, a)| *other != name && a.shape() == shape);
            changes.extend(like.map(|(other, _)| Change::Other(other.clone())));
            if !input {
                changes.extend(lengths(&case.inputs));
                changes.extend(groups(name, cases));
            }
            let slip = |change| ArraySlip {
                input,
                array: name.clone(),
                change,
                forward: question.kind == Kind::Forward,
            };
            all.extend(changes.into_iter().map(slip));
        }
    }
    all
}

/// A factor, or a summand, of one output, or of one component of it, as its largest element shows it: in four digits, as people write it,
/// and as it is.
fn fitted(plain: &Hypothesis, question: &Question, cases: &[(&Case, &Answer)]) -> Vec<ArraySlip> {
    let mut shown: BTreeSet<String> = BTreeSet::new();
    let mut all = vec![];
    for (case, answer) in cases {
        let (predicted, _) = plain.prediction(question, case);
        for (name, p, got) in beside(answer, &predicted) {
            if p.len() < 2 || shown.contains(name) {
                continue;
            }
            let Some((p, g)) = largest_off(p.iter().zip(&got)) else { continue };
            shown.insert(name.clone());
            let slip = |change| ArraySlip {
                input: false,
                array: name.clone(),
                change,
                forward: question.kind == Kind::Forward,
            };
            all.extend(rounded(g / p).map(|k| slip(Change::All(By::Times(k)))));
            all.extend(rounded(g - p).map(|k| slip(Change::All(By::Plus(k)))));
            let (predicted, axis) = (&predicted[name], predicted[name].ndim() - 1);
            for element in (0..predicted.len_of(Axis(axis))).filter(|_| predicted.len_of(Axis(axis)) <= SHORT)
            {
                let part = |a: &ArrayD<f64>| a.index_axis(Axis(axis), element).into_owned();
                let Some((p, g)) = largest_off(part(predicted).iter().zip(&part(&got))) else { continue };
                let one = |by| slip(Change::One { axis, element, by });
                all.extend(rounded(g / p).map(|k| one(By::Times(k))));
                all.extend(rounded(g - p).map(|k| one(By::Plus(k))));
            }
        }
        if shown.len() == predicted.len() {
            break;
        }
    }
    all.extend(of_columns(plain, question, cases));
    all
}

/// What became of some elements of an output's long axis, as all cases show it. Rays and points come in any order: of their axis no element
/// says anything.
fn of_columns(plain: &Hypothesis, question: &Question, cases: &[(&Case, &Answer)]) -> Vec<ArraySlip> {
    let mut pairs: BTreeMap<String, Vec<_>> = BTreeMap::new();
    for (case, answer) in cases {
        let (predicted, _) = plain.prediction(question, case);
        for (name, p, got) in beside(answer, &predicted) {
            pairs.entry(name.clone()).or_default().push((p.clone(), got));
        }
    }
    let forward = question.kind == Kind::Forward;
    let mut all = vec![];
    for (array, pairs) in &pairs {
        let axes = pairs[0].0.ndim();
        let long = |axis: &usize| pairs.iter().any(|(p, _)| p.shape().get(*axis).is_some_and(|n| *n > SHORT));
        for axis in (usize::from(axes > 1)..axes).rev().filter(long) {
            let slip = |changed| ArraySlip {
                input: false,
                array: array.clone(),
                change: Change::Columns(changed),
                forward,
            };
            all.extend(columns::shown(pairs, axis).into_iter().map(slip));
        }
    }
    all
}

/// The largest predicted number with what was given for it, where that is another.
fn largest_off<'a>(pairs: impl Iterator<Item = (&'a f64, &'a f64)>) -> Option<(f64, f64)> {
    let finite = pairs.filter(|(p, g)| p.is_finite() && g.is_finite() && **p != 0.0);
    let largest = finite.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    largest.filter(|(p, g)| p != g).map(|(p, g)| (*p, *g))
}

#[cfg(test)]
mod tests {
    use super::super::super::super::answer::given;
    use super::super::super::super::exam::Exam;
    use super::super::super::super::judging::{EXP_ULP, judge_answers};
    use super::super::super::super::report::Row;
    use super::super::columns::{Becomes, Changed};
    use super::super::slip::{ALONG, turned};
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::testing::one_in;
    use crate::convention::CS180;
    use crate::registry::COMPONENTS;

    const OPTIONS: MarkOptions = MarkOptions { dtype: Dtype::F64, exp_ulp: EXP_ULP };

    /// The rows of a report on forward answers that a change makes of the right ones.
    fn judged(
        component: &'static str,
        dtype: Dtype,
        slip: &ArraySlip,
        mistakes: &[&'static str],
    ) -> Vec<Row> {
        let exam = Exam::new(component, dtype, None).unwrap();
        let wrong =
            Hypothesis { slip: Some(Slip::Array(slip.clone())), ..Hypothesis::new(mistakes.to_vec(), CS180) };
        let answer = |question: &Question, case: &Case| {
            let rounded = |(name, a): (String, ndarray::ArrayD<f64>)| (name, a.mapv(|x| dtype.round(x)));
            given(wrong.prediction(question, case).0.into_iter().map(rounded).collect())
        };
        let forward = |q: &Question| q.kind == Kind::Forward;
        let all = |q: &Question| {
            q.cases.iter().map(|case| forward(q).then(|| answer(q, case))).collect::<Answers>()
        };
        let answers: Vec<Answers> = exam.questions.iter().map(all).collect();
        judge_answers(&exam, &answers, EXP_ULP).rows
    }

    fn slip(input: bool, array: &str, change: Change) -> ArraySlip {
        ArraySlip { input, array: array.into(), change, forward: true }
    }

    fn named(what: &str) -> usize {
        ALONG.iter().position(|(other, _)| *other == what).expect("one of them")
    }

    fn each(what: &str) -> usize {
        EACH.iter().position(|(other, _)| *other == what).expect("one of them")
    }

    #[test]
    fn what_no_catalogue_lists_is_described() {
        let places = slip(true, "deltas", Change::Along(named("taken for its running sum"), 1));
        let bent = slip(false, "srgb", Change::All(By::Times(0.93)));
        let mirrored = slip(true, "d", Change::Opposite(1, 2));
        let center = slip(true, "K", Change::Entry { from: [0, 2], to: [1, 2] });
        let corner = slip(true, "uv", Change::One { axis: 1, element: 0, by: By::Each(each("plus 1/2")) });
        let opposite = Change::Cell { at: [2, 0], by: By::Each(each("with the other sign")) };
        let rotated = slip(false, "rotations", opposite);
        let frame = slip(true, "c2w", Change::Turned(1, turned().next().expect("one")));
        let elements = vec![
            (1, Becomes::Element { from: 3, negative: false }),
            (6, Becomes::Changed(By::Each(each("halved")))),
        ];
        let columns = Change::Columns(Changed { axis: 1, from_end: false, elements });
        let harmonics = slip(false, "harmonics", columns);
        let elements = vec![(0, Becomes::Changed(By::Each(each("halved"))))];
        let last = slip(false, "weights", Change::Columns(Changed { axis: 1, from_end: true, elements }));
        let by_feature = Change::Regrouped { input: "table0".into(), axis: 1, back: true };
        let by_feature = slip(false, "encoding", by_feature);
        let longer = slip(false, "rays_d_ndc", Change::One { axis: 1, element: 1, by: By::Times(1.25) });
        let rows = [
            ("volume_render", &places, &[][..]),
            ("volume_render", &places, &["inclusive_transmittance"]),
            ("linear_to_srgb", &bent, &[]),
            ("spherical_harmonics", &mirrored, &[]),
            ("spherical_harmonics", &harmonics, &[]),
            ("hash_grid", &by_feature, &[]),
            ("volume_render_alpha", &last, &[]),
            ("pixel_to_camera", &center, &[]),
            ("pixel_to_camera", &corner, &[]),
            ("ndc_rays", &longer, &[]),
            ("so3_exp", &rotated, &[]),
            ("image_rays", &frame, &[]),
        ];
        for (n, (component, slip, mistakes)) in rows.into_iter().enumerate() {
            for dtype in [Dtype::F64, Dtype::F32].into_iter().skip(n % one_in(2)).step_by(one_in(2)) {
                let rows = judged(component, dtype, slip, mistakes);
                let forward = rows.iter().find(|row| row.name == component && row.kind == "forward").unwrap();
                let best = forward.diagnosis.first().unwrap_or_else(|| panic!("{component} {dtype}"));
                let names: Vec<&str> = best.mistakes.iter().map(|m| m.name).collect();
                let said = best.slip.as_ref().map(Slip::says);
                assert_eq!((said, &names[..]), (Some(slip.says()), mistakes), "{component} {dtype}");
            }
        }
    }

    /// Without an error, as of the target against itself, the ratio is infinite.
    #[test]
    fn what_predicts_infinity_explains_no_other_number() {
        let exam = Exam::new("psnr", Dtype::F64, None).unwrap();
        let question = &exam.questions[0];
        let explains = |value: f64| {
            let answer = given([("value".to_string(), crate::contract::arrays::scalar(value))].into());
            let case = &question.cases[0];
            let all = slips(question, &[(case, &answer)], &CS180);
            let same = all.into_iter().find(|slip| slip.says() == "target in the place of prediction");
            let slip = Some(Slip::Array(same.expect("two pictures of one shape")));
            let wrong = Hypothesis { slip, ..Hypothesis::new(vec![], CS180) };
            wrong.explains(question, case, &answer, &OPTIONS)
        };
        assert_eq!(
            [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 20.0].map(explains),
            [true, false, false, false]
        );
    }

    #[test]
    fn every_slip_can_be_tried_on_every_row() {
        for component in COMPONENTS {
            for question in &Exam::new(component.name, Dtype::F64, None).unwrap().questions {
                let direction = question.component.direction(question.kind).unwrap();
                let right = |case: &Case| Some(given((direction.oracle)(&case.inputs, &CS180)));
                let answers: Answers = question.cases.iter().map(right).collect();
                let cases = small_cases(question, &answers);
                let forward = question.kind == Kind::Forward;
                let gradient = |m: &&crate::contract::component::Mistake| m.gradient != forward;
                let mistakes: Vec<_> = question.component.mistakes.iter().filter(gradient).collect();
                for (n, slip) in slips(question, &cases, &CS180).into_iter().step_by(one_in(10)).enumerate() {
                    let wrong =
                        Hypothesis { slip: Some(Slip::Array(slip)), ..Hypothesis::new(vec![], CS180) };
                    cases.iter().take(3).for_each(|(case, _)| drop(wrong.prediction(question, case)));
                    // Beside one of the mistakes, each in its turn.
                    if let Some(mistake) = mistakes.get(n % mistakes.len().max(1)) {
                        let both = Hypothesis { mistakes: vec![mistake.name], ..wrong };
                        drop(both.prediction(question, cases[0].0));
                    }
                }
            }
        }
    }
}
