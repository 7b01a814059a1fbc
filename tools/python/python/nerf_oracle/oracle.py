"""The f64 reference: `oracle.volume_render(sigmas, rgbs, deltas)`, its gradient `oracle.volume_render.vjp(...)`; `dir(oracle)`
has all.

Arrays of numpy, torch, jax and cupy go in, numpy's of f64 come out: one output as it is, several as a named tuple.
"""

from . import _core
from .truth import resolver

__getattr__, __dir__ = resolver(_core.oracle, {}, "The reference")
