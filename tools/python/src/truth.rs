//! The reference itself, and how far an honest implementation may be off, on anybody's inputs.

use std::panic::{AssertUnwindSafe, catch_unwind};

use nerf_oracle::contract::check::tolerance;
use nerf_oracle::contract::{Arithmetic, Arrays, Grade};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Given, component, conventions, dict, dtype, kind, owned, value_error};

/// What the formula gives in f64.
#[pyfunction]
#[pyo3(signature = (row, direction, inputs, profile=None))]
pub(crate) fn oracle<'py>(
    py: Python<'py>,
    row: &str,
    direction: &str,
    inputs: Given,
    profile: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let (component, c, inputs) = (component(row)?, conventions(profile)?, owned(&inputs));
    let Some(direction) = component.direction(kind(direction)) else {
        return Err(value_error(format!("{row}: it has no gradient in the contract")));
    };
    let outputs = computed(py, row, || (direction.oracle)(&inputs, &c))?;
    dict(py, &outputs)
}

/// How far an answer in `dtype` may be off, element by element: by the textbook's formula, or where `stable` by the more accurate one.
#[pyfunction]
#[pyo3(signature = (row, direction, inputs, dtype, stable, profile=None))]
pub(crate) fn bound<'py>(
    py: Python<'py>,
    row: &str,
    direction: &str,
    inputs: Given,
    dtype: &str,
    stable: bool,
    profile: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let (component, c, inputs) = (component(row)?, conventions(profile)?, owned(&inputs));
    let grade = if stable { Grade::A } else { Grade::B };
    let arithmetic = Arithmetic::new(self::dtype(dtype)?, grade);
    let Some(direction) = component.direction(kind(direction)) else {
        return Err(value_error(format!("{row}: it has no gradient in the contract")));
    };
    let bounds = computed(py, row, || tolerance(direction, &inputs, &c, &arithmetic))?;
    dict(py, &bounds)
}

/// Runs without Python's lock. What the oracle asserts of its inputs, and the Python half didn't check, is an error with its words.
fn computed(py: Python, row: &str, work: impl FnOnce() -> Arrays + Send) -> PyResult<Arrays> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).map_err(|panic| {
        let said = panic.downcast_ref::<String>().cloned();
        let said = said.or_else(|| panic.downcast_ref::<&str>().map(ToString::to_string));
        value_error(format!("{row}: {}", said.unwrap_or_else(|| "inputs that the formula can't take".into())))
    })
}
