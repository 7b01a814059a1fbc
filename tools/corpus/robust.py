"""Losses that outliers don't rule."""

import torch
import torch.nn.functional as F
from entry import convention, fault, right


@right("huber", seen="codes with torch's Huber loss", times=2)
def loss_of_torch(prediction, target, delta):
    """F.huber_loss."""
    return F.huber_loss(prediction, target, delta=float(delta))


@right("huber", seen="ports with a limited difference", digits=True)
def square_and_rest(prediction, target, delta):
    """q = min(|d|, delta); q^2 / 2 + delta (|d| - q): torch's gradient of q adds and takes away delta."""
    size = (prediction - target).abs()
    inside = size.clamp(max=float(delta))
    return (0.5 * inside**2 + delta * (size - inside)).mean()


@convention(
    "huber",
    {"huber_slope": "one"},
    seen="nerfacc examples and others: F.smooth_l1_loss with beta",
    times=3,
)
def smooth_l1(prediction, target, delta):
    """F.smooth_l1_loss."""
    return F.smooth_l1_loss(prediction, target, beta=float(delta))


@convention("huber", {"huber_slope": "one"}, seen="NVlabs/instant-ngp huber_loss and its ports", times=2)
def square_over_alpha(prediction, target, delta):
    """0.5 / alpha d^2, or |d| - 0.5 alpha."""
    size = torch.abs(prediction - target)
    return torch.where(size > delta, size - 0.5 * delta, 0.5 / delta * size * size).mean()


@convention("huber", {"loss_reduction": "sum"}, seen="losses with reduction sum")
def summed(prediction, target, delta):
    """The sum over entries."""
    return F.huber_loss(prediction, target, delta=float(delta), reduction="sum")


@fault("huber", "half_forgotten", seen="by hand: d^2 for d^2 / 2", gradient="none")
def squares_not_halved(prediction, target, delta):
    """d^2 inside."""
    d = prediction - target
    return torch.where(d.abs() <= delta, d * d, delta * (d.abs() - 0.5 * delta)).mean()


@fault("huber", "offset_forgotten", seen="by hand: delta |d| beyond", gradient="right")
def pieces_that_do_not_meet(prediction, target, delta):
    """delta |d| beyond, without its offset: the gradient is right all the same."""
    d = prediction - target
    return torch.where(d.abs() <= delta, 0.5 * d * d, delta * d.abs()).mean()


@fault("huber", "sign_kept", seen="by hand: d < delta without |.|", gradient="none")
def comparison_with_a_sign(prediction, target, delta):
    """d <= delta."""
    d = prediction - target
    return torch.where(d <= delta, 0.5 * d * d, delta * (d.abs() - 0.5 * delta)).mean()


@right("charbonnier", seen="google-research/multinerf internal/train_utils.py compute_data_loss and ports", times=4)
def padded_root(prediction, target, eps):
    """mean sqrt(d^2 + eps^2)."""
    return torch.sqrt((prediction - target) ** 2 + eps**2).mean()


@convention("charbonnier", {"charbonnier_eps": "as_given"}, seen="image restoration: sqrt(d^2 + eps)", times=2)
def eps_not_squared(prediction, target, eps):
    """mean sqrt(d^2 + eps)."""
    return torch.mean(torch.sqrt((prediction - target) ** 2 + eps))


@convention("charbonnier", {"loss_reduction": "sum"}, seen="image restoration, reduction sum")
def summed_roots(prediction, target, eps):
    """sum sqrt(d^2 + eps^2)."""
    return torch.sqrt((prediction - target) ** 2 + eps**2).sum()


@fault("charbonnier", "root_of_mean", seen="NeRF-Factory's mip-NeRF 360", gradient="none")
def root_of_the_mean_square(prediction, target, eps):
    """sqrt(mean(d^2) + eps^2)."""
    return torch.sqrt(((prediction - target) ** 2).mean() + eps**2)


@fault("charbonnier", "eps_outside", seen="by hand: |d| + eps", gradient=("eps_outside", "eps_forgotten"))
def length_plus_eps(prediction, target, eps):
    """mean |d| + eps."""
    return (prediction - target).abs().mean() + eps


@fault("huber", "large_negative_ones_dropped", seen="on-policy#47")
def positive_ones_beyond_alone(prediction, target, delta):
    """Two masks: |d| <= delta, and d > delta."""
    d = prediction - target
    return ((d.abs() <= delta) * d**2 / 2 + (d > delta) * delta * (d.abs() - delta / 2)).mean()


@fault("huber", "beyond_as_of_one", seen="EfficientDet#93, and a framework's document", times=2)
def a_half_less_whatever_delta(prediction, target, delta):
    """|d| - 0.5."""
    size = (prediction - target).abs()
    return torch.where(size <= delta, size * size / 2, size - 0.5).mean()


@fault("huber", "slip: another formula: of the pieces: beyond everywhere", seen="a trial on unseen code: an agent's loss", gradient="none")
def lines_alone(prediction, target, delta):
    """delta (|d| - delta / 2) for every d."""
    return (0.5 * delta**2 + delta * ((prediction - target).abs() - delta)).mean()
