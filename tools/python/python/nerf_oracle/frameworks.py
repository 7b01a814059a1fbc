"""The frameworks that functions are written in: how arrays get there, and gradients come back."""

from __future__ import annotations

import contextlib
import importlib
import inspect
import sys
from typing import Any, Callable

import numpy as np

NAMES = ("numpy", "torch", "jax", "cupy")
FLOATS = {"f64": "float64", "f32": "float32", "f16": "float16"}


class Undifferentiable(Exception):
    """Why there is no gradient."""


class Framework:
    """numpy, and what the others share."""

    name, short = "numpy", "float32"
    # Whether arrays may have gaps between their elements.
    gaps = True

    def __init__(self, dtype: str, device: str | None) -> None:
        self.dtype, self.device = dtype, device
        self.module = importlib.import_module("jax.numpy" if self.name == "jax" else self.name)

    def array(self, x: np.ndarray, stored: str) -> Any:
        """An array of f64 in the type that a case stores it in."""
        return x.astype({"i64": "int64", "u8": "uint8"}.get(stored) or FLOATS[stored])

    def with_gaps(self, x: Any) -> Any:
        """The same array as every other element of a longer one."""
        wide = self.zeros((*x.shape[:-1], 2 * x.shape[-1]), x)
        wide[..., ::2] = x
        return wide[..., ::2]

    def zeros(self, shape: tuple[int, ...], like: Any) -> Any:
        """Zeros beside another array."""
        return self.module.zeros(shape, dtype=like.dtype)

    def stacked(self, items: list[Any]) -> Any:
        """Arrays or numbers as one array."""
        return self.module.stack([self.module.asarray(x) for x in items])

    def around(self) -> Any:
        """What calls must run in."""
        return contextlib.nullcontext()

    def gradient(
        self,
        call: Callable[[dict[str, Any]], dict[str, Any]],
        leaves: dict[str, Any],
        cotangents: dict[str, np.ndarray],
        strided: bool = False,
    ) -> Any:
        """The gradients of `call` with respect to `leaves`, and the outputs that it returns. Without `cotangents`: of the sum of
        what it returns. `strided`: from cotangents with gaps."""
        raise Undifferentiable(f"{self.name} has no gradients")

    def short_or(self, stored: str) -> str:
        """The name of a type of floats: in bf16 it is what this framework has for it."""
        return self.short if self.dtype == "bf16" and stored == "f32" else FLOATS[stored]


class Torch(Framework):
    """PyTorch: gradients by autograd."""

    name, short = "torch", "bfloat16"

    def array(self, x, stored):
        """A tensor on the device, in memory of torch's own: what autograd keeps of an error is freed behind the interpreter's end, where
        numpy's memory can't be, and the program never ends."""
        if stored in ("i64", "u8"):
            return self.module.from_numpy(Framework.array(self, x, stored)).to(self.device, copy=True)
        return self.module.from_numpy(np.array(x)).to(self.device, getattr(self.module, self.short_or(stored)), copy=True)

    def zeros(self, shape, like):
        """Zeros beside another tensor."""
        return like.new_zeros(shape)

    def stacked(self, items):
        """Tensors as one, their gradients kept."""
        return self.module.stack([self.module.as_tensor(x) for x in items])

    def gradient(self, call, leaves, cotangents, strided=False):
        """By torch.autograd.grad. A result that depends on nothing, as that of a ray without samples, has a gradient of 0."""
        torch = self.module
        leaves = {name: x.requires_grad_() for name, x in leaves.items()}
        outputs = call(leaves)
        asked = cotangents or outputs
        smooth = {n: x for n, x in outputs.items() if n in asked and isinstance(x, torch.Tensor) and x.requires_grad}
        if not smooth:
            return None, list(outputs)
        cotangents = cotangents or {n: np.ones(x.shape) for n, x in smooth.items()}
        given = [torch.from_numpy(np.array(cotangents[n])).to(x, copy=True).reshape(x.shape) for n, x in smooth.items()]
        given = [self.with_gaps(g) if strided and g.ndim else g for g in given]
        found = torch.autograd.grad(list(smooth.values()), list(leaves.values()), given, allow_unused=True)
        return {n: torch.zeros_like(x) if g is None else g for (n, x), g in zip(leaves.items(), found)}, list(outputs)


