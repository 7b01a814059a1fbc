//! Fitting beside another mistake: what that leaves of the answers is what the number is read off.

use super::super::answer::{Answer, Answers};
use super::super::assignment::small_cases;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::apply;
use super::evidence::{Explanation, explains_all, shows, usable};
use super::fitted::{with_its_number, within_reach};
use super::hypothesis::Hypothesis;
use super::nearness::likely;
use super::telling::{SURE, evidence, evidence_of_places};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::parallel;

/// Elements that all pairs together may have in their smallest case.
const WORK: usize = 400_000;

/// By how many times what wrong code may be off a mistake alone misses answers that show another's number, and in how many cases at least.
const FAR: f64 = 100.0;
const FEW: usize = 2;

/// Conventions in which another mistake is looked for beside one that explains most cases.
const LIKELY: usize = 4;

/// Pairs of which one mistake has a number, chosen so that they explain every answer, in the conventions `near`: what the other mistake
/// leaves is what the number is read off.
pub(crate) fn fitting_pairs(
    question: &Question,
    answers: &Answers,
    near: &[Conventions],
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let all = || question.component.mistakes.iter().filter(|m| !m.gradient);
    let numbered = all().filter(|m| m.number.is_some());
    let mut pairs: Vec<(&Mistake, &Mistake)> = numbered
        .flat_map(|m| all().filter(|other| other.name != m.name).map(move |other| (m, other)))
        .collect();
    // What is seen most often first, and no more than there is time for.
    pairs.sort_by_key(|(m, other)| std::cmp::Reverse(m.count + other.count));
    let cases = small_cases(question, answers);
    let Some((case, _)) = cases.first() else { return vec![] };
    let most = WORK / question.cost(case);
    pairs.truncate(most);
    let near = distinct(near, (most / pairs.len().max(1)).max(1), question, &cases);
    let found = parallel::map(pairs.len() * near.len(), |n| {
        let ((mistake, other), c) = (pairs[n / near.len()], near[n % near.len()]);
        fitted_beside(mistake, (other, None), c, question, answers, options)
    });
    found.into_iter().flatten().collect()
}

/// What explains every answer beside the mistake of `most`, which explains most cases, in its conventions or in the likeliest others: these
/// may be too many for pairs to be looked for in.
pub(crate) fn beside(
    most: &Explanation,
    base: &Conventions,
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let ([mistake], Kind::Forward) = (&most.mistakes[..], question.kind) else { return vec![] };
    let mut near = vec![apply(&most.conventions, base)];
    near.extend(likely(LIKELY, (question, answers), base, options));
    let near = distinct(&near, near.len(), question, &small_cases(question, answers));
    let others: Vec<&Mistake> =
        question.component.mistakes.iter().filter(|m| !m.gradient && m.name != mistake.name).collect();
    let fits =
        |h: &Hypothesis| explains_all(h, question, answers, options) && shows(h, question, answers, options);
    let found = parallel::map(near.len() * others.len(), |n| {
        let (c, n) = (near[n / others.len()], n % others.len());
        let both = Hypothesis {
            fitted: most.fitted.clone(),
            ..Hypothesis::new(vec![mistake.name, others[n].name], c)
        };
        let fit = || {
            others[n].number?;
            let known = (*mistake, most.fitted.first().copied());
            fitted_beside(others[n], known, c, question, answers, options)
        };
        if fits(&both) { Some(both) } else { fit() }
    });
    found.into_iter().flatten().collect()
}

