//! The training step against the components that it consists of.

use super::arrays::usual;
use super::chain::{chain, plainly};
use super::component::TRAINING_STEP;
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::check::{Kind, budget_used, tolerance};
use crate::contract::component::Component;
use crate::convention::{CHOICES, CS180};
use crate::optimizer::mistakes::ADAM_STEP;

/// In every convention, the step and the chain of rows agree bit for bit.
#[test]
fn a_step_is_its_rows_one_after_the_other() {
    for key in TRAINING_STEP.conventions {
        let (_, values) = CHOICES.iter().find(|(name, _)| name == key).expect("a convention");
        for value in *values {
            let c = CS180.with(key, value).expect("listed");
            let c = if *key == "last_delta" { c.with("delta", "differences").expect("listed") } else { c };
            let u = usual(&c);
            for case in TRAINING_STEP.cases_of(Kind::Forward, &c) {
                let trained = (TRAINING_STEP.forward.oracle)(&case.inputs, &c);
                let run = |kind: Kind, row: &Component, a: &Arrays| {
                    (row.direction(kind).expect("a direction").oracle)(a, &u)
                };
                let chained = chain(&case.inputs, &u, &run, &plainly);
                assert_eq!(trained, chained, "{key} {value} {}", case.id);
            }
        }
    }
}

/// Changing a convention that an output is declared not to depend on leaves its bits unchanged.
#[test]
fn an_output_reads_no_other_conventions() {
    let start = CS180.with("delta", "differences").expect("listed");
    let trained = |c: &crate::convention::Conventions| {
        let case = &TRAINING_STEP.cases_of(Kind::Forward, c)[0];
        (TRAINING_STEP.forward.oracle)(&case.inputs, c)
    };
    let here = trained(&start);
    for key in TRAINING_STEP.conventions {
        for value in CHOICES.iter().find(|(name, _)| name == key).expect("a convention").1 {
            let other = trained(&start.with(key, value).expect("listed"));
            for (output, _) in TRAINING_STEP.special.reads.iter().filter(|(_, keys)| !keys.contains(key)) {
                assert_eq!(here[*output], other[*output], "{output} reads {key} {value}");
            }
        }
    }
}

/// After ten steps, f64's bounds, which grow from step to step, still tell: most of what is remembered keeps eight digits.
#[test]
fn ten_steps_keep_their_digits() {
    let arithmetic = Arithmetic::new(Dtype::F64, Grade::B);
    let cases = TRAINING_STEP.cases_of(Kind::Forward, &CS180);
    for case in cases.iter().filter(|case| case.id.starts_with("ten_steps")) {
        let truth = (TRAINING_STEP.forward.oracle)(&case.inputs, &CS180);
        let bound = tolerance(&TRAINING_STEP.forward, &case.inputs, &CS180, &arithmetic);
        for (name, y) in &truth {
            let told = y.iter().zip(&bound[name]).filter(|(y, _)| **y != 0.0).map(|(y, b)| b / y.abs());
            let mut told: Vec<f64> = told.collect();
            told.sort_by(f64::total_cmp);
            let middle = told[told.len() / 2];
            println!("{} {name}: {:.1e}, in the middle {middle:.1e}", case.id, told[0]);
            assert!(middle < 1e-8, "{} {name}: {middle:.1e}", case.id);
        }
    }
}

/// Samples are taken before anything is learned.
#[test]
fn no_mistake_reaches_what_is_declared_untouched() {
    for mistake in TRAINING_STEP.mistakes {
        for case in TRAINING_STEP.cases_of(Kind::Forward, &CS180) {
            let right = (TRAINING_STEP.forward.oracle)(&case.inputs, &CS180);
            let wrong = (TRAINING_STEP.forward.wrong)(&case.inputs, &CS180, &[mistake.name]);
            for name in TRAINING_STEP.special.untouched {
                assert_eq!(right[*name], wrong[*name], "{} reaches {name} of {}", mistake.name, case.id);
            }
        }
    }
}

/// The row doesn't list what an optimizer may do wrong, and passes none of it.
#[test]
fn no_optimizer_that_is_wrong_stays_within_the_bounds() {
    let cases = TRAINING_STEP.cases_of(Kind::Forward, &CS180);
    // Gradients of these cases are far below 1.
    let shown = ADAM_STEP.iter().filter(|m| m.name != "gradient_clipped_first");
    for (mistake, dtype) in shown.flat_map(|m| [(m, Dtype::F64), (m, Dtype::F32)]) {
        let run = |kind: Kind, row: &Component, a: &Arrays| {
            let direction = row.direction(kind).expect("a direction");
            match row.name {
                "adam_step" => (direction.wrong)(a, &CS180, &[mistake.name]),
                _ => (direction.oracle)(a, &CS180),
            }
        };
        let arithmetic = Arithmetic::new(dtype, Grade::B);
        let largest = cases.iter().filter(|case| case.exists_in(dtype)).flat_map(|case| {
            let wrong = chain(&case.inputs, &CS180, &run, &plainly);
            let right = (TRAINING_STEP.forward.oracle)(&case.inputs, &CS180);
            let bound = tolerance(&TRAINING_STEP.forward, &case.inputs, &CS180, &arithmetic);
            let of = |(name, y): (&String, &ndarray::ArrayD<f64>)| {
                let each = wrong[name].iter().zip(y).zip(&bound[name]);
                each.map(|((&got, &y), &bound)| budget_used(got, y, bound)).fold(0.0, f64::max)
            };
            right.iter().map(of).collect::<Vec<_>>()
        });
        let largest = largest.fold(0.0, f64::max);
        assert!(largest > 100.0, "{} in {dtype}: {largest:.1e} of its bound", mistake.name);
    }
}
