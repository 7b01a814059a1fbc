//! The numbers in a hypothesis' mistakes.

use super::super::exam::Question;
use super::hypothesis::Hypothesis;
use super::slips::each::rounded;
use crate::contract::component::Number;

impl Hypothesis {
    /// The same with this number in its first mistake that has one.
    pub(crate) fn with_number(&self, x: f64) -> Hypothesis {
        let others = self.fitted.iter().skip(1).copied();
        Hypothesis { fitted: std::iter::once(x).chain(others).collect(), ..self.clone() }
    }

    /// Whether its numbers are such as people write.
    pub(crate) fn plain_numbers(&self) -> bool {
        self.fitted.iter().all(|x| rounded(*x)[0] == *x)
    }

    /// What is made of the names of some of its mistakes, the fitted numbers with those that have one (`Mistake::among`).
    pub(super) fn named<T>(
        &self,
        question: &Question,
        some: &[&'static str],
        made: impl FnOnce(&[&str]) -> T,
    ) -> T {
        if self.fitted.is_empty() {
            return made(some);
        }
        let mut numbers = self.fitted.iter();
        let say = |name: &&'static str| match number_of(question, name).and_then(|_| numbers.next()) {
            Some(number) => format!("{name}={number}"),
            None => name.to_string(),
        };
        let all: Vec<String> = self.mistakes.iter().map(say).collect();
        let kept = self.mistakes.iter().zip(&all).filter(|(name, _)| some.contains(name));
        made(&kept.map(|(_, said)| said.as_str()).collect::<Vec<_>>())
    }
}

/// The number of a row's mistake, if it has one.
pub(crate) fn number_of(question: &Question, name: &str) -> Option<Number> {
    question.component.mistakes.iter().find(|m| m.name == name).and_then(|m| m.number)
}
