"""The faults: what is wrong, in which rows and types, and how it is planted around a right kernel."""

from dataclasses import dataclass

import numpy as np
from kernel import Kernel, arrays_of, rounded

PLANTED = []
FORWARD, VJP = "forward", "vjp"


@dataclass
class Fault:
    """One fault in one row, direction and type."""

    name: str
    family: str
    row: str
    kind: str
    dtype: str
    plant: object
    tier: str = "small"

    def candidate(self):
        """The kernel with the fault in it."""
        kernel = Kernel(self.row, self.kind, self.dtype)
        return self.plant(kernel)


def plant(name, family, rows, dtypes=("f32",), tier="small"):
    """Plants a fault in rows (`row` or `row/vjp`) and types; what it decorates makes the wrong kernel of the right one."""

    def listed(wrap):
        for row in rows:
            row, _, kind = row.partition("/")
            PLANTED.extend(Fault(name, family, row, kind or FORWARD, dtype, wrap, tier) for dtype in dtypes)
        return wrap

    return listed


def of_inputs(change):
    """The right kernel on other inputs."""
    return lambda kernel: lambda **arrays: kernel(**change(dict(arrays)))


def of_outputs(change):
    """The right kernel's outputs, changed: (outputs, inputs) -> outputs."""

    def wrap(kernel):
        def wrong(**arrays):
            out = kernel(**arrays)
            return kernel.stored(change({name: x.astype(np.float64) for name, x in out.items()}, arrays))

        return wrong

    return wrap


def through(dtype, chosen=None):
    """Inputs, or those that are chosen by name, rounded to a shorter type on the way in."""

    def change(arrays):
        names = [name for name in arrays_of(arrays) if chosen is None or chosen(name)]
        return arrays | {name: rounded(arrays[name], dtype).astype(arrays[name].dtype) for name in names}

    return of_inputs(change)


# Precision.
REAL = (
    "transform pixel_to_ray sample_along_rays positional_encoding nerf_mlp hash_grid spherical_harmonics trunc_exp volume_render "
    "volume_render/vjp volume_render_alpha early_stop packed_scan distortion_loss depth adam_step importance_sampling contraction "
    "gaussian_covariance gaussian_projection lens_distort mse linear_to_srgb"
).split()
for short in ("tf32", "bf16", "f16"):
    plant(f"inputs through {short}", "precision", REAL, ("f32",))(through(short))
plant("f64 inputs through f32", "precision", REAL, ("f64",))(through("f32"))
parameters = ["mlp", "mlp/vjp", "nerf_mlp", "nerf_mlp/vjp", "hash_grid"]
plant("parameters kept in bf16", "precision", parameters, ("f64", "f32"))(
    through("bf16", lambda name: name.startswith(("w", "table")) or name.endswith("_w"))
)


@plant("computed in f32, answered in f64", "precision", REAL, ("f64",))
def in_single(kernel):
    """Everything in f32: inputs, results."""
    single = Kernel(kernel.row, kernel.kind, "f32")
    return lambda **arrays: {name: x.astype(np.float64) for name, x in through("f32")(single)(**arrays).items()}


@plant("results kept in bf16", "precision", ["volume_render", "mlp", "hash_grid", "adam_step", "transform"], ("f64", "f32"))
def results_in_bf16(kernel):
    """A buffer of the short type at the end."""
    return lambda **arrays: {name: rounded(x, "bf16") for name, x in kernel(**arrays).items()}


# State: what one call leaves to the next.
STATE = [
    "transform",
    "positional_encoding",
    "volume_render",
    "volume_render/vjp",
    "mlp",
    "adam_step",
    "hash_grid",
    "mse",
    "packed_scan",
]


# What has items, one of which may be lost.
OF_ITEMS = [row for row in STATE if row != "mse"]


@plant("the first answer of a shape, repeated", "state", STATE, ("f32", "bf16"))
def repeated(kernel):
    """A cache that is keyed by shapes."""
    known = {}

    def wrong(**arrays):
        out = kernel(**arrays)
        key = tuple(x.shape for x in out.values())
        return known.setdefault(key, out)

    return wrong


@plant("the answer to the question before", "state", STATE)
def late(kernel):
    """A result that is copied out before the kernel has run."""
    last = {}

    def wrong(**arrays):
        out = kernel(**arrays)
        key = tuple(x.shape for x in out.values())
        before, last[key] = last.get(key, out), out
        return before

    return wrong


