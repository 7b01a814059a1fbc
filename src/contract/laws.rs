//! Laws: the formulas that people write in a row's place, right and wrong ones, as choices of the parts that they are made of.

use super::arrays::Arrays;
use crate::convention::Conventions;

/// A family of formulas: each has one choice of every part, and the first choice of a part is the right one.
#[derive(Clone, Copy, Debug)]
pub struct Laws {
    /// How many choices each part has.
    pub choices: &'static [usize],
    /// What a choice of a part is, as one would write it: `C = sum_i w_i c_i / N`. Of the right ones nothing is said.
    pub says: fn(part: usize, choice: usize) -> String,
    /// The outputs, or the gradients, with these choices.
    pub of: fn(&Arrays, &Conventions, &[usize]) -> Arrays,
    /// The choices, each after its part, that round to whole numbers.
    pub rounding: &'static [(usize, usize)],
}

impl Laws {
    /// The formulas that differ from the right one in so many parts of those that may.
    pub fn differing(&self, parts: usize, may: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
        let mut all: Vec<(usize, Vec<usize>)> = vec![(0, vec![])];
        for (n, choices) in self.choices.iter().enumerate() {
            let left = (n + 1..self.choices.len()).filter(|other| may(*other)).count();
            let choices = if may(n) { *choices } else { 1 };
            let longer = |(had, law): (usize, Vec<usize>)| {
                let next = (0..choices).map(move |c| (had + usize::from(c > 0), [&law[..], &[c]].concat()));
                next.filter(move |(had, _)| *had <= parts && had + left >= parts)
            };
            all = all.into_iter().flat_map(longer).collect();
        }
        all.into_iter().map(|(_, law)| law).collect()
    }

    /// Whether a formula rounds to whole numbers where the right one doesn't.
    pub fn rounds(&self, law: &[usize]) -> bool {
        self.rounding.iter().any(|(part, choice)| law[*part] == *choice)
    }

    /// What is said of a formula: what its wrong parts are.
    pub fn said(&self, law: &[usize]) -> String {
        let wrong = law.iter().enumerate().filter(|(_, choice)| **choice > 0);
        wrong.map(|(part, choice)| (self.says)(part, *choice)).collect::<Vec<_>>().join(", and ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THREE: Laws = Laws {
        choices: &[3, 1, 2],
        says: |part, choice| format!("{part} is {choice}"),
        of: |a, _, _| a.clone(),
        rounding: &[(0, 2)],
    };

    #[test]
    fn each_formula_comes_once() {
        let all = |parts| THREE.differing(parts, |_| true);
        assert_eq!(all(0), [[0, 0, 0]]);
        assert_eq!(all(1), [[0, 0, 1], [1, 0, 0], [2, 0, 0]]);
        assert_eq!(all(2), [[1, 0, 1], [2, 0, 1]]);
        assert_eq!(all(3), Vec::<Vec<usize>>::new());
        let but_for_the_last = |parts| THREE.differing(parts, |part| part < 2);
        assert_eq!(but_for_the_last(1), [[1, 0, 0], [2, 0, 0]]);
        assert_eq!(but_for_the_last(2), Vec::<Vec<usize>>::new());
        assert!(THREE.rounds(&[2, 0, 1]) && !THREE.rounds(&[1, 0, 1]));
        assert_eq!(THREE.said(&[2, 0, 1]), "0 is 2, and 2 is 1");
    }
}
