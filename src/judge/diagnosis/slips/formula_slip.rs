//! A formula with some operations done in another way: what honest code with a fault in it gives, and how that is said.

use super::infix;
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::component::Honest;
use crate::contract::fault::{Fault, Nth, Wrong};
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// A formula with some operations done in another way.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FormulaSlip {
    /// Number of the machine whose way to the result it is.
    pub machine: u64,
    /// What is done where.
    pub fault: Fault,
    /// What it may cost: more is without end.
    pub operations: usize,
    /// Whether it is one of the forward function, also where a gradient is asked for.
    pub forward: bool,
}

impl FormulaSlip {
    /// What comes out.
    pub(crate) fn of(&self, inputs: &Arrays, c: &Conventions, honest: Honest) -> Arrays {
        Fault::begin(self.operations);
        honest(inputs, c, &machine(self.machine, self.fault))
    }

    /// The same with one operation less, each of several.
    pub(crate) fn without_each(&self) -> Vec<FormulaSlip> {
        let all: Vec<Wrong> = self.fault.all().copied().collect();
        let others = |n: usize| all.iter().enumerate().filter(move |(k, _)| *k != n).map(|(_, wrong)| *wrong);
        let less = |n: usize| FormulaSlip { fault: Fault::of(others(n)), ..self.clone() };
        (0..all.len()).filter(|_| all.len() > 1).map(less).collect()
    }

    /// What it says, on a line.
    pub(crate) fn says(&self) -> String {
        let one = |wrong: &Wrong| {
            let each = infix::says(&wrong.site, wrong.how);
            wrong.nth.map_or(each.clone(), |Nth { index, of }| {
                format!("{each}, at time {} of {of} for each point alone", index + 1)
            })
        };
        let mut all: Vec<String> = self.fault.all().map(one).collect();
        // In whichever order they were found.
        all.sort();
        all.join(", and ")
    }
}

/// A machine with a fault.
pub(super) fn machine(n: u64, fault: Fault) -> Machine {
    Machine { fault: Some(fault), ..Machine::number(Dtype::F64, n) }
}
