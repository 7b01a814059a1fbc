//! Named arrays of the contract as dicts of numpy's.

use std::collections::HashMap;

use nerf_oracle::contract::{Arrays, Component, Dtype, Kind};
use nerf_oracle::convention::Conventions;
use nerf_oracle::convention::profiles::{self, Profile};
use nerf_oracle::registry::all_rows;
use numpy::{PyReadonlyArrayDyn, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A dict as Python hands it over.
pub(crate) type Given<'py> = HashMap<String, PyReadonlyArrayDyn<'py, f64>>;

/// As the contract has it: row-major, owned.
pub(crate) fn owned(given: &Given) -> Arrays {
    given
        .iter()
        .map(|(name, array)| (name.clone(), array.as_array().as_standard_layout().into_owned()))
        .collect()
}

/// As a dict of arrays of its own.
pub(crate) fn dict<'py>(py: Python<'py>, arrays: &Arrays) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, array) in arrays {
        dict.set_item(name, array.to_pyarray(py))?;
    }
    Ok(dict)
}

/// An error of the library's, or of its words, as Python's.
pub(crate) fn value_error(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A row by its name.
pub(crate) fn component(name: &str) -> PyResult<&'static Component> {
    all_rows()
        .find(|row| row.name == name)
        .ok_or_else(|| value_error(format!("{name}: no row of the contract")))
}

/// A direction as reports call it.
pub(crate) fn kind(name: &str) -> Kind {
    if name == "vjp" { Kind::Vjp } else { Kind::Forward }
}

/// A type by its name.
pub(crate) fn dtype(name: &str) -> PyResult<Dtype> {
    name.parse().map_err(value_error)
}

/// A profile by its name, if there is one.
pub(crate) fn profile(name: Option<&str>) -> PyResult<Option<&'static Profile>> {
    name.map(profiles::find).transpose().map_err(value_error)
}

/// The conventions of a profile, or the default's.
pub(crate) fn conventions(name: Option<&str>) -> PyResult<Conventions> {
    Ok(profile(name)?.map_or(nerf_oracle::convention::CS180, |profile| profile.conventions))
}
