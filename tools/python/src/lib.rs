//! `nerf_oracle._core`: what the Python package needs of the library. Arrays come and go as numpy's, in f64; everything else as text.

use pyo3::prelude::*;

mod arrays;
mod exam;
mod registry;
mod truth;

/// The Rust half of the package; `nerf_oracle` itself is the half that users call.
#[pymodule(gil_used = true)]
mod _core {
    /// The library's version.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use super::exam::{Exam, LargeExam};
    #[pymodule_export]
    use super::registry::registry;
    #[pymodule_export]
    use super::run;
    #[pymodule_export]
    use super::truth::{bound, oracle};
}

/// Runs the program with these arguments, its own name first, and returns the exit code.
#[pyfunction]
fn run(py: Python, arguments: Vec<std::ffi::OsString>) -> u8 {
    let code = py.detach(|| nerf_oracle::cli::main(arguments));
    // An exit code keeps its number to itself, but for this.
    (0..=u8::MAX).find(|&n| std::process::ExitCode::from(n) == code).unwrap_or(u8::MAX)
}
