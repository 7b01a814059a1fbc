"""The reference and its bounds as functions."""

import inspect
import math

import nerf_oracle as no
import numpy as np
import pytest
from conftest import render
from nerf_oracle.rows import rows

ROWS = [name for name, row in rows().items() if not row["statistics"]]


def itself(name):
    """A row's own reference as a candidate, gradient included."""
    out = {name: lambda **inputs: getattr(no.oracle, name)(**inputs)}
    if rows()[name]["vjp"]:
        out[f"{name}_vjp"] = lambda **inputs: getattr(no.oracle, name).vjp(**inputs)
    return out


@pytest.mark.parametrize("name", ROWS)
def test_the_reference_passes_its_own_judge(name):
    report = no.judge(dtype="f64", profile="cs180", again=False, **itself(name))
    assert report.passed and len(report) == 1 + rows()[name]["vjp"], report


def test_numbers_that_a_reader_can_check():
    ln2 = math.log(2)
    sigmas, rgbs = [[ln2, ln2, 0.0, ln2]], np.tile([1.0, 0.5, 0.0], (1, 4, 1))
    found = no.oracle.volume_render(sigmas, rgbs, deltas=np.ones((1, 4)))
    assert found.weights.tolist() == [[0.5, 0.25, 0.0, 0.125]] and found.colors.tolist() == [[0.875, 0.4375, 0.0]]
    assert found._fields == ("colors", "weights", "opacity", "transmittance") and found.weights.dtype == np.float64
    assert isinstance(no.oracle.mse([0.0, 2.0], [0.0, 0.0]), float) and no.oracle.mse([0.0, 2.0], [0.0, 0.0]) == 2.0


def test_gradients_are_those_of_differences(ray):
    gradient = no.oracle.volume_render.vjp(**ray, grad_colors=np.ones((5, 3)))
    assert gradient._fields == ("grad_sigmas", "grad_rgbs", "grad_deltas")
    for name in ray:
        for index in [(0, 0), (2, 3), (4, 6)]:
            moved = [{**ray, name: ray[name].copy()} for _ in range(2)]
            moved[0][name][index] += 1e-6
            moved[1][name][index] -= 1e-6
            by_hand = [no.oracle.volume_render(**inputs).colors.sum() for inputs in moved]
            got = getattr(gradient, f"grad_{name}")[index].sum()
            assert got == pytest.approx((by_hand[0] - by_hand[1]) / 2e-6, rel=1e-6, abs=1e-9)


def test_layers_are_numbered():
    rng = np.random.default_rng(0)
    layers = {"w0": rng.random((4, 3)), "b0": rng.random(4), "w1": rng.random((2, 4)), "b1": rng.random(2)}
    x = rng.random((5, 3))
    y = no.oracle.mlp(x, **layers)
    hidden = np.maximum(x @ layers["w0"].T + layers["b0"], 0)
    np.testing.assert_allclose(y, 1 / (1 + np.exp(-(hidden @ layers["w1"].T + layers["b1"]))), rtol=1e-14)
    assert list(no.oracle.mlp.vjp(x, grad_y=np.ones((5, 2)), **layers)) == ["grad_x", "grad_w0", "grad_b0", "grad_w1", "grad_b1"]


def test_a_profile_decides(ray):
    image = {"height": 2, "width": 3, "focal": 2.0, "cx": 1.5, "cy": 1.0, "c2w": np.eye(4)}
    ours, theirs = (no.oracle.image_rays(**image, profile=name) for name in (None, "nerf2020"))
    assert ours.rays_d[0, 0, 2] > 0 > theirs.rays_d[0, 0, 2] and theirs.uv[0, 0].tolist() == [0, 0]


def test_a_bound_holds_what_honest_code_does_and_grows_with_the_type(ray):
    ray = {name: x.astype(np.float32) for name, x in ray.items()}
    off = np.abs(render(**ray)[0].astype(np.float64) - no.oracle.volume_render(**ray).colors)
    bounds = [no.bound.volume_render(**ray, dtype=dtype).colors for dtype in ("f64", "f32", "bf16")]
    assert off.max() > 0 and np.all(off <= bounds[1])
    assert np.all(bounds[0] < 1e-13) and np.all(bounds[0] * 1e6 < bounds[1]) and np.all(bounds[1] * 1e3 < bounds[2])
    assert np.all(no.bound.volume_render(**ray, stable=True).weights <= no.bound.volume_render(**ray).weights)
    assert no.bound.volume_render.vjp(**ray, grad_colors=np.ones((5, 3))).grad_rgbs.shape == (5, 7, 3)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"sigmas": np.ones(7)},
            "volume_render: sigmas (the array of densities, 1 / length) has the shape (7,), expected (R, N): 2 axes. One alone",
        ),
        ({"sigmas": np.ones((5, 7, 1))}, "Drop the last axis: x[..., 0]."),
        (
            {"deltas": np.ones((5, 8))},
            "deltas (the array of step lengths) has the shape (5, 8), expected (R, N) with N = 7, as in sigmas.",
        ),
        ({"rgbs": np.ones((5, 7, 4))}, "rgbs (the array of colors) has the shape (5, 7, 4), expected (R, N, 3)."),
        ({"deltas": None}, "volume_render: deltas is missing: step lengths"),
        ({"sigma": np.ones((5, 7))}, "volume_render: sigma is no input; did you mean sigmas?"),
        ({"sigmas": "dense"}, "volume_render: sigmas: an array of <U5, expected numbers"),
        ({"profile": "cs"}, "profile: found 'cs'"),
    ],
)
def test_errors_name_the_argument(ray, change, says):
    with pytest.raises(no.CandidateError) as error:
        no.oracle.volume_render(**{**ray, **change})
    assert says in str(error.value)


def test_counts_are_whole_and_names_are_rows():
    with pytest.raises(no.CandidateError, match="positional_encoding: L = 2.5, expected whole numbers: number of bands"):
        no.oracle.positional_encoding(np.ones((2, 3)), 2.5)
    with pytest.raises(no.CandidateError, match=r"mlp: b\* is missing: biases of layer 0, 1, ..."):
        no.oracle.mlp(np.ones((2, 3)), w0=np.ones((1, 3)))
    with pytest.raises(AttributeError, match="did you mean volume_render"):
        no.oracle.volume_rendering
    with pytest.raises(no.CandidateError, match="dtype: found 'half'"):
        no.bound.mse([1.0], [1.0], dtype="half")
    assert not hasattr(no.oracle.psnr, "vjp") and set(dir(no.oracle)) == set(dir(no.bound)) == set(ROWS)


def test_help_has_shapes_and_units():
    assert "sigmas (R,N): densities, 1 / length" in no.oracle.volume_render.__doc__
    assert str(inspect.signature(no.bound.depth)) == "(weights, t, far, *, profile=None, dtype='f32', stable=False)"
