"""Hash grid, harmonics, truncated exponential."""

import numpy as np
import torch
from entry import convention, fault, right

PRIMES = (1, 2654435761, 805459861)


def tables(rest):
    """The levels' tables."""
    return [rest[f"table{i}"] for i in range(sum(name.startswith("table") for name in rest))]


def resolutions(base, finest, L, how):
    """Cells along an edge, level by level."""
    growth = (finest / base) ** (1 / (L - 1)) if L > 1 else 1.0
    return [int(how(base * growth**level + (1e-6 if how is np.floor else 0))) for level in range(L)]


def entry_of(corner, n, size, primes=PRIMES, dense=True, combine=np.bitwise_xor):
    """The entry of each vertex: dense where all fit, else hashed."""
    x, y, z = (corner[:, k].astype(np.uint64) for k in range(3))
    if dense and (n + 1) ** 3 <= size:
        return (x + np.uint64(n + 1) * (y + np.uint64(n + 1) * z)).astype(np.int64)
    mixed = combine(combine(x * np.uint64(primes[0]), y * np.uint64(primes[1])), z * np.uint64(primes[2]))
    return (mixed % np.uint64(size)).astype(np.int64)


def encoded(x, levels, sizes, offset=0.0, smooth=False, last_cell=True, axes=3, **how):
    """Trilinear interpolation, level by level; corners are weighed along so many axes."""
    out = []
    for table, n in zip(levels, sizes):
        at = x * n + offset
        cell = np.floor(at.detach().numpy())
        cell = np.minimum(cell, n - 1) if last_cell else cell
        part = at - torch.from_numpy(cell)
        part = part * part * (3 - 2 * part) if smooth else part
        total = 0
        for corner in range(8):
            bits = np.array([corner >> k & 1 for k in range(3)])
            weight = torch.stack([part[:, k] if bits[k] else 1 - part[:, k] for k in range(axes)]).prod(0)
            total = total + weight[:, None] * table[torch.from_numpy(entry_of(cell + bits, n, len(table), **how))]
        out.append(total)
    return torch.cat(out, -1)


@right("hash_grid", seen="torch ports that index coarse levels densely and round", times=2)
def rounded_and_dense(x, base, finest, **rest):
    """Whole resolutions, coarse levels dense, corners by bits."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.rint))


@convention("hash_grid", {"hash_levels": "floor"}, seen="Instant-NGP's equation 2; int(base * growth ** level) of a torch port", times=6)
def resolutions_cut(x, base, finest, **rest):
    """floor(base growth^l), coarse levels dense."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.floor))


def between_floor_and_ceiling(x, levels, sizes):
    """All vertices hashed, on a grid of any size."""
    out = []
    for table, n in zip(levels, sizes):
        at = x * float(n)
        low, high = torch.floor(at), torch.ceil(at)
        part, total = at - low, 0
        for corner in range(8):
            bits = [corner >> k & 1 for k in range(3)]
            vertex = torch.stack([(high if bits[k] else low)[:, k] for k in range(3)], -1).detach().numpy()
            weight = torch.stack([part[:, k] if bits[k] else 1 - part[:, k] for k in range(3)]).prod(0)
            total = total + weight[:, None] * table[torch.from_numpy(entry_of(vertex, n, len(table), dense=False))]
        out.append(total)
    return torch.cat(out, -1)


@convention(
    "hash_grid",
    {"hash_levels": "floor", "hash_index": "hashed"},
    seen="nerfstudio encodings.py (its torch code); HashNeRF-pytorch hash_encoding.py; a jax port",
    times=4,
)
def all_levels_hashed(x, base, finest, **rest):
    """floor of the resolutions, and every level hashed."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.floor), dense=False)


@convention("hash_grid", {"hash_weights": "smoothstep"}, seen="tiny-cuda-nn encodings/grid.h, interpolation Smoothstep; nerfstudio's option", times=2)
def smooth_weights(x, base, finest, **rest):
    """3 t^2 - 2 t^3 of the fractions."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.rint), smooth=True)


