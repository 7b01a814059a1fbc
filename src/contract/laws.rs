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

/// What keeps a number off 0 that is divided by, or whose logarithm is taken.
#[derive(Clone, Copy, Debug)]
pub enum Guard {
    /// x.
    Nothing,
    /// x + eps.
    Plus(f64),
    /// max(x, eps).
    AtLeast(f64),
    /// sqrt(x^2 + eps).
    UnderRoot(f64),
}

impl Guard {
    /// What stands for the number.
    pub fn of(self, x: f64) -> f64 {
        match self {
            Guard::Nothing => x,
            Guard::Plus(eps) => x + eps,
            Guard::AtLeast(eps) => x.max(eps),
            Guard::UnderRoot(eps) => (x * x + eps).sqrt(),
        }
    }

    /// The same as one would write it.
    pub fn said(self, x: &str) -> String {
        match self {
            Guard::Nothing => x.into(),
            Guard::Plus(eps) => format!("{x} + {}", as_written(eps)),
            Guard::AtLeast(eps) => format!("max({x}, {})", as_written(eps)),
            Guard::UnderRoot(eps) => format!("sqrt({x}^2 + {})", as_written(eps)),
        }
    }
}

/// A threshold as one writes it.
pub fn as_written(x: f64) -> String {
    if x < 0.01 { format!("{x:e}") } else { x.to_string() }
}

impl Laws {
    /// The first `most` of the formulas that differ from the right one in so many of the parts that may. Those whose wrong parts come last come
    /// first.
    pub fn differing(&self, parts: usize, may: impl Fn(usize) -> bool, most: usize) -> Vec<Vec<usize>> {
        let may: Vec<bool> = (0..self.choices.len()).map(may).collect();
        let mut all = vec![];
        self.longer(&[], parts, &may, most, &mut all);
        all
    }

    /// Those that begin with these choices, and differ in so many more parts.
    fn longer(&self, law: &[usize], parts: usize, may: &[bool], most: usize, all: &mut Vec<Vec<usize>>) {
        let Some(choices) = self.choices.get(law.len()) else { return all.push(law.to_vec()) };
        let left = may[law.len() + 1..].iter().filter(|may| **may).count();
        for choice in 0..if may[law.len()] { *choices } else { 1 } {
            let wrong = usize::from(choice > 0);
            if all.len() < most && wrong <= parts && parts - wrong <= left {
                self.longer(&[law, &[choice]].concat(), parts - wrong, may, most, all);
            }
        }
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
    fn a_guard_does_what_it_says() {
        let all = [Guard::Nothing, Guard::Plus(1e-8), Guard::AtLeast(0.5), Guard::UnderRoot(9.0)];
        assert_eq!(all.map(|guard| guard.of(4.0)), [4.0, 4.0 + 1e-8, 4.0, 5.0]);
        assert_eq!(all.map(|guard| guard.of(0.0)), [0.0, 1e-8, 0.5, 3.0]);
        assert_eq!(
            all.map(|guard| guard.said("|w|")),
            ["|w|", "|w| + 1e-8", "max(|w|, 0.5)", "sqrt(|w|^2 + 9)"]
        );
    }

    #[test]
    fn each_formula_comes_once() {
        let all = |parts| THREE.differing(parts, |_| true, 9);
        assert_eq!(all(0), [[0, 0, 0]]);
        assert_eq!(all(1), [[0, 0, 1], [1, 0, 0], [2, 0, 0]]);
        assert_eq!(all(2), [[1, 0, 1], [2, 0, 1]]);
        assert_eq!(all(3), Vec::<Vec<usize>>::new());
        assert_eq!(THREE.differing(1, |_| true, 2), [[0, 0, 1], [1, 0, 0]]);
        let but_for_the_last = |parts| THREE.differing(parts, |part| part < 2, 9);
        assert_eq!(but_for_the_last(1), [[1, 0, 0], [2, 0, 0]]);
        assert_eq!(but_for_the_last(2), Vec::<Vec<usize>>::new());
        assert!(THREE.rounds(&[2, 0, 1]) && !THREE.rounds(&[1, 0, 1]));
        assert_eq!(THREE.said(&[2, 0, 1]), "0 is 2, and 2 is 1");
    }
}
