"""Along a ray: sampling, rendering, packed rays."""

import adapters.nerfacc as nerfacc_
import adapters.nerfstudio as nerfstudio_
import numpy as np
import scipy
from bases import beside, plain

RENDERED = "colors", "weights", "opacity", "transmittance"


def without(*names):
    """Cases whose gradient doesn't come through these outputs, which a library doesn't return."""
    return lambda case, x: plain(case, x) and not any(np.any(x.get(f"grad_{name}", 0)) for name in names)


@beside("volume_render", "nerfacc", "rendering", "steps from 0, an empty sample behind", plain, within=2**22)
def volume_render(sigmas, rgbs, deltas):
    """All outputs."""
    return dict(zip(RENDERED, nerfacc_.volume_render(sigmas, rgbs, deltas)))


@beside("volume_render", "nerfstudio", "RaySamples.get_weights, RGBRenderer", only=without("transmittance"), within=2**22)
def volume_render_nerfstudio(sigmas, rgbs, deltas):
    """Without what is left behind."""
    return dict(zip(RENDERED, nerfstudio_.volume_render(sigmas, rgbs, deltas)))


@beside("volume_render_alpha", "nerfacc", "rendering", "an empty sample behind", plain)
def volume_render_alpha(alphas, rgbs):
    """All outputs."""
    return dict(zip(RENDERED, nerfacc_.volume_render_alpha(alphas, rgbs)))


@beside("composite_background", "nerfstudio", "blend_background_for_loss_computation", "its draw is the case's background")
def composite_background(colors, opacity, background):
    """As it comes."""
    return {"colors_out": nerfstudio_.composite_background(colors, opacity, background)}


@beside("depth", "numpy", "average", "far on empty rays", plain, "numpy")
def depth(weights, t, far):
    """Ray by ray."""
    return {"depth": np.array([np.average(at, weights=w) if np.any(w) else far for w, at in zip(weights, t)])}


@beside("pack_info", "scipy", "sparse.csr_array", "row pointers of a matrix with an entry a sample", arrays="numpy")
def pack_info(ray_ids, rays):
    """Rays are rows."""
    count = len(ray_ids)
    pointers = scipy.sparse.csr_array(
        (np.ones(count), (ray_ids.astype(int), np.arange(count))), shape=(rays, max(count, 1))
    ).indptr
    return {"starts": pointers[:-1], "counts": np.diff(pointers)}


@beside("packed_scan", "nerfacc", "exclusive_sum, inclusive_sum, exclusive_prod, inclusive_prod", "ray by ray")
def packed_scan(x, offsets):
    """All four."""
    names = "exclusive_sum", "inclusive_sum", "exclusive_product", "inclusive_product"
    return dict(zip(names, nerfacc_.packed_scan(offsets.long(), x)))


@beside("accumulate_along_rays", "nerfacc", "accumulate_along_rays")
def accumulate_along_rays(weights, values, offsets):
    """Packed."""
    return {"sums": nerfacc_.accumulate_along_rays(offsets.long(), weights, values)}


@beside("early_stop", "nerfacc", "render_visibility_from_density, rendering", "of what is visible", plain)
def early_stop(sigmas, rgbs, deltas, offsets, eps):
    """Ray by ray."""
    found = nerfacc_.early_stop(sigmas, rgbs, deltas, offsets, eps)
    return dict(zip(("live", *RENDERED), found))


@beside("distortion_loss", "nerfstudio", "lossfun_distortion", within=1024)
def distortion_loss(weights, t):
    """All pairs."""
    return {"loss": nerfstudio_.distortion_loss(weights, t)}


def some_weight(case, x):
    """Rays with light: an empty one is 0 / 0."""
    return np.all(x["weights"].sum(-1) + x["padding"] > 0) and np.all(x["u"] < 1)


@beside("importance_sampling", "nerfacc", "_sample_from_weighted", "weights with the padding, u as given", some_weight)
def importance_sampling(edges, weights, u, padding):
    """With its gradient."""
    return {"t": nerfacc_.importance_sampling(edges, weights, u, padding)}


def no_narrow_bin(case, x):
    """Bins with a width: a histogram's density has none without."""
    return some_weight(case, x) and np.all(np.diff(x["edges"]) > 0)


@beside("importance_sampling", "scipy", "stats.rv_histogram.ppf", "weights with the padding, u as given", no_narrow_bin, "numpy")
def importance_scipy(edges, weights, u, padding):
    """Ray by ray."""
    rows = [scipy.stats.rv_histogram((w + padding, e), density=False).ppf(at) for w, e, at in zip(weights, edges, u)]
    return {"t": np.stack(rows)}
