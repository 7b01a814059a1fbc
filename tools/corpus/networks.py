"""Plain networks and the radiance field."""

import numpy as np
import torch
import torch.nn.functional as F
from entry import convention, fault, right


def layers(inputs):
    """(weight, bias) of all layers, first to last."""
    return [(inputs[f"w{i}"], inputs[f"b{i}"]) for i in range(sum(name.startswith("w") for name in inputs))]


def network(x, stack, hidden=torch.relu, last=torch.sigmoid):
    """Hidden layers with one activation, the last with another."""
    for w, b in stack[:-1]:
        x = hidden(F.linear(x, w, b))
    return last(F.linear(x, *stack[-1]))


@right("mlp", seen="CS180 students (nn.Linear, relu, sigmoid)", times=10)
def linear_layers(x, **rest):
    """F.linear, relu, and a sigmoid at the end."""
    return network(x, layers(rest))


@right("mlp", seen="tinygrad and numpy ports: x @ W + b with W stored transposed", times=3)
def products_with_transposed_weights(x, **rest):
    """x W^T + b; sigmoid as 1 / (1 + exp(-z))."""
    stack = layers(rest)
    for w, b in stack[:-1]:
        x = torch.clamp(x @ w.T + b, min=0)
    return 1 / (1 + torch.exp(-(x @ stack[-1][0].T + stack[-1][1])))


@right("mlp", seen="C++ and Rust ports (loops)", times=3, arrays="numpy")
def numpy_layers(x, **rest):
    """numpy: a maximum with 0, sigmoid as half of 1 + tanh of the half where small values aren't asked for."""
    stack = layers(rest)
    for w, b in stack[:-1]:
        x = np.maximum(np.einsum("mi,oi->mo", x, w) + b, 0)
    z = np.einsum("mi,oi->mo", x, stack[-1][0]) + stack[-1][1]
    e = np.exp(-np.abs(z))
    return np.where(z >= 0, 1 / (1 + e), e / (1 + e))


@fault("mlp", "sigmoid_missing", seen="Ajithjaas/NeRF Network.py: raw values, activated later", times=3)
def raw_output(x, **rest):
    """No sigmoid."""
    return network(x, layers(rest), last=lambda z: z)


@fault("mlp", "relu_before_sigmoid+sigmoid_missing", seen="sixer51/SfM-NeRF NeRFModel.py: relu for colors")
def relu_at_the_end(x, **rest):
    """relu for the sigmoid."""
    return network(x, layers(rest), last=torch.relu)


@fault("mlp", "relu_before_sigmoid", seen="students' Sequential with a relu behind every layer")
def relu_then_sigmoid(x, **rest):
    """relu, then sigmoid: never below one half."""
    return network(x, layers(rest), last=lambda z: torch.sigmoid(torch.relu(z)))


@fault("mlp", "smooth_units", seen="SiLU networks of neighboring fields", times=3)
def smooth_units(x, **rest):
    """x sigmoid(x) in the hidden layers."""
    return network(x, layers(rest), hidden=F.silu)


@fault("mlp", "leaky_units", seen="a fluorescence field in keras: LeakyReLU", times=2)
def leaky_units(x, **rest):
    """LeakyReLU in the hidden layers."""
    return network(x, layers(rest), hidden=lambda z: F.leaky_relu(z, 0.01))


@fault("mlp", "layer_never_applied", seen="sixer51/SfM-NeRF (one block over and over); a field that returns its input", times=2)
def one_layer_left_out(x, **rest):
    """The second of several hidden layers is built and never called."""
    stack = layers(rest)
    square = [i for i, (w, _) in enumerate(stack[:-1]) if i and w.shape[0] == w.shape[1]]
    return network(x, [layer for i, layer in enumerate(stack) if i not in square[:1]])


@fault("mlp", "bias_forgotten", seen="tiny-cuda-nn's fully fused networks have none: other layers, not this row's", times=2)
def no_biases(x, **rest):
    """Products alone."""
    return network(x, [(w, torch.zeros_like(b)) for w, b in layers(rest)])


