//! Cases of schedules: their beginning, middle and end, what is after it, warm-ups and delays; short ones, in which a step shows.

use crate::contract::arrays::scalar;
use crate::contract::case::Case;

/// A case from scalars.
fn case(id: &str, comment: &'static str, names: &[&'static str], numbers: &[f64]) -> Case {
    let inputs = names.iter().zip(numbers).map(|(name, x)| (*name, scalar(*x)));
    Case::new(id, comment, inputs.collect())
}

/// Exponential decay.
pub(crate) fn lr_exponential() -> Vec<Case> {
    let of = |id, comment, numbers: [f64; 4]| {
        case(id, comment, &["step", "decay_steps", "lr_init", "decay"], &numbers)
    };
    vec![
        of("begin", "step 0 has the first rate", [0.0, 10.0, 0.5, 0.1]),
        of("second", "one step later", [1.0, 10.0, 0.5, 0.1]),
        of("middle", "half of the way: the root of the decay", [5.0, 10.0, 0.5, 0.25]),
        of("odd", "7 of 23 steps", [7.0, 23.0, 0.3, 0.3]),
        of("late", "the last step but one", [9.0, 10.0, 0.5, 0.1]),
        of("end", "the whole decay", [10.0, 10.0, 0.75, 0.1]),
        of("beyond", "two and a half times the steps", [25.0, 10.0, 0.75, 0.25]),
        of("each_step", "a factor a step", [7.0, 1.0, 0.5, 0.9]),
        of("far_beyond", "six times the steps: next to no rate", [60.0, 10.0, 0.0005, 0.1]),
        of("paper", "NeRF's: a tenth after 250,000 steps", [20_000.0, 250_000.0, 5e-4, 0.1]),
    ]
}

/// A cosine after a warm-up.
pub(crate) fn lr_cosine() -> Vec<Case> {
    let of = |id, comment, numbers: [f64; 5]| {
        case(id, comment, &["step", "max_steps", "lr_init", "lr_final", "warmup_steps"], &numbers)
    };
    vec![
        of("begin", "step 0 has the first rate", [0.0, 100.0, 0.5, 0.01, 0.0]),
        of("second", "one step of ten", [1.0, 10.0, 0.5, 0.0625, 0.0]),
        of("quarter", "a quarter of the way", [25.0, 100.0, 0.5, 0.1, 0.0]),
        of("middle", "half of the way: the mean of both rates", [50.0, 100.0, 0.75, 0.25, 0.0]),
        of("late", "nine tenths of the way", [90.0, 100.0, 0.5, 0.05, 0.0]),
        of("end", "the last rate", [100.0, 100.0, 0.5, 0.05, 0.0]),
        of("beyond", "after the last step", [130.0, 100.0, 0.5, 0.05, 0.0]),
        of("to_nothing", "a last rate of 0", [60.0, 100.0, 0.5, 0.0, 0.0]),
        of("warm_nothing", "step 0 of a warm-up: no rate", [0.0, 100.0, 0.5, 0.05, 8.0]),
        of("warm_second", "one step of a warm-up of eight", [1.0, 100.0, 0.5, 0.05, 8.0]),
        of("warm_nothing_long", "step 0 of a longer warm-up", [0.0, 1000.0, 0.75, 0.1, 120.0]),
        of("warm_second_long", "one step of it", [1.0, 1000.0, 0.75, 0.1, 120.0]),
        of("warm_late", "the last step of a warm-up but one", [118.0, 1000.0, 0.75, 0.1, 120.0]),
        of("to_nothing_warm_nothing", "step 0 of a warm-up before a decay to 0", [0.0, 100.0, 0.5, 0.0, 8.0]),
        of("to_nothing_warm_second", "one step of it", [1.0, 100.0, 0.5, 0.0, 8.0]),
        of("to_nothing_warm_late", "seven of eight", [7.0, 100.0, 0.75, 0.0, 8.0]),
        of("warming_up", "a quarter of the warm-up", [30.0, 1000.0, 0.75, 0.05, 120.0]),
        of("warm", "the warm-up is over: the first rate", [120.0, 1000.0, 0.75, 0.05, 120.0]),
        of("after_warm_up", "the cosine after it", [370.0, 1000.0, 0.5, 0.1, 120.0]),
        of("after_both", "after the last step of both", [1240.0, 1000.0, 0.5, 0.1, 120.0]),
        of("usual", "NeuS: 300,000 steps after 5,000", [100_000.0, 300_000.0, 5e-4, 2.5e-5, 5000.0]),
        of("to_nothing_begin", "step 0 of a decay to 0", [0.0, 100.0, 0.5, 0.0, 0.0]),
        of("to_nothing_quarter", "a quarter of the way to 0", [25.0, 100.0, 0.75, 0.0, 0.0]),
        of("to_nothing_beyond", "after the end of a decay to 0", [130.0, 100.0, 0.5, 0.0, 0.0]),
        of("to_nothing_late", "nine tenths of the way to 0", [90.0, 100.0, 0.5, 0.0, 0.0]),
        of(
            "to_nothing_warming_up",
            "half of the warm-up before a decay to 0",
            [60.0, 1000.0, 0.75, 0.0, 120.0],
        ),
        of("to_nothing_after_warm_up", "and the decay after it", [370.0, 1000.0, 0.5, 0.0, 120.0]),
    ]
}

/// A log-linear decay with a delay.
pub(crate) fn lr_log_linear() -> Vec<Case> {
    let names = ["step", "max_steps", "lr_init", "lr_final", "delay_steps", "delay_mult"];
    let of = |id, comment, numbers: [f64; 6]| case(id, comment, &names, &numbers);
    vec![
        of("begin", "step 0 has the first rate", [0.0, 100.0, 0.5, 0.005, 0.0, 1.0]),
        of("second", "one step of ten", [1.0, 10.0, 0.5, 0.125, 0.0, 1.0]),
        of("middle", "half of the way: the geometric mean", [50.0, 100.0, 0.5, 0.125, 0.0, 1.0]),
        of("late", "nine tenths of the way", [9.0, 10.0, 0.5, 0.05, 0.0, 1.0]),
        of("end", "the last rate", [10.0, 10.0, 0.75, 0.1, 0.0, 1.0]),
        of("beyond", "after the last step", [15.0, 10.0, 0.75, 0.25, 0.0, 1.0]),
        of(
            "no_delay_begin",
            "a factor of a delay without steps: no delay",
            [0.0, 100.0, 0.5, 0.125, 0.0, 0.25],
        ),
        of("no_delay", "the same, half of the way", [50.0, 100.0, 0.75, 0.125, 0.0, 0.01]),
        of("delayed_begin", "step 0 of a delay: a quarter of the rate", [0.0, 100.0, 0.5, 0.125, 20.0, 0.25]),
        of("delayed_second", "one step of a delay of four", [1.0, 16.0, 0.5, 0.125, 4.0, 0.25]),
        of("delayed", "a third of the delay", [8.0, 100.0, 0.5, 0.0625, 24.0, 0.01]),
        of("delay_over", "the first step without delay", [20.0, 100.0, 0.5, 0.125, 20.0, 0.25]),
        of("after_delay", "the decay after it", [55.0, 100.0, 0.5, 0.125, 20.0, 0.25]),
        of("after_both", "after the last step of both", [130.0, 100.0, 0.5, 0.125, 20.0, 0.25]),
        of("usual", "multinerf: 250,000 steps, 512 delayed", [128.0, 250_000.0, 2e-3, 2e-5, 512.0, 0.01]),
    ]
}
