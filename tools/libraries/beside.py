"""The libraries' views of the components, one function each."""

from importlib.metadata import version

import adapters.nerfacc as nerfacc_
import adapters.nerfstudio as nerfstudio_
import cv2
import jax
import kornia
import mpmath
import numpy as np
import optax
import scipy
import skimage.metrics
import skimage.util
import torch
from bases import beside, of_convention, plain
from gsplat.cuda._torch_impl import _eval_sh_bases_fast, _world_to_cam
from nerfstudio.field_components.encodings import HashEncoding, NeRFEncoding
from nerfstudio.field_components.spatial_distortions import SceneContraction
from torchmetrics.functional.image import structural_similarity_index_measure

OPENCV = "opencv-python-headless"
jax.config.update("jax_platforms", "cpu")
jax.config.update("jax_enable_x64", True)


@beside("transform", "gsplat", "_world_to_cam", only=plain)
def transform(c2w, x_c):
    """R x + o."""
    return {"x_w": _world_to_cam(x_c[:, None], torch.zeros(len(x_c), 1, 3, 3).to(x_c), c2w[:, None])[0][:, 0, 0]}


@beside("transform", OPENCV, "transform", arrays="numpy")
def transform_opencv(c2w, x_c):
    """Matrix by matrix."""
    return {"x_w": np.concatenate([cv2.transform(x[None, None], m[:3])[0] for m, x in zip(c2w, x_c)])}


@beside("pixel_to_camera", OPENCV, "undistortPoints", "times the depth", arrays="numpy")
def pixel_to_camera(K, uv, s):
    """(x, y, 1) s."""
    x = cv2.undistortPoints(uv[:, None], K, None)[:, 0]
    return {"x_c": np.concatenate([x, np.ones_like(x[:, :1])], -1) * s[:, None]}


@beside("pixel_to_camera", "kornia", "unproject_points", only=lambda case, x: case["kind"] == "forward")
def pixel_to_camera_kornia(K, uv, s):
    """One camera; the gradient of its whole matrix isn't ours."""
    return {"x_c": kornia.geometry.camera.perspective.unproject_points(uv, s[:, None], K[None])}


def off_the_origin(case, x):
    """Where its gradient is a number."""
    return case["kind"] == "forward" or np.all(np.any(x["x"] != 0, -1))


@beside(
    "contraction", "nerfstudio", "SceneContraction()",
    only=lambda case, x: off_the_origin(case, x) and case.get("conventions") == {"contraction_norm": "l2", "contraction_range": "two"},
)  # fmt: skip
def contraction(x):
    """Euclidean."""
    return {"contracted": SceneContraction()(x)}


@beside(
    "contraction", "nerfstudio", 'SceneContraction(order=float("inf"))', "y / 4 + 1/2, as its nerfacto has it",
    only=lambda case, x: off_the_origin(case, x) and case.get("conventions") == {"contraction_norm": "linf", "contraction_range": "unit"},
)  # fmt: skip
def contraction_inf(x):
    """By the largest coordinate, into the unit box."""
    return {"contracted": SceneContraction(order=float("inf"))(x) / 4 + 0.5}


def moderate(case, x):
    """Arguments up to 2048 pi, whose rounding costs 2^12 ULP: the library rounds 2^k pi x before it takes the sine."""
    return np.max(np.abs(x["x"]), initial=0) * 2 ** (x["L"] - 1) <= 2048


@beside("positional_encoding", "nerfstudio", "NeRFEncoding", "of x / 2, columns reordered; arguments up to 2048 pi", moderate)
def positional_encoding(x, L):
    """2 pi x / 2; sin of all (dimension, band), then cos: ours are by band."""
    size = x.shape[1]
    both = NeRFEncoding(size, L, 0.0, L - 1.0)(x / 2).unflatten(-1, (2, size, L))
    return {"encoding": torch.cat([x, both.permute(0, 3, 1, 2).flatten(1)], -1)}


def between_faces(case, x):
    """Points off all cells' faces, where every library has another one-sided derivative."""
    return case["kind"] == "forward" or not np.any(x["x"] * x["base"] % 1 == 0)


def whole(base, finest, levels):
    """Cells of every level."""
    return [round(base * (finest / base) ** (n / max(levels - 1, 1))) for n in range(levels)]


@beside(
    "hash_grid", "nerfstudio", "HashEncoding",
    "hashed levels, one module a level; dense ones by torch's grid_sample(align_corners=True)", only=between_faces,
)  # fmt: skip
def hash_grid(x, base, finest, **tables):
    """Level by level."""
    found = []
    for level, n in enumerate(whole(base, finest, len(tables))):
        table = tables[f"table{level}"]
        size, features = table.shape
        if (n + 1) ** 3 <= size:
            volume = table[: (n + 1) ** 3].reshape(n + 1, n + 1, n + 1, features).permute(3, 0, 1, 2)[None]
            y = torch.nn.functional.grid_sample(volume, 2 * x[None, :, None, None] - 1, align_corners=True)
            found.append(y[0, :, :, 0, 0].T)
        else:
            grid = HashEncoding(1, n, n, size.bit_length() - 1, features, implementation="torch")
            del grid.hash_table
            grid.hash_table = table
            found.append(grid(x))
    return {"encoding": torch.cat(found, -1)}


