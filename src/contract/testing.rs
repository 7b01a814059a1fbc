//! Helpers that the components' tests share.

/// Properties run 64 times from a fixed seed, or `PROPTEST_CASES` times.
pub(crate) fn properties() -> proptest::test_runner::Config {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(64);
    let rng_seed = proptest::test_runner::RngSeed::Fixed(180);
    proptest::test_runner::Config { cases, rng_seed, failure_persistence: None, ..Default::default() }
}

/// One in so many: all of them where `NERF_ORACLE_TYPES` is set, as `.ci/run` does.
pub(crate) fn one_in(few: usize) -> usize {
    if std::env::var_os("NERF_ORACLE_TYPES").is_some() { 1 } else { few }
}

/// f'(0) by central differences at 2^-9 and 2^-10: for the tests of hand-written gradients. The error is that of h^4 and of rounding.
pub(crate) fn slope(f: impl Fn(f64) -> f64) -> f64 {
    let central = |h: f64| (f(h) - f(-h)) / (2.0 * h);
    let h = crate::math::power_of_two(-9);
    (4.0 * central(0.5 * h) - central(h)) / 3.0
}
