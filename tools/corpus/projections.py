"""Projections of one's own: wrong in several parts at once, none of which a catalog lists."""

import torch
from entry import fault
from gaussians import drawn, in_camera, jacobian, matrices, sizes_of
from splats import flat, three


def held_to(most, t, k):
    """J of slopes that are held to so much on either side."""
    slopes = torch.minimum(torch.maximum(t[:, :2] / t[:, 2:], -most), most)
    return jacobian(slopes, t[:, 2], k)


@fault(
    "gaussian_projection",
    "slip: another formula: focal lengths (1, 1) in J, and x/z and y/z of J held to nothing, and nothing added to the variances, "
    "and J at (x, y, z) in the world",
    # Of means nothing is answered.
    "slip: another formula: focal lengths (1, 1) in J, and x/z and y/z of J held to nothing, and nothing added to the variances, "
    "and m, as it is in the world, in the camera",
    seen="a trial on unseen code: a renderer in torch, in work",
    gradient="none",
)
def jacobian_of_the_world(means, covariances, w2c, K, width, height):
    """J of the mean in the world, without focal lengths; nothing is added."""
    _, sigma = in_camera(means, covariances, w2c)
    j = jacobian(means[:, :2] / means[:, 2:], means[:, 2], torch.eye(3))
    return {"covariances2d": three(j @ sigma @ j.mT)}


@fault(
    "gaussian_projection",
    "slip: another formula: J Sigma, not turned, J^T, and x/z and y/z of J held to nothing, and J at (u, v, z), u and v the mean in the picture",
    seen="a trial on unseen code: features of splats in torch",
    gradient="none",
)
def jacobian_of_the_picture(means, covariances, w2c, K, width, height):
    """J of the mean in pixels, the covariance as it is in the world, 0.1 added."""
    t, _ = in_camera(means, covariances, w2c)
    middle = (t @ K.mT)[:, :2] / t[:, 2:]
    j = jacobian(middle / t[:, 2:], t[:, 2], K)
    return {"means2d": middle, "depths": t[:, 2], "covariances2d": three(j @ matrices(covariances) @ j.mT + 0.1 * torch.eye(2))}


@fault(
    "gaussian_projection",
    "slip: another formula: x/z and y/z of J held to 1.3 of half the width on either side, in y too, and nothing added to the variances",
    seen="a trial on unseen code: a port of the rasterizer to torch",
    gradient="none",
)
def limits_of_the_width(means, covariances, w2c, K, width, height):
    """1.3 W / (2 fy) where 1.3 H / (2 fy) belongs; nothing is added."""
    t, sigma = in_camera(means, covariances, w2c)
    most = 1.3 * 0.5 * width / torch.stack([K[0, 0], K[1, 1]])
    j = held_to(most, t, K)
    return {"depths": t[:, 2], "covariances2d": three(j @ sigma @ j.mT)}


@fault(
    "gaussian_projection",
    "slip: another formula: mean = ((fx x/z + cx) (W - 1)/W, (fy y/z + cy) (H - 1)/H)",
    "slip: (ndc + 1) * (axis.size - 1) in the place of (ndc + 1) * axis.size",
    seen="a trial on unseen code: splats in torch, by normalized coordinates",
    gradient="none",
)
def pixels_to_the_edges(means, covariances, w2c, K, width, height):
    """-1 and 1 are the middles of the first and of the last pixel."""
    middle, depths, cov = flat(means, covariances, w2c, K, width, height)
    size = sizes_of(width, height)
    return {"means2d": middle * (size - 1) / size, "depths": depths, "covariances2d": three(cov + 0.3 * torch.eye(2))}


@fault(
    "gaussian_alpha",
    "slip: another formula: q = dx^2 + dy^2, and 0 where |dx| > 3 or |dy| > 3, and dx and dy from the mean rounded down",
    "slip: another formula: q = dx^2 + dy^2, and 0 where |dx| > 3 or |dy| > 3, and dx and dy from the mean cut off to whole pixels",
    seen="a trial on unseen code: a simplified renderer in torch",
    gradient="none",
)
def a_round_stamp(pixels, means2d, conics, opacities):
    """exp(-(dx^2 + dy^2) / 2) about whole pixels, up to three of them away: the conic isn't used."""
    d = pixels[:, None] - torch.trunc(means2d)[None]
    return torch.where(d.abs().amax(-1) > 3, 0.0, opacities * torch.exp(-0.5 * (d * d).sum(-1)))


