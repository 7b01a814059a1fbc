//! Peeling: faults of one output after another. Two that meet in no output, and three or four at once, are found one by one, and where
//! one can't be, those found before it stand.

use super::super::answer::{Answer, Answers};
use super::super::assignment::{open, possible, small_cases};
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::{apply, partial};
use super::evidence::{Explanation, difference, explains_all, largest_residual, shows};
use super::fitted::with_its_number;
use super::hypothesis::Hypothesis;
use super::nearness::likeliest;
use crate::contract::check::Kind;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::parallel;

/// The largest number of mistakes.
const MISTAKES: usize = 4;

/// The largest number of assignments of conventions to begin with, and of layers that are kept when a mistake is added.
const KEPT: [usize; 2] = [240, 48];

/// Conventions, and the mistakes found so far. An output may show all of them, in this order, or some: one grid of pixels is returned and
/// another made into rays.
#[derive(Clone, Debug, PartialEq)]
struct Layer<'a> {
    conventions: Conventions,
    mistakes: Vec<&'static str>,
    /// The outputs that it explains, and by which of its mistakes.
    explained: Vec<(&'a str, Hypothesis)>,
}

impl Layer<'_> {
    fn explains(&self, name: &str) -> bool {
        self.explained.iter().any(|(known, _)| *known == name)
    }
}

/// What is known of the search.
struct Peeling<'a> {
    question: &'a Question,
    answers: &'a Answers,
    base: &'a Conventions,
    options: &'a MarkOptions,
}

