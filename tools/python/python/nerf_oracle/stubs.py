"""Type stubs of `oracle` and `bound`, written from the registry: `python -m nerf_oracle.stubs`. A test fails where they are
stale."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .rows import DTYPES, registry, rows
from .truth import class_name, documented

HEAD = '''"""Written by `python -m nerf_oracle.stubs`."""

from typing import Any, Literal, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import NDArray

# Arrays of numpy, torch, jax, cupy; lists; numbers.
Array = Any
Profile = Optional[Literal[{profiles}]]
Dtype = Literal[{dtypes}]
Float = NDArray[np.float64]
'''


def stub(settings: str, says: str) -> str:
    """The stub of a module whose functions are the rows."""
    profiles = ", ".join(f'"{profile["name"]}"' for profile in registry()["profiles"])
    dtypes = ", ".join(f'"{dtype}"' for dtype in DTYPES)
    parts = [HEAD.format(profiles=profiles, dtypes=dtypes)]
    parts += [of_row(row, settings, says) for row in rows().values() if not row["statistics"]]
    return "\n".join(parts)


def of_row(row: dict[str, Any], settings: str, says: str) -> str:
    """The classes of a row and its name."""
    name = class_name(row["name"], "forward")
    parts = [returns(row, "forward"), returns(row, "vjp") if row["vjp"] else "", f"class _{name}:"]
    parts.append(method("__call__", row, "forward", settings, says))
    if row["vjp"]:
        parts.append(method("vjp", row, "vjp", settings, says))
    return "\n".join(part for part in [*parts, "", f"{row['name']}: _{name}", ""] if part is not None)


def returns(row: dict[str, Any], direction: str) -> str:
    """The named tuple of several outputs."""
    fields = outputs(row, direction)
    if fields is None or len(fields) == 1:
        return ""
    lines = [f"    {name}: {kind}" for name, kind in fields.items()]
    return "\n".join([f"class {class_name(row['name'], direction)}(NamedTuple):", *lines, ""])


def outputs(row: dict[str, Any], direction: str) -> dict[str, str] | None:
    """Outputs and their types; None where their names are numbered."""
    if direction == "vjp" and any(port["name"].endswith("*") for port in row["inputs"]):
        return None
    ports = row["outputs"] if direction == "forward" else [port for port in row["inputs"] if port["gradient"]]
    prefix = "" if direction == "forward" else "grad_"
    kinds = {"": "float", "...": "Union[float, Float]"}
    return {prefix + port["name"]: kinds.get(port["shape"], "Float") for port in ports}


def method(name: str, row: dict[str, Any], direction: str, settings: str, says: str) -> str:
    """A method with its docstring."""
    named = [port["name"] for port in row["inputs"] if not port["name"].endswith("*")]
    layers = ", **layers: Array" if len(named) < len(row["inputs"]) else ""
    arrays = ", ".join(f"{port}: Array" for port in named)
    cotangents = (
        [f"grad_{port['name']}: Optional[Array] = None" for port in row["outputs"] if port["gradient"]]
        if direction == "vjp"
        else []
    )
    keywords = ", ".join([*cotangents, "profile: Profile = None"]) + settings + layers
    fields = outputs(row, direction)
    result = (
        "dict[str, Float]"
        if fields is None
        else next(iter(fields.values()))
        if len(fields) == 1
        else class_name(row["name"], direction)
    )
    lines = documented(row, direction, says).splitlines()
    doc = "\n".join(f"        {line}".rstrip() for line in lines).lstrip()
    return f'    def {name}(self, {arrays}, *, {keywords}) -> {result}:\n        """{doc}\n        """'


MODULES = {"oracle": ("", "The reference"), "bound": (", dtype: Dtype = 'f32', stable: bool = False", "The error bound")}


def main() -> None:
    """Writes both."""
    for module, (settings, says) in MODULES.items():
        (Path(__file__).parent / f"{module}.pyi").write_text(stub(settings, says), encoding="utf-8")


if __name__ == "__main__":
    main()
