//! What the statistics of all answers show, in the conventions in which least is wrong.

use super::super::answer::Answers;
use super::super::assignment::assignments;
use super::super::exam::Question;
use super::super::partial::{Partial, apply, partial};
use super::super::statistics::{mistakes, plausible};
use super::evidence::{Explanation, difference};
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::parallel;

/// An explanation for each mistake. Where nothing is wrong in some conventions it is the run that disagrees; what keeps all else from being
/// asked comes last.
pub(super) fn shown_together(question: &Question, answers: &Answers, base: &Conventions) -> Vec<Explanation> {
    let all = assignments(question.component, base);
    let home = partial(question.component, base);
    let told = |mistakes: Vec<&'static Mistake>, p: &Partial| Explanation {
        mistakes,
        conventions: difference(p, &home),
        ..Explanation::default()
    };
    if let Some(p) = all.iter().find(|p| plausible(question, answers, &apply(p, base))) {
        return if *p == home { vec![] } else { vec![told(vec![], p)] };
    }
    let last_word = question.component.special.statistics.map_or("", |statistics| statistics.last_word);
    let each = parallel::map(all.len(), |n| mistakes(question, answers, &apply(&all[n], base)));
    let wrong = each.into_iter().zip(&all).filter(|(found, _)| !found.is_empty());
    let rank = |(found, _): &(Vec<&Mistake>, &Partial)| {
        (found.iter().any(|mistake| mistake.name == last_word), found.len())
    };
    let Some((found, p)) = wrong.min_by_key(rank) else { return vec![] };
    found.into_iter().map(|mistake| told(vec![mistake], p)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::arrays::{Arrays, scalar};
    use crate::contract::case::Case;
    use crate::convention::CS180;

    /// A right sampler of pixels' corners has no mistake, and one that never jitters has that one alone, in its own conventions.
    #[test]
    fn a_sampler_is_told_in_its_own_conventions() {
        let exam = Exam::new("sample_random_rays", Dtype::F64, None).unwrap();
        let question = &exam.questions[0];
        let corners = CS180.with("pixel_center", "integer").expect("listed");
        let told = |c: &Conventions, still: bool| {
            let resting = |case: &Case| {
                let mut inputs = Arrays::clone(&case.inputs);
                inputs.insert("training".into(), scalar(0.0));
                inputs
            };
            let answer = |case: &Case| {
                let mut answer = (question.component.forward.oracle)(&case.inputs, c);
                let rest = (question.component.forward.oracle)(&resting(case), c).remove("t");
                answer.extend(rest.filter(|_| still).map(|t| ("t".to_string(), t)));
                Some(given(answer))
            };
            let answers: Answers = question.cases.iter().map(answer).collect();
            let names = |e: &Explanation| e.mistakes.iter().map(|mistake| mistake.name).collect::<Vec<_>>();
            let all = shown_together(question, &answers, &CS180);
            all.iter().map(|e| (names(e), e.conventions.get("pixel_center").copied())).collect::<Vec<_>>()
        };
        assert_eq!(told(&CS180, false), vec![]);
        assert_eq!(told(&corners, false), vec![(vec![], Some("integer"))]);
        assert_eq!(told(&CS180, true), vec![(vec!["never_jittered"], None)]);
        assert_eq!(told(&corners, true), vec![(vec!["never_jittered"], Some("integer"))]);
    }
}
