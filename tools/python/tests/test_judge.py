"""Verdicts, in process."""

import sys

import nerf_oracle as no
import numpy as np
import pytest
from conftest import render, shaded_by_itself


def test_right_code_passes_and_says_what_it_followed():
    report = no.judge(volume_render=render)
    assert report.passed and report, report
    row = report["volume_render"]
    assert row is report["volume_render", "forward"] and row.verdict == "pass" and row.cases == row.answered > 20
    assert row.missing_outputs == ["opacity", "transmittance"] and row.conventions == {"product_eps": "none", "backdrop": "none", "sigma_relu": "none", "opacity_sum": "all", "last_sample": "as_it_is"}
    assert "CONVENTIONS FOUND: cs180   (answers in f32)" in str(report) and report.profile == "cs180"
    assert report.notes and all(note in str(report) for note in report.notes)


def test_wrong_code_is_told_its_mistake():
    report = no.judge(volume_render=shaded_by_itself)
    best = report["volume_render"].diagnosis[0]
    assert not report.passed and best.name == "inclusive_transmittance" and best.residual <= 1
    assert "shift the cumulative product by one" in best.fix and best.cause and best.effect
    assert report["volume_render"].worst_case["bound"] < 1e-5 and "inclusive_transmittance" in str(report)


@pytest.mark.parametrize("dtype", ["f64", "f32", "tf32", "f16"])
def test_every_type(dtype):
    kernel = lambda **x: {"mse": np.mean((x["prediction"] - x["target"]) ** 2)}["mse"]  # noqa: E731
    assert no.judge(mse=kernel, dtype=dtype)["mse"].verdict in ("pass", "imprecise")
    types = set()
    no.judge(composite_background=lambda colors, opacity, background: types.add(colors.dtype.name) or colors, dtype=dtype)
    assert types == {{"f64": "float64", "f16": "float16"}.get(dtype, "float32")}


def test_assert_pass_shows_the_page():
    no.assert_pass(volume_render=render, profile="cs180")
    with pytest.raises(AssertionError, match="consistent with: inclusive_transmittance"):
        no.assert_pass(volume_render=shaded_by_itself, dtype="f64")


def test_a_pinned_profile_fails_what_deviates():
    def with_eps(sigmas, rgbs, deltas):
        alpha = 1 - np.exp(-sigmas * deltas)
        front = np.cumprod(np.concatenate([np.ones_like(alpha[:, :1]), 1 - alpha + sigmas.dtype.type(1e-7)], 1), 1)[:, :-1]
        return ((front * alpha)[..., None] * rgbs).sum(1)

    found = no.judge(volume_render=with_eps, dtype="f64")
    assert found.passed and found["volume_render"].conventions == {"product_eps": "1e-7", "backdrop": "none", "sigma_relu": "none", "opacity_sum": "all", "last_sample": "as_it_is"}, found
    assert not no.judge(volume_render=with_eps, dtype="f64", profile="cs180").passed


def test_the_course_s_signature_takes_one_line():
    def volrend(sigmas, rgbs, step_size):
        """Densities (R, N, 1), as the course hands them out."""
        alphas = 1 - np.exp(-sigmas * step_size)
        front = np.cumprod(np.concatenate([np.ones_like(alphas[:, :1]), 1 - alphas], 1), 1)[:, :-1]
        return np.sum(front * alphas * rgbs, 1)

    report = no.judge(volume_render=volrend)
    assert report.passed and report["volume_render"].answered >= 10, report
    assert "step_size as step, sigmas with a last axis of one" in report.notes[0]
    inclusive = lambda sigmas, rgbs, step_size: np.sum(  # noqa: E731
        np.cumprod(np.exp(-sigmas * step_size), 1) * (1 - np.exp(-sigmas * step_size)) * rgbs, 1
    )
    assert no.judge(volume_render=inclusive)["volume_render"].diagnosis[0].name == "inclusive_transmittance"


def test_one_ray_at_a_time():
    def one(sigmas, rgbs, deltas):
        color, through = np.zeros(3, rgbs.dtype), np.ones((), rgbs.dtype)
        for i in range(len(sigmas)):
            alpha = -np.expm1(-sigmas[i] * deltas[i])
            color, through = color + through * alpha * rgbs[i], through * (1 - alpha)
        return color

    report = no.judge(volume_render=one)
    assert report.passed and "one at a time" in report.notes[0], report


