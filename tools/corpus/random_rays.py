"""Rays drawn from all pictures."""

import numpy as np
from entry import convention, fault, right


def positions(near, far, n, u, kind="intervals"):
    """t by a grid."""
    if kind == "ends":
        return np.linspace(near, far, n) + u * (far - near) / n
    return near + (np.arange(n) + u) * (far - near) / n


def rays(images, ids, rows, columns, half=0.5):
    """What is returned of each ray but its samples."""
    uv = np.stack([columns, rows], 1) + half
    return {"image_ids": ids, "uv": uv, "rgbs": images[ids, rows, columns]}


def out(found, t):
    """f32 arrays."""
    return {name: np.asarray(x, np.float32) for name, x in (found | {"t": t}).items()}


def pixels(images, count, random):
    """Any pixel of any picture."""
    number, height, width = images.shape[:3]
    flat = random.integers(0, number * height * width, count)
    return flat // (height * width), flat // width % height, flat % width


def jitter(random, count, samples, training, rest=0.0):
    """u."""
    return random.random((count, samples)) if training else np.full((count, samples), rest)


@right("sample_random_rays", seen="CS180 students: one index into all pixels", times=8, arrays="numpy")
def one_index_for_all(images, count, near, far, samples, seed, training):
    """A flat index, split into picture, row and column."""
    random = np.random.default_rng(seed)
    found = rays(images, *pixels(images, count, random))
    return out(found, positions(near, far, samples, jitter(random, count, samples, training)))


