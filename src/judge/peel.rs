//! Peeling: faults of one output after another. Two that meet in no output, and three or four at once, are found one by one, and where
//! one can't be, those found before it stand.

use super::answer::{Answer, Answers};
use super::assignment::{apply, assignments, partial, possible};
use super::diagnose::{Explanation, difference, explains_all, largest_residual, shows};
use super::exam::Question;
use super::hypothesis::Hypothesis;
use super::mark::MarkOptions;
use crate::contract::check::Kind;
use crate::convention::Conventions;
use crate::parallel;

/// The largest number of mistakes.
const MISTAKES: usize = 4;

/// The largest number of assignments of conventions to begin with, and of layers that are kept when a mistake is added.
const KEPT: [usize; 2] = [120, 12];

/// Conventions, and the mistakes found so far. An output may show all of them, in this order, or some: one grid of pixels is returned and
/// another made into rays.
#[derive(Clone, Debug, PartialEq)]
struct Layer {
    conventions: Conventions,
    mistakes: Vec<&'static str>,
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

impl Peeling<'_> {
    fn run(&self) -> Option<Explanation> {
        let answered = |name: &&str| self.answers.iter().flatten().any(|answer| answer.contains_key(*name));
        let mut outputs: Vec<&str> =
            self.question.component.outputs.iter().map(|port| port.name).filter(answered).collect();
        let begin = |conventions| Layer { conventions, mistakes: vec![] };
        let mut layers: Vec<Layer> = self.conventions(&outputs).into_iter().map(begin).collect();
        let mut explained = vec![];
        loop {
            self.take(&mut outputs, &mut layers, &mut explained);
            if outputs.is_empty() || layers[0].mistakes.len() == MISTAKES {
                break;
            }
            let grown = outputs.iter().map(|name| self.grow(&layers, name)).find(|grown| !grown.is_empty());
            let Some(grown) = grown else { break };
            layers = grown;
        }
        self.explanation(&layers[0], &explained, &outputs)
    }

    /// The conventions to begin with: those that the outputs show which are right in some.
    fn conventions(&self, outputs: &[&str]) -> Vec<Conventions> {
        let mut all = assignments(self.question.component, self.base);
        all.retain(|p| self.question.admits(&apply(p, self.base)));
        for name in outputs {
            let right = possible(self.question, &self.alone(name), all.clone(), self.base, self.options);
            if !right.is_empty() {
                all = right;
            }
        }
        all.truncate(KEPT[0]);
        all.iter().map(|p| apply(p, self.base)).collect()
    }

    /// Moves outputs that some layers explain to `explained`, and keeps those layers.
    fn take<'n>(&self, outputs: &mut Vec<&'n str>, layers: &mut Vec<Layer>, explained: &mut Vec<&'n str>) {
        while let Some((n, kept)) = outputs
            .iter()
            .enumerate()
            .map(|(n, name)| (n, self.explaining(layers, name)))
            .find(|(_, kept)| !kept.is_empty())
        {
            explained.push(outputs.remove(n));
            *layers = kept;
        }
    }

    /// The layers that explain this output.
    fn explaining(&self, layers: &[Layer], name: &str) -> Vec<Layer> {
        let alone = self.alone(name);
        let fits = parallel::map(layers.len(), |n| self.subset(&layers[n], &alone).is_some());
        layers.iter().zip(fits).filter(|(_, fits)| *fits).map(|(layer, _)| layer.clone()).collect()
    }

    /// Layers with one mistake more, before or after those that they have, that explain this output.
    fn grow(&self, layers: &[Layer], name: &str) -> Vec<Layer> {
        let names: Vec<&str> =
            self.question.component.mistakes.iter().filter(|m| !m.gradient).map(|m| m.name).collect();
        let mut grown = vec![];
        for layer in layers.iter().take(KEPT[1]) {
            for name in names.iter().filter(|name| !layer.mistakes.contains(*name)) {
                let with = |at: usize| {
                    let mut layer = layer.clone();
                    layer.mistakes.insert(at, *name);
                    layer
                };
                grown.push(with(layer.mistakes.len()));
                grown.extend((!layer.mistakes.is_empty()).then(|| with(0)));
            }
        }
        let mut grown = self.explaining(&grown, name);
        // What is seen most often first, in the nearest conventions.
        let seen = |layer: &Layer| {
            let count = |name: &&str| {
                self.question.component.mistakes.iter().find(|m| m.name == *name).map_or(0, |m| m.count)
            };
            std::cmp::Reverse(layer.mistakes.iter().map(count).sum::<u32>())
        };
        grown.sort_by_key(seen);
        grown.truncate(KEPT[1]);
        grown
    }

    /// Those of a layer's mistakes that explain these answers, as few as do.
    fn subset(&self, layer: &Layer, answers: &Answers) -> Option<Hypothesis> {
        let count = layer.mistakes.len();
        let mut sets: Vec<u32> = (0..1 << count).collect();
        sets.sort_by_key(|set| set.count_ones());
        let hypothesis = |set: u32| {
            let mistakes = (0..count).filter(|n| set >> n & 1 == 1).map(|n| layer.mistakes[n]).collect();
            Hypothesis { mistakes, conventions: layer.conventions, loose: false }
        };
        let fits = |h: &Hypothesis| {
            explains_all(h, self.question, answers, self.options)
                && shows(h, self.question, answers, self.options)
        };
        sets.into_iter().map(hypothesis).find(fits)
    }

    /// Answers with this output alone.
    fn alone(&self, name: &str) -> Answers {
        let one = |answer: &Answer| answer.get(name).map(|given| [(name.to_string(), given.clone())].into());
        self.answers.iter().map(|answer| answer.as_ref().and_then(one)).collect()
    }

    /// What a layer says, where it says anything.
    fn explanation(&self, layer: &Layer, explained: &[&str], unexplained: &[&str]) -> Option<Explanation> {
        let found: Vec<(Hypothesis, Answers)> = explained
            .iter()
            .map(|name| self.alone(name))
            .filter_map(|alone| Some((self.subset(layer, &alone)?, alone)))
            .collect();
        let shown = |m: &&str| found.iter().any(|(h, _)| h.mistakes.contains(m));
        let names: Vec<&str> = layer.mistakes.iter().copied().filter(|name| shown(&name)).collect();
        let all = self.question.component.mistakes;
        let mistakes: Vec<_> = names.iter().filter_map(|name| all.iter().find(|m| m.name == *name)).collect();
        let residuals =
            found.iter().map(|(h, alone)| largest_residual(h, self.question, alone, self.options));
        let own = |c: &Conventions| partial(self.question.component, c);
        (!mistakes.is_empty()).then(|| Explanation {
            mistakes,
            conventions: difference(&own(&layer.conventions), &own(self.base)),
            residual: residuals.fold(0.0, f64::max),
            same_as_best: false,
            inaccurate: false,
            unexplained: unexplained.iter().map(|name| name.to_string()).collect(),
        })
    }
}
