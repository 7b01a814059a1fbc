"""Arrays of numpy, torch, jax and cupy, in and out."""

from __future__ import annotations

from typing import Any

import numpy as np

from .errors import CandidateError


def host(x: Any) -> np.ndarray:
    """Any array as numpy's, in its own type. numpy has no bfloat16: it goes out as float32, which holds it exactly."""
    if hasattr(x, "detach"):
        x = x.detach().cpu()
        x = (x.float() if str(x.dtype) == "torch.bfloat16" else x).resolve_conj().resolve_neg()
    elif hasattr(x, "__cuda_array_interface__") and hasattr(x, "get"):
        x = x.get()
    elif hasattr(x, "__dlpack__") and not hasattr(x, "__array__"):
        x = np.from_dlpack(x)
    x = np.asarray(x)
    return x.astype(np.float32) if str(x.dtype) == "bfloat16" else x


def f64(x: Any, name: str) -> np.ndarray:
    """Any array as f64, row-major: what crosses into the library."""
    try:
        x = host(x)
    except Exception as error:
        raise CandidateError(f"{name}: {type(x).__name__} is no array: {error}") from error
    if x.dtype.kind not in "fiub":
        raise CandidateError(
            f"{name}: an array of {x.dtype}, expected numbers. Lists must be of one length: numpy.stack makes an array."
        )
    return np.require(x, np.float64, "C")


def answered(x: Any, name: str) -> tuple[np.ndarray, str]:
    """An output in f64, and the type it came in, as the judge calls it."""
    kept = host(x)
    kinds = {"f2": "f16", "f4": "f32", "u1": "u8", "b1": "u8"}
    code = kept.dtype.kind + str(kept.dtype.itemsize)
    return f64(kept, name), kinds.get(code, "f64" if kept.dtype.kind == "f" else "i64")


def type_of(x: Any) -> str | None:
    """The judge's name for an array's type of floats; None for numbers, lists and whole numbers."""
    names = {"float64": "f64", "float32": "f32", "float16": "f16", "bfloat16": "bf16"}
    return names.get(str(getattr(x, "dtype", "")).rpartition(".")[2])
