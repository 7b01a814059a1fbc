"""How far an honest implementation may be off on these inputs, element by element: `bound.volume_render(sigmas, rgbs, deltas,
dtype="bf16")`.

`dtype` is what it computes in: "f64", "f32", "tf32", "bf16", "f16". Hand over the inputs that it gets, rounded to the type
already. `stable=True` is the bound of the more accurate formula (-expm1(-x) for 1 - exp(-x)), where there is one.
"""

from . import _core
from .truth import resolver

__getattr__, __dir__ = resolver(_core.bound, {"dtype": "f32", "stable": False}, "The error bound")
