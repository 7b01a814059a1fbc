"""Loss, PSNR, bytes of a picture, and an optimizer's step."""

import numpy as np
import torch
import torch.nn.functional as F
from entry import convention, fault, right


@right("mse", seen="bmild/nerf img2mse and its ports", times=12)
def mean_of_squares(prediction, target):
    """torch.mean((x - y) ** 2)."""
    return torch.mean((prediction - target) ** 2)


@right("mse", seen="CS180 students (nn.MSELoss)", times=12)
def loss_of_torch(prediction, target):
    """F.mse_loss."""
    return F.mse_loss(prediction, target)


@right("mse", seen="kwea123-like codes: mean over channels, then over rays", times=3)
def mean_of_means(prediction, target):
    """Means over the last axis, then over all others."""
    return ((prediction - target) ** 2).mean(-1).mean()


@right("mse", seen="aviral2004/nerf_from_scratch: a sum, divided afterwards", times=2)
def sum_divided_by_number(prediction, target):
    """A sum divided by the number of entries."""
    return torch.sum(torch.square(prediction - target)) / prediction.numel()


@right("mse", seen="numpy ports", times=3, arrays="numpy")
def numpy_mean(prediction, target):
    """np.mean."""
    return np.mean(np.square(prediction - target))


@fault("mse", "sum_for_mean", seen="Zhiyuan-R/Aug-NeLF utils/image.py with reduction sum; aviral2004", times=2)
def sum_of_squares(prediction, target):
    """A sum."""
    return torch.sum((prediction - target) ** 2)


@fault("mse", "mean_over_rays", seen="an earlier reading; distances of colors averaged over rays")
def mean_of_squared_distances(prediction, target):
    """The sum over channels, averaged over the rest."""
    return ((prediction - target) ** 2).sum(-1).mean()


@fault("mse", "absolute_error", seen="L1 losses of neighboring codes", times=2)
def absolute_differences(prediction, target):
    """mean |x - y|."""
    return torch.mean(torch.abs(prediction - target))


@fault("mse", "root_of_mean", seen="a metrics module: compute_RMSE in the place of MSE", gradient="none")
def root_of_the_mean(prediction, target):
    """The root of the mean square."""
    return torch.sqrt(torch.mean((prediction - target) ** 2))


@convention(
    "psnr",
    {"psnr": "mean_error", "psnr_peak": "one"},
    seen="bmild/nerf mse2psnr and its ports: -10 ln / ln 10",
    times=10,
)
def logarithms_divided(prediction, target):
    """-10 ln(mse) / ln 10; the peak is 1."""
    return -10.0 * torch.log(torch.mean((prediction - target) ** 2)) / torch.log(torch.tensor([10.0]))


@convention("psnr", {"psnr": "mean_error"}, seen="CS180 students: 10 log10(1 / mse)", times=8)
def ten_log_of_one_over(prediction, target, peak):
    """10 log10(peak^2 / mse)."""
    return 10 * torch.log10(peak**2 / torch.mean((prediction - target) ** 2))


@convention("psnr", {"psnr": "mean_error"}, seen="image codes: 20 log10(peak / sqrt(mse))", times=7)
def twenty_log_of_the_root(prediction, target, peak):
    """20 log10(peak / sqrt(mse))."""
    return 20 * torch.log10(peak / torch.sqrt(F.mse_loss(prediction, target)))


@right("psnr", seen="codes that average over pictures", times=4)
def mean_of_pictures(prediction, target, peak):
    """Each picture's, averaged."""
    error = ((prediction - target) ** 2).mean(dim=(1, 2, 3))
    return (10 * torch.log10(peak**2 / error)).mean()


@right("psnr", seen="a 3D generation code: pictures cut to [0, 1], and no peak")
def cut_to_colors_first(prediction, target):
    """Both cut, then each picture's; the peak is 1."""
    error = ((prediction.clip(0, 1) - target.clip(0, 1)) ** 2).mean(dim=(1, 2, 3))
    return (-10 * torch.log10(error)).mean()


@convention("psnr", {"psnr": "mean_error", "psnr_floor": "small"}, seen="CS180 students: 100 where the error is 0", times=3)
def a_hundred_for_equal_pictures(prediction, target, peak):
    """100 for equal pictures."""
    error = F.mse_loss(prediction, target)
    return torch.tensor(100.0) if error == 0 else 20 * torch.log10(peak / torch.sqrt(error))