@plant("buffers that are added to, never cleared", "state", STATE)
def added(kernel):
    """Accumulates with atomic additions into what is there."""
    sums = {}

    def wrong(**arrays):
        out = kernel(**arrays)
        for name, x in out.items():
            sums[name, x.shape] = sums.get((name, x.shape), 0) + x
        return {name: sums[name, x.shape] for name, x in out.items()}

    return wrong


@plant("the second call of a shape rolled by one", "state", OF_ITEMS)
def rolled(kernel):
    """Every other call of a shape starts one item late."""
    calls = {}

    def wrong(**arrays):
        out = kernel(**arrays)
        key = tuple(x.shape for x in out.values())
        calls[key] = calls.get(key, 0) + 1
        return {name: np.roll(x, 1, 0) if x.ndim and calls[key] % 2 == 0 else x for name, x in out.items()}

    return wrong


@plant("the last item kept from the call before", "state", OF_ITEMS)
def tail_of_before(kernel):
    """The last block isn't written where it isn't full: what lay there stays."""
    last = {}

    def wrong(**arrays):
        out = {name: x.copy() for name, x in kernel(**arrays).items()}
        for name, x in out.items():
            before, last[name, x.shape] = last.get((name, x.shape)), x.copy()
            if before is not None and x.ndim and len(x):
                x[-1] = before[-1]
        return out

    return wrong


# Habits of kernels.
@plant(
    "a race: an item in a hundred misses its last addition",
    "habits",
    ["volume_render", "mlp", "hash_grid", "adam_step", "packed_scan"],
)
def race(kernel):
    """Lost updates, other ones in each call."""
    draw = np.random.default_rng(7)

    def wrong(**arrays):
        return {name: np.where(draw.random(x.shape) < 0.01, x * x.dtype.type(0.9), x) for name, x in kernel(**arrays).items()}

    return wrong


@plant("sums in another order at each call", "habits", ["volume_render", "mlp", "mse", "packed_scan", "accumulate_along_rays"])
def unstable(kernel):
    """Atomic additions: the last bit depends on chance."""
    draw = np.random.default_rng(8)
    return lambda **arrays: {
        name: np.where((draw.random(x.shape) < 0.3) & (x != 0), np.nextafter(x, x.dtype.type(np.inf)), x)
        for name, x in kernel(**arrays).items()
    }


def by_item(trouble):
    """Outputs of the items where there is trouble, half as large again: (inputs, items) -> mask over items."""

    def change(out, arrays):
        n = len(next(iter(out.values()))) if all(np.ndim(x) for x in out.values()) else 0
        mask = np.asarray(trouble(arrays, n), bool)
        for x in out.values():
            if np.ndim(x) and len(x) == len(mask):
                x[mask] = x[mask] * 1.5 + 0.125
        return out

    return of_outputs(change)


PER_ITEM = [
    "transform",
    "pixel_to_ray",
    "positional_encoding",
    "mlp",
    "nerf_mlp",
    "spherical_harmonics",
    "trunc_exp",
    "hash_grid",
    "adam_step",
]
PER_RAY = ["volume_render", "volume_render_alpha", "depth", "sample_along_rays", "importance_sampling", "distortion_loss"]
plant("all but the first item wrong", "habits", PER_ITEM + PER_RAY)(by_item(lambda arrays, n: np.arange(n) > 0))
plant("the last item of an odd number wrong", "habits", PER_ITEM + PER_RAY)(
    by_item(lambda arrays, n: (np.arange(n) == n - 1) & (n % 2 == 1))
)


@plant("a cache that is keyed by which numbers come, not by their order", "habits", PER_ITEM + PER_RAY)
def unordered(kernel):
    """Keyed by a sum or a histogram: the same rays in another order are the same question to it."""
    known = {}

    def wrong(**arrays):
        key = tuple(np.sort(np.asarray(x), None).tobytes() for x in arrays.values())
        return known.setdefault(key, kernel(**arrays))

    return wrong


@plant("arrays are read as if they lay in one piece", "habits", PER_ITEM + PER_RAY)
def in_one_piece(kernel):
    """A pointer without its strides."""

    def read(x):
        strided = isinstance(x, np.ndarray) and x.size and not x.flags.c_contiguous
        return x.base.reshape(-1)[: x.size].reshape(x.shape) if strided else x

    return lambda **arrays: kernel(**{name: read(x) for name, x in arrays.items()})


