"""Cases of real sizes, in process: a million parameters, of which the last block may be lost."""

import nerf_oracle as no
import numpy as np


def adam(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """One step, in the type of its arrays."""
    grad = grad + weight_decay * params
    m, v = beta1 * m + (1 - beta1) * grad, beta2 * v + (1 - beta2) * grad * grad
    root = np.sqrt(v / -np.expm1(step * np.log(beta2))) + eps
    return params - lr * (m / -np.expm1(step * np.log(beta1))) / root, m, v


def last_block_lost(params, grad, m, v, **settings):
    """The same in blocks of 1,024; what doesn't fill one stays as it was."""
    full = len(params) // 1024 * 1024
    out = adam(params[:full], grad[:full], m[:full], v[:full], **settings)
    return tuple(np.concatenate([new, old[full:]]) for new, old in zip(out, (params, m, v)))


def test_what_shows_at_real_sizes_alone():
    right = no.judge(adam_step=adam, tier="large")
    assert right.passed and right["adam_step"].cases == 1, right
    wrong = no.judge(adam_step=last_block_lost, tier="large")["adam_step"]
    assert wrong.verdict == "fail" and "number 999424 of 1000003 is the first that is off" in wrong.observed[0], wrong
