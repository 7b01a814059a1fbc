use super::*;

const START: Moments = Moments { param: 1.0, m: 0.0, v: 0.0 };

fn steps(adam: &Adam, gradients: &[f64]) -> Moments {
    gradients.iter().zip(1..).fold(START, |state, (&g, step)| adam_step(adam, state, g, step))
}

#[test]
fn tr3_the_first_step_is_lr_whatever_the_gradient() {
    let adam = Adam { lr: 0.01, ..Adam::default() };
    for g in [1e-3, 1.0, 1e6, 1e100] {
        // lr g / (|g| + eps)
        let expected = 0.01 * g / (g + 1e-8);
        assert!((1.0 - steps(&adam, &[g]).param - expected).abs() < 1e-15);
        assert!((steps(&adam, &[-g]).param - 1.0 - expected).abs() < 1e-15);
    }
    // eps stands outside the root: at g = eps half a step, inside it would be almost none.
    assert!((1.0 - steps(&adam, &[1e-8]).param - 0.005).abs() < 1e-15);
}

/// The paper's shorter form, written out: lr sqrt(1 - b2^t) / (1 - b1^t) m / (sqrt(v) + eps).
#[test]
fn an_uncorrected_eps_is_the_papers_shorter_form() {
    let adam = Adam { lr: 0.125, eps: 0.5, ..Adam::default() };
    let before = Moments { param: 1.0, m: 0.25, v: 0.75 };
    for step in [1, 2, 10, 1000] {
        let shorter = Adam { eps: eps(&adam, step, AdamEps::Uncorrected), ..adam };
        let after = adam_step(&shorter, before, -0.75, step);
        let rate = 0.125 * (1.0 - 0.999f64.powi(step as i32)).sqrt() / (1.0 - 0.9f64.powi(step as i32));
        let expected = 1.0 - rate * after.m / (after.v.sqrt() + 0.5);
        assert!((after.param - expected).abs() < 1e-12, "{step}: {} {expected}", after.param);
        assert!((after.param - adam_step(&adam, before, -0.75, step).param).abs() > 1e-4);
    }
}

#[test]
fn tr4_no_gradient_no_step() {
    assert_eq!(steps(&Adam::default(), &[0.0; 5]), START);
    // sqrt(v) at v = 0 is in the denominator beside eps: nothing is 0 / 0.
    assert!(steps(&Adam::default(), &[0.0, 1.0]).param.is_finite());
}

#[test]
fn three_steps_by_hand() {
    // beta1 = 1/2, beta2 = 3/4, eps = 0, lr = 1; gradients 1, 3, -2.
    let adam = Adam { lr: 1.0, beta1: 0.5, beta2: 0.75, eps: 0.0, weight_decay: 0.0 };
    let (m, v) = ([0.5, 1.75, -0.125], [0.25, 2.4375, 2.828125]);
    let (c1, c2) = ([0.5, 0.75, 0.875], [0.25, 0.4375, 0.578125]);
    let mut expected = 1.0;
    for n in 0..3 {
        expected -= m[n] / c1[n] / f64::sqrt(v[n] / c2[n]);
        let state = steps(&adam, &[1.0, 3.0, -2.0][..=n]);
        assert_eq!((state.m, state.v), (m[n], v[n]));
        assert!((state.param - expected).abs() < 1e-15 * 8.0, "step {}", n + 1);
    }
}

#[test]
fn a_constant_gradient_moves_lr_a_step() {
    // m / c1 = g and v / c2 = g^2 at every step.
    let adam = Adam { lr: 1e-3, eps: 0.0, ..Adam::default() };
    assert!((steps(&adam, &[0.25; 100]).param - 0.9).abs() < 1e-13);
}

#[test]
fn weight_decay_is_coupled() {
    let adam = Adam { lr: 0.1, weight_decay: 0.5, ..Adam::default() };
    // g' = g + 0.5 * 1: with g = -0.5 nothing moves, with 0 the step is lr.
    assert_eq!(steps(&adam, &[-0.5]).param, 1.0);
    assert!((steps(&adam, &[0.0]).param - 0.9).abs() < 1e-8);
    let two = Moments { param: 2.0, ..START };
    assert_eq!(adam_step(&adam, two, -1.0, 1).param, 2.0, "g' = -1 + 0.5 * 2");
}

#[test]
fn bias_corrections_keep_their_digits() {
    assert!((bias_correction(0.999, 1) / 0.001 - 1.0).abs() < 4.0 * f64::EPSILON * 1.1);
    assert!((bias_correction(0.5, 3) - 0.875).abs() < 1e-16 * 4.0);
    assert_eq!((bias_correction(0.0, 1), bias_correction(0.9, 100_000)), (1.0, 1.0));
}

/// AdamW by hand: beta1 = 1/2, beta2 = 3/4, eps = 0, lr = 1/4, a decay of 1/2; gradients 1, 3.
#[test]
fn adamw_takes_the_decay_off_what_was_before_the_step() {
    let adam = Adam { lr: 0.25, beta1: 0.5, beta2: 0.75, eps: 0.0, weight_decay: 0.5 };
    let first = adamw_step(&adam, START, 1.0, 1);
    // m / c1 = sqrt(v / c2) = 1: 1 - 1/4 - 1/8.
    assert_eq!((first.param, first.m, first.v), (0.625, 0.5, 0.25));
    let second = adamw_step(&adam, first, 3.0, 2);
    let step = 0.25 * (1.75 / 0.75) / f64::sqrt(2.4375 / 0.4375);
    assert!((second.param - (0.625 - step - 0.078125)).abs() < 1e-15);
    assert_eq!((second.m, second.v), (1.75, 2.4375));
}

#[test]
fn adamw_without_decay_is_adam_and_its_means_know_of_none() {
    let decayed = Adam { lr: 0.125, weight_decay: 0.5, ..Adam::default() };
    let plain = Adam { weight_decay: 0.0, ..decayed };
    let before = Moments { param: 2.0, m: 0.25, v: 0.5 };
    for step in [1, 3, 1000] {
        let (adam, adamw) =
            (adam_step(&plain, before, -0.75, step), adamw_step(&decayed, before, -0.75, step));
        assert_eq!(adamw_step(&plain, before, -0.75, step), adam);
        assert_eq!((adamw.m, adamw.v, adamw.param), (adam.m, adam.v, adam.param - 0.125));
    }
}
