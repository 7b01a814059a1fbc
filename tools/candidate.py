"""Hand functions of your own to the judge.

    nerf-oracle cases --dtype f32 --out CASES
    python my_candidate.py
    nerf-oracle judge CASES ANSWERS

where my_candidate.py holds your function and one call:

>>> import numpy as np
>>> def composite(colors, opacity, background):
...     return colors + (1 - opacity[:, None]) * background
>>> run("CASES", "ANSWERS", composite_background=composite)            # doctest: +SKIP
{'composite_background/forward': 'answered', 'composite_background/vjp': 'unsupported: no function of torch tensors'}

A keyword is a component of the contract (`nerf-oracle list` prints them); the names of the function's parameters are the case's
input arrays, and what it doesn't name it isn't given; `**rest` takes all others. It returns an array, a tuple in the contract's
order (None for what it hasn't got), or a dict by output name.

Arrays come in the type under test: float64, float32 or float16; tf32 and bf16 as float32, but bfloat16 tensors where the function
is torch's. Scalars (`near`, `far`, `lr`, `L`) come as Python numbers. A function is torch's where the file that defines it
imports torch; `arrays="torch"` or `arrays="numpy"` says so instead.

A function may take less, or something else: `get_rays(height, width, focal, c2w)` assumes the center in the middle of the picture.
Cases that it can't be asked are left out, and the judge says so; `forms` in cases.json says what there is:

* image_rays, render_trace: without `cx` and `cy`; `K` in the place of `focal`, `cx`, `cy`;
* volume_render: `t` (R, N + 1) in the place of `deltas`, with an empty sample at the end for a last step of the function's own (of
  its weights the judge is handed N); `step`, one number, in the place of `deltas`;
* early_stop: without `eps`, where nothing stops at a threshold of the function's own, up to 0.05;
* ray_aabb: without `near` and `far`, where rays begin at 0 and end beyond the box.

Where the function crashes, that is the case's answer, and the others are judged.

Gradients: a torch function is differentiated by autograd, through the outputs that it returns. Where that can't be (numpy), nothing is
answered and the judge reports `unsupported`. A gradient of your own goes in as `volume_render_vjp=f`, which is handed the inputs
and `grad_<output>` (those of the outputs that the function returns), and returns `grad_<input>` in the contract's order.

`answers.json`, beside the answers, holds what the judge can't see in them: what a function takes, the outputs that its gradient goes
through, and where it crashed.
"""

import difflib
import inspect
import json
import math
import os
import sys
from pathlib import Path

import numpy as np


class CandidateError(Exception):
    """What doesn't fit: the case, the function, what was found, what was expected, what to do."""


class Crash(CandidateError):
    """What the function raised."""


class Unsupported(Exception):
    """A question that the function can't answer; the judge is told nothing."""


class OtherShape(Unsupported):
    """A result whose shape isn't that of its cotangent: in all cases it is another question, in some a fault of these."""


def run(cases, answers, *, arrays=None, device="cpu", **functions):
    """Answers the cases in folder `cases` that `functions` are for, below `answers`. Returns what became of each component.

    A function that crashes in every case is an error, once all others have answered. Answers of earlier runs are replaced for these components and left alone for all others.
    """
    cases, answers, manifest = Path(cases), Path(answers), read_manifest(Path(cases))
    known = {case["component"] for case in manifest["cases"]}
    for name in functions:
        if name.removesuffix("_vjp") not in known:
            raise CandidateError(f"{name}: no component of {cases / 'cases.json'}; {hint(name, sorted(known))}.")
    forward = {case["component"]: case for case in manifest["cases"] if case["kind"] != "vjp"}
    outcome, hopeless = {}, []
    for component, kind in dict.fromkeys((case["component"], case["kind"]) for case in manifest["cases"]):
        own = functions.get(f"{component}_vjp") if kind == "vjp" else None
        function = own or functions.get(component)
        if function is None:
            continue
        group = [case for case in manifest["cases"] if (case["component"], case["kind"]) == (component, kind)]
        style = arrays or ("torch" if uses_torch(function) else "numpy")
        by_autograd = kind == "vjp" and own is None
        row, what, results, odd = f"{component}/{kind}", Declared(), {}, {}
        try:
            what.takes = taken(function, group[0])
            what.returns = through(what.takes, group[0]) if own else None
            for case in group:
                if needed(case, what.takes):
                    what.left.append(case["id"])
                    continue
                # What the function returns: autograd's gradients come from the forward outputs.
                names = [port["name"] for port in (forward[component] if by_autograd else case)["outputs"]]
                inputs = inputs_of(cases, case, manifest["dtype"], style, device)
                try:
                    results[case["file"]] = (
                        differentiated(function, case, inputs, names, what) if by_autograd else called(function, case, inputs, names)
                    )
                except Crash as crash:
                    what.crashed.setdefault(case["id"], crash)
                except OtherShape as reason:
                    odd[case["id"]] = reason
            # One that fits by chance, as it is of one number, doesn't make the others faults.
            if odd and len(odd) >= len(results):
                raise next(iter(odd.values()))
            for name, reason in odd.items():
                what.crashed.setdefault(name, Crash(f"case {name}: {reason}"))
            if not results and what.crashed:
                hopeless += [] if by_autograd else list(what.crashed.values())[:1]
                outcome[row] = "crashed in every case"
            elif not results or (by_autograd and not what.differentiable):
                raise Unsupported("the result isn't differentiable" if results else "every case needs more than it takes")
            else:
                outcome[row] = "answered" + (f", but for {len(what.left)} cases that need more than it takes" if what.left else "")
        except Unsupported as reason:
            results, what = {}, None
            outcome[row] = f"unsupported: {reason}"
        for case in group:
            if case["file"] in results:
                write(answers / case["file"], results[case["file"]])
            else:
                (answers / case["file"]).unlink(missing_ok=True)
        declare(answers / "answers.json", row, what)
    if hopeless:
        raise hopeless[0]
    return outcome