@beside("spherical_harmonics", "gsplat", "_eval_sh_bases_fast", only=plain)
def spherical_harmonics(d, degree):
    """Sloan's recurrences."""
    return {"harmonics": _eval_sh_bases_fast((degree + 1) ** 2, d)}


def on_the_sphere(case, x):
    """Unit directions: scipy takes angles."""
    return plain(case, x) and np.all(np.abs(np.linalg.norm(x["d"], axis=-1) - 1) < 1e-15)


@beside("spherical_harmonics", "scipy", "special.sph_harm_y", "real and imaginary parts, times the root of 2", on_the_sphere, "numpy")
def harmonics_scipy(d, degree):
    """By angles, with Legendre functions."""
    polar, azimuth = np.arctan2(np.hypot(d[:, 0], d[:, 1]), d[:, 2]), np.arctan2(d[:, 1], d[:, 0])
    columns = []
    for n in range(degree + 1):
        for m in range(-n, n + 1):
            y = scipy.special.sph_harm_y(n, abs(m), polar, azimuth)
            columns.append(y.real if m == 0 else np.sqrt(2) * (y.real if m > 0 else y.imag))
    return {"harmonics": np.stack(columns, -1)}


@beside("trunc_exp", "nerfstudio", "trunc_exp", only=plain)
def trunc_exp(x):
    """As it comes."""
    return {"sigmas": nerfstudio_.trunc_exp(x)}


@beside("mlp", "nerfstudio", "MLP", only=plain)
def mlp(x, **parameters):
    """As it comes."""
    return {"y": nerfstudio_.mlp(x, **parameters)}


def without(*names):
    """Cases whose gradient doesn't come through these outputs, which a library doesn't return."""
    return lambda case, x: plain(case, x) and not any(np.any(x.get(f"grad_{name}", 0)) for name in names)


@beside("volume_render", "nerfacc", "rendering", "steps from 0", without("transmittance"))
def volume_render(sigmas, rgbs, deltas):
    """Without what is left behind."""
    return dict(zip(("colors", "weights", "opacity"), nerfacc_.volume_render(sigmas, rgbs, deltas)))


@beside("volume_render", "nerfstudio", "RaySamples.get_weights, RGBRenderer", only=without("transmittance"))
def volume_render_nerfstudio(sigmas, rgbs, deltas):
    """Without what is left behind."""
    return dict(zip(("colors", "weights", "opacity"), nerfstudio_.volume_render(sigmas, rgbs, deltas)))


@beside("volume_render_alpha", "nerfacc", "rendering", only=without("transmittance"))
def volume_render_alpha(alphas, rgbs):
    """Without what is left behind."""
    return dict(zip(("colors", "weights", "opacity"), nerfacc_.volume_render_alpha(alphas, rgbs)))


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
    pointers = scipy.sparse.csr_array((np.ones(count), (ray_ids.astype(int), np.arange(count))), shape=(rays, max(count, 1))).indptr
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


@beside("early_stop", "nerfacc", "render_visibility_from_density, rendering", "of what is visible", without("transmittance"))
def early_stop(sigmas, rgbs, deltas, offsets, eps):
    """Ray by ray."""
    found = nerfacc_.early_stop(sigmas, rgbs, deltas, offsets, eps)
    return dict(zip(("live", "colors", "weights", "opacity"), found))


@beside("distortion_loss", "nerfstudio", "lossfun_distortion")
def distortion_loss(weights, t):
    """All pairs."""
    return {"loss": nerfstudio_.distortion_loss(weights, t)}


@beside("mse", "scikit-image", "mean_squared_error", arrays="numpy")
def mse(prediction, target):
    """As it comes."""
    return {"value": skimage.metrics.mean_squared_error(target, prediction)}


@beside("psnr", "scikit-image", "peak_signal_noise_ratio", "picture by picture, then the mean", of_convention(psnr="images"), "numpy")
def psnr(prediction, target, peak):
    """The mean of the pictures' own."""
    with np.errstate(divide="ignore"):
        each = [skimage.metrics.peak_signal_noise_ratio(b, a, data_range=peak) for a, b in zip(prediction, target)]
    return {"value": np.mean(each)}


@beside("to_uint8", "scikit-image", "img_as_ubyte", "of what is clipped", plain, "numpy")
def to_uint8(image):
    """Rounded."""
    return {"bytes": skimage.util.img_as_ubyte(np.clip(image, 0, 1))}


@beside("linear_to_srgb", "kornia", "linear_rgb_to_rgb", only=plain)
def linear_to_srgb(linear):
    """Each number as a gray pixel."""
    pixels = torch.stack([linear, linear.detach(), linear.detach()], -1)[..., None, None]
    return {"srgb": kornia.color.linear_rgb_to_rgb(pixels)[:, 0, 0, 0]}