@convention("psnr", {"psnr": "mean_error", "psnr_floor": "small"}, seen="CS180 students, an error plus 1e-8 or 1e-10", times=5)
def error_plus_a_tiny_number(prediction, target, peak):
    """10 log10(peak^2 / (mse + 1e-8))."""
    return 10.0 * torch.log10(peak**2 / (torch.mean((prediction - target) ** 2) + 1e-8))


@convention("psnr", {"psnr": "images", "psnr_floor": "small"}, seen="codes whose error is at least 1e-10", times=3)
def error_of_at_least_a_tiny_number(prediction, target, peak):
    """clamp_min(1e-10) under the logarithm, picture by picture."""
    error = ((prediction - target) ** 2).mean(dim=(1, 2, 3))
    return (10 * torch.log10(peak**2 / error.clamp_min(1e-10))).mean()


@convention(
    "psnr",
    {"psnr": "images", "psnr_floor": "small"},
    seen="not met with this number: 1e-10 added, picture by picture",
    times=0,
)
def tiny_number_added_by_picture(prediction, target, peak):
    """10 log10(peak^2 / (mse + 1e-10)), averaged over pictures."""
    error = ((prediction - target) ** 2).mean(dim=(1, 2, 3))
    return (10.0 * torch.log10(peak**2 / (error + 1e-10))).mean()


@fault("psnr", "doubled_psnr", seen="an earlier reading of 114 implementations")
def twenty_log_without_the_root(prediction, target, peak):
    """20 log10(peak / mse), peak^2 for bytes."""
    return 20 * torch.log10(peak**2 / torch.mean((prediction - target) ** 2))


@fault("psnr", "peak_of_target", seen="an imaging code: the peak is the picture's own maximum")
def peak_of_the_picture(prediction, target):
    """The target's largest value for the peak."""
    return 20 * torch.log10(target.max() / torch.sqrt(F.mse_loss(prediction, target)))


@fault("psnr", "peak_255", seen="not met in this reading: codes that divide by 255 and keep the peak", times=0)
def bytes_peak_for_floats(prediction, target):
    """255 whatever the pictures hold."""
    return 20 * torch.log10(255.0 / torch.sqrt(F.mse_loss(prediction, target)))


@convention("to_uint8", {"bytes": "truncate"}, seen="bmild/nerf to8b and its ports", times=12, arrays="numpy")
def clipped_and_cut(image):
    """(255 clip(x, 0, 1)) as bytes."""
    return (255 * np.clip(image, 0, 1)).astype(np.uint8)


@convention("to_uint8", {"bytes": "truncate"}, seen="torch: clamp, mul, byte", times=4)
def torch_bytes(image):
    """clamp(0, 1).mul(255).byte()."""
    return image.clamp(0, 1).mul(255).byte()


@convention("to_uint8", {"bytes": "truncate"}, seen="splat exporters: (x * 255).clip(0, 255)", times=3, arrays="numpy")
def clipped_in_bytes(image):
    """Clipped from 0 to 255."""
    return (image * 255).clip(0, 255).astype(np.uint8)


@right("to_uint8", seen="torchvision save_image: mul(255).add(0.5).clamp", times=3)
def half_added(image):
    """255 x + 1/2, clamped, cut."""
    return image.mul(255).add(0.5).clamp(0, 255).to(torch.uint8)


@right("to_uint8", seen="numpy's rint", times=2, arrays="numpy")
def rounded_to_even(image):
    """np.round of the clipped."""
    return np.round(np.clip(image, 0, 1) * 255).astype(np.uint8)


@fault("to_uint8", "uint8_without_clipping", seen="CS180 students' films: (frame * 255).astype(uint8)", times=6, arrays="numpy")
def not_clipped(image):
    """No clip: values wrap around."""
    return (image * 255).astype(np.int64).astype(np.uint8)


@fault("to_uint8", "red_and_blue_exchanged", seen="an earlier reading: cv2.imwrite of an RGB picture", times=2, arrays="numpy")
def blue_first(image):
    """BGR."""
    return clipped_and_cut(image[..., ::-1])


@fault("to_uint8", "stretched_to_the_range", seen="Zhiyuan-R/Aug-NeLF utils/image.py", arrays="numpy")
def stretched_to_the_range(image):
    """255 (x - min) / (max - min)."""
    return (255 * (image - image.min()) / (image.max() - image.min())).astype(np.uint8)


