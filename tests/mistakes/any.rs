//! The judge asks what several mistakes at once would answer, whatever they are: each of these must come to an end.

use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::case::Draw;
use nerf_oracle::convention::{CHOICES, CS180, Conventions};
use nerf_oracle::parallel;

use super::number;

/// Mistakes at once.
const AT_ONCE: usize = 4;

/// Inputs of more elements than this are left to others.
const SMALL: usize = 2_000;

#[test]
fn any_four_mistakes_at_once_give_an_answer() {
    let draws = number("NERF_ORACLE_ANY", 200);
    parallel::map(COMPONENTS.len(), |n| {
        let component = COMPONENTS[n];
        let cases = (component.cases)();
        let mut draw = Draw::new(component.name, 11);
        for _ in 0..draws {
            let mut names: Vec<&str> = vec![];
            for _ in 0..AT_ONCE.min(component.mistakes.len()) {
                names.push(component.mistakes[draw.below(component.mistakes.len() as u64) as usize].name);
            }
            let c = component.conventions.iter().fold(CS180, |c: Conventions, key| {
                let (_, values) = CHOICES.iter().find(|(name, _)| name == key).expect("known conventions");
                c.with(key, values[draw.below(values.len() as u64) as usize]).expect("a listed value")
            });
            let small = cases.iter().filter(|case| case.size() <= SMALL);
            for case in small.filter(|case| (component.special.admits)(&case.inputs, &c)) {
                (component.forward.wrong)(&case.inputs, &c, &names);
            }
        }
    });
}