def through(takes, case):
    """The outputs through which a gradient of one's own goes, where it takes not all of their cotangents."""
    asked = [port["name"] for port in case["inputs"] if port["name"].startswith("grad_")]
    named = [name.removeprefix("grad_") for name in asked if takes is None or name in takes]
    return named if 0 < len(named) < len(asked) else None


class Declared:
    """What the judge can't see in the answers to a row."""

    def __init__(self):
        self.takes, self.returns, self.crashed, self.left, self.differentiable = None, None, {}, [], False

    def json(self):
        """As answers.json has it."""
        out = {} if self.takes is None else {"takes": self.takes}
        out |= {} if self.returns is None else {"returns": self.returns}
        return out | ({"crashed": {name: str(what)[:1000] for name, what in self.crashed.items()}} if self.crashed else {})


def declare(path, row, what):
    """Writes a row of answers.json, or removes it where nothing was answered."""
    rows = json.loads(path.read_text(encoding="utf-8"))["rows"] if path.exists() else {}
    rows.pop(row, None)
    if what is not None and what.json():
        rows[row] = what.json()
    path.unlink(missing_ok=True)
    if rows:
        path.parent.mkdir(parents=True, exist_ok=True)
        text = json.dumps({"schema": "nerf-oracle/answers/1", "rows": rows}, indent=1)
        path.write_text(text + "\n", encoding="utf-8")


def taken(function, case):
    """The inputs that a function takes, in the contract's form or another; None: all of them."""
    try:
        parameters = inspect.signature(getattr(function, "forward", function)).parameters.values()
    except ValueError:
        return None
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        return None
    known = {port["name"] for port in case["inputs"]} | {form["takes"] for form in case["forms"]}
    return [p.name for p in parameters if p.name in known]


def needed(case, takes):
    """The inputs that a case needs and a function doesn't take, neither themselves nor in another form."""
    needed = []
    for name in [] if takes is None else [port["name"] for port in case["inputs"] if port["name"] not in takes]:
        forms = [form for form in case["forms"] if name in form["without"] and (form["takes"] is None or form["takes"] in takes)]
        needed += [name] if forms and not forms[0]["holds"] else []
    return needed


def read_manifest(cases):
    """`cases.json`, checked to be one."""
    path = cases / "cases.json"
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise CandidateError(f"{path}: not there. Write the cases first: nerf-oracle cases --out {cases}") from None
    if not str(manifest.get("schema", "")).startswith("nerf-oracle/cases/1"):
        raise CandidateError(f"{path}: schema {manifest.get('schema')!r}, expected nerf-oracle/cases/1.")
    return manifest


