"""nerfstudio's torch implementations on a CPU. Its fields have no feature layer, so that `nerf_mlp` doesn't fit them."""

import torch
from entry import answers, replaced
from nerfstudio.cameras.cameras import Cameras
from nerfstudio.cameras.lie_groups import exp_map_SE3, exp_map_SO3xR3
from nerfstudio.cameras.rays import Frustums, RayBundle, RaySamples
from nerfstudio.field_components.activations import trunc_exp as nerfstudio_trunc_exp
from nerfstudio.field_components.encodings import HashEncoding, NeRFEncoding
from nerfstudio.field_components.mlp import MLP
from nerfstudio.field_components.spatial_distortions import SceneContraction
from nerfstudio.model_components.losses import lossfun_distortion, lossfun_outer, nerfstudio_distortion_loss
from nerfstudio.model_components.ray_samplers import PDFSampler, UniformSampler
from nerfstudio.model_components.renderers import AccumulationRenderer, DepthRenderer, RGBRenderer
from nerfstudio.utils.math import (
    Gaussians,
    components_from_spherical_harmonics,
    conical_frustum_to_gaussian,
    intersect_aabb,
)


def samples(starts, ends, deltas=None):
    """RaySamples with these intervals, along no ray in particular."""
    column = lambda x: x[..., None]  # noqa: E731
    nowhere = torch.zeros(*starts.shape, 3, dtype=starts.dtype)
    frustums = Frustums(nowhere, nowhere, column(starts), column(ends), torch.ones_like(column(starts)))
    return RaySamples(
        frustums, deltas=None if deltas is None else column(deltas), spacing_starts=column(starts), spacing_ends=column(ends)
    )


def bundle(rays_o, rays_d, near, far):
    """A RayBundle with the same near and far for all."""
    ones = torch.ones_like(rays_o[:, :1])
    return RayBundle(rays_o, rays_d, ones, nears=ones * near, fars=ones * far)


@answers("nerfstudio", "image_rays", "Cameras.generate_rays", why="in f64: directions pass through f32, pixels are made in it")
def image_rays(height, width, focal, cx, cy, c2w):
    """All pixels of one camera."""
    number = lambda x: torch.tensor([[x]], dtype=torch.float64).to(c2w.dtype)  # noqa: E731
    cameras = Cameras(c2w[None, :3], number(focal), number(focal), number(cx), number(cy), width, height)
    rays = cameras.generate_rays(0)
    return cameras.get_image_coords().flip(-1), rays.origins, rays.directions


@answers("nerfstudio", "pixel_to_ray", "Cameras.generate_rays(coords)", why="in f64: directions pass through f32")
def pixel_to_ray(K, c2w, uv):
    """A camera for each pixel."""
    every = lambda x: x.expand(len(c2w), 1)  # noqa: E731
    cameras = Cameras(c2w[:, :3], every(K[0, 0]), every(K[1, 1]), every(K[0, 2]), every(K[1, 2]), 64, 64)
    rays = cameras.generate_rays(torch.arange(len(c2w))[:, None], uv.flip(-1))
    return rays.origins, rays.directions


@answers("nerfstudio", "sample_along_rays", "UniformSampler: the edges of its intervals", why="in f64: bins are made in f32")
def sample_along_rays(rays_o, rays_d, near, far, u):
    """It draws its own u: it is handed the case's. N edges bound N - 1 intervals, and one edge none, which it can't be asked."""
    if u.shape[1] < 2:
        return torch.full_like(u, near)
    sampler = UniformSampler(u.shape[1] - 1)
    with replaced(torch, rand=lambda *_, **__: u):
        found = sampler(bundle(rays_o, rays_d, near, far)).frustums
    return torch.cat([found.starts[..., 0], found.ends[:, -1:, 0]], -1)


@answers("nerfstudio", "positional_encoding", "NeRFEncoding(0, L - 1, include_input=True)")
def positional_encoding(x, L):
    """Octaves: exponents from 0 to L - 1 in L steps."""
    return NeRFEncoding(x.shape[1], L, 0.0, L - 1.0, include_input=True)(x)


@answers("nerfstudio", "hash_grid", 'HashEncoding(implementation="torch")')
def hash_grid(x, base, finest, **tables):
    """One table for all levels, one behind the other."""
    table = torch.cat([tables[f"table{level}"] for level in range(len(tables))])
    size, features = tables["table0"].shape
    grid = HashEncoding(len(tables), int(base), int(finest), size.bit_length() - 1, features, implementation="torch")
    del grid.hash_table
    grid.hash_table = table
    return grid(x)