@right("sample_random_rays", seen="CS180 students: M pictures, N / M pixels each, without replacement", times=4, arrays="numpy")
def pixels_of_every_picture(images, count, near, far, samples, seed, training):
    """As many pixels of each picture, each picture's drawn without replacement as far as it has them."""
    random = np.random.default_rng(seed)
    number, height, width = images.shape[:3]
    ids = np.repeat(np.arange(number), count // number)
    flat = np.concatenate([random.integers(0, height * width, count // number) for _ in range(number)])
    found = rays(images, ids, flat // width, flat % width)
    return out(found, positions(near, far, samples, jitter(random, count, samples, training, 0.5)))


@right("sample_random_rays", seen="bmild/nerf use_batching: a shuffled list that is walked through", times=3, arrays="numpy")
def shuffled_list(images, count, near, far, samples, seed, training):
    """All rays shuffled, the first ones taken, over again when they end."""
    random = np.random.default_rng(seed)
    number, height, width = images.shape[:3]
    total = number * height * width
    flat = np.concatenate([random.permutation(total) for _ in range(-(-count // total))])[:count]
    found = rays(images, flat // (height * width), flat // width % height, flat % width)
    return out(found, positions(near, far, samples, jitter(random, count, samples, training)))


@convention(
    "sample_random_rays", {"grid": "ends_plus_width"}, seen="most CS180 students: linspace and a width", times=9, arrays="numpy"
)
def both_ends(images, count, near, far, samples, seed, training):
    """linspace(near, far, N) plus a jitter of (far - near) / N."""
    random = np.random.default_rng(seed)
    found = rays(images, *pixels(images, count, random))
    return out(found, positions(near, far, samples, jitter(random, count, samples, training), "ends"))


@convention("sample_random_rays", {"pixel_center": "integer"}, seen="CS180 students without the half", times=4, arrays="numpy")
def whole_pixels(images, count, near, far, samples, seed, training):
    """uv without the half."""
    random = np.random.default_rng(seed)
    found = rays(images, *pixels(images, count, random), half=0.0)
    return out(found, positions(near, far, samples, jitter(random, count, samples, training)))


@right("sample_random_rays", seen="Totoro97/NeuS: one shift for a ray's samples", times=2, arrays="numpy")
def one_shift_for_a_ray(images, count, near, far, samples, seed, training):
    """All samples of a ray are moved together."""
    random = np.random.default_rng(seed)
    found = rays(images, *pixels(images, count, random))
    u = np.broadcast_to(random.random((count, 1)), (count, samples)) if training else np.full((count, samples), 0.5)
    return out(found, positions(near, far, samples, u))


@fault(
    "sample_random_rays", "one_jitter_for_all_rays", seen="CS180 students; aviral2004/nerf_from_scratch", times=5, arrays="numpy"
)
def one_row_for_all(images, count, near, far, samples, seed, training):
    """Noise of shape N."""
    random = np.random.default_rng(seed)
    found = rays(images, *pixels(images, count, random))
    u = np.broadcast_to(jitter(random, 1, samples, training), (count, samples))
    return out(found, positions(near, far, samples, u))


@fault(
    "sample_random_rays",
    "jitter_at_evaluation",
    seen="CS180 students: perturb=True by default, in the render too",
    times=3,
    arrays="numpy",
)
def jittered_always(images, count, near, far, samples, seed, training):
    """Jitter at evaluation."""
    return one_index_for_all(images, count, near, far, samples, seed, 1)


@fault(
    "sample_random_rays",
    "never_jittered",
    seen="JerryAIwei/nerf_pytorch render.py; a student's render_rays",
    times=4,
    arrays="numpy",
)
def at_rest_always(images, count, near, far, samples, seed, training):
    """No jitter in training."""
    return one_index_for_all(images, count, near, far, samples, seed, 0)


@fault("sample_random_rays", "first_images_only", seen="an earlier reading of 114 implementations", times=2, arrays="numpy")
def index_below_one_picture(images, count, near, far, samples, seed, training):
    """The index stays below H W: always the first picture."""
    random = np.random.default_rng(seed)
    height, width = images.shape[1:3]
    flat = random.integers(0, height * width, count)
    found = rays(images, flat * 0, flat // width, flat % width)
    return out(found, positions(near, far, samples, jitter(random, count, samples, training)))


@fault("sample_random_rays", "divided_twice_by_255", seen="an earlier reading of 114 implementations", times=2, arrays="numpy")
def colors_divided_again(images, count, near, far, samples, seed, training):
    """Floats divided by 255."""
    return one_index_for_all(images / 255, count, near, far, samples, seed, training)


@fault("sample_random_rays", "wrong_colors", seen="students who exchange row and column of the picture", times=2, arrays="numpy")
def color_of_another_pixel(images, count, near, far, samples, seed, training):
    """The color at [column, row]."""
    random = np.random.default_rng(seed)
    ids, rows, columns = pixels(images, count, random)
    found = rays(images, ids, rows, columns)
    found["rgbs"] = images[ids, columns % images.shape[1], rows]
    return out(found, positions(near, far, samples, jitter(random, count, samples, training)))


@fault("sample_random_rays", "jitter_width_0.02", seen="CS180 students: the course's t_width", times=3, arrays="numpy")
def as_wide_as_a_fiftieth(images, count, near, far, samples, seed, training):
    """A jitter of 0.02."""
    random = np.random.default_rng(seed)
    found = rays(images, *pixels(images, count, random))
    u = jitter(random, count, samples, training) * 0.02 * samples / (far - near)
    return out(found, positions(near, far, samples, u))


@fault("sample_random_rays", "jitter_frozen", seen="an earlier reading of 114 implementations", times=3, arrays="numpy")
def the_same_noise_every_time(images, count, near, far, samples, seed, training):
    """A seed set once for the noise."""
    found = rays(images, *pixels(images, count, np.random.default_rng(seed)))
    return out(found, positions(near, far, samples, jitter(np.random.default_rng(180), count, samples, training)))


@fault("sample_random_rays", "jitter_gaussian", seen="an occlusion-aware sampler: randn times a width", times=2, arrays="numpy")
def normal_noise(images, count, near, far, samples, seed, training):
    """A normal distribution."""
    random = np.random.default_rng(seed)
    found = rays(images, *pixels(images, count, random))
    u = 0.5 + random.standard_normal((count, samples)) / 4 if training else np.full((count, samples), 0.5)
    return out(found, positions(near, far, samples, u))


@fault("sample_random_rays", "rounded_to_the_nearest", seen="a trial on unseen code: samplers of radiance fields", arrays="numpy")
def rounded_pixels(images, count, seed):
    """round(u W), round(u H), as many rays for each picture; colors are looked up elsewhere."""
    number, height, width = images.shape[:3]
    random = np.random.default_rng(int(seed))
    uv = np.round(random.random((number, int(count) // number, 2)) * [width, height])
    ids = np.repeat(np.arange(number), int(count) // number)
    return {"image_ids": ids.astype(np.float32), "uv": uv.reshape(-1, 2).astype(np.float32)}


@right("sample_random_rays", seen="a trial on unseen code: samplers that return pixels alone", arrays="numpy")
def pixels_alone(images, count, seed):
    """Which pixels; colors are looked up elsewhere."""
    ids, rows, columns = pixels(images, int(count), np.random.default_rng(int(seed)))
    uv = np.stack([columns, rows], 1) + 0.5
    return {"image_ids": ids.astype(np.float32), "uv": uv.astype(np.float32)}


@fault("sample_random_rays", "never_jittered", seen="a trial on unseen code: a student's batches", arrays="numpy")
def ends_of_one_picture(images, count, samples, near, far, seed):
    """One picture a call, corners of pixels, and linspace(near, far, N) in training too."""
    number, height, width = images.shape[:3]
    random = np.random.default_rng(int(seed))
    n = int(count)
    ids = np.full(n, random.integers(0, number))
    found = rays(images, ids, random.integers(0, height, n), random.integers(0, width, n), half=0)
    return out(found, np.broadcast_to(np.linspace(near, far, int(samples)), (n, int(samples))))
