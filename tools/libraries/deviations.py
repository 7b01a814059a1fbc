"""Where a library deviates from the formula: a few lines that show it, what they find, and what mpmath says at 50 digits.

Each function is a reproduction that can be pasted; `page` in __main__.py prints its body. `found` and `expected` are lists of numbers.
"""

from dataclasses import dataclass
from importlib.metadata import version

DEVIATIONS = []


@dataclass(frozen=True)
class Deviation:
    """`kind`: a bug, digits that are lost, or a choice of the library's that callers should know."""

    package: str
    title: str
    kind: str
    function: object

    @property
    def name(self):
        """The library with its version."""
        return f"{self.package} {version(self.package)}"

    @property
    def why(self):
        """Its reason: the function's docstring."""
        return " ".join(self.function.__doc__.split())


def deviation(package, kind, title):
    """A decorator that makes a function a reproduction."""

    def keep(function):
        DEVIATIONS.append(Deviation(package, title, kind, function))
        return function

    return keep


@deviation("nerfacc", "bug", "`_ray_aabb_intersect` calls a box behind `far_plane` a hit")
def box_behind_far():
    """`hits` is taken before t is clamped to [near_plane, far_plane]. Both ends become the far plane: an interval without length,
    reported as a hit. Expected is no hit: the slab [2, 3] has nothing in [0, 1]. The CUDA kernel decides before it clamps too (read, not
    run), and has t_min = 2, t_max = 1 there."""
    import torch
    from nerfacc.grid import _ray_aabb_intersect

    box = torch.tensor([[-1.0, -1.0, 2.0, 1.0, 1.0, 3.0]])
    o, d = torch.zeros(1, 3), torch.tensor([[0.0, 0.0, 1.0]])
    _, _, hits = _ray_aabb_intersect(o, d, box, near_plane=0.0, far_plane=1.0)
    found, expected = [float(hits)], [0.0]
    return found, expected


@deviation("nerfacc", "bug", "`_ray_aabb_intersect` misses a box whose face the ray runs in")
def in_a_face():
    """(low - o) / d is 0 / 0 in that slab, and every comparison with NaN is false. The closed box [0, 1]^3 has the whole of this ray's
    part with 1 <= t <= 2 in it. Kay and Kajiya's slab of d = 0 is all t where low <= o <= high."""
    import torch
    from nerfacc.grid import _ray_aabb_intersect

    box = torch.tensor([[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]])
    o, d = torch.tensor([[-1.0, 0.0, 0.5]]), torch.tensor([[1.0, 0.0, 0.0]])
    _, _, hits = _ray_aabb_intersect(o, d, box)
    found, expected = [float(hits)], [1.0]
    return found, expected


@deviation("nerfacc", "bug", "`OccGridEstimator._update` keeps the last of several samples of a cell, not the largest")
def last_sample_of_a_cell():
    """`occs[cell_ids] = maximum(occs[cell_ids] * ema_decay, occ)` writes a repeated cell once for each sample, and the last write
    stays. After the warm-up cells do repeat: `_sample_uniform_and_occupied_cells` draws with replacement. The comment in the source
    says that a scatter with maximum was meant; torch has it: `occs.scatter_reduce_(0, cell_ids, occ, "amax")`."""
    import torch
    from nerfacc import OccGridEstimator

    grid = OccGridEstimator([0.0, 0.0, 0.0, 1.0, 1.0, 1.0], resolution=2)
    grid._sample_uniform_and_occupied_cells = lambda n: [torch.tensor([3, 3])]
    grid._update(step=256, occ_eval_fn=lambda x: torch.tensor([[5.0], [1.0]]), ema_decay=0.5)
    found, expected = [float(grid.occs[3])], [5.0]
    return found, expected