# Inputs that trigger.
def rays_where(condition):
    """Rays of which some sample has it."""
    return by_item(lambda arrays, n: condition(arrays).reshape(n, -1).any(1))


def last(x):
    """The last sample's."""
    return x[:, -1:] if x.shape[1] else x


TYPES = ("f64", "f32")
RENDER = ["volume_render", "volume_render/vjp"]
plant("wrong where sigma > 0 in front of a last step of 1e10", "trigger", RENDER, TYPES)(
    rays_where(lambda a: (last(a["sigmas"]) > 0) & (last(a["deltas"]) > 1e9))
)
plant("wrong where a color is above 1", "trigger", RENDER, TYPES)(rays_where(lambda a: a["rgbs"] > 1))
plant("wrong where a color is below 0", "trigger", RENDER, TYPES)(rays_where(lambda a: a["rgbs"] < 0))
plant("wrong where a step is 0", "trigger", RENDER, TYPES)(rays_where(lambda a: a["deltas"] == 0))
plant("wrong where a density is infinite", "trigger", ["volume_render"], TYPES)(rays_where(lambda a: np.isinf(a["sigmas"])))
plant("wrong where a density is above 1e4", "trigger", RENDER, TYPES)(rays_where(lambda a: a["sigmas"] > 1e4))
plant("wrong on an empty ray", "trigger", RENDER, TYPES)(
    by_item(lambda a, n: (a["sigmas"] * (a["deltas"] > 0) == 0).reshape(n, -1).all(1))
)
plant("wrong from the 33rd sample on", "trigger", RENDER, TYPES)(by_item(lambda a, n: np.full(n, a["sigmas"].shape[1] > 32)))
plant("wrong from the 129th sample on", "trigger", RENDER, TYPES)(by_item(lambda a, n: np.full(n, a["sigmas"].shape[1] > 128)))
plant("wrong for one ray", "trigger", [*RENDER, "sample_along_rays", "depth"], TYPES)(by_item(lambda a, n: np.full(n, n == 1)))
plant("wrong for more than two rays", "trigger", [*RENDER, "importance_sampling"], TYPES)(by_item(lambda a, n: np.full(n, n > 2)))
plant("wrong where alpha is 1", "trigger", ["volume_render_alpha", "volume_render_alpha/vjp"], TYPES)(
    rays_where(lambda a: a["alphas"] == 1)
)
plant("wrong where x is negative", "trigger", ["positional_encoding", "trunc_exp", "contraction"], TYPES)(
    rays_where(lambda a: a["x"] < 0)
)
plant("wrong where |x| is above 1", "trigger", ["positional_encoding", "contraction"], TYPES)(
    rays_where(lambda a: np.abs(a["x"]) > 1)
)
plant("wrong from the tenth band on", "trigger", ["positional_encoding"], TYPES)(
    by_item(lambda a, n: np.full(n, int(a["L"]) > 9))
)
plant("wrong from degree 3 on", "trigger", ["spherical_harmonics"], TYPES)(by_item(lambda a, n: np.full(n, int(a["degree"]) > 2)))
plant("wrong on a face of the box", "trigger", ["hash_grid"], TYPES)(rays_where(lambda a: (a["x"] == 0) | (a["x"] == 1)))
plant("wrong where features are more than two", "trigger", ["hash_grid"], TYPES)(
    by_item(lambda a, n: np.full(n, a["table0"].shape[1] > 2))
)
plant("wrong where levels are finer than 31", "trigger", ["hash_grid"], TYPES)(
    by_item(lambda a, n: np.full(n, float(a["finest"]) > 31))
)
plant("wrong along an axis", "trigger", ["ray_aabb"], TYPES)(rays_where(lambda a: a["rays_d"] == 0))
plant("wrong for backward rays", "trigger", ["ray_aabb"], TYPES)(rays_where(lambda a: a["rays_d"] < 0))
plant("wrong where a gradient is 0", "trigger", ["adam_step"], TYPES)(rays_where(lambda a: a["grad"] == 0))
plant("wrong after ten thousand steps", "trigger", ["adam_step"], TYPES)(by_item(lambda a, n: np.full(n, float(a["step"]) > 1e4)))
plant("wrong with weight decay", "trigger", ["adam_step"], TYPES)(by_item(lambda a, n: np.full(n, float(a["weight_decay"]) > 0)))
plant("wrong with other betas", "trigger", ["adam_step"], TYPES)(by_item(lambda a, n: np.full(n, float(a["beta1"]) != 0.9)))
plant("wrong where u is 0", "trigger", ["importance_sampling", "sample_along_rays"], TYPES)(rays_where(lambda a: a["u"] == 0))
plant("wrong where all weights are 0", "trigger", ["importance_sampling", "depth"], TYPES)(
    by_item(lambda a, n: (a["weights"] == 0).reshape(n, -1).all(1))
)
plant("wrong where a weight is 0", "trigger", ["importance_sampling", "distortion_loss"], TYPES)(
    rays_where(lambda a: a["weights"] == 0)
)
plant("wrong in portrait", "trigger", ["image_rays", "render_trace"], TYPES)(
    of_outputs(lambda out, a: {name: x * (1.5 if float(a["height"]) > float(a["width"]) else 1.0) for name, x in out.items()})
)
plant("wrong where the camera is far from the origin", "trigger", ["transform", "pixel_to_ray"], TYPES)(
    rays_where(lambda a: np.abs(a["c2w"][:, :3, 3]) > 100)
)


