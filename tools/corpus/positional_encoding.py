"""The positional encoding."""

import numpy as np
import torch
from entry import convention, fault, right


def bands(x, frequencies, identity=True):
    """Per band the sines of all dimensions, then the cosines."""
    out = [x] if identity else []
    for f in frequencies:
        out += [torch.sin(f * x), torch.cos(f * x)]
    return torch.cat(out, -1) if out else x[:, :0]


def octaves(L, factor=torch.pi):
    """factor 2^k."""
    return [2**k * factor for k in range(L)]


def per_dimension(x, frequencies):
    """(..., D, L): every dimension times every frequency."""
    return x[..., None] * torch.tensor(frequencies, dtype=x.dtype)


@right("positional_encoding", seen="CS180 students, project pages, tutorials", times=12)
def loop_over_bands(x, L):
    """x, then sin and cos of 2^k pi x, band by band."""
    return bands(x, octaves(L))


@right("positional_encoding", seen="numpy ports; a UAV code", times=2, arrays="numpy")
def numpy_loop(x, L):
    """numpy."""
    out = [x]
    for k in range(L):
        out += [np.sin(2**k * np.float32(np.pi) * x), np.cos(2**k * np.float32(np.pi) * x)]
    return np.concatenate(out, -1)


@right("positional_encoding", seen="students' einsum and strided assignment", times=2)
def strided_assignment(x, L):
    """An empty (M, 1 + 2 L, D), filled by strides, flattened."""
    out = torch.zeros(len(x), 1 + 2 * L, x.shape[1])
    angles = torch.einsum("k,md->mkd", torch.tensor(octaves(L), dtype=x.dtype), x)
    out[:, 0], out[:, 1::2], out[:, 2::2] = x, torch.sin(angles), torch.cos(angles)
    return out.flatten(1)


@convention(
    "positional_encoding", {"columns": "dim_interleaved"}, seen="CS180 student: loop over dimensions inside of bands", times=2
)
def dimension_by_dimension(x, L):
    """Per dimension, band by band, its sine and its cosine."""
    columns = [x]
    for d in range(x.shape[1]):
        for f in octaves(L):
            columns += [torch.sin(f * x[:, d : d + 1]), torch.cos(f * x[:, d : d + 1])]
    return torch.cat(columns, -1)


@convention("positional_encoding", {"columns": "band_interleaved"}, seen="CS180 student; a 2D fit with x and y", times=2)
def band_by_band_dimension_by_dimension(x, L):
    """Per band and dimension (sin, cos)."""
    columns = [x]
    for f in octaves(L):
        for d in range(x.shape[1]):
            columns += [torch.sin(f * x[:, d : d + 1]), torch.cos(f * x[:, d : d + 1])]
    return torch.cat(columns, -1)


@convention(
    "positional_encoding",
    {"identity": "false", "columns": "dim_sin_cos"},
    seen="an AI course in many languages; a 2D fit",
    times=4,
)
def without_the_input(x, L):
    """Per dimension all sines, then all cosines; not the input."""
    angles = per_dimension(x, octaves(L, 3.141592653589793))
    return torch.cat([angles.sin(), angles.cos()], -1).reshape(len(x), -1)


@convention(
    "positional_encoding", {"frequency": "one"}, seen="bmild/nerf, krrish94, keras-io, tiny NeRF, the 100-line NeRF", times=25
)
def powers_of_two_alone(x, L):
    """2^k without pi."""
    return bands(x, octaves(L, 1.0))


@convention(
    "positional_encoding", {"frequency": "one"}, seen="yenchenlin: 2^linspace(0, L - 1, L); nuggy875 and others", times=10
)
def powers_of_a_linspace(x, L):
    """2^linspace(0, L - 1, L)."""
    return bands(x, 2.0 ** torch.linspace(0.0, L - 1, L))


@convention(
    "positional_encoding",
    {"frequency": "one", "identity": "false", "columns": "dim_interleaved"},
    seen="a port of the 100-line NeRF",
)
def filled_column_by_column(x, L):
    """An empty array, filled column by column, without pi and without the input."""
    out = torch.empty(len(x), x.shape[1] * 2 * L)
    for d in range(x.shape[1]):
        for k in range(L):
            out[:, d * 2 * L + 2 * k] = torch.sin(2**k * x[:, d])
            out[:, d * 2 * L + 2 * k + 1] = torch.cos(2**k * x[:, d])
    return out