def encode(x, width, factor, columns="band"):
    """Identity, then L bands; L from the width of the first layer."""
    L, out = (width // x.shape[1] - 1) // 2, [x]
    angles = x[..., None] * (2.0 ** torch.arange(L)) * factor
    if columns == "x_last":
        return torch.cat([angles.sin().flatten(1), angles.cos().flatten(1), x], -1)
    if columns == "x_within":
        return torch.cat([x[..., None], angles.sin(), angles.cos()], -1).flatten(1)
    if columns == "dim":
        return torch.cat([x, torch.cat([angles.sin(), angles.cos()], -1).reshape(len(x), -1)], -1)
    for k in range(L):
        out += [torch.sin(2**k * factor * x), torch.cos(2**k * factor * x)]
    return torch.cat(out, -1)


def field(
    a,
    factor=torch.pi,
    columns="band",
    hidden_first=True,
    density=torch.relu,
    last=True,
    feature=None,
    unit=torch.relu,
    colors=torch.sigmoid,
):
    """The paper's network: eight layers, the encoding again into the fifth, density, feature, one layer for the color."""
    x = encode(a["positions"], a["trunk0_w"].shape[1], factor, columns)
    d = encode(a["directions"], a["color0_w"].shape[1] - a["feature_w"].shape[0], factor, columns)
    h = x
    for i in range(8):
        if i == 4:
            h = torch.cat([h, x] if hidden_first else [x, h], -1)
        h = F.linear(h, a[f"trunk{i}_w"], a[f"trunk{i}_b"])
        h = torch.relu(h) if last or i < 7 else h
    sigma = density(F.linear(h, a["sigma_w"], a["sigma_b"]))[:, 0]
    f = F.linear(h, a["feature_w"], a["feature_b"])
    c = unit(F.linear(torch.cat([feature(f) if feature else f, d], -1), a["color0_w"], a["color0_b"]))
    return sigma, colors(F.linear(c, a["color1_w"], a["color1_b"]))


@right("nerf_mlp", seen="CS180 students (the course's diagram)", times=6)
def course_network(**a):
    """The network of the course."""
    return field(a)


@convention("nerf_mlp", {"last_trunk": "none"}, seen="CS180 students: no relu behind the eighth layer", times=3)
def no_relu_behind_the_trunk(**a):
    """The trunk's last layer is linear."""
    return field(a, last=False)


@convention(
    "nerf_mlp",
    {"frequency": "two_pi", "columns": "dim_sin_cos", "last_trunk": "none"},
    seen="CS180 student (nerf.py in one file)",
)
def whole_turns_in_the_field(**a):
    """2 pi 2^k, sines and cosines by dimension, a linear eighth layer."""
    return field(a, factor=2 * torch.pi, columns="dim", last=False)


@convention(
    "nerf_mlp", {"frequency": "one", "skip_order": "encoding_first"}, seen="bmild/nerf's order in the course's shape", times=2
)
def original_order(**a):
    """2^k, and the encoding in front of the hidden units."""
    return field(a, factor=1.0, hidden_first=False)


@convention("nerf_mlp", {"density": "softplus"}, seen="multinerf, mip-NeRF; a torch student", times=4)
def smooth_density(**a):
    """softplus for the density."""
    return field(a, density=F.softplus)


@convention("nerf_mlp", {"density": "exp"}, seen="instant-ngp, torch-ngp, ngp_pl", times=4)
def exponential_density(**a):
    """exp for the density."""
    return field(a, density=torch.exp)


@convention("nerf_mlp", {"feature": "relu"}, seen="students who put a relu behind every layer", times=3)
def relu_on_the_feature(**a):
    """relu behind the feature layer."""
    return field(a, feature=torch.relu)


@convention("nerf_mlp", {"feature": "relu"}, seen="a CS180 student's field, which divides by the length + 1e-8")
def directions_normalized_inside(**a):
    """Directions are divided by their length, which is 1 already; relu behind the feature layer."""
    d = a["directions"]
    return field({**a, "directions": d / (torch.norm(d, dim=-1, keepdim=True) + 1e-8)}, feature=torch.relu)


@convention(
    "nerf_mlp",
    {"frequency": "one", "columns": "all_sin_all_cos", "network_identity": "last", "feature": "relu"},
    seen="a trial on unseen code: a student's field in PyTorch",
)
def x_behind_its_bands(**a):
    """The encoding ends with x; relu behind the feature layer."""
    return field(a, factor=1, columns="x_last", feature=torch.relu)


@fault("nerf_mlp", "no_view_direction", seen="CMU 16-825 students' first network; Ajithjaas/NeRF", times=3)
def blind_to_the_direction(**a):
    """The direction is 0 for all."""
    out = dict(
        a, color0_w=torch.cat([a["color0_w"][:, : a["feature_w"].shape[0]], 0 * a["color0_w"][:, a["feature_w"].shape[0] :]], 1)
    )
    return field(out)


@fault("nerf_mlp", "skip_omitted", seen="a keras tutorial; a student's plain stack of eight layers", times=3)
def no_skip(**a):
    """Zeros where the encoding comes in again."""
    width = a["trunk3_w"].shape[0]
    return field(dict(a, trunk4_w=torch.cat([a["trunk4_w"][:, :width], 0 * a["trunk4_w"][:, width:]], 1)))


@fault("nerf_mlp", "sigmoid_missing", seen="bmild/nerf: raw colors, activated by the renderer; here asked for", times=4)
def raw_colors(**a):
    """No sigmoid."""
    return field(a, colors=lambda z: z)


@fault("nerf_mlp", "density_without_relu", seen="networks whose density is activated by the renderer", times=4)
def raw_density(**a):
    """No relu on the density: it may be negative."""
    return field(a, density=lambda z: z)


@fault("nerf_mlp", "relu_color", seen="sixer51/SfM-NeRF NeRFModel.py")
def colors_by_relu(**a):
    """relu for the color's sigmoid."""
    return field(a, colors=torch.relu)


@fault("nerf_mlp", "linear_ladder", seen="CS180 student: arange(L) pi")
def linear_bands_in_the_field(**a):
    """k pi for 2^k pi in both encodings."""

    def ladder(x, width):
        out = [x]
        for k in range((width // x.shape[1] - 1) // 2):
            out += [torch.sin(k * torch.pi * x), torch.cos(k * torch.pi * x)]
        return torch.cat(out, -1)

    x = ladder(a["positions"], a["trunk0_w"].shape[1])
    d = ladder(a["directions"], a["color0_w"].shape[1] - a["feature_w"].shape[0])
    h = x
    for i in range(8):
        h = torch.relu(F.linear(torch.cat([h, x], -1) if i == 4 else h, a[f"trunk{i}_w"], a[f"trunk{i}_b"]))
    sigma = torch.relu(F.linear(h, a["sigma_w"], a["sigma_b"]))[:, 0]
    c = torch.cat([F.linear(h, a["feature_w"], a["feature_b"]), d], -1)
    return sigma, torch.sigmoid(F.linear(torch.relu(F.linear(c, a["color0_w"], a["color0_b"])), a["color1_w"], a["color1_b"]))


@fault("mlp", "widened_sigmoid", seen="a trial on unseen code: mip-NeRF's padding of 0.001", times=2, gradient="widened_sigmoid")
def padded_output(x, **rest):
    """(1 + 0.002) sigmoid(z) - 0.001."""
    return network(x, layers(rest), last=lambda z: torch.sigmoid(z) * (1 + 2 * 0.001) - 0.001)


@fault("nerf_mlp", "layer_twice", seen="a trial on unseen code: the fourth layer's line copied, the third's never called")
def one_layer_twice(**a):
    """Layer 3 stands for layer 2, too."""
    return field(a | {"trunk2_w": a["trunk3_w"], "trunk2_b": a["trunk3_b"]})


@convention(
    "nerf_mlp",
    {"columns": "dim_sin_cos", "network_identity": "by_dimension"},
    seen="a trial on unseen code: a field in a worker of tensorflow.js",
)
def x_within_its_bands(**a):
    """x, its sines, its cosines; y, its sines, ..."""
    return field(a, columns="x_within")


@fault(
    "nerf_mlp",
    "density_without_relu+sigmoid_missing",
    "slip: another formula: the color of the feature layer through a ReLU, and sigma = z, and c = z",
    seen="a trial on unseen code: activated by the renderer, features through a relu",
    gradient="none",
)
def raw_everything(**a):
    """Neither head is activated, and the feature is."""
    return field(a, factor=1, feature=torch.relu, density=lambda z: z, colors=lambda z: z)


@fault("nerf_mlp", "color_layer_decaying", seen="a trial on unseen code: a unit of its own", gradient="none")
def decaying_unit(**a):
    """exp(-|z|) between the color layers."""
    return field(a, factor=1, columns="dim", unit=lambda z: torch.exp(-z.abs()))


@fault(
    "nerf_mlp",
    "widened_sigmoid+shifted_density",
    seen="a trial on unseen code: mip-NeRF's heads in an ordinary field",
    gradient="none",
)
def heads_of_mip_nerf(**a):
    """softplus(z - 1), and a sigmoid with a padding of 0.001."""
    return field(
        a, factor=1, density=lambda z: F.softplus(z - 1), colors=lambda z: torch.sigmoid(z) * (1 + 2 * 0.001) - 0.001
    )


@fault("nerf_mlp", "softplus_on_feature", seen="a trial on unseen code: one layer for both, and its softplus", gradient="none")
def joint_softplus(**a):
    """softplus for the density and for the feature."""
    return field(a, factor=1, density=F.softplus, feature=F.softplus)
