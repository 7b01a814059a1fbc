"""PyTorch as a candidate, row by row, gradients by autograd: `python torch_candidate.py CASES ANSWERS`. Verdicts in ../README.md."""

import sys

import torch
import torch.nn.functional as F
from right import composite_background, positional_encoding, run, sample_along_rays, volume_render


def transform(c2w, x_c):
    """R x + o."""
    return torch.einsum("mij,mj->mi", c2w[:, :3, :3], x_c) + c2w[:, :3, 3]


def unprojected(K, uv):
    """K^-1 (u, v, 1)."""
    x = (uv - K[:2, 2]) / torch.diagonal(K)[:2]
    return torch.cat([x, torch.ones_like(x[..., :1])], -1)


def pixel_to_camera(K, uv, s):
    """At depth s."""
    return unprojected(K, uv) * s[:, None]


def pixel_to_ray(K, c2w, uv):
    """Origin, unit direction."""
    d = torch.einsum("...ij,...j->...i", c2w[..., :3, :3], unprojected(K, uv))
    return c2w[..., :3, 3].expand(d.shape), d / torch.linalg.norm(d, dim=-1, keepdim=True)


def image_rays(height, width, focal, cx, cy, c2w):
    """Centers of all pixels."""
    v, u = torch.meshgrid(torch.arange(height) + 0.5, torch.arange(width) + 0.5, indexing="ij")
    uv = torch.stack([u, v], -1).to(c2w)
    K = c2w.new_tensor([[focal, 0, cx], [0, focal, cy], [0, 0, 1]])
    return uv, *pixel_to_ray(K, c2w, uv)


def step_sizes(t, near, far):
    """The width of an interval."""
    return torch.full_like(t, (far - near) / t.shape[1])


def mlp(x, **parameters):
    """Linear layers, ReLU between, sigmoid after."""
    count = sum(name.startswith("w") for name in parameters)
    for n in range(count):
        x = F.linear(x if n == 0 else F.relu(x), parameters[f"w{n}"], parameters[f"b{n}"])
    return torch.sigmoid(x)


def nerf_mlp(positions, directions, **p):
    """Figure 7; the numbers of bands follow from the widths."""
    layer = lambda name, h: F.linear(h, p[f"{name}_w"], p[f"{name}_b"])  # noqa: E731
    width = len(p["feature_w"])
    x = positional_encoding(positions, (p["trunk0_w"].shape[1] - 3) // 6)
    d = positional_encoding(directions, (p["color0_w"].shape[1] - width - 3) // 6)
    h = x
    for n in range(8):
        h = F.relu(layer(f"trunk{n}", torch.cat([h, x], -1) if n == 4 else h))
    color = F.relu(layer("color0", torch.cat([layer("feature", h), d], -1)))
    return F.relu(layer("sigma", h))[:, 0], torch.sigmoid(layer("color1", color))


def volume_render_alpha(alphas, rgbs):
    """By the product."""
    product = torch.cumprod(F.pad(1 - alphas, (1, 0), value=1), -1)
    weights = product[:, :-1] * alphas
    return (weights[..., None] * rgbs).sum(-2), weights, weights.sum(-1), product[:, -1]


def depth(weights, t, far):
    """Mean distance; far where nothing was met. The double where keeps 0 / 0 out of the gradient."""
    total = weights.sum(-1)
    empty = total == 0
    return torch.where(empty, torch.full_like(total, far), (weights * t).sum(-1) / torch.where(empty, 1, total))


def mse(prediction, target):
    """Mean over all entries."""
    return F.mse_loss(prediction, target)


def psnr(prediction, target, peak):
    """Mean over the images."""
    return (10 * torch.log10(peak**2 / ((prediction - target) ** 2).mean((1, 2, 3)))).mean()


def to_uint8(image):
    """Rounded. Not 255 x + 0.5 cut off: in bfloat16 that is 256, and as a byte 0."""
    return (image.clamp(0, 1) * 255).round().to(torch.uint8)


def adam_step(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """torch.optim.Adam itself, with its state put in place."""
    params = torch.nn.Parameter(params.clone())
    params.grad = grad.clone()
    adam = torch.optim.Adam([params], lr=lr, betas=(beta1, beta2), eps=eps, weight_decay=weight_decay, foreach=False)
    adam.state[params] = {"step": torch.tensor(float(step - 1)), "exp_avg": m.clone(), "exp_avg_sq": v.clone()}
    adam.step()
    return params, adam.state[params]["exp_avg"], adam.state[params]["exp_avg_sq"]


ROWS = (
    transform, pixel_to_camera, pixel_to_ray, image_rays, sample_along_rays, step_sizes, positional_encoding, mlp, nerf_mlp,
    volume_render, volume_render_alpha, composite_background, depth, mse, psnr, to_uint8, adam_step,
)  # fmt: skip

if __name__ == "__main__":
    for what, became in run(*sys.argv[1:], **{row.__name__: row for row in ROWS}).items():
        print(f"{what:30} {became}")