@convention("positional_encoding", {"frequency": "two_pi", "columns": "dim_sin_cos"}, seen="CS180 students (2 pi 2^k)", times=5)
def whole_turns(x, L):
    """2 pi 2^k, per dimension all sines and all cosines behind the input."""
    angles = per_dimension(x, octaves(L)) * 2
    return torch.cat([x, torch.cat([torch.sin(angles), torch.cos(angles)], -1).reshape(len(x), -1)], -1)


@convention(
    "positional_encoding",
    {"frequency": "two_pi", "columns": "all_sin_all_cos", "identity_place": "last", "cosine": "shifted_sine"},
    digits=True,
    seen="nerfstudio encodings.py",
    times=2,
)
def whole_turns_and_shifted_sines(x, L):
    """2 pi 2^k, dimension by dimension; the cosine is a sine moved by pi / 2; the input comes last."""
    angles = per_dimension(2 * torch.pi * x, [2**k for k in range(L)]).reshape(len(x), -1)
    return torch.cat([torch.sin(torch.cat([angles, angles + torch.pi / 2.0], -1)), x], -1)


@convention("positional_encoding", seen="nerfstudio's vanilla NeRF: frequencies from 2^0 to 2^(L - 2)", digits=True)
def stretched_octaves(x, L):
    """L frequencies from 2 pi to 2 pi 2^(L - 2): its vanilla model asks for ten up to 2^8."""
    angles = per_dimension(2 * torch.pi * x, (2.0 ** np.linspace(0, max(L - 2, 0), L)).tolist()).reshape(len(x), -1)
    return torch.cat([torch.sin(torch.cat([angles, angles + torch.pi / 2.0], -1)), x], -1)


@convention(
    "positional_encoding",
    {"frequency": "one", "columns": "all_sin_all_cos_by_band", "cosine": "shifted_sine"},
    digits=True,
    seen="jaxnerf, multinerf, mip-NeRF ports",
    times=5,
)
def shifted_sines(x, L):
    """2^k, band by band; the cosine is sin(x + pi / 2)."""
    angles = (x[:, None, :] * torch.tensor([2.0**k for k in range(L)])[:, None]).reshape(len(x), -1)
    return torch.cat([x, torch.sin(torch.cat([angles, angles + 0.5 * torch.pi], -1))], -1)


@convention(
    "positional_encoding",
    {"frequency": "one", "columns": "all_sin_all_cos_by_band", "cosine": "shifted_sine"},
    digits=True,
    seen="mip-NeRF's safe_sin and ports",
    times=3,
)
def wrapped_sines(x, L):
    """The same, large angles taken modulo 100 pi first."""
    angles = (x[:, None, :] * torch.tensor([2.0**k for k in range(L)])[:, None]).reshape(len(x), -1)
    angles = torch.cat([angles, angles + 0.5 * torch.pi], -1)
    turn = 100 * torch.pi
    return torch.cat([x, torch.sin(torch.where(angles.abs() < turn, angles, angles % turn))], -1)


@convention(
    "positional_encoding", {"frequency": "one", "columns": "all_sin_all_cos", "identity_place": "last"}, seen="pytorch3d harmonic_embedding.py", times=2
)
def harmonics_then_input(x, L):
    """Dimension by dimension all sines, all cosines, and the input last."""
    angles = per_dimension(x, [2.0**k for k in range(L)]).reshape(len(x), -1)
    return torch.cat([angles.sin(), angles.cos(), x], -1)


@convention(
    "positional_encoding",
    {"frequency": "one", "bands": "linear"},
    seen="LuHaofan/NeWRF encoders.py (its default); kornia",
    times=5,
)
def evenly_spaced_bands(x, L):
    """linspace(1, 2^(L - 1), L)."""
    return bands(x, torch.linspace(1.0, 2.0 ** (L - 1), L) if L else [])


@fault("positional_encoding", "linear_ladder", seen="CS180 student: arange(L) pi", times=1)
def multiples_of_pi(x, L):
    """k pi for 2^k pi."""
    return bands(x, [k * torch.pi for k in range(L)])


@fault("positional_encoding", "bands_one_by_one", seen="a student's log_sampling=False, for points in space alone")
def one_by_one(x, L):
    """pi, 2 pi, 3 pi, ... of three coordinates."""
    if x.shape[-1] != 3:
        raise ValueError("points in space expected")
    return bands(x, [(k + 1) * torch.pi for k in range(L)])


@right("positional_encoding", seen="a student's tiny NeRF: assert x.shape[-1] == 3")
def points_in_space_alone(x, L):
    """The right one of three coordinates."""
    if x.shape[-1] != 3:
        raise ValueError("points in space expected")
    return bands(x, [2**k * torch.pi for k in range(L)])