@convention("hash_grid", {"hash_primes": "prime"}, seen="tiny-cuda-nn hash type Prime; a python mirror of it", times=2)
def another_first_prime(x, base, finest, **rest):
    """1958374283 for x."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.rint), primes=(1958374283, *PRIMES[1:]))


def scaled(x, base, finest, levels, shift, more=0, smooth=False, **how):
    """x (n - 1) + shift with n in f32, not rounded; dense levels count ceil(n - 1) + 1 + more vertices."""
    out, growth = [], np.float32(np.log2(finest / base) / max(len(levels) - 1, 1))
    for level, table in enumerate(levels):
        scale = float(np.exp2(np.float32(level) * growth) * np.float32(base) - np.float32(1))
        side = int(np.ceil(scale)) + 1 + more
        at = x * scale + shift
        cell = np.floor(at.detach().numpy())
        part = at - torch.from_numpy(cell)
        part = part * part * (3 - 2 * part) if smooth else part
        total = 0
        for corner in range(8):
            bits = np.array([corner >> k & 1 for k in range(3)])
            weight = torch.stack([part[:, k] if bits[k] else 1 - part[:, k] for k in range(3)]).prod(0)
            entry = entry_of(cell + bits, side - 1, len(table), **how) % len(table)
            total = total + weight[:, None] * table[torch.from_numpy(entry)]
        out.append(total)
    return torch.cat(out, -1)


@convention(
    "hash_grid",
    {"hash_levels": "tiny_cuda_nn"},
    seen="tiny-cuda-nn encodings/grid.h and a taichi port of Instant-NGP: scale and +0.5",
    times=4,
)
def half_a_cell_shifted(x, base, finest, **rest):
    """x (n - 1) + 1/2, where n isn't rounded, ceil(n - 1) + 1 vertices."""
    return scaled(x, base, finest, tables(rest), 0.5)


@convention(
    "hash_grid",
    {"hash_levels": "tiny_cuda_nn", "hash_weights": "smoothstep", "hash_primes": "reversed"},
    seen="not met: tiny-cuda-nn's options, all at once",
    times=0,
)
def options_of_the_cuda_grid(x, base, finest, **rest):
    """The same with smoothstep and the reversed primes."""
    return scaled(x, base, finest, tables(rest), 0.5, smooth=True, primes=(2165219737, 1434869437, 2097192037))


@convention("hash_grid", {"hash_levels": "torch_ngp"}, seen="ashawkey/torch-ngp gridencoder.cu and its copies", times=6)
def one_vertex_more(x, base, finest, **rest):
    """x (n - 1) + 1/2, and ceil(n - 1) + 2 vertices."""
    return scaled(x, base, finest, tables(rest), 0.5, more=1)


@convention("hash_grid", {"hash_levels": "align_corners"}, seen="torch-ngp gridencoder.cu, align_corners", times=2)
def aligned_corners(x, base, finest, **rest):
    """x (n - 1)."""
    return scaled(x, base, finest, tables(rest), 0.0)


@convention(
    "hash_grid",
    {"hash_levels": "floor", "hash_index": "hashed"},
    seen="nerfstudio encodings.py: corners by floor and ceil, n in f32",
    times=2,
)
def floors_and_ceilings(x, base, finest, **rest):
    """Corners by floor and ceil: on a face both are one vertex; floor of powers in f32."""
    levels = tables(rest)
    growth = np.exp((np.log(finest) - np.log(base)) / (len(levels) - 1)) if len(levels) > 1 else 1.0
    sizes = np.floor(np.float32(base) * np.float32(growth) ** np.arange(len(levels), dtype=np.float32))
    return between_floor_and_ceiling(x, levels, sizes)


@fault("hash_grid", "resolution_not_rounded", seen="a trial on unseen code: Nexels, a C# renderer", times=2, gradient="none")
def real_numbers_of_cells(x, base, finest, **rest):
    """base growth^l as it is; all hashed."""
    levels = tables(rest)
    growth = (finest / base) ** (1 / max(len(levels) - 1, 1))
    return between_floor_and_ceiling(x, levels, [base * growth**i for i in range(len(levels))])


