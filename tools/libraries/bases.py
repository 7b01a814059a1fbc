"""What stands beside the fixtures that our own definition didn't write: libraries, in f64, in our conventions.

A function takes a case's inputs by name and returns outputs by name; its gradient is autograd's. `setting` says what turns the
library's convention into ours; `only` leaves out cases that the library has another convention for, or another derivative.
Farther than `within` it isn't the same function: 32 ULP, but for forms that lose digits by themselves (../README.md: which).
"""

import json
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
import torch

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
BASES = []
# Components in a row: each of their parts has its own line.
COMPOSED = ("render_trace", "training_step", "loss_gradient", "loss_curve")


@dataclass(frozen=True)
class Basis:
    """One library's view of one component."""

    component: str
    package: str
    call: str
    function: object
    setting: str
    only: object
    arrays: str
    within: float

    @property
    def title(self):
        """The library, its version and what is called."""
        return f"{self.package} {version(self.package)}: {self.call}"


def beside(component, package, call, setting="", only=lambda case, x: True, arrays="torch", within=32):
    """A decorator that makes a function a basis."""

    def keep(function):
        BASES.append(Basis(component, package, call, function, setting, only, arrays, within))
        return function

    return keep


@dataclass
class Distance:
    """Cases compared, of how many; the largest difference in ULP of the largest term in its array."""

    compared: int
    cases: int
    gradients: bool
    ulp: float


def distance(basis):
    """A basis against the definition at 50 digits."""
    note = json.loads((FIXTURES / basis.component / "mpmath.json").read_text(encoding="utf-8"))
    stored = np.load(FIXTURES / basis.component / "mpmath.npz")
    out = Distance(0, len(note["cases"]), False, 0.0)
    for case in note["cases"]:
        name = case["name"]
        inputs, truth = below(stored, f"{name}.in."), below(stored, f"{name}.out.")
        if not basis.only(case, inputs) or (case["kind"] == "vjp" and basis.arrays != "torch"):
            continue
        found = gradients(basis, inputs, truth) if case["kind"] == "vjp" else outputs(basis, inputs, truth)
        out.compared += 1
        out.gradients |= case["kind"] == "vjp"
        out.ulp = max([out.ulp, *(off(y, truth, key) for key, y in found.items())])
    if not out.compared or not out.ulp <= basis.within:
        raise SystemExit(f"{basis.component}, {basis.title}: {out}, within {basis.within} expected, and a case")
    return out


def below(stored, prefix):
    """The arrays whose names begin so, by the rest of their names."""
    return {key.removeprefix(prefix): stored[key] for key in stored.files if key.startswith(prefix)}


def number(x):
    """A scalar of a fixture, whole numbers as such."""
    return int(x) if x == np.floor(x) and abs(x) < 2**53 else float(x)


def outputs(basis, inputs, truth):
    """What the library says, of the outputs that a case stores."""
    lift = torch.from_numpy if basis.arrays == "torch" else np.asarray
    found = basis.function(**{name: lift(x) if x.ndim else number(x) for name, x in inputs.items()})
    found = {name: y.detach() if hasattr(y, "detach") else y for name, y in found.items() if name in truth}
    return {name: np.asarray(y, dtype=np.float64) for name, y in found.items()}


def gradients(basis, inputs, truth):
    """What its autograd says, through the outputs that it has."""
    given = {name[5:]: g for name, g in inputs.items() if name.startswith("grad_")}
    wanted = [key[5:] for key in truth if key.startswith("grad_") and not key.endswith((".lo", ".term"))]
    tensors = {name: torch.from_numpy(x) if x.ndim else number(x) for name, x in inputs.items() if not name.startswith("grad_")}
    leaves = [tensors[name].requires_grad_() for name in wanted]
    found = basis.function(**tensors)
    if any(np.any(g) for name, g in given.items() if name not in found):
        raise AssertionError(f"{basis.title}: a gradient through an output that it doesn't return")
    # What depends on nothing has a gradient of 0.
    nothing = sum((leaf * 0).sum() for leaf in leaves)
    objective = nothing + sum((torch.from_numpy(np.asarray(given[name])) * y).sum() for name, y in found.items() if name in given)
    slopes = torch.autograd.grad(objective, leaves)
    return {f"grad_{name}": g.numpy() for name, g in zip(wanted, slopes)}


def off(found, truth, key):
    """The largest difference of an array, in ULP of its largest term."""
    hi, lo = truth[key], truth.get(f"{key}.lo", np.zeros_like(truth[key]))
    term = truth.get(f"{key}.term", np.abs(hi))
    unit = np.spacing(np.max(term[np.isfinite(term)], initial=0.0))
    # Of a ray that misses t is anything.
    counts = truth["hit"] == 1 if key in ("t_near", "t_far") else np.ones_like(hi, dtype=bool)
    with np.errstate(invalid="ignore"):
        far = np.where(found == hi, np.abs(lo), np.abs((found - hi) - lo))
    assert found.shape == hi.shape and not np.any(np.isnan(far[counts])), f"{key}: {found.shape} or NaN, {hi.shape} expected"
    return float(np.max(far[counts], initial=0.0) / unit)


def plain(case, x):
    """Cases in the default conventions."""
    return not case.get("conventions")


def of_convention(**wanted):
    """Cases with these conventions, where they state them."""
    return lambda case, x: all(case.get("conventions", {}).get(key, value) == value for key, value in wanted.items())