@beside("adam_step", "optax", "adam", "in 64 bits; decay added to the gradient", arrays="numpy")
def adam_step(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """One update from a given state."""
    grad, _ = optax.add_decayed_weights(weight_decay).update(grad, optax.EmptyState(), params)
    adam = optax.adam(lr, b1=beta1, b2=beta2, eps=eps)
    first, *rest = adam.init(params)
    state = first._replace(count=np.int32(step - 1), mu=m, nu=v), *rest
    update, state = adam.update(grad, state, params)
    return {"params_out": optax.apply_updates(params, update), "m_out": state[0].mu, "v_out": state[0].nu}


@beside("adam", "optax", "adam", "in 64 bits; decay added to the gradient", arrays="numpy")
def adam(params, grads, lr, beta1, beta2, eps, weight_decay):
    """Twenty updates from the start."""
    chain = optax.chain(optax.add_decayed_weights(weight_decay), optax.adam(lr, b1=beta1, b2=beta2, eps=eps))
    state, steps = chain.init(params), []
    for grad in grads:
        update, state = chain.update(grad, state, params)
        params = optax.apply_updates(params, update)
        steps.append(params)
    return {"params_out": np.stack(steps)}


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


def in_no_face(case, x):
    """Rays that lie in no face: 0 / 0 there."""
    o, d = x["rays_o"], x["rays_d"]
    return case["kind"] == "forward" and not np.any((d == 0) & ((o == x["low"]) | (o == x["high"])))


@beside("ray_aabb", "nerfacc", "_ray_aabb_intersect", "a hit ends before it begins: none", in_no_face)
def ray_aabb(rays_o, rays_d, low, high, near, far):
    """Its hits know neither near nor far: where they leave nothing of the box, both are the same plane."""
    t_near, t_far, hit = nerfacc_.ray_aabb(rays_o, rays_d, low, high, near, far)
    return {"t_near": t_near, "t_far": t_far, "hit": hit & (t_near < t_far)}


@beside("occupancy_grid", "nerfacc", "OccGridEstimator._update", "the largest sigma of each cell; density alone", only=plain)
def occupancy_grid(density, points, sigmas, queries, decay, threshold):
    """One point a cell: of several its last one counts."""
    order = torch.argsort(sigmas)
    return {"density_out": nerfacc_.occupancy_grid(density, points[order], sigmas[order], queries, decay, threshold)[0]}





def pictures():
    """Two pictures of 13 x 17 in three channels that are alike, and two that are opposites."""
    j, i, c = np.meshgrid(np.arange(13), np.arange(17), np.arange(3), indexing="ij")
    a = (37 * j + 101 * i + 53 * c) * 0.61803398875 % 1
    return (a, 0.9 * a), (a, 1 - a)


def exact_ssim(a, b):
    """Wang et al. 2004 over the reals: windows inside of the picture, Gaussian of 11 x 11 with deviation 1.5."""
    g = [mpmath.exp(-(mpmath.mpf(k) ** 2) / (2 * mpmath.mpf(1.5) ** 2)) for k in range(-5, 6)]
    weights = np.array([[x * y / sum(g) ** 2 for x in g] for y in g])
    lift = np.vectorize(lambda x: mpmath.mpf(float(x)), otypes=[object])
    a, b, c1, c2 = lift(a), lift(b), mpmath.mpf("1e-4"), mpmath.mpf("9e-4")
    values = []
    for j, i, c in np.ndindex(a.shape[0] - 10, a.shape[1] - 10, a.shape[2]):
        x, y = a[j : j + 11, i : i + 11, c], b[j : j + 11, i : i + 11, c]
        mx, my = (weights * x).sum(), (weights * y).sum()
        vx, vy, cov = (weights * (x - mx) ** 2).sum(), (weights * (y - my) ** 2).sum(), (weights * (x - mx) * (y - my)).sum()
        values.append((2 * mx * my + c1) * (2 * cov + c2) / ((mx**2 + my**2 + c1) * (vx + vy + c2)))
    return mpmath.fsum(values) / len(values)


def ssims():
    """(library, ULP, what was set) of each SSIM in f64."""
    tensor = lambda x: torch.from_numpy(x).permute(2, 0, 1)[None]  # noqa: E731
    inside = lambda every: every[1][..., 5:-5, 5:-5].mean().item()  # noqa: E731
    measure = {
        ("scikit-image", "population variances"): lambda a, b: skimage.metrics.structural_similarity(
            a, b, gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1.0, channel_axis=2
        ),
        ("kornia", 'padding="valid", eps=0.0'): lambda a, b: (
            kornia.metrics.ssim(tensor(a), tensor(b), 11, eps=0.0, padding="valid").mean().item()
        ),
        ("torchmetrics", "its map without the border of five pixels"): lambda a, b: inside(
            structural_similarity_index_measure(tensor(a), tensor(b), data_range=1.0, return_full_image=True)
        ),
    }
    exact = [(a, b, exact_ssim(a, b)) for a, b in pictures()]
    for (package, setting), function in measure.items():
        ulp = max(float(abs(function(a, b) - y) / np.spacing(abs(float(y)))) for a, b, y in exact)
        yield f"{package} {version(package)}", ulp, setting