@fault("hash_grid", "growth_over_levels", seen="ports whose growth is taken over L steps")
def growth_too_small(x, base, finest, **rest):
    """(finest / base)^(1 / L)."""
    levels = tables(rest)
    growth = (finest / base) ** (1 / len(levels))
    return encoded(x, levels, [int(np.rint(base * growth**i)) for i in range(len(levels))])


@fault("hash_grid", "sum_for_xor", seen="hash functions that add", times=1)
def hashed_by_a_sum(x, base, finest, **rest):
    """A sum in the place of the exclusive or."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.rint), combine=np.add)


@fault("hash_grid", "primes_rolled", seen="kaolin-wisp#132")
def primes_of_other_axes(x, base, finest, **rest):
    """2654435761, 805459861, 1."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.rint), primes=(*PRIMES[1:], 1))


@fault("hash_grid", "primes_of_cloth", seen="a torch port that took the factors of the hash that the paper cites")
def factors_of_another_paper(x, base, finest, **rest):
    """73856093, 19349663, 83492791."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.rint), primes=(73856093, 19349663, 83492791))


@fault(
    "hash_grid",
    "primes_of_cloth_but_the_first",
    seen="a trial on unseen code: dendenxu/mipnerf360-pytorch-minus lib/networks/embedder.py",
    times=2,
)
def factors_behind_a_one(x, base, finest, **rest):
    """1, 19349663, 83492791."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.rint), primes=(1, 19349663, 83492791))


