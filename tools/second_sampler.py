"""The second implementation's random rays: numpy's own generator, with every mistake that the statistics can name. See second.py."""

import numpy as np
from second_geometry import positions

MISTAKES = (
    "outside_the_images rounded_to_the_nearest first_images_only images_not_uniform pixels_not_uniform rays_frozen rays_repeat one_image_for_ever "
    "divided_twice_by_255 wrong_colors never_jittered jitter_frozen one_jitter_for_all_rays rays_jittered_together "
    "jitter_repeats jitter_of_the_pixel jitter_antithetic jitter_correlated jitter_width_0.02 "
    "jitter_width_0.1 jitter_width_1 jitter_centered_on_edges jitter_gaussian jitter_not_uniform jitter_at_evaluation not_at_rest"
).split()

# No mistakes, though draws aren't independent: NeuS shifts a ray's samples together, bmild/nerf draws from one image a step.
HONEST = "one_jitter_per_ray one_image_per_call rays_per_image".split()


def sample_random_rays(a, c, wrong):
    """Rays from the pool of all pixels, samples in the intervals of `c`."""
    images, count, n = a["images"], a["count"], a["samples"]
    number, height, width = images.shape[:3]
    training = bool(a["training"])
    random = np.random.default_rng([2020, 0 if "rays_frozen" in wrong else a["seed"]])
    pick = lambda size: random.integers(0, size, count)  # noqa: E731
    if "images_not_uniform" in wrong:
        ids = np.minimum(pick(number), pick(number))
    else:
        ids = pick(1 if "first_images_only" in wrong else number)
    if "one_image_per_call" in wrong:
        ids = np.repeat(random.integers(0, number, 1), count)
    if "rays_per_image" in wrong:
        ids = np.repeat(random.integers(0, number, 8), count // 8)
    if "one_image_for_ever" in wrong:
        ids = np.full(count, number // 2)
    j, i = pick(height), pick(width)
    if "rays_repeat" in wrong:
        ids, j, i = (np.tile(x[: count // 8], 8) for x in (ids, j, i))
    if "pixels_not_uniform" in wrong:
        i = np.minimum(i, pick(width))
    if "outside_the_images" in wrong:
        i = i + 1
    rgbs = images[ids, j % height, i % width]
    if "wrong_colors" in wrong:
        rgbs = images[ids, i % height, j % width]
    if "divided_twice_by_255" in wrong:
        rgbs = rgbs / 255
    uv = np.stack([i, j], 1).astype(images.dtype) + (0.5 if c["pixel_center"] == "half" else 0)
    if "rounded_to_the_nearest" in wrong:
        uv = np.round(random.random((count, 2)) * [width, height]).astype(images.dtype)
        uv = uv + (0.5 if c["pixel_center"] == "half" else 0)
    jitter = np.random.default_rng([7, 0 if "jitter_frozen" in wrong else a["seed"]])
    u = drawn(jitter, count, n, wrong)
    if "jitter_of_the_pixel" in wrong:
        u = np.random.default_rng(7).random((number * height * width, n))[(ids * height + j % height) * width + i % width]
    if "jitter_centered_on_edges" in wrong:
        u = u - 0.5
    for name in wrong:
        if name.startswith("jitter_width_"):
            u = u * (float(name.removeprefix("jitter_width_")) * n / (a["far"] - a["near"]))
    rest = {"left": 0.0, "mid": 0.5, "right": 1.0}[c["rest"]] + (0.25 if "not_at_rest" in wrong else 0)
    if not training and "jitter_at_evaluation" not in wrong or "never_jittered" in wrong:
        u = np.full((count, n), rest)
    t = positions(a["near"], a["far"], u.astype(images.dtype), c["grid"])
    return {"image_ids": ids.astype(images.dtype), "uv": uv, "rgbs": rgbs, "t": t}


def drawn(random, count, n, wrong):
    """u (R, N)."""
    if "one_jitter_for_all_rays" in wrong:
        return np.broadcast_to(random.random((1, n)), (count, n))
    if "one_jitter_per_ray" in wrong:
        return np.broadcast_to(random.random((count, 1)), (count, n))
    if "rays_jittered_together" in wrong:
        return np.repeat(random.random((count // 2, n)), 2, 0)
    if "jitter_repeats" in wrong:
        return np.tile(random.random((count // 8, n)), (8, 1))
    if "jitter_antithetic" in wrong:
        half = random.random((count // 2, n))
        return np.stack([half, 1 - half], 1).reshape(count, n)
    if "jitter_correlated" in wrong:
        u = random.random((count, n))
        return (u + np.roll(u, 3, 0)) / 2
    if "jitter_gaussian" in wrong:
        return 0.5 + random.standard_normal((count, n)) / 4
    if "jitter_not_uniform" in wrong:
        return random.random((count, n)) ** 2
    return random.random((count, n))
