//! Slips of the formula: an operation of it, or several, done in another way. Honest implementations say which operations there are; one of
//! them with a fault in it is a hypothesis like any other.

use super::super::super::answer::{Answer, Answers};
use super::super::super::assignment::small_cases;
use super::super::super::exam::Question;
use super::super::super::mark::MarkOptions;
use super::super::evidence::Explanation;
use super::super::hypothesis::Hypothesis;
use super::super::telling::{MOST_BITS, by_chance};
use super::of_arrays::{Beside, slipped};
use super::other_numbers::{TRIALS, other_numbers};
use super::places::{Place, Times};
use super::proved::proved;
use super::several::several;
use super::tried::{Tried, WORK, nearby};
use crate::contract::case::Case;
use crate::contract::how::How;
use crate::contract::seen::OTHERS;
use crate::convention::Conventions;

/// In how many ways an operation can be done wrong, about.
const WAYS: usize = 12;

/// The formulas with one slip that explain every answer, the likeliest first.
pub(crate) fn misdone(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    let cases = small_cases(question, answers);
    let nearby = nearby(question, answers, base, options);
    let tried = Tried::in_each(question, &cases, &nearby, options);
    let mut all: Vec<(usize, usize, Hypothesis)> = vec![];
    for t in &tried {
        let ways = |place: &Place| How::all(place.seen.site.operation).into_iter().enumerate();
        let each = |place: &Place| {
            let here = ways(place).filter(|(_, how)| place.first || how.of_parenthesis());
            here.map(|(n, how)| (n, t.failing, place.hypothesis(how, &t.conventions))).collect::<Vec<_>>()
        };
        all.extend(t.affordable(WAYS, t.share).iter().flat_map(each));
    }
    all.sort_by_key(|(rank, ..)| *rank);
    let all: Vec<_> = all.into_iter().map(|(_, failing, h)| (failing, h)).collect();
    let chance = by_chance(all.len());
    let found = proved(all, chance, &nearby, question, answers, base, options);
    let nearest = tried.iter().min_by_key(|t| t.shown);
    let Some(t) = nearest.filter(|_| found.is_empty()) else { return found };
    let mixed_up = |t: &Tried| {
        let places = t.affordable(2 * (1 + OTHERS), t.share).iter().filter(|place| place.first);
        let ways = places.flat_map(|place| place.seen.mixed_up().into_iter().map(move |how| (place, how)));
        ways.map(|(place, how)| (t.failing, place.hypothesis(how, &t.conventions))).collect::<Vec<_>>()
    };
    let mixed: Vec<_> = tried.iter().flat_map(mixed_up).collect();
    let chance = by_chance(mixed.len());
    let found = proved(mixed, chance, &nearby, question, answers, base, options);
    if !found.is_empty() {
        return found;
    }
    let alone = times_alone(t, question, &cases);
    let chance = by_chance(alone.len());
    let found = proved(alone, chance, &nearby, question, answers, base, options);
    if !found.is_empty() {
        return found;
    }
    // A number that is read off an element explains that one anyway.
    let read = other_numbers(question, &cases, t.affordable(TRIALS, 1.0), &t.conventions, options);
    let read: Vec<_> = read.into_iter().map(|h| (t.failing, h)).collect();
    let chance = MOST_BITS + by_chance(read.len());
    proved(read, chance, &nearby, question, answers, base, options)
}

/// What happens to an array or to an operation alone: of a gradient whose forward function has none of the mistakes that explain it.
pub(crate) fn slips_alone(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    let slips = slipped(question, answers, base, options, Beside::Nothing);
    if slips.is_empty() { misdone(question, answers, base, options) } else { slips }
}

/// One of the times alone that the formula comes by an operation for every point, as many as may be tried.
fn times_alone(t: &Tried, question: &Question, cases: &[(&Case, &Answer)]) -> Vec<(usize, Hypothesis)> {
    let times = Times::new(question, cases, t.failing, &t.conventions);
    let mut all = vec![];
    for place in t.places.iter().filter(|place| place.first) {
        let ways = How::all(place.seen.site.operation).into_iter().chain(place.seen.both());
        all.extend(ways.flat_map(|how| {
            times.of(place).map(move |nth| (t.failing, place.at(Some(nth), how, &t.conventions)))
        }));
        if all.len() * t.cost > WORK {
            break;
        }
    }
    all
}

/// The formulas with several slips that explain every answer.
pub(crate) fn misdone_at_once(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    let cases = small_cases(question, answers);
    let nearby = nearby(question, answers, base, options);
    let tried = Tried::in_each(question, &cases, &nearby, options);
    let prove = |found: Vec<(usize, Hypothesis)>, tried: usize| {
        proved(found, by_chance(tried), &nearby, question, answers, base, options)
    };
    several(&tried, question, answers, options, &prove)
}

