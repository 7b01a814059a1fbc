"""Fixture files: cases, their inputs, the npz and the JSON beside it (fixtures/README.md has the format)."""

import ast
import hashlib
import io
import json
import os
import platform
import zipfile
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from zlib import crc32

import numpy as np

import philox

SCHEMA = "nerf-oracle/fixture/1"
SEED = 180
TOOLS = Path(__file__).resolve().parent.parent
SHARED = {"fixture", "bases", "reals"}


@dataclass
class Case:
    """One set of inputs. `vjp` adds a case `<name>-vjp` with cotangents drawn in [-1, 1), or `cotangents` where given.

    `outputs` names the outputs to store (all when empty); `quirks` what a basis does otherwise on purpose, with its numbers.
    """

    name: str
    inputs: dict
    comment: str = ""
    flags: list = field(default_factory=list)
    conventions: dict = field(default_factory=dict)
    vjp: bool = True
    cotangents: dict = field(default_factory=dict)
    outputs: tuple = ()
    quirks: dict = field(default_factory=dict)


@dataclass
class Fixture:
    """What one npz and its JSON hold."""

    component: str
    basis: str
    key: list
    arrays: dict = field(default_factory=dict)
    cases: list = field(default_factory=list)
    known_differences: list = field(default_factory=list)

    def add(self, name, kind, case, arrays, **more):
        """Appends one case under `name`; `arrays` maps 'in.x' and 'out.y' to values."""
        assert name not in [c["name"] for c in self.cases], f"two cases named {name}"
        entry = {"name": name, "kind": kind, "flags": case.flags, "comment": case.comment}
        if case.conventions:
            entry["conventions"] = case.conventions
        if case.quirks:
            entry["quirks"] = case.quirks
        self.cases.append(entry | more)
        for key, value in arrays.items():
            self.arrays[f"{name}.{key}"] = np.asarray(value, dtype="<f8", order="C")


class Draw:
    """Numbers for one case: each call reads the next ray of the stream (SEED, purpose, step = crc32 of the case's name)."""

    def __init__(self, purpose, name):
        self.purpose, self.step, self.ray = purpose, crc32(name.encode()), 0

    def uniform(self, shape, low=0.0, high=1.0):
        """low + (high - low) u, in f64."""
        count = int(np.prod(shape, dtype=int))
        u = philox.uniform(SEED, self.purpose, self.step, self.ray, count)
        self.ray += 1
        return (low + (high - low) * u).reshape(shape)


def hash_of(component):
    """sha256 over the component's script and all modules behind it: any edit asks for a new run."""
    digest = hashlib.sha256((TOOLS / "philox.py").read_bytes())
    for name in sorted(modules_behind({component} | SHARED)):
        digest.update((TOOLS / f"golden/{name}.py").read_bytes())
    return digest.hexdigest()


def modules_behind(names):
    """Modules of this package that the named ones import, and they themselves."""
    found = set(names)
    for name in names:
        for node in ast.walk(ast.parse((TOOLS / f"golden/{name}.py").read_text())):
            if isinstance(node, ast.ImportFrom) and node.level == 1:
                found |= {node.module} if node.module else {alias.name for alias in node.names}
    return found if found == set(names) else modules_behind(found)


def archive(arrays):
    """The bytes of an npz with fixed dates and order, so that equal arrays give equal files."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as z:
        for name, array in arrays.items():
            entry = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            body = io.BytesIO()
            np.lib.format.write_array(body, array, version=(1, 0))
            z.writestr(entry, body.getvalue())
    return out.getvalue()


def write(fixture, folder, packages):
    """Writes `<basis>.npz` and `<basis>.json` aside, then renames them into place."""
    target = folder / fixture.component
    target.mkdir(parents=True, exist_ok=True)
    body = archive(fixture.arrays)
    note = {
        "schema": SCHEMA,
        "component": fixture.component,
        "basis": fixture.basis,
        "generator": {
            "script": f"tools/golden/{fixture.component}.py",
            "sha256": hash_of(fixture.component),
            "arguments": ["--only", fixture.component],
            "key": fixture.key,
        },
        "versions": {"python": platform.python_version()} | {name: version(name) for name in packages},
        "npz": {"file": f"{fixture.basis}.npz", "bytes": len(body), "sha256": hashlib.sha256(body).hexdigest()},
        "cases": fixture.cases,
        "known_differences": fixture.known_differences,
    }
    replace(target / f"{fixture.basis}.npz", body)
    replace(target / f"{fixture.basis}.json", (json.dumps(note, indent=1, ensure_ascii=False) + "\n").encode())


def replace(path, body):
    """Writes a file whole or not at all."""
    aside = path.with_name(f".{path.name}.{os.getpid()}")
    aside.write_bytes(body)
    aside.replace(path)
