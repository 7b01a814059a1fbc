//! The judge asks what several mistakes at once would answer, whatever they are: each of these must come to an end.

use nerf_oracle::contract::case::Draw;
use nerf_oracle::contract::{Component, Dtype};
use nerf_oracle::convention::{CHOICES, CS180, Conventions};
use nerf_oracle::judge::Exam;
use nerf_oracle::{COMPONENTS, parallel};

use super::number;

/// Mistakes at once.
const AT_ONCE: usize = 4;

/// Inputs of more elements than this are left to others.
const SMALL: usize = 2_000;

/// A mistake's name, where it has a number with any that it may have.
fn named(component: &Component, draw: &mut Draw) -> String {
    let mistake = component.mistakes[draw.below(component.mistakes.len() as u64) as usize];
    let Some(number) = mistake.number else { return mistake.name.into() };
    let all: Vec<f64> = number.range.iter().chain(number.listed).copied().collect();
    match draw.below(all.len() as u64 + 1) as usize {
        0 => mistake.name.into(),
        n => format!("{}={}", mistake.name, all[n - 1]),
    }
}

#[test]
fn any_four_mistakes_at_once_give_an_answer() {
    let draws = number("NERF_ORACLE_ANY", 100);
    parallel::map(COMPONENTS.len(), |n| {
        let component = COMPONENTS[n];
        let mut draw = Draw::new(component.name, 11);
        for question in Exam::new(component.name, Dtype::F64, None).expect("a row").questions {
            let direction =
                question.component.direction(question.kind).expect("a question has its direction");
            for _ in 0..draws {
                let names: Vec<String> = (0..AT_ONCE).map(|_| named(question.component, &mut draw)).collect();
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                let c = question.component.conventions.iter().fold(CS180, |c: Conventions, key| {
                    let (_, values) =
                        CHOICES.iter().find(|(name, _)| name == key).expect("known conventions");
                    let value = values[draw.below(values.len() as u64) as usize];
                    c.with(key, value).expect("a listed value")
                });
                let small = question.cases.iter().filter(|case| case.size() <= SMALL);
                for case in small.filter(|case| (question.component.special.admits)(&case.inputs, &c)) {
                    (direction.wrong)(&case.inputs, &c, &names);
                }
            }
        }
    });
}
