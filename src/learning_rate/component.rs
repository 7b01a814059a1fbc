//! Registry rows of learning rates.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::arrays::number;
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Form, Special};

const STEP: Port =
    Port::plain("step", "", "steps that were taken before: 0 for the first").of(Entries::Count);
const MAX_STEPS: Port = Port::plain("max_steps", "", "the step that has the last rate").of(Entries::Count);
const LR_INIT: Port = Port::plain("lr_init", "", "the first rate");
const LR_FINAL: Port = Port::plain("lr_final", "", "the last rate");
const RATE: &[Port] = &[Port::plain("rate", "", "the learning rate of this step")];

/// Schedulers that take the factor of one step.
const EACH_STEP: &[Form] = &[Form {
    without: &["decay_steps"],
    takes: None,
    meaning: "1: the decay is that of one step",
    holds: |a, _| number(a, "decay_steps") == 1.0,
}];

/// Schedules without a warm-up, and those that end at nothing.
const SHORTER: &[Form] = &[
    Form {
        without: &["warmup_steps"],
        takes: None,
        meaning: "0: there is no warm-up",
        holds: |a, _| number(a, "warmup_steps") == 0.0,
    },
    Form {
        without: &["lr_final"],
        takes: None,
        meaning: "0: the last rate is nothing",
        holds: |a, _| number(a, "lr_final") == 0.0,
    },
];

/// Schedules without a delay.
const AT_ONCE: &[Form] = &[Form {
    without: &["delay_steps", "delay_mult"],
    takes: None,
    meaning: "0 steps: there is no delay",
    holds: |a, _| number(a, "delay_steps") == 0.0,
}];

/// Exponential decay.
pub(crate) const LR_EXPONENTIAL: Component = Component {
    name: "lr_exponential",
    folder: "learning_rate",
    code: include_str!("honest.rs"),
    formula: "lr_init decay^(step / decay_steps)",
    source: "bmild/nerf run_nerf.py: ExponentialDecay; torch.optim.lr_scheduler.ExponentialLR with decay_steps = 1",
    inputs: &[
        STEP,
        Port::plain("decay_steps", "", "steps after which `decay` is left").of(Entries::Count),
        LR_INIT,
        Port::plain("decay", "", "what is left of the rate after `decay_steps`"),
    ],
    outputs: RATE,
    conventions: &["rate_end"],
    forward: Direction {
        oracle: arrays::exponential,
        bound: bound::lr_exponential,
        honest: honest::lr_exponential,
        wrong: mistakes::lr_exponential,
    },
    vjp: None,
    cases: cases::lr_exponential,
    mistakes: mistakes::LR_EXPONENTIAL,
    special: Special { forms: EACH_STEP, laws: Some(mistakes::laws::OF_EXPONENTIALS), ..Special::NONE },
};

/// A cosine after a warm-up.
pub(crate) const LR_COSINE: Component = Component {
    name: "lr_cosine",
    folder: "learning_rate",
    code: include_str!("honest.rs"),
    formula: "lr_init step / warmup_steps in the warm-up; then lr_final + (lr_init - lr_final) (1 + cos(pi p)) / 2, \
              p = (step - warmup_steps) / (max_steps - warmup_steps)",
    source: "Loshchilov and Hutter 2017 (SGDR), equation 5; torch.optim.lr_scheduler.CosineAnnealingLR; with its warm-up NeuS and \
             nerfstudio/engine/schedulers.py CosineDecayScheduler",
    inputs: &[
        STEP,
        MAX_STEPS,
        LR_INIT,
        LR_FINAL,
        Port::plain("warmup_steps", "", "steps of the warm-up, which count among `max_steps`; 0: none")
            .of(Entries::Count),
    ],
    outputs: RATE,
    conventions: &["rate_end"],
    forward: Direction {
        oracle: arrays::cosine,
        bound: bound::lr_cosine,
        honest: honest::lr_cosine,
        wrong: mistakes::lr_cosine,
    },
    vjp: None,
    cases: cases::lr_cosine,
    mistakes: mistakes::LR_COSINE,
    special: Special { forms: SHORTER, laws: Some(mistakes::laws::OF_COSINES), ..Special::NONE },
};

/// A log-linear decay with a delay.
pub(crate) const LR_LOG_LINEAR: Component = Component {
    name: "lr_log_linear",
    folder: "learning_rate",
    code: include_str!("honest.rs"),
    formula: "f lr_init^(1 - t) lr_final^t, t = step / max_steps up to 1; f = m + (1 - m) sin(pi / 2 step / delay_steps) before \
              step `delay_steps`, then 1; m = delay_mult",
    source: "google-research/multinerf internal/math.py learning_rate_decay; graphdeco-inria/gaussian-splatting \
             utils/general_utils.py get_expon_lr_func",
    inputs: &[
        STEP,
        MAX_STEPS,
        LR_INIT,
        LR_FINAL,
        Port::plain("delay_steps", "", "steps of the delay; 0: none").of(Entries::Count),
        Port::plain("delay_mult", "", "what the delay leaves of the rate in step 0"),
    ],
    outputs: RATE,
    conventions: &["rate_delay", "rate_ramp"],
    forward: Direction {
        oracle: arrays::log_linear,
        bound: bound::lr_log_linear,
        honest: honest::lr_log_linear,
        wrong: mistakes::lr_log_linear,
    },
    vjp: None,
    cases: cases::lr_log_linear,
    mistakes: mistakes::LR_LOG_LINEAR,
    special: Special { forms: AT_ONCE, laws: Some(mistakes::laws::OF_DECAYS), ..Special::NONE },
};