@fault("hash_grid", "last_axis_unweighted", seen="a trial on unseen code: the same embedder", gradient="last_axis_unweighted")
def weighed_along_two_axes(x, base, finest, **rest):
    """Corner weights of x and y alone."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.rint), axes=2)


@fault("hash_grid", "vertices_from_one", seen="ymtoo/FieldEncoders.jl src/hash.jl, all levels hashed")
def grid_that_begins_at_one(x, base, finest, **rest):
    """x N + 1."""
    levels = tables(rest)
    return encoded(x, levels, resolutions(base, finest, len(levels), np.floor), offset=1.0, last_cell=False, dense=False)


@fault("hash_grid", "nearest_vertex", seen="a robot's hash encoder that looks up one entry", times=2)
def one_vertex_alone(x, base, finest, **rest):
    """The nearest vertex, not interpolated."""
    out, levels = [], tables(rest)
    for table, n in zip(levels, resolutions(base, finest, len(levels), np.rint)):
        vertex = np.floor(x.detach().numpy() * n + 0.5)
        out.append(table[torch.from_numpy(entry_of(vertex, n, len(table)))])
    return torch.cat(out, -1)


def harmonics(d, degree, sign):
    """Real harmonics up to degree 4 on the unit sphere; `sign` times those of odd m."""
    x, y, z = d.unbind(-1)
    xx, yy, zz, s = x * x, y * y, z * z, sign
    out = [0.28209479177387814 + 0 * x]
    if degree > 0:
        out += [s * 0.4886025119029199 * y, 0.4886025119029199 * z, s * 0.4886025119029199 * x]
    if degree > 1:
        out += [1.0925484305920792 * x * y, s * 1.0925484305920792 * y * z, 0.9461746957575601 * zz - 0.31539156525251999]
        out += [s * 1.0925484305920792 * x * z, 0.5462742152960396 * (xx - yy)]
    if degree > 2:
        out += [
            s * 0.5900435899266435 * y * (3 * xx - yy),
            2.890611442640554 * x * y * z,
            s * 0.4570457994644658 * y * (5 * zz - 1),
        ]
        out += [
            0.3731763325901154 * z * (5 * zz - 3),
            s * 0.4570457994644658 * x * (5 * zz - 1),
            1.445305721320277 * z * (xx - yy),
        ]
        out += [s * 0.5900435899266435 * x * (xx - 3 * yy)]
    if degree > 3:
        out += [2.5033429417967046 * x * y * (xx - yy), s * 1.7701307697799304 * y * z * (3 * xx - yy)]
        out += [0.9461746957575601 * x * y * (7 * zz - 1), s * 0.6690465435572892 * y * z * (7 * zz - 3)]
        out += [0.10578554691520431 * (35 * zz * zz - 30 * zz + 3), s * 0.6690465435572892 * x * z * (7 * zz - 3)]
        out += [0.47308734787878004 * (xx - yy) * (7 * zz - 1), s * 1.7701307697799304 * x * z * (xx - 3 * yy)]
        out += [0.6258357354491761 * (xx * (xx - 3 * yy) - yy * (3 * xx - yy))]
    return out


@right("spherical_harmonics", seen="tiny-cuda-nn spherical_harmonics.h: polynomials on the unit sphere", times=2)
def signed_polynomials(d, degree):
    """With (-1)^m."""
    return torch.stack(harmonics(d, degree, -1), -1)


@convention(
    "spherical_harmonics", {"harmonic_sign": "plain"}, seen="nerfstudio utils/math.py (its torch code), degrees 0 to 3", times=2
)
def unsigned_polynomials(d, degree):
    """Without (-1)^m."""
    return torch.stack(harmonics(d, degree, 1), -1)


@convention(
    "spherical_harmonics",
    {"harmonic_form": "homogeneous"},
    seen="3DGS sh_utils.py, svox2, PlenOctrees, HashNeRF-pytorch",
    times=5,
)
def homogeneous_polynomials(d, degree):
    """With (-1)^m, zz - xx - yy for what needs unit length: the same on the sphere, another gradient beside it."""
    x, y, z = d.unbind(-1)
    xx, yy, zz = x * x, y * y, z * z
    out = harmonics(d, degree, -1)
    if degree > 1:
        out[6] = 0.31539156525252005 * (2.0 * zz - xx - yy)
    if degree > 2:
        out[11], out[13] = -0.4570457994644658 * y * (4 * zz - xx - yy), -0.4570457994644658 * x * (4 * zz - xx - yy)
        out[12] = 0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy)
    return torch.stack(out, -1)


@convention("spherical_harmonics", {"harmonic_form": "normalized"}, seen="splat viewers: dir / |dir| inside the shader", times=2)
def normalized_first(d, degree):
    """Of d / |d|."""
    return torch.stack(harmonics(d / d.norm(dim=-1, keepdim=True), degree, -1), -1)


@convention(
    "spherical_harmonics",
    {"harmonic_sign": "plain", "harmonic_form": "normalized"},
    seen="not met: the two choices together",
    times=0,
)
def normalized_without_signs(d, degree):
    """Of d / |d|, without (-1)^m."""
    return torch.stack(harmonics(torch.nn.functional.normalize(d, dim=-1), degree, 1), -1)


@fault("spherical_harmonics", "band_4_slips", seen="nerfstudio utils/math.py, degree 4 of its torch code")
def two_slips_in_the_fifth_band(d, degree):
    """Without (-1)^m; in band 4 one harmonic lacks its z, and another has a constant too small by the root of 2."""
    out = harmonics(d, degree, 1)
    if degree > 3:
        x, y, z = d.unbind(-1)
        out[19] = 0.6690465435572892 * y * (7 * z * z - 3)
        out[24] = out[24] * (0.4425326924449826 / 0.6258357354491761)
    return torch.stack(out, -1)


@fault(
    "spherical_harmonics", "directions_in_unit_cube", seen="torch-ngp and tiny-cuda-nn callers: (d + 1) / 2 handed on", times=3
)
def shifted_directions(d, degree):
    """(d + 1) / 2 for d."""
    return torch.stack(harmonics((d + 1) / 2, degree, -1), -1)


@fault("spherical_harmonics", "m_descending", seen="not met in this reading", times=0)
def other_order(d, degree):
    """m from l down to -l."""
    out = harmonics(d, degree, -1)
    return torch.stack([out[band * band + band - m] for band in range(degree + 1) for m in range(-band, band + 1)], -1)


class Surrogate(torch.autograd.Function):
    """e^x whose gradient is clamped."""

    @staticmethod
    def forward(ctx, x, low, high):
        """e^x."""
        ctx.save_for_backward(x)
        ctx.ends = low, high
        return torch.exp(x)

    @staticmethod
    def backward(ctx, g):
        """g e^clamp(x)."""
        return g * torch.exp(ctx.saved_tensors[0].clamp(*ctx.ends)), None, None


@right("trunc_exp", seen="torch-ngp activation.py, nerfstudio activations.py, kwea123/ngp_pl custom_functions.py", times=5)
def clamped_at_both_ends(x):
    """Gradient clamped to [-15, 15]."""
    return Surrogate.apply(x, -15, 15)


@convention("trunc_exp", {"exponent_gradient": "above"}, seen="nerfacc's examples and later versions of torch-ngp", times=3)
def clamped_from_above(x):
    """Gradient clamped at 15 alone."""
    return Surrogate.apply(x, None, 15)


@convention("trunc_exp", {"exponent_shift": "one"}, seen="nerfacc's examples: density = trunc_exp(x - 1)", times=2)
def shifted_by_one(x):
    """e^(x - 1)."""
    return Surrogate.apply(x - 1, -15, 15)


@convention(
    "trunc_exp",
    {"exponent_gradient": "above11", "exponent_shift": "one"},
    seen="a CAD code's TruncExp with an offset: exp(11) is what f16 holds",
    times=1,
)
def clamped_for_halves(x):
    """e^(x - 1), the gradient clamped at 11 alone."""
    return Surrogate.apply(x - 1, None, 11)


@fault("trunc_exp", "clamped_above", seen="a city's renderer: exp(min(x, 10))")
def safe_exponential(x):
    """e^min(x, 10), differentiated as it is."""
    return torch.exp(torch.clamp(x, max=10))


@fault("trunc_exp", "clamped_above", seen="not met in this reading: another limit", times=0)
def safe_exponential_at_fifteen(x):
    """e^min(x, 12.5)."""
    return torch.exp(torch.clamp(x, max=12.5))


@right("trunc_exp", gradient=("limits_of_its_own",), seen="an Instant-NGP port: a slope between 1e-6 and 1e6")
def slope_clamped(x):
    """e^x, its slope clamped, not x."""
    return Surrogate.apply(x, float(np.log(1e-6)), float(np.log(1e6)))


@right("trunc_exp", gradient=("gradient_not_clamped",), seen="torch.exp for the density", times=3)
def plain_exponential(x):
    """e^x and its own gradient."""
    return torch.exp(x)


@convention("trunc_exp", {"exponent": "clamped"}, gradient=("zero_outside",), seen="codes that clamp before exp", times=3)
def clamped_before(x):
    """e^clamp(x, -15, 15), differentiated as it stands."""
    return torch.exp(x.clamp(-15, 15))


@fault("trunc_exp", "softplus", seen="softplus for the density, where e^x is asked for", times=2)
def soft_plus(x):
    """log(1 + e^x)."""
    return torch.nn.functional.softplus(x)


@fault("spherical_harmonics", "band_1_signs", seen="a torch port of view-dependent colors")
def signs_of_the_first_band(d, degree):
    """Band 1 without (-1)^m, all others with it."""
    out = harmonics(d, degree, -1)
    if degree > 0:
        out[1], out[3] = -out[1], -out[3]
    return torch.stack(out, -1)


@fault("spherical_harmonics", seen="a trial on unseen code: band 2 by a wrong constant", gradient="none")
def nine_with_a_wrong_band(d, degree):
    """Degrees up to 2, whose band 2 is 7 times too large."""
    if degree > 2:
        raise ValueError("nine coefficients")
    out = harmonics(d, degree, -1)
    return torch.stack(out[:4] + [7 * y for y in out[4:]], -1)


@fault(
    "spherical_harmonics",
    "turned_to_polar_axis_y",
    seen="a trial on unseen code: harmonics by angles of directions with y up",
    gradient="none",
)
def pole_along_y(d, degree):
    """Angles from y, and about it from z."""
    return torch.stack(harmonics(d[:, [2, 0, 1]], degree, 1.0), -1)


@fault("hash_grid", "level_in_the_hash", seen="a trial on unseen code, one of its three faults: an encoder in Rust", gradient="none")
def table_moved_by_its_level(x, base, finest, **rest):
    """hash + level."""
    levels = tables(rest)
    rolled = [torch.roll(table, -n, 0) for n, table in enumerate(levels)]
    return encoded(x, rolled, resolutions(base, finest, len(levels), np.rint), dense=False)


@fault("hash_grid", "resolution_doubled", seen="a trial on unseen code, one of its three faults: an encoder in Rust", gradient="none")
def twice_as_fine_each_level(x, base, finest, **rest):
    """2^l cells, whatever base and finest are."""
    levels = tables(rest)
    return encoded(x, levels, [2**n for n in range(len(levels))])


@fault("hash_grid", "one_cell_less", seen="a trial on unseen code: an encoder in MLX", gradient="none")
def one_vertex_taken_for_one_cell(x, base, finest, **rest):
    """x (N - 1) with N cut to whole numbers, all levels hashed."""
    levels = tables(rest)
    cells = [n - 1 for n in resolutions(base, finest, len(levels), np.floor)]
    return encoded(x, levels, cells, dense=False)


class ClippedSlope(torch.autograd.Function):
    """e^x, whose gradient is clipped itself."""

    @staticmethod
    def forward(ctx, x):
        y = torch.exp(x)
        ctx.save_for_backward(y)
        return y

    @staticmethod
    def backward(ctx, g):
        return (g * ctx.saved_tensors[0]).clamp(-15, 15)


@right("trunc_exp", gradient=("gradient_clipped",), seen="a trial on unseen code: a port to JAX")
def gradient_within_fifteen(x):
    """g e^x, clipped to [-15, 15]."""
    return ClippedSlope.apply(x)


def mixed_by_hash(x, base, finest, rest, place, vertex, entry):
    """Trilinear interpolation of hashed entries: where a point lies, which vertices that is between, and which entry each has."""
    out, levels = [], tables(rest)
    for table, n in zip(levels, resolutions(base, finest, len(levels), np.floor)):
        at = place(x * n, n)
        cell = torch.floor(at)
        part, total = at - cell, 0
        for corner in range(8):
            bits = torch.tensor([corner >> k & 1 for k in range(3)])
            weight = torch.where(bits == 1, part, 1 - part).prod(1, keepdim=True)
            total = total + weight * table[entry(vertex(cell.long() + bits, n), n, len(table))]
        out.append(total)
    return torch.cat(out, -1)


@fault(
    "hash_grid",
    "slip: another formula: N = n rounded down, and vertices floor and the next, of a place held below N - 1, "
    "and hash of x 2654435761, y 805459861, z 3674653429 joined by xor, and dense entry the hash of those",
    seen="a trial on unseen code: a field in Rust",
    gradient="none",
)
def last_cell_unused(x, base, finest, **rest):
    """min(x n, n - 1.0001), always hashed, by primes that begin with the second."""

    def hashed(v, n, size):
        a, b, c = (v[:, k] * p for k, p in enumerate((2654435761, 805459861, 3674653429)))
        return ((a ^ b ^ c) & 0xFFFFFFFF) % size

    return mixed_by_hash(x, base, finest, rest, lambda at, n: at.clamp(max=n - 1.0001), lambda v, n: v, hashed)


@fault(
    "hash_grid",
    "slip: another formula: N = n rounded down, and vertices floor and the next, modulo N, "
    "and hash of x 1, y 2654435761, z 805459861 joined by +, 32 bits of the sum, and dense entry the hash of those, modulo N^3",
    seen="a trial on unseen code: an encoder in PyTorch",
    gradient="none",
)
def sums_around_the_grid(x, base, finest, **rest):
    """Vertices modulo n; a sum of products for their xor, modulo min(T, n^3)."""

    def summed(v, n, size):
        return ((v * torch.tensor(PRIMES)).sum(-1) & 0xFFFFFFFF) % min(size, n**3)

    return mixed_by_hash(x, base, finest, rest, lambda at, n: at, lambda v, n: v % n, summed)
