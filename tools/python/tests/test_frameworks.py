"""Functions of torch and jax: found, differentiated, dealt their numbers. Skipped where these aren't installed."""

import subprocess
import sys

import nerf_oracle as no
import numpy as np
import pytest


@pytest.fixture(scope="module")
def torch():
    return pytest.importorskip("torch")


@pytest.fixture(scope="module")
def jax():
    return pytest.importorskip("jax")


def torch_render(torch):
    def volume_render(sigmas, rgbs, deltas):
        depth = sigmas * deltas
        front = torch.cumsum(torch.nn.functional.pad(depth, (1, 0))[..., :-1], -1)
        weights = -torch.expm1(-depth) * torch.exp(-front)
        return (weights[..., None] * rgbs).sum(-2), weights, weights.sum(-1), torch.exp(-depth.sum(-1))

    return volume_render


@pytest.mark.parametrize("dtype", ["f64", "f32", "bf16"])
def test_torch_with_its_gradient(torch, dtype):
    types = set()

    def kernel(sigmas, rgbs, deltas):
        types.add(str(sigmas.dtype))
        return torch_render(torch)(sigmas, rgbs, deltas)

    report = no.judge(volume_render=kernel, dtype=dtype)
    assert report.passed and report["volume_render", "vjp"].verdict == "pass", report
    assert types == {{"f64": "torch.float64", "f32": "torch.float32", "bf16": "torch.bfloat16"}[dtype]}