@fault(
    "gaussian_projection",
    "slip: another formula: x/z and y/z of J held to 1.3 max(cx, W - cx) / fx and 1.3 max(cy, H - cy) / fy on either side",
    seen="a trial on unseen code: 3D Gaussians in torch",
    gradient="none",
)
def limits_of_the_farther_edge(means, covariances, w2c, K, width, height):
    """The same limit on both sides of the center, from the edge that is farther away."""
    t, sigma = in_camera(means, covariances, w2c)
    size, center = sizes_of(width, height), K[:2, 2]
    most = 1.3 * torch.maximum(center, size - center) / torch.stack([K[0, 0], K[1, 1]])
    j = held_to(most, t, K)
    return {"depths": t[:, 2], "covariances2d": three(j @ sigma @ j.mT + 0.3 * torch.eye(2))}


@fault(
    "gaussian_projection",
    "slip: another formula: J Sigma, not turned, J^T, and x/z and y/z of J held to nothing, and what the smaller eigenvalue lacks of a tenth "
    "of the larger one added to the variances, and radius = 3 sqrt(lambda), with nothing held up in lambda",
    seen="a trial on unseen code: splats by eigenvalues",
    gradient="none",
)
def never_ten_times_as_long(means, covariances, w2c, K, width, height):
    """Covariances as they are in the world; thin splats are made thicker, to a tenth of their length."""
    t, _ = in_camera(means, covariances, w2c)
    j = jacobian(t[:, :2] / t[:, 2:], t[:, 2], K)
    cov = j @ matrices(covariances) @ j.mT
    values = torch.linalg.eigvalsh(cov)
    more = (values[:, 1] / 10 - values[:, 0]).clamp_min(0)
    return {
        "depths": t[:, 2],
        "covariances2d": three(cov + more[:, None, None] * torch.eye(2)),
        "radii": 3 * (values[:, 1] + more).sqrt(),
    }


@fault(
    "gaussian_projection",
    "slip: another formula: J R^T Sigma R J^T, and x/z and y/z of J held to 1.3 times the tangent of the whole angle",
    seen="a trial on unseen code: a splat renderer in GLSL",
    gradient="none",
)
def back_and_wide(means, covariances, w2c, K, width, height):
    """The rotation of c2w, and tan(fov) for tan(fov / 2) in the limits."""
    t, _ = in_camera(means, covariances, w2c)
    _, sigma = in_camera(means, covariances, w2c.mT)
    half = 0.5 * sizes_of(width, height) / torch.stack([K[0, 0], K[1, 1]])
    j = held_to(1.3 * 2 * half / (1 - half * half), t, K)
    return {"depths": t[:, 2], "covariances2d": three(j @ sigma @ j.mT + 0.3 * torch.eye(2))}


@fault(
    "gaussian_projection",
    "slip: another formula: radius = ceil(3 sqrt(lambda)), 0 where the mean lies outside of the picture",
    seen="a trial on unseen code: splats in CUDA",
    gradient="none",
)
def means_outside_dropped(means, covariances, w2c, K, width, height):
    """A radius of 0 for what has its mean beside the picture."""
    middle, depths, cov = flat(means, covariances, w2c, K, width, height)
    _, wide, conics, _, radii, _ = drawn(middle, cov, depths, 0.1)
    inside = ((middle >= 0) & (middle < sizes_of(width, height))).all(-1)
    return {"means2d": middle, "depths": depths, "covariances2d": wide, "conics": conics, "radii": radii * inside}


@fault(
    "gaussian_projection",
    "slip: another formula: mean = (fx x/z + W/2, fx y/z + H/2), and focal lengths (fx, fx) in J, and x/z and y/z of J held to nothing, "
    "and nothing added to the variances, and R^T (m - T), the pose inverted, in the camera",
    seen="a trial on unseen code: splats on a tiny network",
)
def inverted_on_a_square(means, covariances, w2c, K, width, height):
    """Means by the pose's inverse, covariances by the pose; one focal length, and the picture's middle."""
    r, t, fx = w2c[:3, :3], w2c[:3, 3], K[0, 0]
    x, y, z = ((means - t) @ r).unbind(-1)
    zero = torch.zeros_like(z)
    rows = [torch.stack([fx / z, zero, -fx * x / z**2], -1), torch.stack([zero, fx / z, -fx * y / z**2], -1)]
    j = torch.stack(rows, -2)
    covariance = j @ (r @ matrices(covariances) @ r.T) @ j.mT
    means2d = torch.stack([fx * x / z + width / 2, fx * y / z + height / 2], -1)
    return {"means2d": means2d, "covariances2d": three(covariance), "depths": z}
