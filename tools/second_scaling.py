"""The second implementation's loss scale, by selections. See second.py."""

import numpy as np


def loss_scale_update(a, c, wrong):
    """Scale and tracker after a step, in f32 at least."""
    scale, tracker, found, growth, backoff, interval = (
        float(a[name]) for name in ("scale", "growth_tracker", "found_inf", "growth_factor", "backoff_factor", "growth_interval")
    )
    if "meaning_of_bit_exchanged" in wrong:
        found = 1 - found
    if "overflow_ignored" in wrong:
        found = 0
    if "grown_with_every_step" in wrong:
        interval = 1
    for _ in range(2 if "updated_twice" in wrong else 1):
        counted = tracker + 1
        due = counted > interval if "one_step_late" in wrong else counted >= interval
        shrunk = scale / backoff if "divided_by_backoff" in wrong else scale * backoff
        shrunk = max(shrunk, 1.0) if c["loss_scale_floor"] == "one" else shrunk
        grown = min(scale * growth, {"none": np.inf, "2^16": 2.0**16, "2^24": 2.0**24}[c["loss_scale_ceiling"]])
        after_overflow = tracker if "tracker_kept_at_overflow" in wrong else float("overflow_counted" in wrong)
        after_growth = counted if "tracker_kept_at_growth" in wrong else 0.0
        scale = np.where(found, shrunk, np.where(due, grown, scale)).item()
        tracker = np.where(found, after_overflow, np.where(due, after_growth, counted)).item()
    return {"scale_out": np.array(scale), "growth_tracker_out": np.array(tracker)}


def unscale_gradients(a, c, wrong):
    """Times the inverse, and whether 0 times any of them isn't 0."""
    g, kind = a["gradients"], a["gradients"].dtype.type
    scale = float(a["scale"])
    if "unscaled_twice" in wrong:
        scale = scale * scale
    if "divided_by_root_of_scale" in wrong:
        scale = scale**0.5
    with np.errstate(invalid="ignore"):
        found = np.isnan(g * 0).any()
        by = scale if "multiplied_by_scale" in wrong else 1 if "scale_left_in" in wrong else 1 / scale
        # A short type would lose the inverse.
        unscaled = (g.astype(np.promote_types(g.dtype, np.float32)) * np.promote_types(g.dtype, np.float32).type(by)).astype(kind)
    return {"found_inf": np.array(int(found)), "unscaled": unscaled}