/// A mistake with the number that it needs to explain every answer beside another, whose own number may be known.
fn fitted_beside(
    mistake: &Mistake,
    (other, number): (&Mistake, Option<f64>),
    c: Conventions,
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> Option<Hypothesis> {
    // The first that has a number gets it.
    let names = if other.number.is_some() { [mistake, other] } else { [other, mistake] };
    let own = mistake.number.map(|own| own.usual);
    let both = number.map_or_else(Vec::new, |number| own.into_iter().chain([number]).collect());
    let usual = Hypothesis { fitted: both, ..Hypothesis::new(names.map(|m| m.name).to_vec(), c) };
    let fitted = number.into_iter().collect();
    let alone = Hypothesis { fitted, ..Hypothesis::new(vec![other.name], c) };
    // A number next to the right one takes up what rounding left of the other mistake alone.
    let needed = |h: &Hypothesis| {
        let cases = usable(h, question, answers);
        let missed = |(case, answer): &&(&Case, &Answer)| !alone.explains(question, case, answer, options);
        let missed: Vec<_> = cases.iter().filter(missed).collect();
        // An eps shows where something is small, and nowhere else; but there by far.
        let far = |(case, answer): &&&(&Case, &Answer)| alone.residual(question, case, answer, options) > FAR;
        // What is cut off is told by where it is: of so many places two of a kind tell little.
        let cut = || evidence_of_places(h, &alone, question, &cases, options) >= 2.0 * SURE;
        let told = || evidence(h, &alone, question, &cases, options) >= SURE || cut();
        2 * missed.len() >= cases.len() || missed.iter().filter(far).count() >= FEW || told()
    };
    let fits = |h: &Hypothesis| {
        explains_all(h, question, answers, options) && shows(h, question, answers, options) && needed(h)
    };
    within_reach(mistake, &usual, question, answers)
        .then(|| with_its_number(mistake, &usual, question, answers, fits))?
}

/// The first `most` of these conventions that answer differently: what changes nothing that was answered takes no other's place.
fn distinct(
    near: &[Conventions],
    most: usize,
    question: &Question,
    cases: &[(&Case, &Answer)],
) -> Vec<Conventions> {
    let oracle = question.component.direction(question.kind).expect("a question has its direction").oracle;
    let mut kept: Vec<(Conventions, Vec<Arrays>)> = vec![];
    for c in near {
        if kept.len() == most {
            break;
        }
        let answered = |(case, answer): &(&Case, &Answer)| {
            let all = oracle(&case.inputs, c).into_iter();
            all.filter(|(name, _)| answer.contains_key(name)).collect()
        };
        let answers: Vec<Arrays> = cases.iter().map(answered).collect();
        if kept.iter().all(|(_, others)| *others != answers) {
            kept.push((*c, answers));
        }
    }
    kept.into_iter().map(|(c, _)| c).collect()
}

#[cfg(test)]
mod tests {
    use ndarray::ArrayD;

    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::super::fitted::tests::answered;
    use super::super::mostly::mostly;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// The pairs that are fitted to forward answers with these mistakes.
    fn pairs(component: &str, dtype: Dtype, mistakes: &[&str]) -> Vec<(Vec<&'static str>, Vec<f64>)> {
        let exam = Exam::new(component, dtype, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype, exp_ulp: 4.0 });
        let answers = answered(question, dtype, mistakes);
        let found = fitting_pairs(question, &answers, &[CS180], &options);
        found.into_iter().map(|h| (h.mistakes, h.fitted)).collect()
    }

    #[test]
    fn a_number_is_read_off_beside_another_mistake() {
        for (component, numbered, other, number) in [
            ("volume_render", "weights_normalized", "inclusive_transmittance", 1e-5),
            ("volume_render", "delta_scaled", "rolled_transmittance", 0.25),
            ("sample_along_rays", "jitter_about_grid", "one_jitter_for_all_rays", 1e-4),
            ("ray_aabb", "eps_in_direction", "behind_is_a_hit", 1e-5),
        ] {
            for dtype in [Dtype::F64, Dtype::F32] {
                let found = |number: f64| pairs(component, dtype, &[other, &format!("{numbered}={number}")]);
                let found = found(number);
                assert!(
                    found.contains(&(vec![other, numbered], vec![number])),
                    "{component} {dtype}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn no_number_is_read_off_two_other_mistakes() {
        for (component, mistakes) in [
            ("volume_render", ["opacity_in_front_as_transmittance", "delta_differenced_twice"]),
            ("sample_along_rays", ["middles_not_halved", "points_without_origin"]),
            ("pixel_to_ray", ["center_swapped", "rotation_transposed"]),
        ] {
            assert_eq!(pairs(component, Dtype::F32, &mistakes), [], "{component}");
        }
    }

    /// Three conventions away from the run's, pairs with a number aren't looked for but beside what explains most cases.
    #[test]
    fn what_explains_most_cases_is_joined_by_what_explains_the_others() {
        let exam = Exam::new("gaussian_alpha", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 });
        let c = [("alpha_cap", "0.99"), ("faint", "skipped"), ("positive_power", "skipped")];
        let c = c.iter().fold(CS180, |c, (key, value)| c.with(key, value).unwrap());
        let both = ["conic_in_another_order", "cut_at_a_radius"];
        let h = Hypothesis { fitted: vec![2.0], ..Hypothesis::new(both.to_vec(), c) };
        let single = |a: &ArrayD<f64>| a.mapv(|x| Dtype::F32.round(x));
        let answer = |case| {
            let (arrays, _) = h.prediction(question, case);
            Some(given(arrays.iter().map(|(name, a)| (name.clone(), single(a))).collect()))
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let most = mostly(question, &answers, &CS180, &[], &options).unwrap();
        assert_eq!(most.mistakes.iter().map(|m| m.name).collect::<Vec<_>>(), both[..1]);
        let found = beside(&most, &CS180, question, &answers, &options);
        let found: Vec<_> = found.iter().map(|h| (&h.mistakes[..], &h.fitted[..])).collect();
        assert_eq!(found[0], (&both[..], &[2.0][..]));
    }

    /// Forward answers notice no ReLU before densities, and colors without opacities not which weights these add up: the next convention
    /// that they notice is tried in their place.
    #[test]
    fn conventions_that_change_no_answer_take_no_place() {
        let exam = Exam::new("volume_render", Dtype::F64, None).unwrap();
        let question = &exam.questions[0];
        let mut answers = answered(question, Dtype::F64, &[]);
        let with = |key, value| CS180.with(key, value).unwrap();
        let near = [
            CS180,
            with("sigma_relu", "inside"),
            with("opacity_sum", "without_last"),
            with("backdrop", "white"),
        ];
        let kept = |answers: &Answers| distinct(&near, 2, question, &small_cases(question, answers));
        assert_eq!(kept(&answers), [CS180, near[2]]);
        answers.iter_mut().flatten().for_each(|answer| {
            answer.remove("opacity");
        });
        assert_eq!(kept(&answers), [CS180, near[3]]);
    }

    /// A march that passes over thin samples and gives up, at thresholds of its own.
    #[test]
    fn both_may_have_numbers_of_their_own() {
        let exam = Exam::new("volume_render", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 });
        let answers = answered(question, Dtype::F32, &["thin_samples_skipped=0.001", "given_up_early=0.001"]);
        let most = mostly(question, &answers, &CS180, &[], &options).unwrap();
        let found = beside(&most, &CS180, question, &answers, &options);
        let sorted = |h: &Hypothesis| {
            let mut names = h.mistakes.clone();
            names.sort_unstable();
            (names, h.fitted.clone())
        };
        let found: Vec<_> = found.iter().map(sorted).collect();
        let both = vec!["given_up_early", "thin_samples_skipped"];
        assert!(found.iter().any(|(names, fitted)| *names == both && fitted.contains(&0.001)), "{found:?}");
    }
}