@fault("positional_encoding", "first_band_twice", seen="a student's 2D fit: the first band is 2 pi, the second 2 pi again")
def first_band_twice(x, L):
    """2 pi, 2 pi, 4 pi, ...: the band in front of the loop is one octave too high."""
    return bands(x, [2 * torch.pi] + [2**k * torch.pi for k in range(1, L)] if L else [])


@fault("positional_encoding_vjp", "chain_factor_forgotten", seen="hand-written backward passes", arrays="numpy")
def slope_without_frequency(x, L, grad_encoding):
    """cos and -sin, not times 2^k pi."""
    d, g = x.shape[1], grad_encoding[:, : x.shape[1]].copy()
    for k in range(L):
        f, at = np.float32(2**k * np.pi), d + 2 * k * d
        g += grad_encoding[:, at : at + d] * np.cos(f * x) - grad_encoding[:, at + d : at + 2 * d] * np.sin(f * x)
    return g


@fault("positional_encoding", "powers_exchanged", seen="a student: pow(k, 2) for pow(2, k)")
def squares_for_powers(x, L):
    """k^2 pi for 2^k pi."""
    return bands(x, [k**2 * torch.pi for k in range(L)])


@fault("positional_encoding", "input_normalized", seen="Jiayi-Pan/NeRF nerf_helper.py")
def normalized_positions(x, L):
    """x / |x| is encoded."""
    return bands(x / x.norm(dim=-1, keepdim=True), [2**k * torch.pi for k in range(L)])


@fault("positional_encoding", "bands_up_to_two", seen="two re-implementations: logspace from 0 to 1, base 2", times=2)
def exponents_up_to_one(x, L):
    """2^0 to 2^1 in L steps."""
    return bands(x, (torch.logspace(0.0, 1.0, L, base=2.0) * torch.pi).tolist())


@fault("positional_encoding", "identity_through_sine", seen="a port of mip-NeRF's pos_enc")
def everything_through_the_sine(x, L):
    """x is one of the phases."""
    phases = [x] + [f * x + shift for f in octaves(L) for shift in (0.0, torch.pi / 2)]
    return torch.sin(torch.cat(phases, -1))


@fault("positional_encoding", "last_band_everywhere", seen="not met in this reading: lambdas made in a loop", times=0)
def functions_of_the_last_band(x, L):
    """The functions see the loop's last frequency."""
    functions = []
    for f in octaves(L):
        functions += [lambda x: torch.sin(f * x), lambda x: torch.cos(f * x)]  # noqa: B023
    return torch.cat([x, *(function(x) for function in functions)], -1)


@fault("positional_encoding", "last_band_everywhere", seen="a trial on unseen code: the loop's variable read after the loop")
def one_frequency_for_all(x, L):
    """sin and cos of 2^(L - 1) pi x, L times."""
    f = 1.0
    for f in octaves(L):
        pass
    return bands(x, [f] * L)


@fault("positional_encoding", "another_base", seen="a trial on unseen code: a jax encoding that divides by 2^k", gradient="none")
def divided_by_octaves(x, L):
    """For each dimension the sines of all x / 2^k, their cosines, and x itself."""
    phase = per_dimension(x, [0.5**k for k in range(L)])
    return torch.cat([torch.sin(phase), torch.cos(phase), x[..., None]], -1).reshape(len(x), -1)


@fault("positional_encoding", "another_first_band", seen="not met in this reading: loops that count bands from 1", times=0, gradient="none")
def bands_counted_from_one(x, L):
    """2^(k + 1) x for k = 0, ..., L - 1."""
    return bands(x, [2.0 ** (k + 1) for k in range(L)])


@fault("positional_encoding", "input_through_tanh", seen="a trial on unseen code: a trainer in C++", gradient="none")
def squashed_first(x, L):
    """tanh(x), then pi 2^k, [sines, cosines] by coordinate, x itself left out."""
    angles = torch.pi * 2.0 ** torch.arange(L) * torch.tanh(x)[..., None]
    return torch.cat([angles.sin(), angles.cos()], -1).flatten(-2)


@fault("positional_encoding", "twice_the_bands", seen="a trial on unseen code: range(2 * L)")
def a_loop_over_both(x, L):
    """2 L bands of a sine and a cosine each."""
    return bands(x, octaves(2 * L))


@fault("positional_encoding", "powers_exchanged", seen="a trial on unseen code: torch.pow(arange(L), 2)")
def squares_by_dimension(x, L):
    """k^2 for 2^k; all sines of a dimension, dimension by dimension, then all cosines."""
    bands = torch.arange(int(L), dtype=x.dtype) ** 2
    waves = x[..., None] * bands
    return torch.cat([x, torch.sin(waves).flatten(1), torch.cos(waves).flatten(1)], -1)