#[cfg(test)]
mod tests {
    use super::super::super::super::answer::given;
    use super::super::super::super::exam::Exam;
    use super::super::super::super::judging::{EXP_ULP, judge_answers};
    use super::super::formula_slip::{FormulaSlip, machine};
    use super::super::places::places;
    use super::super::slip::Slip;
    use super::super::slipping::attempt;
    use super::super::tried::LOOKS;
    use super::*;
    use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
    use crate::contract::check::{Kind, tolerance, worst};
    use crate::contract::component::Direction;
    use crate::contract::fault::{Fault, Nth};
    use crate::contract::testing::one_in;
    use crate::convention::CS180;
    use crate::registry::COMPONENTS;

    fn formula(h: Hypothesis) -> FormulaSlip {
        match h.slip {
            Some(Slip::Formula(slip)) => slip,
            _ => unreachable!("a slip of the formula"),
        }
    }

    /// The slip of a row's forward formula with these words.
    fn slip(question: &Question, says: &str) -> FormulaSlip {
        let right = |case: &Case| Some(given((question.component.forward.oracle)(&case.inputs, &CS180)));
        let answers: Answers = question.cases.iter().map(right).collect();
        let cases = small_cases(question, &answers);
        let slips = |place: &Place| {
            let all = How::all(place.seen.site.operation).into_iter().chain(place.seen.mixed_up());
            all.map(|how| formula(place.hypothesis(how, &CS180))).collect::<Vec<_>>()
        };
        let all: Vec<FormulaSlip> = places(question, &cases, &CS180, LOOKS).iter().flat_map(slips).collect();
        let found = all.iter().find(|slip| slip.says().starts_with(says));
        let said = || all.iter().map(FormulaSlip::says).collect::<Vec<_>>().join("\n");
        found.unwrap_or_else(|| panic!("{says} is none of\n{}", said())).clone()
    }

    /// What is said first of a row whose forward answers a slip made.
    fn said(
        component: &'static str,
        dtype: Dtype,
        slip: impl Fn(&Question) -> FormulaSlip,
    ) -> [Option<String>; 2] {
        let exam = Exam::new(component, dtype, None).unwrap();
        let forward = exam.questions.iter().find(|q| q.kind == Kind::Forward).expect("each has one");
        let slip = slip(forward);
        let answer = |question: &Question, case: &Case| {
            let of = slip.of(&case.inputs, &CS180, question.component.forward.honest);
            given(of.into_iter().map(|(name, a)| (name, a.mapv(|x| dtype.round(x)))).collect())
        };
        let all = |q: &Question| -> Answers {
            q.cases.iter().map(|case| (q.kind == Kind::Forward).then(|| answer(q, case))).collect()
        };
        let answers: Vec<Answers> = exam.questions.iter().map(all).collect();
        let report = judge_answers(&exam, &answers, EXP_ULP);
        let row = report.rows.iter().find(|row| row.name == component && row.kind == "forward").unwrap();
        let best = row.diagnosis.first().and_then(|best| best.slip.as_ref()).map(Slip::says);
        [best, Some(slip.says())]
    }

    #[test]
    fn an_operation_done_in_another_way_is_described() {
        let rows = [
            ("conical_frustum", "d in the place of d * d"),
            ("conical_frustum", "sqrt(dd) / 3 in the place of dd / 3"),
            ("ndc_rays", "plane - o[2], of which plane is taken outside"),
            ("lens_distort", "p[0] * p[0] in the place of p[0] * p[1]"),
            ("lens_distort", "r2 * p[1] in the place of p[0] * p[1]"),
            ("hash_grid", "1 in the place of 1 - cells[a].1"),
        ];
        for (n, (component, says)) in rows.into_iter().enumerate() {
            for dtype in [Dtype::F64, Dtype::F32].into_iter().skip(n % one_in(2)).step_by(one_in(2)) {
                let [best, own] = said(component, dtype, |forward| slip(forward, says));
                assert_eq!(best, own, "{component} {dtype}");
            }
        }
    }

    /// Two slips that are both needed.
    fn two(forward: &Question) -> FormulaSlip {
        let mut one = slip(forward, "sqrt(dd) / 3 in the place of dd / 3");
        let other = slip(forward, "f.origin[i] - mean * v[i] in the place of");
        one.fault = one.fault.with(*other.fault.all().next().expect("one")).expect("room for two");
        one
    }

    #[test]
    fn several_slips_are_described_together() {
        let [best, own] = said("conical_frustum", Dtype::F32, two);
        let parts = |says: Option<String>| -> Vec<String> {
            says.iter().flat_map(|says| says.split(", and ").map(String::from)).collect()
        };
        // The other one has a name that is as good: -x for x.
        let (best, own) = (parts(best), parts(own));
        assert!(best.len() == 2 && own.iter().any(|own| best.contains(own)), "{best:?}");
    }

