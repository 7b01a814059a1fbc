//! The check that comes first: a variant's results against the oracle's.

use std::collections::BTreeMap;

use super::error::same_shapes;
use super::{Errors, Prepare, Suite, Variant};
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::check::{oracle_error, with_oracle_error, worst};
use crate::convention::CS180;

/// What a suite's variants are compared with.
pub(super) struct Truth {
    /// The inputs that are checked.
    pub inputs: Arrays,
    expected: Arrays,
    /// The oracle's own error.
    oracle_error: Option<Arrays>,
    /// Bounds by dtype and by the accuracy of elementary functions.
    bounds: BTreeMap<(Dtype, u64), Arrays>,
}

impl Truth {
    /// The oracle's results on the suite's inputs.
    pub(super) fn new(suite: &Suite) -> Truth {
        let inputs = (suite.workload)(suite.checked);
        let expected = match suite.registered() {
            Some(component) => (component.forward.oracle)(&inputs, &CS180),
            None => output(suite.oracle, &inputs),
        };
        Truth { inputs, expected, oracle_error: None, bounds: BTreeMap::new() }
    }

    /// The component's bound in a type, grade B, with elementary functions within `ulp`.
    fn bound(&mut self, suite: &Suite, dtype: Dtype, ulp: f64) -> Option<&Arrays> {
        let component = suite.registered()?;
        let arithmetic = Arithmetic { elementary_ulp: ulp, ..Arithmetic::new(dtype, Grade::B) };
        let (direction, inputs) = (&component.forward, &self.inputs);
        let make = || {
            let error = self.oracle_error.get_or_insert_with(|| oracle_error(direction, inputs, &CS180));
            with_oracle_error((direction.bound)(inputs, &CS180, &arithmetic), error)
        };
        Some(self.bounds.entry((dtype, ulp.to_bits())).or_insert_with(make))
    }

    /// Checks a variant: its errors, or why it is rejected.
    pub(super) fn check(&mut self, suite: &Suite, variant: &Variant) -> Result<Errors, String> {
        let got = output(variant.prepare, &self.inputs);
        same_shapes(&got, &self.expected)?;
        let allowed = match variant.tolerance.exp_ulp {
            Some(ulp) => self.bound(suite, Dtype::F32, ulp).cloned(),
            None => None,
        };
        let allowed = variant.tolerance.bound(allowed.as_ref(), &self.expected);
        let used = worst(&got, &self.expected, &allowed);
        if used > 1.0 || used.is_nan() {
            return Err(format!("off by {used:.3} times what it may be off by"));
        }
        let budget = self.bound(suite, variant.dtype, 4.0).cloned();
        let budget = budget.map(|bound| worst(&got, &self.expected, &bound));
        Ok(Errors::measure(&got, &self.expected, variant.dtype, budget, used))
    }
}

fn output(prepare: Prepare, inputs: &Arrays) -> Arrays {
    let mut kernel = prepare(inputs);
    kernel.run();
    kernel.read()
}