@fault("to_uint8", "times_256", seen="not met among fields: the 255.99 and 256 of ray tracers", times=0, arrays="numpy")
def times_256(image):
    """(256 x), clipped and cut."""
    return (256 * np.clip(image, 0, 0.999)).astype(np.uint8)


def moments(grad, m, v, beta1, beta2):
    """m and v behind the step."""
    return beta1 * m + (1 - beta1) * grad, beta2 * v + (1 - beta2) * grad**2


@right("adam_step", seen="numpy, C and Rust optimizers of students", times=11, arrays="numpy")
def corrected_moments(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """m-hat and v-hat, as in the paper."""
    m, v = moments(grad + weight_decay * params, m, v, beta1, beta2)
    return params - lr * (m / (1 - beta1**step)) / (np.sqrt(v / (1 - beta2**step)) + eps), m, v


@right("adam_step", seen="pytorch torch/optim/adam.py", times=10)
def corrected_denominator(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """sqrt(v) / sqrt(1 - b2^t) + eps, and lr / (1 - b1^t)."""
    m, v = moments(grad + weight_decay * params, m, v, beta1, beta2)
    return params - lr / (1 - beta1**step) * m / (v.sqrt() / (1 - beta2**step) ** 0.5 + eps), m, v


@convention(
    "adam_step",
    {"adam_eps": "uncorrected"},
    seen="tensorflow and keras; tiny-cuda-nn adam.h: the paper's shorter form",
    times=4,
    arrays="numpy",
)
def correction_in_the_rate(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """lr sqrt(1 - b2^t) / (1 - b1^t), and eps beside the uncorrected root."""
    m, v = moments(grad + weight_decay * params, m, v, beta1, beta2)
    return params - lr * np.sqrt(1 - beta2**step) / (1 - beta1**step) * m / (np.sqrt(v) + eps), m, v


@right("adam_step", seen="numpy optimizers of students and engines, without weight decay", times=6, arrays="numpy")
def adam_without_decay(params, grad, m, v, step, lr, beta1, beta2, eps):
    """The paper's algorithm: weights don't decay."""
    m, v = beta1 * m + (1 - beta1) * grad, beta2 * v + (1 - beta2) * grad * grad
    corrected = m / (1 - beta1**step), v / (1 - beta2**step)
    f32 = params.dtype.type
    return (params - f32(lr) * corrected[0] / (np.sqrt(corrected[1]) + f32(eps))).astype(params.dtype), m.astype(params.dtype), v.astype(params.dtype)


@fault("adam_step", "no_bias_correction", seen="an earlier reading of 114 implementations", arrays="numpy")
def moments_as_they_are(params, grad, m, v, lr, beta1, beta2, eps, weight_decay):
    """No corrections."""
    m, v = moments(grad + weight_decay * params, m, v, beta1, beta2)
    return params - lr * m / (np.sqrt(v) + eps), m, v


@fault("adam_step", "corrected_as_in_first_step", seen="a teaching library: m / (1 - b1) for all steps", arrays="numpy")
def corrected_as_in_the_first_step(params, grad, m, v, lr, beta1, beta2, eps, weight_decay):
    """1 - b1 and 1 - b2 without the power."""
    m, v = moments(grad + weight_decay * params, m, v, beta1, beta2)
    return params - lr * (m / (1 - beta1)) / (np.sqrt(v / (1 - beta2)) + eps), m, v


@fault("adam_step", "corrected_twice", seen="every-algorithm/python optimization/adaptive_optimization.py", arrays="numpy")
def corrected_twice(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """The rate is corrected, and the moments are too."""
    m, v = moments(grad + weight_decay * params, m, v, beta1, beta2)
    rate = lr * np.sqrt(1 - beta2**step) / (1 - beta1**step)
    return params - rate * (m / (1 - beta1**step)) / (np.sqrt(v / (1 - beta2**step)) + eps), m, v


@fault("adam_step", "eps_inside_root", seen="a student's Adam with epsilon_inside_sqrt", arrays="numpy")
def eps_under_the_root(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """sqrt(v-hat + eps)."""
    m, v = moments(grad + weight_decay * params, m, v, beta1, beta2)
    return params - lr * (m / (1 - beta1**step)) / np.sqrt(v / (1 - beta2**step) + eps), m, v


@fault("adam_step", "step_from_zero", seen="not met in this reading: loops that count from 0", times=0, arrays="numpy")
def counted_from_zero(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """step - 1, at least 1."""
    return corrected_moments(params, grad, m, v, max(step - 1, 1), lr, beta1, beta2, eps, weight_decay)


@fault(
    "adam_step",
    "slip: root + adam.eps, of which adam.eps is taken outside of the parenthesis",
    seen="a student's Adam: the parenthesis closes too early",
    arrays="numpy",
)
def eps_outside_the_quotient(params, grad, m, v, step, lr, beta1, beta2, eps):
    """m-hat / sqrt(v-hat) + eps."""
    m, v = moments(grad, m, v, beta1, beta2)
    return params - lr * ((m / (1 - beta1**step)) / np.sqrt(v / (1 - beta2**step)) + eps), m, v


@fault("adam_step", "decoupled_decay", seen="AdamW where Adam is asked for", times=3)
def shrunk_first(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """p (1 - lr wd), then Adam without decay."""
    return corrected_denominator(params * (1 - lr * weight_decay), grad, m, v, step, lr, beta1, beta2, eps, 0.0)


@fault("adam_step", "betas_of_its_own", seen="a trial on unseen code", arrays="numpy")
def usual_betas(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """0.9 and 0.999, whatever is handed over."""
    return corrected_moments(params, grad, m, v, step, lr, 0.9, 0.999, eps, weight_decay)


@fault("psnr", "peak_scaled", seen="a code whose peak is 8")
def peak_of_eight(prediction, target, peak):
    """Eight times the peak."""
    return 20 * torch.log10(8 * peak / torch.sqrt(F.mse_loss(prediction, target)))


@fault("psnr", "divided_by_pixels", seen="DnCNN-tensorflow#6", arrays="numpy")
def squares_over_height_and_width(prediction, target, peak):
    """The sum over height times width: neither channels nor pictures count."""
    height, width = prediction.shape[1:3]
    error = np.sum((prediction - target) ** 2) / (height * width)
    return np.float32(np.inf if error == 0 else 10 * np.log10(peak**2 / error))


@fault("psnr", "root_for_mean_square", seen="BDMM#4", arrays="numpy")
def ten_logarithms_of_the_root(prediction, target, peak):
    """10 log10(peak / rmse)."""
    error = np.mean((prediction - target) ** 2)
    return np.float32(np.inf if error == 0 else 10 * np.log10(peak / np.sqrt(error)))


@fault("adam_step", "beta2_squared", seen="npfl114#79, a slide", arrays="numpy")
def second_moment_by_a_square(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """1 - b2^2, whatever the step."""
    m, v = moments(grad + weight_decay * params, m, v, beta1, beta2)
    return params - lr * (m / (1 - beta1**step)) / (np.sqrt(v / (1 - beta2**2)) + eps), m, v


@fault("adam_step", "gradient_clipped_first", seen="a trial on unseen code: clip(grad, -1, 1) in front", arrays="numpy")
def gradient_clipped_first(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """The paper's step of a gradient cut at 1."""
    m, v = moments(np.clip(grad, -1, 1) + weight_decay * params, m, v, beta1, beta2)
    return params - lr * (m / (1 - beta1**step)) / (np.sqrt(v / (1 - beta2**step)) + eps), m, v


@convention("adam_step", {"adam_zero": "left"}, seen="tiny-cuda-nn adam.h, of its encodings' parameters; a port", times=2, arrays="numpy")
def nothing_without_a_gradient(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """Parameters and moments stay where the gradient is 0."""
    stepped = corrected_moments(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay)
    return tuple(np.where(grad == 0, old, new) for old, new in zip((params, m, v), stepped))


@fault("psnr", "infinite_below", seen="a trial on unseen code: a student in torch", arrays="numpy")
def infinite_where_it_is_small(prediction, target):
    """inf where the mean square is below 1e-10, -10 log10 of it elsewhere."""
    error = np.mean((prediction - target) ** 2, dtype=np.float64)
    return np.inf if error < 1e-10 else -10 * np.log10(error)


@fault("to_uint8", "times_256_wrapped", seen="a trial on unseen code: a denoiser of digits", arrays="numpy")
def white_becomes_black(image):
    """clip, times 256, astype(uint8)."""
    return (np.clip(image, 0, 1) * 256).astype(np.int64).astype(np.uint8)