/// The explanation that is found output by output; `None` where no output that is wrong can be explained.
pub(crate) fn peel(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<Explanation> {
    // Numeric gradients of so many sets would take minutes.
    if question.kind != Kind::Forward || question.component.outputs.len() < 2 {
        return None;
    }
    Peeling { question, answers, base, options }.run()
}

/// What is known, with one mistake more in outputs that it leaves, whose number they show.
pub(crate) fn with_numbers(
    known: Explanation,
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Explanation {
    Peeling { question, answers, base, options }.with_numbers(known)
}

impl<'a> Peeling<'a> {
    fn with_numbers(&self, mut known: Explanation) -> Explanation {
        let c = apply(&known.conventions, self.base);
        let mut left = std::collections::VecDeque::from(std::mem::take(&mut known.unexplained));
        while let Some(output) = left.pop_front() {
            match self.one_more(&known, c, &output) {
                Some((mistake, numbers)) => {
                    // What was known before is all that the others show that are explained.
                    let open = |name: &str| left.iter().chain(&known.unexplained).any(|open| open == name);
                    let told = |name: &str| known.apart.iter().any(|(known, _)| known == name);
                    let others = self.answered().into_iter().filter(|name| *name != output);
                    let before: Vec<_> = known.mistakes.iter().map(|m| m.name).collect();
                    let apart = others.filter(|name| !open(name) && !told(name));
                    let apart: Vec<_> = apart.map(|name| (name.to_string(), before.clone())).collect();
                    known.apart.extend(apart);
                    known.mistakes.insert(0, mistake);
                    known.fitted = numbers;
                }
                None => known.unexplained.push(output),
            }
        }
        known
    }

    /// A mistake that explains one output beside what is known of the others, with its number.
    fn one_more(
        &self,
        known: &Explanation,
        c: Conventions,
        output: &str,
    ) -> Option<(&'static Mistake, Vec<f64>)> {
        let alone = self.alone(output);
        let fits = |h: &Hypothesis| {
            explains_all(h, self.question, &alone, self.options)
                && shows(h, self.question, &alone, self.options)
        };
        let all = self.question.component.mistakes.iter();
        let others = all.filter(|m| !m.gradient && m.number.is_some() && !known.mistakes.contains(m));
        let with = |m: &Mistake| {
            let mistakes = std::iter::once(m.name).chain(known.mistakes.iter().map(|m| m.name)).collect();
            let own = m.number.filter(|_| !known.fitted.is_empty()).map(|number| number.usual);
            let fitted = own.into_iter().chain(known.fitted.iter().copied()).collect();
            let usual = Hypothesis { fitted, ..Hypothesis::new(mistakes, c) };
            with_its_number(m, &usual, self.question, &alone, fits)
        };
        let mut found = others.filter_map(|m| with(m).map(|h| (m, h.fitted)));
        found.next()
    }

    /// The outputs that are answered anywhere.
    fn answered(&self) -> Vec<&'a str> {
        let answered = |name: &&str| self.answers.iter().flatten().any(|answer| answer.contains_key(*name));
        self.question.component.outputs.iter().map(|port| port.name).filter(answered).collect()
    }

    fn run(&self) -> Option<Explanation> {
        let mut outputs = self.answered();
        let conventions = self.conventions(&outputs);
        let mut layers = parallel::map(conventions.len(), |n| {
            let right = Layer { conventions: conventions[n], mistakes: vec![], explained: vec![] };
            self.explaining(right, &outputs)
        });
        loop {
            // What some layers explain is settled by them.
            while let Some(n) =
                outputs.iter().position(|name| layers.iter().any(|layer| layer.explains(name)))
            {
                layers.retain(|layer| layer.explains(outputs[n]));
                outputs.remove(n);
            }
            if outputs.is_empty() || layers[0].mistakes.len() == MISTAKES {
                break;
            }
            let grown = self.grow(&layers, &outputs);
            let Some(name) = outputs.iter().find(|name| grown.iter().any(|layer| layer.explains(name)))
            else {
                break;
            };
            layers = self.likeliest(grown, name);
        }
        // Mistakes that explain all outputs together come before those of which each explains its own.
        let together = |layer: &&Layer| self.all_of(layer, &outputs).is_some();
        let best = layers.iter().find(together).unwrap_or(&layers[0]);
        self.explanation(best, &outputs)
    }

    /// All mistakes of a layer at once, where they explain every output.
    fn all_of(&self, layer: &Layer, unexplained: &[&str]) -> Option<Hypothesis> {
        let all = Hypothesis::new(layer.mistakes.clone(), layer.conventions);
        let fits = unexplained.is_empty() && explains_all(&all, self.question, self.answers, self.options);
        fits.then_some(all)
    }

    /// The conventions to begin with: those that the outputs show which are right in some.
    fn conventions(&self, outputs: &[&str]) -> Vec<Conventions> {
        let mut all = open(self.question, self.answers, self.base, self.options);
        for name in outputs {
            let right = possible(self.question, &self.alone(name), all.clone(), self.base, self.options);
            if !right.is_empty() {
                all = right;
            }
        }
        let all = likeliest(all, KEPT[0], (self.question, self.answers), self.base, self.options);
        all.iter().map(|p| apply(p, self.base)).collect()
    }

    /// A layer with what its latest mistake, and any of the others with it, explains of these outputs.
    fn explaining(&self, mut layer: Layer<'a>, outputs: &[&'a str]) -> Layer<'a> {
        let count = layer.mistakes.len();
        let mut sets: Vec<u32> = (0..1 << count).filter(|set| count == 0 || set & 1 == 1).collect();
        sets.sort_by_key(|set| set.count_ones());
        for set in sets {
            let mistakes = (0..count).filter(|n| set >> n & 1 == 1).map(|n| layer.mistakes[n]).collect();
            let h = Hypothesis::new(mistakes, layer.conventions);
            let mut left: Vec<&str> = outputs.iter().copied().filter(|name| !layer.explains(name)).collect();
            for (case, answer) in small_cases(self.question, self.answers) {
                if !left.is_empty() {
                    h.keep_explained(self.question, case, answer, self.options, &mut left);
                }
            }
            left.retain(|name| shows(&h, self.question, &self.alone(name), self.options));
            layer.explained.extend(left.into_iter().map(|name| (name, h.clone())));
        }
        layer
    }

    /// Layers with one mistake more.
    fn grow(&self, layers: &[Layer<'a>], outputs: &[&'a str]) -> Vec<Layer<'a>> {
        let all = self.question.component.mistakes.iter().filter(|m| !m.gradient);
        let mut grown = vec![];
        for name in all.map(|m| m.name) {
            for layer in layers.iter().take(KEPT[1]).filter(|layer| !layer.mistakes.contains(&name)) {
                let mut layer = layer.clone();
                layer.mistakes.insert(0, name);
                grown.push(layer);
            }
        }
        parallel::map(grown.len(), |n| self.explaining(grown[n].clone(), outputs))
    }

    /// Those that explain this output, what is seen most often first.
    fn likeliest(&self, mut layers: Vec<Layer<'a>>, name: &str) -> Vec<Layer<'a>> {
        layers.retain(|layer| layer.explains(name));
        let all = self.question.component.mistakes;
        let count = |name: &&str| all.iter().find(|m| m.name == *name).map_or(0, |m| m.count);
        layers.sort_by_key(|layer| std::cmp::Reverse(layer.mistakes.iter().map(count).sum::<u32>()));
        layers.truncate(KEPT[1]);
        layers
    }

    /// Answers with this output alone.
    fn alone(&self, name: &str) -> Answers {
        let one = |answer: &Answer| answer.get(name).map(|given| [(name.to_string(), given.clone())].into());
        self.answers.iter().map(|answer| answer.as_ref().and_then(one)).collect()
    }

    /// What a layer says, where it says anything.
    fn explanation(&self, layer: &Layer, unexplained: &[&str]) -> Option<Explanation> {
        let all = self.question.component.mistakes;
        let shown = |m: &&Mistake| layer.explained.iter().any(|(_, h)| h.mistakes.contains(&m.name));
        let mistakes: Vec<_> = all.iter().filter(shown).collect();
        let residuals = layer
            .explained
            .iter()
            .map(|(name, h)| largest_residual(h, self.question, &self.alone(name), self.options));
        let own = |c: &Conventions| partial(self.question.component, c);
        let together = self.all_of(layer, unexplained);
        let some =
            layer.explained.iter().filter(|(_, h)| together.is_none() && h.mistakes.len() < mistakes.len());
        let apart = some.map(|(name, h)| (name.to_string(), h.mistakes.clone())).collect();
        let found = (!mistakes.is_empty()).then(|| Explanation {
            mistakes,
            conventions: difference(&own(&layer.conventions), &own(self.base)),
            residual: match together {
                Some(all) => largest_residual(&all, self.question, self.answers, self.options),
                None => residuals.fold(0.0, f64::max),
            },
            apart,
            unexplained: unexplained.iter().map(|name| name.to_string()).collect(),
            spared: self.spared(layer),
            ..Explanation::default()
        });
        // What nobody reads where a box is missed isn't explained by whatever misses all of them.
        found.filter(|found| found.residual <= 1.0)
    }

    /// Outputs that are right without any mistake, and wouldn't be with what was found of others.
    fn spared(&self, layer: &Layer) -> Vec<String> {
        let all = Hypothesis::new(layer.mistakes.clone(), layer.conventions);
        let changed = |name: &str| {
            let mut left = vec![name];
            for (case, answer) in small_cases(self.question, self.answers) {
                all.keep_explained(self.question, case, answer, self.options, &mut left);
            }
            left.is_empty()
        };
        let right = layer.explained.iter().filter(|(_, h)| h.right());
        right.filter(|(name, _)| changed(name)).map(|(name, _)| name.to_string()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::case::Case;
    use crate::convention::CS180;

    /// What a row answers with these mistakes.
    fn wrong(question: &Question, case: &Case, mistakes: &[&str]) -> Answer {
        given((question.component.forward.wrong)(&case.inputs, &CS180, mistakes))
    }

    const THREE: [&str; 3] = ["row_column_swapped", "delta_missing", "divided_by_opacity"];

    /// What is found in a trace with three mistakes whose outputs have been through `change`.
    fn found(change: impl Fn(&mut Answer)) -> Explanation {
        let exam = Exam::new("render_trace", Dtype::F64, None).unwrap();
        let question = &exam.questions[0];
        let answer = |case: &Case| {
            let mut answer = wrong(question, case, &THREE);
            change(&mut answer);
            Some(answer)
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let options = MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 };
        peel(question, &answers, &CS180, &options).unwrap()
    }

    fn sorted(e: &Explanation) -> Vec<&str> {
        let mut names: Vec<_> = e.mistakes.iter().map(|m| m.name).collect();
        names.sort_unstable();
        names
    }

    #[test]
    fn three_mistakes_at_once_are_found_one_after_another() {
        let all = found(|_| ());
        let mut three = THREE;
        three.sort_unstable();
        assert_eq!((sorted(&all), all.unexplained.len()), (three.to_vec(), 0));
    }

    #[test]
    fn what_is_found_stands_where_another_output_is_beyond_it() {
        let part = found(|answer| {
            answer.get_mut("weights").unwrap().values.mapv_inplace(|w| (10.0 * w).sin());
        });
        assert_eq!(part.unexplained, ["weights"]);
        assert!(sorted(&part).contains(&"row_column_swapped"), "{:?}", sorted(&part));
    }

    /// Weights that are handed on divided by their sum and 1e-7, and aren't composited like that.
    #[test]
    fn what_one_output_shows_besides_has_its_number() {
        let exam = Exam::new("volume_render", Dtype::F64, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 });
        let answer = |case: &Case| {
            let wrong = |names: &[&str]| wrong(question, case, names);
            let mut answer = wrong(&["inclusive_transmittance"]);
            let divided = wrong(&["inclusive_transmittance", "weights_normalized=1e-7"]);
            answer.insert("weights".into(), divided["weights"].clone());
            Some(answer)
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let e = peel(question, &answers, &CS180, &options).unwrap();
        assert_eq!(e.unexplained, ["weights"]);
        let e = with_numbers(e, question, &answers, &CS180, &options);
        assert_eq!(
            (sorted(&e), e.fitted.clone()),
            (vec!["inclusive_transmittance", "weights_normalized"], vec![1e-7])
        );
        assert!(e.unexplained.is_empty());
    }

    /// Nothing is said of an output that nothing explains.
    #[test]
    fn what_is_unexplained_shows_no_mistakes() {
        let exam = Exam::new("volume_render", Dtype::F64, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 });
        let answer = |case: &Case| {
            let mut answer = wrong(question, case, &["inclusive_transmittance"]);
            let divided = wrong(question, case, &["inclusive_transmittance", "weights_normalized=1e-7"]);
            answer.insert("weights".into(), divided["weights"].clone());
            answer.get_mut("opacity").expect("an output").values += 0.37;
            Some(answer)
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let e = peel(question, &answers, &CS180, &options).unwrap();
        let e = with_numbers(e, question, &answers, &CS180, &options);
        let apart: Vec<_> = e.apart.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(e.unexplained, ["opacity"]);
        assert!(apart.contains(&"colors") && !apart.contains(&"opacity"), "{apart:?}");
    }

    /// The second moment alone as AdamW has it: the first shows that the decay isn't decoupled.
    #[test]
    fn outputs_are_told_that_are_right_and_would_be_changed() {
        let exam = Exam::new("adam_step", Dtype::F64, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 });
        let answer = |case: &Case| {
            let wrong = |names: &[&str]| wrong(question, case, names);
            let (mut answer, decoupled) = (wrong(&[]), wrong(&["decoupled_decay"]));
            answer.insert("v_out".into(), decoupled["v_out"].clone());
            Some(answer)
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let e = peel(question, &answers, &CS180, &options).unwrap();
        assert_eq!((sorted(&e), e.unexplained.len()), (vec!["decoupled_decay"], 0));
        assert!(e.spared.contains(&"m_out".to_string()), "{:?}", e.spared);
    }
}
