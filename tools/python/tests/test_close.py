"""Verdicts on one's own data."""

import nerf_oracle as no
import numpy as np
import pytest
from conftest import render, shaded_by_itself


def test_what_is_close_passes(ray):
    assert no.check_close(render(**ray), "volume_render", **ray)
    assert no.check_close(render, "volume_render", **ray).passed
    colors, weights = render(**ray)
    assert no.check_close({"weights": weights}, "volume_render", **ray)["volume_render"].missing_outputs[0] == "colors"


def test_the_type_is_that_of_the_inputs(ray):
    short = {name: x.astype(np.float32) for name, x in ray.items()}
    mine = render(**short)
    assert no.check_close(mine, "volume_render", **short).dtype == "f32" and no.check_close(mine, "volume_render", **short)
    # In f64 as many digits aren't enough, and an answer in f32 is too narrow.
    assert not no.check_close(mine, "volume_render", dtype="f64", **short)


def test_one_digit_off_fails(ray):
    colors = render(**ray)[0]
    colors[3, 1] *= 1 + 1e-12
    report = no.check_close(colors, "volume_render", **ray)
    worst = report["volume_render"].worst_case
    assert not report and (worst["id"], worst["output"], worst["index"]) == ("yours", "colors", [3, 1])


def test_a_mistake_on_one_s_own_data_is_named(ray):
    report = no.check_close(shaded_by_itself(**ray), "volume_render", **ray)
    assert report["volume_render"].diagnosis[0].name == "inclusive_transmittance"


def test_gradients_too(ray):
    given = {**ray, "grad_colors": np.ones((5, 3))}
    right = no.oracle.volume_render.vjp(**given)
    assert no.check_close(right, "volume_render", direction="vjp", **given)
    wrong = right._replace(grad_sigmas=-right.grad_sigmas)
    assert not no.check_close(wrong, "volume_render", direction="vjp", **given)


def test_what_is_too_small_to_prove_anything_is_still_close(ray):
    opaque = {**ray, "sigmas": ray["sigmas"] * 0 + 200.0}
    report = no.check_close(no.oracle.volume_render(**opaque), "volume_render", **opaque)
    assert report and report["volume_render"].verdict in ("pass", "unproved")


@pytest.mark.parametrize(
    ("row", "says"),
    [("volume_rendr", "no row of the contract"), ("sample_random_rays", "it is judged by the statistics of many draws")],
)
def test_rows_that_cannot_be(ray, row, says):
    with pytest.raises(no.CandidateError, match=says):
        no.check_close(ray["sigmas"], row, **ray)


def test_the_direction_and_the_outputs_are_checked(ray):
    with pytest.raises(no.CandidateError, match="direction: found 'backward'"):
        no.check_close(ray["sigmas"], "volume_render", direction="backward", **ray)
    with pytest.raises(no.CandidateError, match="returned a dict of color; did you mean|returned a dict of shade"):
        no.check_close({"shade": 1}, "volume_render", **ray)