def test_a_program_ends_where_a_gradient_could_not_be_had(torch):
    program = """
import nerf_oracle as no
import torch

def early_stop(sigmas, rgbs, deltas, offsets, eps):
    colors, opacity = [], []
    for begin, end in zip(offsets[:-1], offsets[1:]):
        light, seen, left = 1.0, sigmas.new_zeros(3), sigmas.new_zeros(())
        for i in range(int(begin), int(end)):
            alpha = 1 - (-sigmas[i] * deltas[i]).exp()
            seen, left = seen + light * alpha * rgbs[i], left + light * alpha
            light *= 1 - alpha
        colors, opacity = colors + [seen], opacity + [left]
    return {"colors": torch.stack(colors), "opacity": torch.stack(opacity)}

print(no.judge(early_stop=early_stop, dtype="f64"))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and "modified by an inplace operation" in done.stdout, done.stderr


def test_a_wrong_gradient_is_named_as_the_gradient_s(torch):
    class Detached(torch.autograd.Function):
        @staticmethod
        def forward(ctx, x):
            ctx.save_for_backward(x)
            return torch.exp(x)

        @staticmethod
        def backward(ctx, g):
            return torch.zeros_like(g)

    report = no.judge(trunc_exp=lambda x: Detached.apply(x))
    assert report["trunc_exp"].passed and report["trunc_exp", "vjp"].verdict == "fail"


def test_what_has_no_gradient_is_said(torch):
    report = no.judge(
        composite_background=lambda colors, opacity, background: (colors + (1 - opacity)[:, None] * background).detach()
    )
    assert [row.kind for row in report] == ["forward"] and "gradient isn't judged: the result isn't differentiable" in str(report)


def test_numpy_in_a_file_that_imports_torch(torch):
    from conftest import shaded_by_itself

    report = no.judge(volume_render=shaded_by_itself)
    assert "arrays of numpy" in report.notes[0] and report["volume_render"].diagnosis[0].name == "inclusive_transmittance"


def test_methods_alone_are_found_by_trying(torch):
    report = no.judge(
        composite_background=lambda colors, opacity, background: colors.add((1 - opacity).unsqueeze(-1).mul(background))
    )
    assert report.passed and "arrays of torch" in report.notes[0] and len(report) == 2


def test_the_course_s_renderer_in_torch(torch):
    def volrend(sigmas, rgbs, step_size):
        alphas = 1 - torch.exp(-sigmas * step_size)
        front = torch.cumprod(torch.cat([torch.ones_like(alphas[:, :1]), 1 - alphas], dim=1), dim=1)[:, :-1]
        return torch.sum(front * alphas * rgbs, dim=1)

    report = no.judge(volume_render=volrend)
    assert report.passed and len(report) == 2 and report["volume_render", "vjp"].missing_outputs == ["grad_deltas"], report


def test_gradients_have_no_entries_where_the_contract_has_none(torch):
    def pixel_to_ray(K, c2w, uv):
        """By the inverse of the matrix, which depends on its zeros too, and of all 16 numbers of the pose."""
        x = torch.linalg.inv(K) @ torch.cat([uv, torch.ones_like(uv[:, :1])], -1)[..., None]
        through = (c2w @ torch.cat([x, torch.ones_like(x[:, :1])], 1))[:, :, 0]
        d = through[:, :3] / through[:, 3:] - c2w[:, :3, 3]
        return c2w[:, :3, 3], d / d.norm(dim=-1, keepdim=True)

    report = no.judge(pixel_to_ray=pixel_to_ray)
    assert report["pixel_to_ray", "vjp"].verdict in ("pass", "imprecise"), report


def test_torch_s_own_numbers_are_dealt(torch):
    def sample(rays_o, rays_d, near, far, n_samples):
        step = (far - near) / n_samples
        t = near + (torch.arange(n_samples) + torch.rand(len(rays_o), n_samples)) * step
        return t, rays_o[:, None] + t[..., None] * rays_d[:, None]

    assert no.judge(sample_along_rays=sample).passed
    u = torch.tensor([[0.25, 0.5]])
    with no.dealt(u):
        assert torch.rand_like(u).tolist() == [[0.25, 0.5]] and torch.empty(2).uniform_(0, 4).tolist() == [1.0, 2.0]
        assert torch.rand(2, 1, dtype=torch.float64).dtype == torch.float64
    assert torch.rand(1, 2).tolist() != [[0.25, 0.5]]


def test_an_encoding_of_bands_alone_has_a_gradient(torch):
    def encode(x, L):
        waves = [f(2.0**k * torch.pi * x) for f in (torch.sin, torch.cos) for k in range(L)]
        return torch.cat(waves, -1)

    report = no.judge(positional_encoding=encode)
    assert report.passed and report["positional_encoding", "vjp"].verdict == "pass", report
    assert "where there is nothing to answer" in report["positional_encoding"].findings[0]

    class Halved(torch.autograd.Function):
        forward = staticmethod(lambda ctx, x: x.clone())
        backward = staticmethod(lambda ctx, grad: grad / 2)

    report = no.judge(positional_encoding=lambda x, L: encode(Halved.apply(x), L))
    assert report["positional_encoding"].verdict == "pass" and report["positional_encoding", "vjp"].verdict == "fail", report


def test_a_module_with_weights(torch):
    class MLP(torch.nn.Module):
        def __init__(self, widths):
            super().__init__()
            self.layers = torch.nn.ModuleList(torch.nn.Linear(a, b) for a, b in zip(widths, widths[1:]))

        def forward(self, x):
            for layer in self.layers[:-1]:
                x = torch.relu(layer(x))
            return torch.sigmoid(self.layers[-1](x))

    def made(x, **layers):
        return MLP([x.shape[1], *(len(layers[f"b{n}"]) for n in range(len(layers) // 2))])

    report = no.judge(mlp=no.functional(made))
    assert report.passed and len(report) == 2 and "arrays of torch" in report.notes[0], report
    with pytest.raises(no.CandidateError, match="functional: the module has 4 parameters"):
        no.judge(mlp=no.functional(MLP([2, 3, 3])))
    swapped = no.functional(made, {"layers.0.weight": "w9"})
    with pytest.raises(no.CandidateError, match="no array 'w9' of the case"):
        no.judge(mlp=swapped)


def test_torch_s_arrays_go_into_the_reference(torch, ray):
    tensors = {name: torch.tensor(x, requires_grad=True) for name, x in ray.items()}
    assert np.array_equal(no.oracle.volume_render(**tensors).colors, no.oracle.volume_render(**ray).colors)
    short = {name: torch.tensor(x).bfloat16() for name, x in ray.items()}
    report = no.check_close(torch_render(torch)(**short), "volume_render", **short)
    assert report.passed and report.dtype == "bf16", report


def test_jax_with_its_gradient(jax):
    jnp = jax.numpy

    def volume_render(sigmas, rgbs, deltas):
        depth = sigmas * deltas
        front = jnp.cumsum(jnp.pad(depth, ((0, 0), (1, 0)))[:, :-1], -1)
        weights = -jnp.expm1(-depth) * jnp.exp(-front)
        return (weights[..., None] * rgbs).sum(-2), weights, weights.sum(-1), jnp.exp(-depth.sum(-1))

    for dtype in ("f64", "f32"):
        for kernel in (volume_render, jax.jit(volume_render)):
            report = no.judge(volume_render=kernel, dtype=dtype)
            assert report.passed and len(report) == 2 and "arrays of jax" in report.notes[0], report
    wrong = lambda sigmas, rgbs, deltas: volume_render(sigmas, rgbs, deltas)[0] + 0 * jax.lax.stop_gradient(jnp.sum(rgbs))  # noqa: E731
    assert no.judge(volume_render=wrong).passed
    stopped = lambda sigmas, rgbs, deltas: volume_render(jax.lax.stop_gradient(sigmas), rgbs, deltas)[0]  # noqa: E731
    assert not no.judge(volume_render=stopped).passed


def test_jax_s_numbers_are_dealt(jax):
    jnp = jax.numpy

    def sample(rays_o, rays_d, near, far, n_samples):
        u = jax.random.uniform(jax.random.PRNGKey(0), (len(rays_o), n_samples))
        t = near + (jnp.arange(n_samples) + u) * ((far - near) / n_samples)
        return t, rays_o[:, None] + t[..., None] * rays_d[:, None]

    report = no.judge(sample_along_rays=sample)
    assert report.passed and "dealt" in report.notes[0], report


def test_jax_s_arrays_go_into_the_reference(jax, ray):
    given = {name: jax.numpy.asarray(x, dtype="float32") for name, x in ray.items()}
    assert no.check_close(no.oracle.volume_render(**given), "volume_render", **given).dtype == "f32"