class Jax(Framework):
    """JAX: gradients by jax.vjp."""

    name, short = "jax", "bfloat16"
    gaps = False

    def array(self, x, stored):
        """An array on the default device, or the one that was asked for."""
        if stored in ("i64", "u8"):
            return self.module.asarray(Framework.array(self, x, stored))
        array = self.module.asarray(x, dtype=getattr(self.module, self.short_or(stored)))
        jax = importlib.import_module("jax")
        return array if self.device is None else jax.device_put(array, jax.devices(self.device)[0])

    def around(self):
        """f64 must be switched on."""
        if self.dtype != "f64":
            return contextlib.nullcontext()
        jax = importlib.import_module("jax")
        return jax.enable_x64(True) if hasattr(jax, "enable_x64") else importlib.import_module("jax.experimental").enable_x64()

    def gradient(self, call, leaves, cotangents, strided=False):
        """By jax.vjp, of the outputs of floats."""
        jax, jnp = importlib.import_module("jax"), self.module
        returned: list[str] = []

        def smooth(leaves):
            outputs = call(leaves)
            returned[:] = outputs
            arrays = {name: jnp.asarray(x) for name, x in outputs.items() if not cotangents or name in cotangents}
            return {name: x for name, x in arrays.items() if jnp.issubdtype(x.dtype, jnp.floating)}

        outputs, pull = jax.vjp(smooth, leaves)
        if not outputs:
            return None, returned
        ones = {name: np.ones(x.shape) for name, x in outputs.items()}
        given = {n: jnp.asarray((cotangents or ones)[n], dtype=x.dtype).reshape(x.shape) for n, x in outputs.items()}
        return pull(given)[0], returned


class Cupy(Framework):
    """CuPy: no gradients."""

    name = "cupy"

    def array(self, x, stored):
        """An array on the current device."""
        return self.module.asarray(Framework.array(self, x, stored))


KINDS = {kind.name: kind for kind in (Framework, Torch, Jax, Cupy)}


def framework(name: str, dtype: str, device: str | None) -> Framework:
    """A framework for a type, on a device."""
    return KINDS[name](dtype, device)


def likely(function: Callable[..., Any]) -> list[str]:
    """The frameworks that a function may be written in, the likeliest first: by what it is, its annotations, and what its code
    and the code of the functions beside it name. Those that only its file imports come behind."""
    found: list[str] = [
        name
        for name in ("torch", "jax")
        if name in sys.modules and type(function).__module__.partition(".")[0] in (name, "jaxlib")
    ]
    torch = sys.modules.get("torch")
    if torch is not None and isinstance(function, torch.nn.Module):
        found.append("torch")
    code = code_of(function)
    if code is not None:
        found += [of(note) for note in getattr(code, "__annotations__", {}).values()]
        found += named(code, set())
        imported = {of(x) for x in code.__globals__.values() if inspect.ismodule(x)}
        # Of a function that names none, those with gradients first.
        found += [name for name in ("torch", "jax", "numpy") if name in imported]
    found += [name for name in NAMES if name == "numpy" or name in sys.modules]
    return list(dict.fromkeys(name for name in found if name in NAMES))


def code_of(function: Callable[..., Any]) -> Any:
    """The Python function behind a callable."""
    function = inspect.unwrap(getattr(function, "func", function))
    if hasattr(function, "__globals__"):
        return function
    method = getattr(function, "forward", None) or type(function).__call__
    method = getattr(method, "__func__", method)
    return method if hasattr(method, "__globals__") else None


def of(x: Any) -> str:
    """The framework that something comes from, or that an annotation names."""
    module = x.__name__ if inspect.ismodule(x) else getattr(x, "__module__", None) or ""
    top = (x if isinstance(x, str) else str(module)).lstrip("_").partition(".")[0]
    return {"np": "numpy", "jnp": "jax", "jaxlib": "jax", "cp": "cupy", "Tensor": "torch", "ndarray": "numpy"}.get(top, top)


def named(function: Any, seen: set[int]) -> list[str]:
    """The frameworks of the globals and closures that a function's code names, and of the functions among them."""
    if id(function) in seen or len(seen) > 200:
        return []
    seen.add(id(function))
    codes, names = [function.__code__], set()
    while codes:
        code = codes.pop()
        names |= set(code.co_names)
        codes += [const for const in code.co_consts if inspect.iscode(const)]
    values = [function.__globals__[name] for name in sorted(names) if name in function.__globals__]
    for cell in function.__closure__ or ():
        with contextlib.suppress(ValueError):
            values.append(cell.cell_contents)
    found = [of(x) for x in values]
    for x in values:
        inner = code_of(x) if callable(x) and of(x) not in NAMES else None
        if inner is not None:
            found += named(inner, seen)
    return sorted((name for name in found if name in NAMES), key=lambda name: name == "numpy")
