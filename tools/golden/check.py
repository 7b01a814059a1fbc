"""Compares what comes out now with the committed files."""

import hashlib
import io
import json

import numpy as np

from .fixture import SCHEMA, hash_of
from .registry import COMPONENTS, PACKAGES


def differs(fixture, folder):
    """What is wrong with the committed npz or JSON of a fixture, or None."""
    stem = folder / fixture.component / fixture.basis
    again = f"make it again with: python tools/golden.py --only {fixture.component}"
    try:
        note = json.loads(stem.with_suffix(".json").read_text())
        body = stem.with_suffix(".npz").read_bytes()
    except (OSError, ValueError) as problem:
        return f"{problem}; {again}"
    if note.get("schema") != SCHEMA:
        return f"{stem}.json: schema {note.get('schema')!r}, expected {SCHEMA!r}; {again}"
    if note["npz"]["sha256"] != hashlib.sha256(body).hexdigest():
        return f"{stem}.npz: its sha256 is not the one in {stem.name}.json; {again}"
    if note["generator"]["sha256"] != hash_of(fixture.component):
        return f"{stem}.json: the generator has changed since; {again}"
    committed = dict(np.load(io.BytesIO(body)))
    if list(committed) != list(fixture.arrays):
        return f"{stem}.npz: other arrays than come out now; {again}"
    for name, now in fixture.arrays.items():
        limit = allowed(note, name)
        if not agrees(committed[name], now, limit):
            return f"{stem}.npz: {name} does not come out within {limit}; {again}"
    return None


# torch and kornia round differently on every processor: which vector instructions there are, and how a matrix product is cut,
# decides in which order a sum is taken. Fixtures of one processor came out up to 4.9 times (error + 1 ulp) apart on others'
# instruction sets; what a wrong formula does is millions of ulps away.
PROCESSORS = 16.0


def allowed(note, name):
    """How far an array may be off: nothing for inputs and mpmath, else the recorded error and one ulp, for any processor."""
    case, _, rest = name.partition(".out.")
    entry = next((c for c in note["cases"] if c["name"] == case), {})
    recorded = entry.get("outputs", {}).get(rest)
    return PROCESSORS * (recorded["ulp"] + 1.0) * recorded["unit"] if recorded else 0.0


def agrees(committed, now, limit):
    """Equal bits where the limit is 0, else every element within it."""
    if committed.shape != now.shape:
        return False
    if limit == 0.0:
        return committed.tobytes() == now.tobytes()
    with np.errstate(invalid="ignore"):
        return bool(np.all((committed == now) | (np.abs(committed - now) <= limit)))


def strangers(folder):
    """Files in the folder that no generator makes: counted and named."""
    found = [path for path in sorted(folder.glob("*/*")) if path.parent.name not in COMPONENTS or path.stem not in PACKAGES]
    for path in found:
        print(f"{path}: no generator makes this file; remove it")
    return len(found)
