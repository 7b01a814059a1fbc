//! What is wrong with schedules, what it does, and where it was seen.

use crate::contract::component::Mistake;

pub(super) const STEP_FROM_ONE: Mistake = Mistake::new(
    "step_from_one",
    "the first step has the rate of step 1",
    "every rate is one step early: nothing shows but in short schedules, and a training that is resumed does it again",
    "the first step is step 0; torch: optimizer.step() before scheduler.step()",
    "torch.optim.lr_scheduler warns of this order",
    1,
);

pub(super) const WHOLE_STEPS: Mistake = Mistake::new(
    "whole_steps",
    "step / steps without its fraction",
    "a staircase: the first rate up to the end, then the last one",
    "divide as real numbers; StepLR is another schedule",
    "integers in C and in CUDA, // in Python; keras' ExponentialDecay where staircase is set",
    1,
);

pub(super) const DECAY_OF_ITS_OWN: Mistake = Mistake::new(
    "decay_of_its_own",
    "a decay that is written in, whatever decay is",
    "what is left of the rate in the end isn't what was asked for",
    "the decay that is handed over",
    "bmild/nerf run_nerf.py has 0.1 in the line that copies take over",
    1,
)
.with("decay", 0.1, [1e-3, 0.99]);
pub(super) const RATE_FLOORED: Mistake = Mistake::new(
    "rate_floored",
    "max(lr, a least rate)",
    "rates stop falling where nothing says so",
    "lr_init decay^(step / decay_steps), however small; a floor belongs outside of what is asked here",
    "1 public implementation",
    1,
)
.with("least", 1e-5, [1e-9, 1e-2]);
pub(super) const LAST_RATE_A_PART: Mistake = Mistake::new(
    "last_rate_a_part_of_first",
    "lr_final = k lr_init, whatever lr_final is",
    "the rates end elsewhere",
    "the lr_final that is handed over",
    "1 public implementation",
    1,
)
.with("k", 0.01, [1e-4, 0.9]);
pub(super) const WARMUP_FROM_A_PART: Mistake = Mistake::new(
    "warmup_from_a_part",
    "lr_init (k + (1 - k) step / warmup_steps)",
    "the first steps are longer than they should be, before the moments of Adam know anything",
    "lr_init step / warmup_steps",
    "never by itself; LinearLR's start_factor is 1/3",
    0,
)
.with("k", 0.1, [1e-4, 0.9]);
pub(super) const WARMUP_FROM_A_RATE: Mistake = Mistake::new(
    "warmup_from_a_rate",
    "first + (lr_init - first) step / warmup_steps, with a first rate of its own",
    "the first steps are longer than they should be, or the first rate is above the last one",
    "lr_init step / warmup_steps",
    "a scheduler of a diffusion code: lr_start",
    1,
)
.with("first", 1e-6, [1e-9, 0.4]);

/// Mistakes of exponential decay.
pub(crate) const LR_EXPONENTIAL: &[Mistake] = &[
    STEP_FROM_ONE,
    WHOLE_STEPS,
    Mistake::new(
        "one_step_less",
        "step / (decay_steps - 1)",
        "the rate falls a little too fast: all of it where there are few steps",
        "step / decay_steps",
        "1 scheduler of a splat trainer",
        1,
    ),
    Mistake::new(
        "factor_every_step",
        "decay^step: that of all steps in each",
        "the rate is gone after some hundred steps, and nothing is learned after them",
        "decay^(step / decay_steps)",
        "ExponentialLR with the gamma of a run, stepped every batch",
        1,
    ),
    Mistake::new(
        "natural_exponent",
        "e^(-step / decay_steps)",
        "0.37 of the rate is left in the end, whatever the decay",
        "decay^(step / decay_steps), e^(ln(decay) step / decay_steps)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "linear_decay",
        "1 - (1 - decay) step / decay_steps: a straight line to the same end",
        "rates that are too high in the middle, and negative ones after the end",
        "a power",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "decay_as_rate",
        "e^(-decay step / decay_steps)",
        "a decay of 0.1 leaves 0.9 of the rate in the end",
        "decay^(step / decay_steps)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "inverse_time",
        "lr_init / (1 + decay step / decay_steps)",
        "a decay of 0.1 leaves 0.91 of the rate in the end",
        "decay^(step / decay_steps); keras' InverseTimeDecay is another schedule",
        "never; cheap to keep",
        0,
    ),
    DECAY_OF_ITS_OWN,
    RATE_FLOORED,
    Mistake::new(
        "compounded",
        "decay^(step / decay_steps) times the last step's rate",
        "the logarithm falls with the square of the steps",
        "times the first rate, which is kept apart",
        "loops that read the rate to decay out of the optimizer",
        0,
    ),
];

/// Mistakes of a log-linear decay with its delay.
pub(crate) const LR_LOG_LINEAR: &[Mistake] = &[
    Mistake::new(
        "one_step_early",
        "t = max(step - 1, 0) / (max_steps - 1)",
        "the first two steps have lr_init, and every rate before the end is too high",
        "step / max_steps",
        "1 public implementation",
        1,
    ),
    STEP_FROM_ONE,
    WHOLE_STEPS,
    Mistake::new(
        "not_clamped",
        "step / max_steps beyond 1",
        "after the last step the rate falls on",
        "clip(step / max_steps, 0, 1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "linear_for_log",
        "(1 - t) lr_init + t lr_final",
        "rates that are many times too high up to the last steps",
        "the same of logarithms",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_rate_for_factor",
        "lr_init lr_final^t: the last rate as the factor of a decay",
        "a last rate of lr_init lr_final, hundreds of times too low",
        "lr_init (lr_final / lr_init)^t",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "half_pi_forgotten",
        "sin(step / delay_steps)",
        "0.84 of the rate at the end of the delay, and for ever where it is clipped",
        "sin(pi / 2 step / delay_steps)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "whole_pi",
        "sin(pi step / delay_steps)",
        "the rate falls again in the second half of the delay",
        "sin(pi / 2 step / delay_steps)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mult_exchanged",
        "(1 - m) + m sin(...)",
        "hardly any delay",
        "m + (1 - m) sin(...)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "delay_over_all_steps",
        "sin(pi / 2 step / max_steps): the delay as long as the training",
        "rates are far too low up to the last steps",
        "sin(pi / 2 step / delay_steps)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "rates_exchanged",
        "from lr_final to lr_init",
        "rates grow",
        "from lr_init to lr_final",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "delay_not_clamped",
        "the sine goes on after the delay",
        "rates that swing, negative ones too",
        "clip(step / delay_steps, 0, 1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mult_on_top",
        "m + sin(...)",
        "1 + m of the rate after the delay",
        "m + (1 - m) sin(...)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "not_delayed_at_first",
        "no delay at step 0: a guard against 0, `delay_steps and step`",
        "the first step has the whole rate, which the delay is there to keep from it",
        "step 0 is delayed most",
        "a port of a splat trainer's scheduler to C++",
        1,
    ),
    Mistake::new(
        "mult_forgotten",
        "sin(...) alone",
        "the first steps have no rate",
        "m + (1 - m) sin(...)",
        "never; cheap to keep",
        0,
    ),
];
