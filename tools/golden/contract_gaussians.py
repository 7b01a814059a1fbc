"""contract_gaussians(means, covariances): f(mean) and J Sigma J^T, J the Jacobian of the contraction (mip-NeRF 360, section 3.1)."""

import numpy as np
import torch

from . import contraction, reals
from .fixture import Case, Draw
from .portable import power_of_ten, product

NAME, PURPOSE = "contract_gaussians", 1361
DIFFERENTIABLE = ("means", "covariances")
SCALES = {"two": 1.0, "one": 0.5, "unit": 0.25}


def cases():
    """Inside, outside, far away in each norm and in some ranges; the origin and the surface."""
    for norm, scale in [("l2", "two"), ("l2", "unit"), ("linf", "unit"), ("linf", "two"), ("merf", "two"), ("merf", "one")]:
        conventions = {"contraction_norm": norm, "contraction_range": scale}
        tag = f"{norm}-{scale}"
        yield case(f"inside-{tag}", Draw(PURPOSE, "inside").uniform((3, 3), -0.5, 0.5), 0.3, "stays", conventions)
        yield case(f"outside-{tag}", Draw(PURPOSE, "outside").uniform((5, 3), -9.0, 9.0), 1.0, "a few lengths out", conventions)
        far = Draw(PURPOSE, "far").uniform((4, 3), -1.0, 1.0) * power_of_ten(Draw(PURPOSE, "size").uniform((4, 1), 1.0, 12.0))
        yield case(f"far-{tag}", far, 30.0, "to 1e12", conventions)
    yield case("origin-CG6", np.array([[0.0, 0.0, 0.0], [-0.0, 2.0**-60, 0.0]]), 0.3, "0 and beside", {})
    surface = np.array([[1.0, 0.0, 0.0], [0.0, -1.0 - 2.0**-12, 0.0], [0.0, 0.0, 1.0 - 2.0**-53]])
    yield case("surface-CG7", surface, 0.3, "r = 1 and beside", {})
    yield case("beside-an-axis", np.array([[1e-3, 40.0, -2e-3], [3e5, 1.0, 2.0]]), 1.0, "1 - u^2 is small", {})


def case(name, means, size, comment, conventions):
    """A case from its means; deviations around `size`."""
    half = Draw(PURPOSE, f"half-{len(means)}").uniform((len(means), 3, 3), -size, size)
    covariances = product(half, half.transpose(0, 2, 1))
    covariances = (covariances + covariances.transpose(0, 2, 1)) / 2
    return Case(name, {"means": means, "covariances": covariances}, comment, conventions=conventions)


def settings(x):
    """Norm and scale of a case."""
    return x["conventions"].get("contraction_norm", "l2"), SCALES[x["conventions"].get("contraction_range", "two")]


def jacobian(point, norm):
    """The definition of one point's, before it is scaled."""
    one, none = reals.real(1), reals.real(0)
    sizes = [contraction.magnitude(x) for x in point]
    k = max(range(3), key=lambda j: sizes[j].value)
    squares = reals.dot(point, point)
    inside = squares.value <= 1 if norm == "l2" else sizes[k].value <= 1
    if inside:
        return [[one if i == j else none for j in range(3)] for i in range(3)]
    r = reals.sqrt(squares) if norm == "l2" else sizes[k]
    u = [x / r for x in point]
    s, square = (2 - r.reciprocal()) / r, (r * r).reciprocal()
    bent = (1 - r.reciprocal()) * -2 / r
    if norm == "l2":
        across = [u[(i + 1) % 3] * u[(i + 1) % 3] + u[(i + 2) % 3] * u[(i + 2) % 3] for i in range(3)]
        return [[s * across[i] + u[i] * u[i] * square if i == j else bent * u[i] * u[j] for j in range(3)] for i in range(3)]
    own, beside = (s, bent) if norm == "linf" else (r.reciprocal(), -r.reciprocal())
    columns = [beside * u[i] * (1 if point[k].value > 0 else -1) for i in range(3)]
    columns[k] = square
    return [[columns[i] if j == k else own if i == j else none for j in range(3)] for i in range(3)]


def over_reals(x):
    """The definition, one by one."""
    norm, scale = settings(x)
    covariances = []
    for point, sigma in zip(x["means"], x["covariances"]):
        j = [[y * scale for y in row] for row in jacobian(list(point), norm)]
        half = [[reals.dot(row, column) for column in sigma.T] for row in j]
        covariances.append([[reals.dot(a, b) for b in j] for a in half])
    means = contraction.over_reals({"x": x["means"], "conventions": x["conventions"]})["contracted"]
    return {"contracted_means": means, "contracted_covariances": np.array(covariances, dtype=object)}


def in_torch(x):
    """The points' own torch, and its Jacobian by automatic differentiation, which is differentiated again."""
    points = x["means"] if x["means"].requires_grad else x["means"].clone().requires_grad_()
    y = contraction.in_torch({"x": points, "conventions": x["conventions"]})["contracted"]
    rows = [torch.autograd.grad(y[:, i].sum(), points, create_graph=True)[0] for i in range(3)]
    j = torch.stack(rows, 1)
    return {"contracted_means": y, "contracted_covariances": j @ x["covariances"] @ j.transpose(1, 2)}