@deviation("nerfacc", "bug", "`grid._query` takes points on the lower faces of the box for outside")
def query_on_the_lower_face():
    """The level is `frexp(|x - 1/2|)[1] + 1`, and frexp(1/2) has exponent 0: |x - 1/2| = 1/2 counts as the next level, which a grid of
    one level hasn't got. x = 0 belongs to the first cell."""
    import torch
    from nerfacc.grid import _query

    box, occupied = torch.tensor([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), torch.ones(1, 2, 2, 2, dtype=torch.bool)
    value, _ = _query(torch.tensor([[0.0, 0.3, 0.3]]), occupied, box)
    found, expected = [float(value)], [1.0]
    return found, expected


@deviation("nerfacc", "choice", "`_sample_from_weighted` puts all samples of an empty ray into its last bin")
def samples_of_an_empty_ray():
    """The CDF's last entry is 1 whatever the weights are, so that what isn't absorbed lies in the last bin: meant for a CDF of 1 - T,
    not for weights that sum to 0, of which F.normalize makes zeros. 0 / 0 has no right answer; expected here is the uniform one."""
    import torch
    from nerfacc.pdf import _sample_from_weighted

    _, centers = _sample_from_weighted(torch.tensor([[0.0, 1.0, 2.0, 3.0]]), torch.zeros(1, 3), 2)
    found, expected = centers[0].tolist(), [0.75, 2.25]
    return found, expected


@deviation("nerfstudio", "bug", "`SceneContraction`: the gradient at the origin is NaN")
def contraction_at_the_origin():
    """Inside the unit ball the contraction is x itself, with derivative 1. But torch.where differentiates both branches, and x / |x| is
    0 / 0 at the origin: 0 times NaN is NaN, which one such point writes into every parameter behind it. A norm that is held to at least
    1 in the outer branch mends it."""
    import torch
    from nerfstudio.field_components.spatial_distortions import SceneContraction

    x = torch.zeros(1, 3, requires_grad=True)
    SceneContraction(order=float("inf"))(x).sum().backward()
    found, expected = x.grad[0].tolist(), [1.0, 1.0, 1.0]
    return found, expected


@deviation("nerfstudio", "bug", "`HashEncoding`: the finest level has 2047 cells where max_res is 2048")
def cells_of_the_finest_level():
    """growth_factor is exp((ln 2048 - ln 16) / 15), whose 15th power times 16 is computed as a little less than 2048, and `torch.floor`
    takes it to 2047. Equations 2 and 3 of the paper have N_max = 2048 there by construction. With the default, 16 levels from 16 to
    1024, the last has 1024. Rounding what misses a whole number by a rounding mends it. The judge lets both pass."""
    import mpmath
    from nerfstudio.field_components.encodings import HashEncoding

    grid = HashEncoding(num_levels=16, min_res=16, max_res=2048, log2_hashmap_size=4, implementation="torch")
    growth = mpmath.exp((mpmath.log(2048) - mpmath.log(16)) / 15)
    found, expected = [grid.scalings[-1].item()], [round(float(16 * growth**15), 9)]
    return found, expected


@deviation("nerfstudio", "bug", "`HashEncoding`: the gradient by the position is 0 on the cells' faces")
def gradient_on_a_face():
    """Corners are ceil(x N) and floor(x N). On a face both are the same vertex, and the difference of the two features, which is the
    derivative, is 0. Here the feature is 4 x along this edge, on both sides of the face: its derivative is 4. floor(x N) + 1 for the
    upper corner gives it. The judge lets it pass, as it does either side's derivative."""
    import torch
    from nerfstudio.field_components.encodings import HashEncoding

    grid = HashEncoding(num_levels=1, min_res=4, max_res=4, log2_hashmap_size=6, features_per_level=1, implementation="torch")
    del grid.hash_table
    grid.hash_table = torch.arange(64.0)[:, None]
    x = torch.tensor([[0.25, 0.0, 0.0]], requires_grad=True)
    grid(x).sum().backward()
    found, expected = [x.grad[0, 0].item()], [4.0]
    return found, expected


@deviation("nerfstudio", "bug", '`DepthRenderer("expected")` clips a ray\'s depth to the steps of other rays')
def depth_of_an_empty_ray():
    """`torch.clip(depth, steps.min(), steps.max())` takes the extremes of the whole batch. The depth 0 / 1e-10 of an empty ray becomes the
    smallest step of any ray, and depends on which rays are rendered with it: 2 with this neighbor, 4 alone. Expected is what the ray has
    alone, its first step."""
    import torch
    from nerfstudio.cameras.rays import Frustums, RaySamples
    from nerfstudio.model_components.renderers import DepthRenderer

    t = torch.tensor([[4.0, 5.0], [2.0, 3.0]])[..., None]
    ones = torch.ones(2, 2, 3)
    samples = RaySamples(Frustums(ones, ones, t, t, torch.ones_like(t)))
    weights = torch.tensor([[0.0, 0.0], [0.5, 0.5]])[..., None]
    found, expected = DepthRenderer("expected")(weights, samples)[0].tolist(), [4.0]
    return found, expected


@deviation("nerfstudio", "choice", '`DepthRenderer("expected")` draws thin rays towards 0')
def depth_of_a_thin_ray():
    """The sum of the weights has 1e-10 beside it, which halves the depth of a ray of opacity 1e-10, and moves that of opacity A by
    1e-10 / A of itself. The judge tells it with the depth of empty rays and lets it pass."""
    import mpmath
    import torch
    from nerfstudio.cameras.rays import Frustums, RaySamples
    from nerfstudio.model_components.renderers import DepthRenderer

    t = torch.tensor([[2.0, 6.0]], dtype=torch.float64)[..., None]
    ones = torch.ones(1, 2, 3, dtype=torch.float64)
    samples = RaySamples(Frustums(ones, ones, t, t, torch.ones_like(t)))
    weights = torch.tensor([[0.0, 1e-10]], dtype=torch.float64)[..., None]
    thin = mpmath.mpf(1e-10)
    found, expected = DepthRenderer("expected")(weights, samples)[0].tolist(), [float(6 * thin / thin)]
    return found, expected


@deviation("nerfstudio", "choice", "`get_weights_and_transmittance_from_alphas`: light passes opaque samples, and grows in empty space")
def light_behind_an_opaque_sample():
    """Each factor of the product is 1 - alpha + 1e-7. Behind an opaque sample 1e-7 is left; a thousand empty ones make 1.0001 of 1. The
    judge reports it as the convention product_eps = 1e-7."""
    import torch
    from nerfstudio.cameras.rays import RaySamples

    alphas = torch.zeros(1, 1001, 1, dtype=torch.float64)
    _, transmittance = RaySamples.get_weights_and_transmittance_from_alphas(alphas)
    opaque, behind = RaySamples.get_weights_and_transmittance_from_alphas(torch.ones(1, 1, 1, dtype=torch.float64))
    found, expected = [transmittance[0, 1000].item(), behind[0, 1].item()], [1.0, 0.0]
    return found, expected


@deviation("nerfstudio", "bug", "`intersect_aabb` returns NaN for a ray in a face of the box, as a hit")
def nan_in_a_face():
    """0 / 0 in that slab makes both ends NaN. `t_max <= t_min` is false for them, so that they aren't replaced by invalid_value and
    become a ray's near and far. The part 1 <= t <= 2 of this ray lies in the closed box."""
    import torch
    from nerfstudio.utils.math import intersect_aabb

    o, d = torch.tensor([[-1.0, 0.0, 0.5]]), torch.tensor([[1.0, 0.0, 0.0]])
    t_min, t_max = intersect_aabb(o, d, torch.tensor([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]))
    found, expected = [t_min.item(), t_max.item()], [1.0, 2.0]
    return found, expected


@deviation("nerfstudio", "digits", "`components_from_spherical_harmonics` answers f64 directions in f32")
def harmonics_in_f32():
    """`torch.zeros(..., device=...)` takes the default type, not the directions'. `dtype=directions.dtype` mends it. SHEncoding has
    the same, four levels at most, and no gradient by the direction (`torch.no_grad`)."""
    import mpmath
    import torch
    from nerfstudio.utils.math import components_from_spherical_harmonics

    d = torch.tensor([[0.6, 0.0, 0.8]], dtype=torch.float64)
    y = components_from_spherical_harmonics(2, d)[0, 2]
    exact = mpmath.sqrt(3 / (4 * mpmath.pi)) * mpmath.mpf(0.8)
    found, expected = [y.item()], [float(exact)]
    return found, expected


@deviation("nerfstudio", "digits", "`Cameras.generate_rays` makes the rays of f64 cameras in f32")
def rays_in_f32():
    """Perspective directions pass through `.float()` in `_generate_rays_from_coords`, and `get_image_coords` is in f32: with poses and
    lenses in f64 rays have 24 bits. `.to(directions_stack)` in the place of `.float()` mends the first."""
    import mpmath
    import torch
    from nerfstudio.cameras.cameras import Cameras

    lens = torch.tensor([[3.0]], dtype=torch.float64)
    cameras = Cameras(torch.eye(4, dtype=torch.float64)[None, :3], lens, lens, lens * 0, lens * 0, 1, 1)
    rays = cameras.generate_rays(0, coords=torch.zeros(1, 2, dtype=torch.float64) + 1)
    exact = 1 / mpmath.sqrt(11)
    found, expected = [rays.directions[0, 0].item()], [float(exact)]
    return found, expected


@deviation("nerfstudio", "digits", "`UniformSampler` makes the bins of f64 rays in f32")
def bins_in_f32():
    """`torch.linspace(0.0, 1.0, num_samples + 1)` takes the default type. With `dtype=ray_bundle.nears.dtype` the edges of the
    intervals come out in f64."""
    import mpmath
    import torch
    from nerfstudio.cameras.rays import RayBundle
    from nerfstudio.model_components.ray_samplers import UniformSampler

    one = torch.ones(1, 1, dtype=torch.float64)
    bundle = RayBundle(one.expand(1, 3), one.expand(1, 3), one, nears=2 * one, fars=6 * one)
    found, expected = [UniformSampler(3).eval()(bundle).frustums.ends[0, 0, 0].item()], [float(2 + mpmath.mpf(4) / 3)]
    return found, expected


@deviation("torchmetrics", "digits", "`peak_signal_noise_ratio` of f64 pictures has f32's digits")
def psnr_in_f32():
    """ln 10 is `torch.log(tensor(base))`, and data_range `tensor(float(data_range))`: both in f32, whatever the pictures are in. Off by
    4.5e-8 of the value. `math.log(base)` mends the first, `dtype=preds.dtype` the second."""
    import mpmath
    import torch
    from torchmetrics.functional.image import peak_signal_noise_ratio

    ones = torch.ones(1, 3, 16, 16, dtype=torch.float64)
    value = peak_signal_noise_ratio(0.5 * ones, ones, data_range=1.0)
    found, expected = [value.item()], [float(20 * mpmath.log10(2))]
    return found, expected


@deviation("torchmetrics", "choice", "`structural_similarity_index_measure` counts windows that reach over the edge")
def ssim_over_the_edge():
    """The mean runs over all pixels, those near the edge with a mirrored neighborhood. Wang et al.'s own program, scikit-image and
    kornia's padding="valid" average the windows that lie inside; on small pictures it shows. Expected is its own map without the
    border of five pixels, which agrees with scikit-image."""
    import torch
    from torchmetrics.functional.image import structural_similarity_index_measure

    a = (torch.arange(3 * 13 * 17, dtype=torch.float64) * 0.61803398875 % 1).reshape(1, 3, 13, 17)
    value, every = structural_similarity_index_measure(a, 1 - a, data_range=1.0, return_full_image=True)
    found, expected = [value.item()], [every[..., 5:-5, 5:-5].mean().item()]
    return found, expected


@deviation("kornia", "choice", "`metrics.ssim`: 1e-12 in the denominator")
def ssim_beside_1e_12():
    """The product in the denominator of a window without contrast is c2 (2 m^2 + c1): a black one has 9e-8, which 1e-12 is 1e-5
    of. Two equal black pictures are 0.99999 alike; eps=0.0 mends it, and the denominator is never 0."""
    import torch
    from kornia.metrics import ssim

    black = torch.zeros(1, 1, 11, 11, dtype=torch.float64)
    found, expected = [ssim(black, black, 11, padding="valid").mean().item()], [1.0]
    return found, expected


@deviation("opencv-python-headless", "choice", "`PSNR` of equal pictures is 313.07 dB, not infinite")
def psnr_of_equal_pictures():
    """It is 20 log10(R / (rms + DBL_EPSILON)), so that nothing is better than 313.07 dB for R = 1, and an rms near 2.2e-16 counts
    double."""
    import cv2
    import numpy as np

    picture = np.zeros((8, 8, 3))
    found, expected = [cv2.PSNR(picture, picture, 1.0)], [float("inf")]
    return found, expected


@deviation("opencv-python-headless", "bug", "`convertScaleAbs` gives a pixel another byte in a wider picture")
def bytes_by_width():
    """Rows of 16 pixels and more go through vector code that takes 255 x in f32, where the 80.5000024 of this pixel is 80.5, which half
    to even makes 80. Shorter rows are taken in f64 and rounded to the right 81. Found are rows of 15 and of 16 pixels."""
    import cv2
    import mpmath
    import numpy as np

    x = 0.31568628391798803
    found = [float(cv2.convertScaleAbs(np.full((1, width), x), alpha=255)[0, 0]) for width in (15, 16)]
    expected = 2 * [float(mpmath.floor(255 * mpmath.mpf(x) + 0.5))]
    return found, expected
