"""nerfstudio."""

from reproduction import deviation


@deviation("nerfstudio", "bug", "`SceneContraction`: the gradient at the origin is NaN")
def contraction_at_the_origin():
    """Inside the unit ball the contraction is x itself, with derivative 1. But torch.where differentiates both branches, and x
    / |x| is 0 / 0 at the origin: 0 times NaN is NaN, which one such point writes into every parameter behind it. A norm that is
    held to at least 1 in the outer branch mends it."""
    import torch
    from nerfstudio.field_components.spatial_distortions import SceneContraction

    x = torch.zeros(1, 3, requires_grad=True)
    SceneContraction(order=float("inf"))(x).sum().backward()
    found, expected = x.grad[0].tolist(), [1.0, 1.0, 1.0]
    return found, expected


@deviation("nerfstudio", "bug", "`HashEncoding`: the finest level has 2047 cells where max_res is 2048")
def cells_of_the_finest_level():
    """`growth_factor**levels` is a power of whole numbers in a tensor, which torch takes in f32: 16 times the 15th is 2047.9988,
    and `torch.floor` makes 2047 of it. Equations 2 and 3 of the paper have N_max = 2048 there by construction. With the
    default, 16 levels from 16 to 1024, the last has 1024. Levels in f64, or rounding what misses a whole number by so little,
    mend it. The judge lets both pass."""
    import mpmath
    from nerfstudio.field_components.encodings import HashEncoding

    grid = HashEncoding(num_levels=16, min_res=16, max_res=2048, log2_hashmap_size=4, implementation="torch")
    growth = mpmath.exp((mpmath.log(2048) - mpmath.log(16)) / 15)
    found, expected = [grid.scalings[-1].item()], [round(float(16 * growth**15), 9)]
    return found, expected


@deviation("nerfstudio", "bug", "`HashEncoding`: the gradient by the position is 0 on the cells' faces")
def gradient_on_a_face():
    """Corners are ceil(x N) and floor(x N). On a face both are the same vertex, and the difference of the two features, which
    is the derivative, is 0. Here the feature is 4 x along this edge, on both sides of the face: its derivative is 4. floor(x N)
    + 1 for the upper corner gives it. The judge lets it pass, as it does either side's derivative."""
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
    """`torch.clip(depth, steps.min(), steps.max())` takes the extremes of the whole batch. The depth 0 / 1e-10 of an empty ray
    becomes the smallest step of any ray, and depends on which rays are rendered with it: 2 with this neighbor, 4 alone.
    Expected is what the ray has alone, its first step."""
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
    """The sum of the weights has 1e-10 beside it, which halves the depth of a ray of opacity 1e-10, and moves that of opacity A
    by 1e-10 / A of itself. The judge tells it with the depth of empty rays and lets it pass."""
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


@deviation(
    "nerfstudio", "choice", "`get_weights_and_transmittance_from_alphas`: light passes opaque samples, and grows in empty space"
)
def light_behind_an_opaque_sample():
    """Each factor of the product is 1 - alpha + 1e-7. Behind an opaque sample 1e-7 is left; a thousand empty ones make 1.0001
    of 1. The judge reports it as the convention product_eps = 1e-7."""
    import torch
    from nerfstudio.cameras.rays import RaySamples

    alphas = torch.zeros(1, 1001, 1, dtype=torch.float64)
    _, transmittance = RaySamples.get_weights_and_transmittance_from_alphas(alphas)
    opaque, behind = RaySamples.get_weights_and_transmittance_from_alphas(torch.ones(1, 1, 1, dtype=torch.float64))
    found, expected = [transmittance[0, 1000].item(), behind[0, 1].item()], [1.0, 0.0]
    return found, expected


@deviation("nerfstudio", "bug", "`intersect_aabb` returns NaN for a ray in a face of the box, as a hit")
def nan_in_a_face():
    """0 / 0 in that slab makes both ends NaN. `t_max <= t_min` is false for them, so that they aren't replaced by invalid_value
    and become a ray's near and far. The part 1 <= t <= 2 of this ray lies in the closed box."""
    import torch
    from nerfstudio.utils.math import intersect_aabb

    o, d = torch.tensor([[-1.0, 0.0, 0.5]]), torch.tensor([[1.0, 0.0, 0.0]])
    t_min, t_max = intersect_aabb(o, d, torch.tensor([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]))
    found, expected = [t_min.item(), t_max.item()], [1.0, 2.0]
    return found, expected


@deviation("nerfstudio", "digits", "`components_from_spherical_harmonics` answers f64 directions in f32")
def harmonics_in_f32():
    """`torch.zeros(..., device=...)` takes the default type, not the directions'. `dtype=directions.dtype` mends it. SHEncoding
    has the same, four levels at most, and no gradient by the direction (`torch.no_grad`)."""
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
    """`_generate_rays_from_coords` makes directions_stack in the default type and fills it through `.float()`; `get_image_coords`
    is in f32 too: with poses and lenses in f64 rays have 24 bits. `dtype=coord_stack.dtype` there, without `.float()`, mends
    the directions."""
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
