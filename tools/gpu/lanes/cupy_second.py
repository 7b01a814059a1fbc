"""CuPy: the second implementation (tools/second*.py), with a module in the place of numpy that computes on the device."""

import re
import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from asked import Absent

HERE = Path(__file__).resolve().parent
TOOLS = HERE.parents[1]


def moved(place):
    """Its files, with on_device for numpy. kind(x) is numpy's on the host alone: a cast in its place."""
    for path in TOOLS.glob("second*.py"):
        text = path.read_text(encoding="utf-8").replace("import numpy as np", "import on_device as np")
        text = re.sub(r"\bkind\((?!\))", "np.cast_(kind, ", text)
        text = re.sub(r"([\w.]+(?:\[\"\w+\"\])?(?:\[\w+\])?)\.dtype\.type\(", r"np.cast_(\1.dtype.type, ", text)
        (place / path.name).write_text(text, encoding="utf-8")
    shutil.copy(HERE.parent / "on_device.py", place)


def answer(asked):
    """Every row. A case that CuPy has no function for isn't answered, and is told."""
    if asked.dtype in ("tf32", "bf16"):
        raise Absent(f"CuPy has no {asked.dtype}")
    from candidate import inputs_of, read_manifest, write

    fallen = Counter()
    with tempfile.TemporaryDirectory() as folder:
        moved(Path(folder))
        sys.path.insert(0, folder)
        import on_device
        import second

        for case in read_manifest(asked.cases)["cases"]:
            function = second.FUNCTIONS.get(case["component"] + ("_vjp" if case["kind"] == "vjp" else ""))
            if function is None:
                continue
            given = inputs_of(asked.cases, case, asked.dtype, "numpy", "cpu")
            try:
                inputs = {name: on_device.asarray(x) if isinstance(x, np.ndarray) else x for name, x in given.items()}
                with np.errstate(all="ignore"):
                    found = function(inputs, second.CS180, [])
                write(asked.answers / "cupy" / case["file"], {name: np.asarray(on_device.down(x)) for name, x in found.items()})
            except Exception as error:
                fallen[f"{case['component']} {case['kind']}: {type(error).__name__}: {str(error)[:160]}"] += 1
    for what, cases in fallen.items():
        print(f"cupy {asked.dtype}: {cases} cases of {what}", flush=True)
