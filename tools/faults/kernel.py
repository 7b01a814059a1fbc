"""A right kernel of a row: the oracle's answer, rounded to the type that it is computed in. Faults are planted around it."""

import nerf_oracle as no
import numpy as np
from nerf_oracle.rows import rows

# Fraction bits that are dropped from the 23 of f32.
DROPPED = {"tf32": 13, "bf16": 16}


def rounded(x, dtype):
    """Numbers to the nearest of a type, ties to even; whole numbers and scalars stay."""
    x = np.asarray(x)
    if x.dtype.kind not in "f" or dtype == "f64":
        return x
    if dtype in DROPPED:
        single = np.ascontiguousarray(x, np.float32)
        bits, drop = single.view(np.uint32).astype(np.uint64), DROPPED[dtype]
        bits += (1 << (drop - 1)) - 1 + ((bits >> drop) & 1)
        short = (bits >> drop << drop).astype(np.uint32).view(np.float32)
        return np.where(np.isfinite(single), short, single).astype(x.dtype)
    with np.errstate(over="ignore"):
        return x.astype({"f32": np.float32, "f16": np.float16}[dtype]).astype(x.dtype)


def wide(arrays):
    """Arrays in f64; scalars as they come."""
    return {name: x.astype(np.float64) if isinstance(x, np.ndarray) and x.dtype.kind == "f" else x for name, x in arrays.items()}


class Kernel:
    """A row and direction in a type: called with the arrays of the contract, it answers all outputs by name."""

    def __init__(self, row, kind, dtype):
        self.row, self.kind, self.dtype = row, kind, dtype
        oracle = getattr(no.oracle, row)
        self.oracle = oracle.vjp if kind == "vjp" else oracle
        ports = rows()[row]["outputs"]
        self.only = None if kind == "vjp" or len(ports) > 1 else ports[0]["name"]
        self.whole = {port["name"] for port in ports if port["whole"]}

    def exact(self, arrays):
        """The outputs in f64, by name."""
        out = self.oracle(**wide(arrays))
        out = {self.only: out} if self.only else dict(out._asdict()) if hasattr(out, "_asdict") else dict(out)
        return {name: np.array(x, np.float64) for name, x in out.items()}

    def stored(self, out):
        """The outputs as this type keeps them."""
        kept = np.float64 if self.dtype == "f64" else np.float16 if self.dtype == "f16" else np.float32
        with np.errstate(over="ignore"):
            return {name: rounded(x, self.dtype).astype(kept) for name, x in out.items()}

    def __call__(self, **arrays):
        """The kernel's answer."""
        return self.stored(self.exact(arrays))


def arrays_of(arrays):
    """The names of those inputs that are arrays of real numbers."""
    return [name for name, x in arrays.items() if isinstance(x, np.ndarray) and x.ndim and x.dtype.kind == "f"]