def inputs_of(cases, case, dtype, style, device):
    """Arrays by name, scalars as Python numbers."""
    with np.load(cases / case["file"], allow_pickle=False) as stored:
        inputs = {name: stored[name] for name in stored.files}
    if style == "torch":
        import torch

        short = torch.bfloat16 if dtype == "bf16" else None
        # Whole numbers stay what they are: bfloat16 holds none beyond 256 exactly.
        # Copied: what autograd keeps of an error is freed behind the interpreter's end, where numpy's memory can't be, and the program
        # never ends.
        lifted = lambda x: torch.from_numpy(x).to(device, short if x.dtype.kind == "f" else None, copy=True)  # noqa: E731
        return {n: lifted(x) if x.ndim else x.item() for n, x in inputs.items()}
    return {name: x if x.ndim else x.item() for name, x in inputs.items()}


def called(function, case, inputs, outputs):
    """What the function returns on the inputs that it names, by output name."""
    title = f"case {case['file']}, function {getattr(function, '__name__', type(function).__name__)}"
    wrap = f"Wrap it: lambda {', '.join(inputs)}: ..."
    try:
        parameters = inspect.signature(getattr(function, "forward", function)).parameters.values()
    except ValueError:
        raise CandidateError(f"{title}: Python can't tell its parameters. {wrap}") from None
    samples = None if "deltas" not in inputs else inputs["deltas"].shape[-1]
    named = {p.name for p in parameters}
    inputs = inputs if named >= set(inputs) else inputs | other_forms(case, inputs, named)
    takes_all = any(p.kind is p.VAR_KEYWORD for p in parameters)
    given = inputs if takes_all else {p.name: inputs[p.name] for p in parameters if p.name in inputs}
    for p in parameters:
        if p.kind in (p.POSITIONAL_ONLY, p.VAR_POSITIONAL):
            raise CandidateError(f"{title}: parameter {p.name!r} has no name to match. {wrap}")
        if p.name not in given and p.default is p.empty and p.kind is not p.VAR_KEYWORD:
            advice = "Rename it, give it a default, or wrap the function in a lambda."
            raise CandidateError(f"{title}: parameter {p.name!r} is no input of the case; {hint(p.name, inputs)}. {advice}")
    try:
        result = function(**given)
    except Exception as error:
        handed = ", ".join(f"{name} {type(x).__name__}{tuple(getattr(x, 'shape', ()))}" for name, x in given.items())
        advice = 'arrays="numpy" or arrays="torch" in run(...) says which it takes'
        raise Crash(f"{title}: {type(error).__name__}: {error}. It was handed {handed}; {advice}.") from error
    if isinstance(result, dict):
        strange = [name for name in result if name not in outputs]
        if strange:
            raise CandidateError(f"{title}: returned {strange[0]!r}; {hint(strange[0], outputs)}.")
    else:
        result = list(result) if isinstance(result, (tuple, list)) else [result]
        if len(result) > len(outputs):
            raise CandidateError(f"{title}: returned {len(result)} arrays; {hint('', outputs)}. Or a dict.")
        result = dict(zip(outputs, result, strict=False))
    if not any(x is not None for x in result.values()):
        raise CandidateError(f"{title}: returned nothing; {hint('', outputs)}.")
    if "t" in given and result.get("weights") is not None and "deltas" not in given and samples is not None:
        result["weights"] = result["weights"][:, :samples]
    return {name: x for name, x in result.items() if x is not None}


def other_forms(case, inputs, named):
    """The inputs in the forms that a function takes in their place."""
    forms = {form["takes"] for form in case["forms"] if form["holds"] and form["takes"] in named}
    out = {}
    if "K" in forms:
        c2w, (focal, cx, cy) = inputs["c2w"], (inputs[name] for name in ("focal", "cx", "cy"))
        K = [[focal, 0, cx], [0, focal, cy], [0, 0, 1]]
        out["K"] = c2w.new_tensor(K) if hasattr(c2w, "new_tensor") else np.array(K, c2w.dtype)
    if "step" in forms:
        out["step"] = float(inputs["deltas"].reshape(-1)[0]) if inputs["deltas"].shape[-1] else 1.0
    if "t" in forms:
        deltas = inputs["deltas"]
        torch = sys.modules["torch"] if hasattr(deltas, "detach") else None
        deltas = deltas.detach() if torch else deltas
        t = [deltas[:, :0].sum(1)]
        for i in range(deltas.shape[1]):
            t.append(t[-1] + deltas[:, i])
        out["t"] = (torch or np).stack(t, 1)
        for name in ("sigmas", "rgbs"):
            x = inputs[name]
            empty = (len(x), 1, *x.shape[2:])
            out[name] = torch.cat([x, x.new_zeros(empty)], 1) if torch else np.concatenate([x, np.zeros(empty, x.dtype)], 1)
    return out


