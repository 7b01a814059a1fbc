//! What nobody reads: a box that is missed has no t. Where wrong code says so, whatever else it says there is no matter.

use super::super::answer::{Answer, reshaped};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::component::Component;

/// Predicts what was answered, where a prediction says that nobody reads it, and so does the answer: else whatever is predicted to be
/// missed would explain any t.
pub(crate) fn as_answered(component: &Component, case: &Case, answer: &Answer, predicted: &mut Arrays) {
    let Some(unread) = component.special.unread else { return };
    let Some(read) = predicted.get(unread.by).cloned() else { return };
    let given = |name: &str| reshaped(&answer.get(name)?.values, read.shape()).map(|(array, _)| array);
    let all = || unread.outputs.iter().map(|name| given(name)).collect::<Option<Vec<_>>>();
    let Some(said) = given(unread.by).or_else(|| Some((unread.told)(&case.inputs, &all()?))) else { return };
    for output in unread.outputs {
        let Some((given, predicted)) = given(output).zip(predicted.get_mut(*output)) else { continue };
        if predicted.shape() != read.shape() {
            continue;
        }
        for (((predicted, given), read), said) in predicted.iter_mut().zip(&given).zip(&read).zip(&said) {
            *predicted = if *read == 0.0 && *said == 0.0 { *given } else { *predicted };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::exam::Exam;
    use super::super::super::mark::MarkOptions;
    use super::super::hypothesis::Hypothesis;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;
    use crate::judge::answer::given;

    /// The cases that a mistake explains of its own answers after a change.
    fn explained(change: impl Fn(&mut Answer)) -> (usize, usize) {
        let exam = Exam::new("ray_aabb", Dtype::F32, None).unwrap();
        let question = &exam.questions[0];
        let h = Hypothesis::new(vec!["face_is_a_miss"], CS180);
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 };
        let fits = |case| {
            let mut answer = given(h.prediction(question, case).0);
            change(&mut answer);
            h.explains(question, case, &answer, &options)
        };
        (question.cases.iter().filter(|case| fits(case)).count(), question.cases.len())
    }

    /// Whether a distance is explained doesn't depend on whether what is hit is asked, too.
    #[test]
    fn a_distance_alone_is_left_open_too() {
        let exam = Exam::new("ray_aabb", Dtype::F32, None).unwrap();
        let question = &exam.questions[0];
        let h = Hypothesis::new(vec!["face_is_a_miss"], CS180);
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 };
        let explained = |asked: &[&'static str]| -> usize {
            let near = |case| {
                let mut answer = given(h.prediction(question, case).0);
                let hit = answer["hit"].values.clone();
                let near = &mut answer.get_mut("t_near").expect("an output").values;
                near.zip_mut_with(&hit, |t, hit| *t = if *hit == 0.0 { -1e6 } else { *t });
                let mut kept = asked.to_vec();
                h.keep_explained(question, case, &answer, &options, &mut kept);
                kept.contains(&"t_near")
            };
            question.cases.iter().filter(|case| near(case)).count()
        };
        assert_eq!(explained(&["t_near"]), question.cases.len());
        assert_eq!(explained(&["hit", "t_near"]), question.cases.len());
    }

    #[test]
    fn what_is_missed_has_no_distance() {
        let all = explained(|_| ());
        assert_eq!(all.0, all.1);
        let of_misses = |answer: &mut Answer, number: f64| {
            let hit = answer["hit"].values.clone();
            let near = &mut answer.get_mut("t_near").expect("an output").values;
            near.zip_mut_with(&hit, |t, hit| *t = if *hit == 0.0 { number } else { *t });
        };
        assert_eq!(explained(|answer| of_misses(answer, f64::NAN)), all);
        assert_eq!(explained(|answer| of_misses(answer, -1e6)), all);
        // Hits are read; without an answer to what is hit, both t say it.
        let moved = |answer: &mut Answer| answer.get_mut("t_near").expect("an output").values += 1.0;
        assert!(explained(moved).0 < all.0);
        let silent = |answer: &mut Answer, number: f64| {
            of_misses(answer, number);
            answer.remove("hit");
        };
        assert_eq!(explained(|answer| silent(answer, 1e6)), all);
        assert!(explained(|answer| silent(answer, -1e6)).0 < all.0);
    }
}