def of_ray(condition):
    """Outputs of packed rays, one number or more each, where a ray is so long: wrong in those alone."""

    def change(out, arrays):
        lengths = np.diff(np.asarray(arrays["offsets"]).astype(int))
        rays = condition(lengths)
        samples = np.repeat(rays, lengths)
        for x in out.values():
            mask = rays if len(x) == len(rays) and len(rays) != len(samples) else samples if len(x) == len(samples) else rays
            x[mask] = x[mask] * 1.5 + 0.125
        return out

    return of_outputs(change)


PACKED = ["packed_scan", "accumulate_along_rays"]
plant("wrong in rays of one sample", "trigger", PACKED, TYPES)(of_ray(lambda lengths: lengths == 1))
plant("wrong behind a ray without samples", "trigger", PACKED, TYPES)(
    of_ray(lambda lengths: np.concatenate([[False], lengths[:-1] == 0])[: len(lengths)])
)


# Size: asked at real sizes.
def items_from(condition):
    """Items whose number is so are left as they were: 0."""

    def change(out, arrays):
        for x in out.values():
            if np.ndim(x):
                x[condition(np.arange(len(x)), len(x))] = 0.0
        return out

    return of_outputs(change)


LARGE = ["volume_render", "positional_encoding", "mlp", "hash_grid", "adam_step", "importance_sampling"]
for block in (32, 256):
    plant(f"the last block of {block} lost", "size", LARGE, ("f32",), "large")(
        items_from(lambda i, n, block=block: i >= n - n % block)
    )
plant("no more than 65,536 items", "size", ["volume_render", "positional_encoding", "adam_step", "hash_grid"], ("f32",), "large")(
    items_from(lambda i, n: i >= 65536)
)
plant("the last item alone lost", "size", LARGE, ("f32",), "large")(items_from(lambda i, n: i == n - 1))


def carry_lost(every):
    """A scan along a ray that begins anew every so many samples: nothing in front of a block shades it."""

    def wrap(kernel):
        def wrong(**arrays):
            out = kernel.exact(arrays)
            sigmas, deltas = (np.asarray(arrays[name], np.float64) for name in ("sigmas", "deltas"))
            depth = np.where(deltas == 0, 0.0, sigmas) * deltas
            n = depth.shape[1]
            weights = np.zeros_like(depth)
            for first in range(0, n, every):
                part = depth[:, first : first + every]
                front = np.concatenate([np.zeros((len(part), 1)), np.cumsum(part, 1)[:, :-1]], 1)
                weights[:, first : first + every] = np.exp(-front) * -np.expm1(-part)
            if n > every:
                out |= {"weights": weights, "colors": (weights[..., None] * arrays["rgbs"]).sum(1), "opacity": weights.sum(1)}
            return kernel.stored(out)

        return wrong

    return wrap


for every in (32, 128, 1024):
    plant(f"the carry of a scan lost every {every} samples", "size", ["volume_render"], ("f32", "bf16"), "large")(
        carry_lost(every)
    )