def differentiated(function, case, inputs, names, what):
    """Gradients of a torch function by autograd, through the outputs that it returns."""
    torch = sys.modules.get("torch")
    wanted = {port["name"]: port["name"].removeprefix("grad_") for port in case["outputs"]}
    # A scalar's cotangent came as a number, which a tensor of its own type would round to f32.
    whole = lambda g: g if isinstance(g, torch.Tensor) else torch.tensor(g, dtype=torch.float64)  # noqa: E731
    cotangents = {name.removeprefix("grad_"): whole(g) for name, g in inputs.items() if torch and name.startswith("grad_")}
    inputs = {name: x for name, x in inputs.items() if not name.startswith("grad_")}
    if torch is None or not all(isinstance(inputs[name], torch.Tensor) for name in wanted.values()):
        raise Unsupported("no function of torch tensors")
    smooth = list(wanted.values())
    leaves = [inputs[name].requires_grad_() for name in smooth]
    result = called(function, case, inputs, names)
    what.returns = [name for name in names if name in result]
    for name, x in result.items():
        if name in cotangents and not alike(x.shape, cotangents[name].shape):
            raise OtherShape(f"{name} has the shape {tuple(x.shape)}, the gradient asked for {tuple(cotangents[name].shape)}")
    pairs = [(x, cotangents[name]) for name, x in result.items() if name in cotangents and getattr(x, "requires_grad", False)]
    what.differentiable = what.differentiable or bool(pairs)
    # A result that depends on nothing, such as that of a ray without samples, has a gradient of 0.
    gradients = [None] * len(leaves)
    if pairs:
        values, given = zip(*((x, torch.as_tensor(g, dtype=x.dtype, device=x.device).reshape(x.shape)) for x, g in pairs))
        try:
            gradients = torch.autograd.grad(values, leaves, given, allow_unused=True)
        except RuntimeError as error:
            raise Crash(f"case {case['file']}: its gradient: {error}") from error
    # What is taken in another form has no gradient in the contract's.
    replaced = {name for form in case["forms"] if what.takes and form["takes"] in what.takes for name in form["without"]}
    wanted = {n: name for n, name in wanted.items() if name not in replaced or name in what.takes}
    found = {f"grad_{name}": torch.zeros_like(inputs[name]) if g is None else g for name, g in zip(smooth, gradients)}
    found = {name: g for name, g in found.items() if name in wanted}
    if "grad_K" in found:
        # The contract's K is (fx, fy, cx, cy) alone; an inverse of the matrix depends on its other entries too.
        found["grad_K"] = found["grad_K"] * found["grad_K"].new_tensor([[1, 0, 1], [0, 1, 1], [0, 0, 0]])
    if "grad_c2w" in found:
        # And its pose the upper three rows.
        found["grad_c2w"] = found["grad_c2w"] * found["grad_c2w"].new_tensor([[1], [1], [1], [0]])
    return found


def alike(own, shape):
    """Whether one shape is the other, with merged axes (H W rays of a picture) or with axes of length one."""
    last = lambda shape: [n for n in shape if n != 1][-1:]  # noqa: E731
    return math.prod(own) == math.prod(shape) and last(own) == last(shape)


def write(path, result):
    """An uncompressed npz, written aside and renamed, so that the judge never meets half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    aside = path.with_name(f".{path.name}.{os.getpid()}")
    with open(aside, "wb") as file:
        np.savez(file, **{name: to_numpy(x) for name, x in result.items()})
    os.replace(aside, path)


def to_numpy(x):
    """Arrays, tensors on any device, numbers. numpy has no bfloat16: it goes out as float32, which holds it exactly."""
    if hasattr(x, "detach"):
        x = x.detach().cpu()
        x = (x.float() if str(x.dtype) == "torch.bfloat16" else x).numpy()
    return np.asarray(x, order="C")


def uses_torch(function):
    """Whether the file that defines a function has imported torch."""
    torch = sys.modules.get("torch")
    function = inspect.unwrap(getattr(function, "func", function))
    if not hasattr(function, "__globals__"):
        function = getattr(type(function), "forward", type(function).__call__)
    around = getattr(function, "__globals__", {}).values()
    return torch is not None and any(x is torch or str(getattr(x, "__module__", "")).startswith("torch") for x in around)


def hint(name, names):
    """What would have been right."""
    near = difflib.get_close_matches(name, list(names), 1)
    return f"{f'did you mean {near[0]}? ' if near else ''}Expected: {', '.join(names)}"