def test_a_batch_of_one_that_crashes_is_told():
    def squeezes(sigmas, rgbs, deltas):
        colors, weights = render(*(x.squeeze() for x in (sigmas, rgbs, deltas)))
        return colors, weights

    report = no.judge(volume_render=no.adapt(squeezes, each=False))
    assert "one alone as two of the same, as it crashes on one" in report.notes[0]
    # Of one sample too many axes are gone all the same.
    assert report["volume_render"].edge_cases == ["one sample"] and report["volume_render"].answered > 20, report


def test_a_crash_is_its_case_s_result():
    def crashes(sigmas, rgbs, deltas):
        assert sigmas.shape[1] > 0, "no samples at all"
        return render(sigmas, rgbs, deltas)

    report = no.judge(volume_render=crashes)
    row = report["volume_render"]
    assert row.crashed and row.answered + len(row.crashed) == row.cases and row.edge_cases == ["no samples"]
    assert "AssertionError: no samples at all (line" in str(report) and "sigmas ndarray(1, 0)" in str(report)


def test_sys_exit_is_a_crash_and_control_c_is_not():
    report = no.judge(volume_render=lambda sigmas, rgbs, deltas: sys.exit(3))
    assert not report.passed and report["volume_render"].answered == 0 and "crashed: SystemExit: 3" in str(report)
    calls = []

    def interrupted(sigmas, rgbs, deltas):
        calls.append(1)
        if len(calls) > 4:
            raise KeyboardInterrupt
        return render(sigmas, rgbs, deltas)

    with pytest.raises(KeyboardInterrupt):
        no.judge(volume_render=interrupted)
    assert len(calls) == 5


def test_answers_that_depend_on_the_call_before_show():
    kept = []

    def stale(sigmas, rgbs, deltas):
        kept.append(render(sigmas, rgbs, deltas))
        return kept[-2] if len(kept) > 1 and kept[-2][0].shape == kept[-1][0].shape and len(kept) % 2 == 0 else kept[-1]

    assert not no.judge(volume_render=stale).passed

    def counted(sigmas, rgbs, deltas):
        kept.append(1)
        return render(sigmas, rgbs, deltas)

    kept.clear()
    row = no.judge(volume_render=counted, again=False)["volume_render"]
    assert len(kept) <= row.cases + 2
    kept.clear()
    no.judge(volume_render=counted)
    assert len(kept) >= 4 * row.cases


def test_inputs_that_are_written_to_harm_nobody():
    def in_place(sigmas, rgbs, deltas):
        out = render(sigmas.copy(), rgbs.copy(), deltas.copy())
        for x in (sigmas, rgbs, deltas):
            x[...] = np.nan
        return out

    assert no.judge(volume_render=in_place).passed


def test_wrong_shapes_nan_and_narrow_types_are_faults():
    shapes = no.judge(volume_render=lambda sigmas, rgbs, deltas: np.zeros((7, 7)))["volume_render"]
    assert any("wrong shape [7, 7]" in fault for fault in shapes.faults)
    nan = no.judge(volume_render=lambda sigmas, rgbs, deltas: rgbs.sum(1) * np.nan)["volume_render"]
    assert any("NaN" in fault for fault in nan.faults)
    narrow = no.judge(volume_render=lambda **x: render(**x)[0].astype(np.float16))["volume_render"]
    assert any("f16 is too narrow for f32" in fault for fault in narrow.faults)


def test_a_gradient_of_one_s_own():
    def right(colors, opacity, background, grad_colors_out):
        return grad_colors_out, -grad_colors_out @ background, ((1 - opacity)[:, None] * grad_colors_out).sum(0)

    def wrong(colors, opacity, background, grad_colors_out):
        return grad_colors_out, grad_colors_out @ background, ((1 - opacity)[:, None] * grad_colors_out).sum(0)

    assert no.judge(composite_background_vjp=right, dtype="f64")["composite_background", "vjp"].passed
    report = no.judge(composite_background_vjp=wrong, dtype="f64")
    assert not report.passed and report["composite_background"].worst_case["output"] == "grad_opacity"