@answers(
    "nerfstudio",
    "spherical_harmonics",
    "utils.math.components_from_spherical_harmonics",
    why="in f64: harmonics are answered in f32",
)
def spherical_harmonics(d, degree):
    """What SHEncoding calls, which has four levels at most and no gradient."""
    return components_from_spherical_harmonics(degree + 1, d)


@answers("nerfstudio", "trunc_exp", "trunc_exp")
def trunc_exp(x):
    """As it comes."""
    return nerfstudio_trunc_exp(x)


ORIGIN = "the gradient at the origin is NaN"


@answers("nerfstudio", "contraction", "SceneContraction()", why=ORIGIN)
def contraction(x):
    """By the Euclidean norm."""
    return SceneContraction()(x)


@answers("nerfstudio", "contraction", 'SceneContraction(order=float("inf"))', why=ORIGIN)
def contraction_inf(x):
    """By the largest coordinate, as nerfacto has it."""
    return SceneContraction(order=float("inf"))(x)


@answers("nerfstudio", "mlp", "MLP")
def mlp(x, **parameters):
    """The case's weights in the module's layers."""
    weights = [parameters[f"w{n}"] for n in range(len(parameters) // 2)]
    net = MLP(x.shape[1], len(weights), len(weights[0]), len(weights[-1]), out_activation=torch.nn.Sigmoid())
    named = {f"layers.{n}.{what}": parameters[f"{what[0]}{n}"] for n in range(len(weights)) for what in ("weight", "bias")}
    return torch.func.functional_call(net, named, x)


@answers("nerfstudio", "volume_render", "RaySamples.get_weights, RGBRenderer, AccumulationRenderer")
def volume_render(sigmas, rgbs, deltas):
    """Without background."""
    weights = samples(torch.zeros_like(deltas), deltas, deltas).get_weights(sigmas[..., None])
    return RGBRenderer.combine_rgb(rgbs, weights), weights[..., 0], AccumulationRenderer()(weights)[..., 0]


@answers("nerfstudio", "volume_render_alpha", "RaySamples.get_weights_and_transmittance_from_alphas")
def volume_render_alpha(alphas, rgbs):
    """With its own product."""
    weights, transmittance = RaySamples.get_weights_and_transmittance_from_alphas(alphas[..., None])
    colors = RGBRenderer.combine_rgb(rgbs, weights)
    return colors, weights[..., 0], AccumulationRenderer()(weights)[..., 0], transmittance[:, -1, 0]


@answers("nerfstudio", "composite_background", 'RGBRenderer("random").blend_background_for_loss_computation')
def composite_background(colors, opacity, background):
    """It draws a background: it is handed the case's."""
    with replaced(torch, rand_like=lambda x: background.expand(x.shape)):
        return RGBRenderer("random").blend_background_for_loss_computation(colors, opacity[:, None], colors)[0]


@answers("nerfstudio", "depth", 'DepthRenderer("expected")')
def depth(weights, t):
    """Intervals without width, whose middles are t."""
    return DepthRenderer("expected")(weights[..., None], samples(t, t))[..., 0]


@answers("nerfstudio", "distortion_loss", "losses.lossfun_distortion")
def distortion_loss(weights, t):
    """Of each ray."""
    return lossfun_distortion(t, weights)


@answers("nerfstudio", "distortion_loss", "losses.nerfstudio_distortion_loss")
def nerfstudio_distortion(weights, t):
    """Of each ray, by RaySamples."""
    return nerfstudio_distortion_loss(samples(t[:, :-1], t[:, 1:]), weights=weights[..., None])[..., 0]


@answers("nerfstudio", "importance_sampling", "PDFSampler(include_original=False)")
def importance_sampling(edges, weights, u, padding):
    """Its own u come from linspace and rand: it is handed the case's."""
    bins = samples(edges[:, :-1], edges[:, 1:])
    bins.spacing_to_euclidean_fn = lambda x: x
    sampler = PDFSampler(u.shape[1] - 1, include_original=False, histogram_padding=padding)
    nowhere = torch.zeros(len(u), 3, dtype=u.dtype)
    with replaced(torch, linspace=lambda *_, **__: u, rand=lambda *_, **__: torch.zeros_like(u)):
        found = sampler(bundle(nowhere, nowhere, 0.0, 1.0), bins, weights[..., None])
    return torch.cat([found.spacing_starts[..., 0], found.spacing_ends[:, -1:, 0]], -1)


@answers(
    "nerfstudio", "ray_aabb", "utils.math.intersect_aabb", why="rays in a face come out as NaN; a box without thickness is missed"
)
@torch.no_grad()
def ray_aabb(rays_o, rays_d, low, high, near, far):
    """Its rays begin at 0: they are moved to near. A miss is 1e10. Without gradient, as where it is called."""
    t_near, t_far = intersect_aabb(rays_o + near * rays_d, rays_d, torch.cat([low, high]), max_bound=far - near)
    return t_near + near, t_far + near, t_near < 1e10


@answers("nerfstudio", "conical_frustum", "utils.math.conical_frustum_to_gaussian")
def conical_frustum(origins, directions, radii, starts, ends):
    """Means and the diagonals of covariances; it hands out no moments."""
    column = lambda x: x[:, None]  # noqa: E731
    blob = conical_frustum_to_gaussian(origins, directions, column(starts), column(ends), column(radii))
    return {"means": blob.mean, "variances": blob.cov.diagonal(dim1=-2, dim2=-1)}


@answers(
    "nerfstudio",
    "integrated_encoding",
    "NeRFEncoding(0, L - 1, include_input=True) with covs",
    why="its variances lack the factor (2 pi)^2 of its means",
)
def integrated_encoding(means, variances, L):
    """Octaves."""
    return NeRFEncoding(means.shape[1], L, 0.0, L - 1.0, include_input=True)(means, torch.diag_embed(variances))


@answers(
    "nerfstudio",
    "contract_gaussians",
    "SceneContraction() of Gaussians",
    why="the gradient at the origin is NaN",
)
def contract_gaussians(means, covariances):
    """By the Euclidean norm, the only one that it takes Gaussians in."""
    out = SceneContraction()(Gaussians(mean=means, cov=covariances))
    return out.mean, out.cov


@answers("nerfstudio", "so3_exp", "exp_map_SO3xR3: its rotation")
def so3_exp(w):
    """Without translation."""
    return exp_map_SO3xR3(torch.cat([torch.zeros_like(w), w], 1))[:, :3, :3]


def whole(motions):
    """With the last row."""
    last = torch.tensor([0.0, 0.0, 0.0, 1.0], dtype=motions.dtype).expand(len(motions), 1, 4)
    return torch.cat([motions, last], 1)


@answers("nerfstudio", "se3_exp", "exp_map_SE3", why="in f64: angles below 0.01 are turned by a Cayley transform")
def se3_exp(twists):
    """Of coupled halves."""
    return whole(exp_map_SE3(twists))


@answers("nerfstudio", "se3_exp", "exp_map_SO3xR3", why="in f32: the gradient near 0, by an eighth of what is allowed")
def se3_exp_apart(twists):
    """Of halves by themselves."""
    return whole(exp_map_SO3xR3(twists))


@answers("nerfstudio", "interlevel_loss", "losses.lossfun_outer, summed")
def interlevel_loss(weights, t, proposal_weights, proposal_t, eps):
    """Of each ray; the case's eps isn't asked for."""
    return lossfun_outer(t, weights, proposal_t, proposal_weights).sum(-1)


def resampled(edges, weights, u, include_original):
    """PDFSampler's edges, its draws replaced by u; no padding, which is another row's."""
    bins = samples(edges[:, :-1], edges[:, 1:])
    bins.spacing_to_euclidean_fn = lambda x: x
    sampler = PDFSampler(u.shape[1] - 1, include_original=include_original, histogram_padding=0.0)
    nowhere = torch.zeros(len(u), 3, dtype=u.dtype)
    with replaced(torch, linspace=lambda *_, **__: u, rand=lambda *_, **__: torch.zeros_like(u)):
        found = sampler(bundle(nowhere, nowhere, 0.0, 1.0), bins, weights[..., None])
    return torch.cat([found.spacing_starts[..., 0], found.spacing_ends[:, -1:, 0]], -1)


@answers("nerfstudio", "resample_edges", "PDFSampler(include_original=False, histogram_padding=0)")
def resample_edges(edges, weights, u):
    """Between samples."""
    return resampled(edges, weights, u, False)


@answers("nerfstudio", "resample_edges", "PDFSampler(include_original=True, histogram_padding=0)")
def resample_edges_with_old(edges, weights, u):
    """And between the old edges."""
    return resampled(edges, weights, u, True)
