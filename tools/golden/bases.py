"""One component's cases, carried through each basis: mpmath at 50 digits, torch on the CPU in f64, kornia."""

from fnmatch import fnmatch

import numpy as np
import torch

from . import reals
from .fixture import SEED, Draw, Fixture


def marked(names, patterns):
    """Those names that have a gradient."""
    return [name for name in names if any(fnmatch(name, pattern) for pattern in patterns)]


def cotangents_of(case, outputs, purpose):
    """Random cotangents in [-1, 1) for every output, or the ones that the case states."""
    draw = Draw(purpose, f"{case.name}-vjp")
    return {name: case.cotangents.get(name, draw.uniform(y.shape, -1.0, 1.0)) for name, y in outputs.items()}


def select(case, outputs):
    """The outputs that a case stores."""
    return {name: y for name, y in outputs.items() if not case.outputs or name in case.outputs}


def settings(case):
    """What a component sees beside its arrays."""
    return {"conventions": case.conventions, "quirks": case.quirks}


def in_reals(component, cases, patterns):
    """The definition over the reals: every output as hi + lo, with its largest term where that isn't its own value."""
    fixture = Fixture(component.NAME, "mpmath", [SEED, component.PURPOSE])
    for case in cases:
        lifted = {name: reals.lift(value) for name, value in case.inputs.items()}
        outputs = select(case, component.over_reals(lifted | settings(case)))
        fixture.add(case.name, "forward", case, inputs_of(case.inputs) | exact_outputs(outputs))
        wanted = {name: lifted[name] for name in marked(lifted, patterns)}
        if case.vjp and wanted:
            given = cotangents_of(case, outputs, component.PURPOSE)
            found = {f"grad_{name}": g for name, g in reals.vjp(outputs, given, wanted).items()}
            extra = {f"grad_{name}": value for name, value in given.items()}
            fixture.add(f"{case.name}-vjp", "vjp", case, inputs_of(case.inputs | extra) | exact_outputs(found))
    return fixture


def in_tensors(component, basis, run, cases, patterns):
    """The same cases as tensors in f64 with autograd: `run` takes and gives dictionaries of them."""
    fixture = Fixture(component.NAME, basis, [SEED, component.PURPOSE])
    for case in cases:
        tensors = {name: torch.tensor(np.asarray(value, dtype=np.float64)) for name, value in case.inputs.items()}
        wanted = {name: tensors[name].requires_grad_() for name in marked(tensors, patterns) if case.vjp}
        outputs = select(case, run(tensors | settings(case)))
        stored = {f"out.{name}": y.detach().numpy() for name, y in outputs.items()}
        fixture.add(case.name, "forward", case, inputs_of(case.inputs) | stored)
        if wanted:
            given = cotangents_of(case, outputs, component.PURPOSE)
            objective = sum((torch.tensor(given[name]) * y).sum() for name, y in outputs.items())
            found = torch.autograd.grad(objective, list(wanted.values()), materialize_grads=True)
            stored = {f"out.grad_{name}": g.numpy() for name, g in zip(wanted, found)}
            extra = {f"grad_{name}": value for name, value in given.items()}
            fixture.add(f"{case.name}-vjp", "vjp", case, inputs_of(case.inputs | extra) | stored)
    return fixture


def inputs_of(inputs):
    """Inputs under their keys of the npz."""
    return {f"in.{name}": value for name, value in inputs.items()}


def exact_outputs(outputs):
    """Outputs as `out.y`, `out.y.lo` and, where some element is a sum with larger terms, `out.y.term`."""
    arrays = {}
    for name, array in outputs.items():
        hi, lo, term = reals.double_double(array)
        arrays |= {f"out.{name}": hi, f"out.{name}.lo": lo}
        if np.any(term > np.maximum(np.abs(hi), reals.LEAST_NORMAL)):
            arrays[f"out.{name}.term"] = term
    return arrays


def measure(fixture, truth):
    """Records the basis' own error for every output: `ulp` times `unit`, the ulp of the largest term in the tensor."""
    for entry in fixture.cases:
        outputs = {}
        for name in [key for key in fixture.arrays if key.startswith(f"{entry['name']}.out.")]:
            hi, lo = truth.arrays[name], truth.arrays[f"{name}.lo"]
            term = truth.arrays.get(f"{name}.term", np.abs(hi))
            unit = float(np.spacing(np.max(term[np.isfinite(term)], initial=0.0)))
            with np.errstate(invalid="ignore"):
                off = np.where(fixture.arrays[name] == hi, np.abs(lo), np.abs((fixture.arrays[name] - hi) - lo))
            outputs[name.split(".out.")[1]] = {"ulp": float(f"{np.max(off, initial=0.0) / unit:.3g}"), "unit": unit}
        entry["outputs"] = outputs
