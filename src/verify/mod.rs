//! The harness around the components: what a component is, how it is checked, and how others' programs are judged.

pub mod answer;
pub mod arithmetic;
pub mod assignment;
pub mod bench;
pub mod bounded;
pub mod case;
pub mod catalogue;
pub mod check;
pub mod component;
pub mod diagnose;
pub mod exam;
pub mod exchange;
pub mod explain;
pub mod golden;
pub mod gradient;
pub mod hypothesis;
pub mod judge;
pub mod layout;
pub mod machine;
pub mod mark;
pub mod numeric;
pub mod own_error;
pub mod page;
pub mod report;
pub mod sampler;
pub mod selfcheck;
pub mod statistics;
pub mod tables;

pub use arithmetic::{Arithmetic, Dtype, Grade};
pub use bounded::Bounded;
pub use case::{Case, Draw};
pub use check::Kind;
pub use component::{Arrays, Component, Mistake, Pass, Port};
pub use exam::Exam;
pub use judge::{Candidate, judge};
pub use machine::Machine;
pub use report::{Report, Verdict};

/// Properties run 64 times from a fixed seed, or `PROPTEST_CASES` times.
#[cfg(test)]
pub(crate) fn properties() -> proptest::test_runner::Config {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(64);
    let rng_seed = proptest::test_runner::RngSeed::Fixed(180);
    proptest::test_runner::Config { cases, rng_seed, failure_persistence: None, ..Default::default() }
}

/// f'(0) by central differences at 2^-9 and 2^-10: for the tests of hand-written gradients. The error is that of h^4 and of rounding.
#[cfg(test)]
pub(crate) fn slope(f: impl Fn(f64) -> f64) -> f64 {
    let central = |h: f64| (f(h) - f(-h)) / (2.0 * h);
    let h = crate::math::power_of_two(-9);
    (4.0 * central(0.5 * h) - central(h)) / 3.0
}
