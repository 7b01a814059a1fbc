"""What shapes don't show: what rays share, and random numbers in strata of the function's own."""

import nerf_oracle as no
import numpy as np
from conftest import render


def one_row_of_positions(sigma, rgb, t_vals):
    """Right for positions of (N,), which all rays share."""
    steps = np.concatenate([t_vals[1:] - t_vals[:-1], np.full_like(t_vals[:1], 1e10)])
    return render(sigma, rgb, np.broadcast_to(steps, sigma.shape))


def test_positions_that_all_rays_share():
    report = no.judge(volume_render=one_row_of_positions)
    assert report.passed and "in batches that share t" in report.notes[0], report

    def over_all(sigma, rgb, t_vals):
        return [x / np.linalg.norm(sigma) for x in one_row_of_positions(sigma, rgb, t_vals)]

    def own(sigma, rgb, t_vals):
        return render(sigma, rgb, np.diff(t_vals, append=t_vals[:, -1:] + sigma.dtype.type(1e10)))

    # What mixes rays even so is wrong; a row for each ray is asked as it is.
    assert not no.judge(volume_render=over_all).passed
    report = no.judge(volume_render=own)
    assert report.passed and "share" not in report.notes[0], report


def test_what_whole_arrays_raise_is_told():
    def contract(x):
        r = np.linalg.norm(x, axis=-1)
        return np.where(r <= 1, x, (2 - 1 / np.maximum(r, 1)) * x / np.maximum(r, 1))

    note = no.judge(contraction=contract).notes[0]
    assert "one at a time, as otherwise it raises ValueError: operands could not be broadcast" in note, note


def inverse(stratified):
    """Samples of bins, at random numbers of the function's own."""

    def sample(edges, weights, n_samples):
        total = weights.sum(-1, keepdims=True)
        f = np.concatenate([np.zeros_like(total), np.cumsum(weights / total, -1)], -1)
        u = stratified(np.random.rand(len(edges), n_samples), n_samples).astype(edges.dtype)
        k = np.stack([np.clip(np.searchsorted(f[r], u[r], "right") - 1, 0, weights.shape[-1] - 1) for r in range(len(f))])
        at = lambda a, i: np.take_along_axis(a, i, -1)  # noqa: E731
        s = (u - at(f, k)) / (at(f, k + 1) - at(f, k))
        return at(edges, k) + s * (at(edges, k + 1) - at(edges, k))

    return sample


def test_strata_of_one_s_own():
    cases = {
        "as they come": lambda r, n: r,
        "in strata": lambda r, n: (np.arange(n) + r) / n,
        "twice": lambda r, n: (2 * np.arange(n) + r) / n,
    }
    shown = {name: no.judge(importance_sampling=inverse(stratified), dtype="f64") for name, stratified in cases.items()}
    told = ["without the strata" in report.notes[0] for report in shown.values()]
    assert told == [False, True, False], [report.notes for report in shown.values()]
    verdicts = [report["importance_sampling"].verdict for report in shown.values()]
    assert verdicts[1] == verdicts[0] and verdicts[2] == "fail", [str(report) for report in shown.values()]


def test_a_depth_is_told_by_its_units():
    def outputs(sigma, rgb, t_vals):
        steps = np.diff(t_vals, append=t_vals[:, -1:] + sigma.dtype.type(1e10))
        colors, weights = render(sigma, rgb, steps)
        return {"rgb": colors, "depth": (weights * t_vals).sum(1), "acc": weights.sum(1), "weights": weights}

    for names in (("rgb", "depth"), ("rgb", "depth", "acc"), ("rgb", "acc", "depth"), ("rgb", "weights", "depth")):
        report = no.judge(volume_render=lambda sigma, rgb, t: [outputs(sigma, rgb, t)[name] for name in names])  # noqa: B023
        assert report.passed and ("opacity" in report["volume_render"].missing_outputs) == ("acc" not in names), (names, report)


def test_rows_with_strata_take_no_others_off():
    def both_ends(rays_o, rays_d, near, far, n_samples):
        t = np.linspace(near, far, n_samples) + np.random.rand(n_samples) * 0.1
        t = np.broadcast_to(t, (len(rays_o), n_samples)).astype(rays_o.dtype)
        return t, rays_o[:, None] + t[..., None] * rays_d[:, None]

    report = no.judge(sample_along_rays=both_ends)
    assert not report.passed and "strata" not in report.notes[0], report