    /// One slip, and a number that has nothing to do with it: no second one is made up for that.
    #[test]
    fn one_number_is_no_second_slip() {
        let exam = Exam::new("conical_frustum", Dtype::F32, None).unwrap();
        let question = exam.questions.iter().find(|q| q.kind == Kind::Forward).expect("it has one");
        let slip = slip(question, "sqrt(dd) / 3 in the place of dd / 3");
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: EXP_ULP };
        let answer = |(n, case): (usize, &Case)| {
            let mut wrong = slip.of(&case.inputs, &CS180, question.component.forward.honest);
            if n == 0 {
                wrong.get_mut("means").expect("an output").iter_mut().take(1).for_each(|x| *x *= 1.25);
            }
            Some(given(wrong.into_iter().map(|(name, a)| (name, a.mapv(|x| Dtype::F32.round(x)))).collect()))
        };
        let answers: Answers = question.cases.iter().enumerate().map(answer).collect();
        let found = misdone_at_once(question, &answers, &CS180, &options);
        assert!(found.is_empty(), "{:?}", found[0].slip.as_ref().map(Slip::says));
    }

    #[test]
    fn one_entry_of_a_matrix_may_be_done_in_another_way() {
        let one = |forward: &Question| {
            let mut slip = slip(forward, "(a * b - c * d) / 2 in the place of");
            slip.fault.wrong[0].as_mut().expect("one operation").nth = Some(Nth { index: 1, of: 3 });
            slip
        };
        let [best, own] = said("gaussian_covariance", Dtype::F32, one);
        assert!(own.as_ref().is_some_and(|own| own.ends_with("at time 2 of 3 for each point alone")));
        assert_eq!(best, own);
    }

    #[test]
    fn another_number_is_read_off_the_answers() {
        for dtype in [Dtype::F64, Dtype::F32] {
            let other = |forward: &Question| {
                let mut slip = slip(forward, "0 in the place of 4 / 15");
                let wrong = slip.fault.wrong[0].as_mut().expect("one operation");
                wrong.how = How::Taken(0.26);
                slip
            };
            let [best, own] = said("conical_frustum", dtype, other);
            assert!(own.as_ref().is_some_and(|own| own.starts_with("0.26 in the place of 4 / 15")));
            assert_eq!(best, own, "{dtype}");
        }
    }

    /// Right answers but for NaN where inputs are infinite: what wrong code makes of these is left open, so that a slip which undoes a
    /// convention would explain them all.
    #[test]
    fn a_slip_does_not_undo_a_convention() {
        let exam = Exam::new("volume_render", Dtype::F32, None).unwrap();
        let question = exam.questions.iter().find(|q| q.kind == Kind::Forward).expect("it has one");
        let answer = |case: &Case| {
            let mut right = (question.component.forward.oracle)(&case.inputs, &CS180);
            if case.inputs.values().flatten().any(|x| x.is_infinite()) {
                right.values_mut().for_each(|array| array.fill(f64::NAN));
            }
            Some(given(right.into_iter().map(|(name, a)| (name, a.mapv(|x| Dtype::F32.round(x)))).collect()))
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: EXP_ULP };
        let said: Vec<_> = misdone(question, &answers, &CS180, &options)
            .iter()
            .filter_map(|e| e.slip.as_ref().map(Slip::says))
            .collect();
        assert!(said.is_empty(), "{said:?}");
    }

    /// Of every row with a formula: each question with its right answers' small cases.
    fn each_row(mut look: impl FnMut(&Question, &Direction, &[(&Case, &Answer)])) {
        for component in COMPONENTS {
            for question in &Exam::new(component.name, Dtype::F64, None).unwrap().questions {
                if !question.statistics() {
                    let direction = question.component.direction(question.kind).unwrap();
                    let right = |case: &Case| Some(given((direction.oracle)(&case.inputs, &CS180)));
                    let answers: Answers = question.cases.iter().map(right).collect();
                    look(question, direction, &small_cases(question, &answers));
                }
            }
        }
    }

    /// A fault whose site no formula comes by changes nothing.
    #[test]
    fn right_formulas_are_right() {
        let inert = machine(0, Fault::default());
        let arithmetic = Arithmetic::new(Dtype::F64, Grade::B);
        each_row(|question, direction, cases| {
            let inputs = &cases[0].0.inputs;
            Fault::begin(usize::MAX);
            let found = (direction.honest)(inputs, &CS180, &inert);
            let bound = tolerance(direction, inputs, &CS180, &arithmetic);
            let used = worst(&found, &(direction.oracle)(inputs, &CS180), &bound);
            assert!(used <= 1.0, "{} {:?}: {used}", question.component.name, question.kind);
        });
    }

    #[test]
    fn every_operation_can_be_tried_on_every_row() {
        let (mut tried, mut ended) = (0, 0);
        each_row(|question, _, cases| {
            let ways = |place: &Place| {
                let ways = How::all(place.seen.site.operation).into_iter().chain(place.seen.mixed_up());
                ways.map(|how| place.hypothesis(how, &CS180)).collect::<Vec<_>>()
            };
            let all = places(question, cases, &CS180, LOOKS);
            for h in all.iter().flat_map(ways).step_by(7 * one_in(8)) {
                // It may break a rule that only right formulas keep; it may not go on for ever.
                tried += 1;
                let end = attempt(|| h.prediction(question, cases[0].0));
                ended += usize::from(end.is_some());
            }
        });
        assert!(10 * ended > 9 * tried && one_in(8) * tried > 4000, "{ended} of {tried} came to an end");
    }
}