def test_imprecise_counts_where_it_is_allowed():
    single = lambda colors, opacity, background: (  # noqa: E731
        colors.astype(np.float32) + (1 - opacity.astype(np.float32))[:, None] * background.astype(np.float32)
    ).astype(np.float64)
    report = no.judge(composite_background=single, dtype="f64")
    assert report["composite_background"].verdict == "imprecise" and not report.passed
    assert no.judge(composite_background=single, dtype="f64", allow=["imprecise"]).passed


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({}, "judge: no function. Name one by its row"),
        ({"volume_rendr": render}, "volume_rendr: no row of the contract, and no setting of judge; did you mean volume_render"),
        ({"psnr_vjp": render}, "psnr_vjp: no row"),
        ({"volume_render": 3}, "adapt: found int, expected a function"),
        ({"volume_render": render, "dtype": "f33"}, "dtype: found 'f33'; did you mean f32"),
        ({"volume_render": render, "profile": "cs18"}, "profile: found 'cs18'; did you mean cs180"),
        ({"volume_render": render, "framework": "tf"}, "framework: found 'tf'"),
        ({"volume_render": render, "allow": ["fail"]}, "allow: found 'fail'"),
        (
            {"volume_render": lambda sigmas, rgbs, deltas: (1, 2, 3, 4, 5)},
            "volume_render: <lambda> returned 5 arrays; Expected: colors, weights, opacity, transmittance",
        ),
        ({"volume_render": lambda sigmas, rgbs, deltas: None}, "volume_render: <lambda> returned nothing; Expected: colors"),
    ],
)
def test_what_cannot_be_judged_is_named(settings, says):
    with pytest.raises(no.CandidateError) as error:
        no.judge(**settings)
    assert says in str(error.value)


def test_the_rows_of_a_report():
    report = no.judge(volume_render=render)
    assert len(report) == 1 and [row.name for row in report] == ["volume_render"]
    assert repr(report) == "<Report passed: volume_render forward: pass>"
    assert report.json["components"][0]["name"] == "volume_render"
    with pytest.raises(KeyError, match="volume_render forward"):
        report["volume_render", "vjp"]


def test_rays_without_their_pixels_are_told_by_their_shapes():
    def get_rays(H, W, focal, c2w):
        i, j = np.meshgrid(np.arange(W, dtype=np.float32) + 0.5, np.arange(H, dtype=np.float32) + 0.5)
        d = np.stack([(i - W * 0.5) / focal, (j - H * 0.5) / focal, np.ones_like(i)], -1)
        d = d @ c2w[:3, :3].T
        return np.broadcast_to(c2w[:3, 3], d.shape), d / np.linalg.norm(d, axis=-1, keepdims=True)

    report = no.judge(image_rays=get_rays)
    assert report.passed, str(report)
    assert report["image_rays"].missing_outputs == ["uv"]


def test_a_number_that_was_fitted_is_told():
    def volrend(sigmas, rgbs, deltas):
        alphas = 1 - np.exp(-3.5 * sigmas * deltas)
        left = np.cumprod(np.concatenate([np.ones_like(alphas[:, :1]), 1 - alphas], 1), 1)
        weights = left[:, :-1] * alphas
        return (weights[..., None] * rgbs).sum(1), weights, weights.sum(1), left[:, -1]

    row = no.judge(volume_render=volrend)["volume_render"]
    assert (row.diagnosis[0].name, row.diagnosis[0].fitted) == ("delta_scaled", 3.5)
    assert row.example is not None and row.example["inputs"]


def test_what_fails_in_edge_cases_alone_counts_where_it_is_allowed():
    def shown(sigmas, rgbs, deltas):
        assert sigmas.shape[1] > 1, "two samples at least"
        return render(sigmas, rgbs, deltas)

    report = no.judge(volume_render=shown)
    assert report["volume_render"].verdict == "edge" and not report.passed
    assert report["volume_render"].edge_cases == ["one sample", "no samples"] and "right, but for edge cases: one sample" in str(report)
    assert no.judge(volume_render=shown, allow=["edge"]).passed
