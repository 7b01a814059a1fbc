"""packed_scan(x, offsets): exclusive and inclusive running sums and products that begin anew with each ray."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "packed_scan", 1234
DIFFERENTIABLE = ("x",)


def cases():
    """Rays of every length, thin and thick ones, factors of 0 and the row VR4."""
    for name, lengths in {"ragged": [5, 3, 1, 8], "first-empty": [0, 0, 4], "middle-empty": [3, 0, 0, 2], "last-empty": [4, 0]}.items():
        yield case(name, Draw(PURPOSE, name).uniform((sum(lengths),), 0.0, 1.5), lengths, "PK1")
    yield case("signed", Draw(PURPOSE, "signed").uniform((24,), -2.0, 2.0), [12, 12], "sums that cancel")
    yield case("thin", Draw(PURPOSE, "thin").uniform((64,), 0.999, 1.0), [40, 24], "what thin samples let through")
    yield case("opaque-VR4", np.array([0.5, 0.0, 0.7, 0.8, 0.0, 0.3, 0.2, 0.0, 0.6]), [4, 5], "factors of 0")


def case(name, x, lengths, comment):
    """A case from its numbers and the rays' lengths."""
    return Case(name, {"x": x, "offsets": np.concatenate([[0.0], np.cumsum(lengths)])}, comment)


def rays(x):
    """The part of each ray."""
    offsets = [int(float(o.value if hasattr(o, "value") else o)) for o in x["offsets"]]
    return [x["x"][a:b] for a, b in zip(offsets, offsets[1:])]


def over_reals(x):
    """The definition, sample by sample."""
    out = {name: [] for name in ("exclusive_sum", "inclusive_sum", "exclusive_product", "inclusive_product")}
    for ray in rays(x):
        for i in range(len(ray)):
            for name, n in (("exclusive", i), ("inclusive", i + 1)):
                out[f"{name}_sum"].append(reals.real(1) * reals.total(ray[:n]))
                product = reals.Real(1)
                for factor in ray[:n]:
                    product = product * factor
                out[f"{name}_product"].append(product)
    return {name: np.array(numbers, dtype=object) for name, numbers in out.items()}


def in_torch(x):
    """cumsum and cumprod of each ray, shifted by one where they are exclusive."""
    out = {name: [] for name in ("exclusive_sum", "inclusive_sum", "exclusive_product", "inclusive_product")}
    for ray in rays(x):
        for name, scan, first in (("sum", torch.cumsum, 0.0), ("product", torch.cumprod, 1.0)):
            shifted = torch.cat([torch.full_like(ray[:1], first), ray[:-1]])
            out[f"exclusive_{name}"].append(scan(shifted, 0))
            out[f"inclusive_{name}"].append(scan(ray, 0))
    return {name: torch.cat(parts) for name, parts in out.items()}
