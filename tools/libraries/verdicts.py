"""Each adapter's answers, and what the judge says of them."""

import importlib
import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from candidate import run

HERE = Path(__file__).resolve().parent


@dataclass
class Verdict:
    """A row's verdicts by type; the conventions found in f32, or in the first type that there is."""

    entry: object
    kind: str
    by_type: dict = field(default_factory=dict)
    conventions: dict = field(default_factory=dict)

    @property
    def passes(self):
        """In every type that it was asked in."""
        return all(verdict == "pass" for verdict in self.by_type.values())


def load(package):
    """All files of a folder: what they register is in its list afterwards."""
    for path in sorted((HERE / package).glob("[a-z]*.py")):
        importlib.import_module(f"{package}.{path.stem}")


def program(*words):
    """JSON that the program prints."""
    done = subprocess.run([*map(str, words), "--json"], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1) or not done.stdout:
        raise SystemExit(f"{' '.join(map(str, words))}: {done.stderr.strip()[:500]}")
    return json.loads(done.stdout)


def judged(tool, entries):
    """All rows that were answered: an entry and forward or vjp."""
    found = {}
    with tempfile.TemporaryDirectory() as place:
        for entry in entries:
            print(f"{entry.title}: {entry.call}", file=sys.stderr)
            for dtype in entry.dtypes:
                cases, answers = Path(place) / f"{entry.component}-{dtype}", Path(place) / f"{entry.key}-{dtype}"
                if not cases.exists():
                    program(tool, "cases", entry.component, "--out", cases, "--dtype", dtype)
                run(cases, answers, arrays=entry.arrays, **{entry.component: entry.function})
                for row in program(tool, "judge", cases, answers)["components"]:
                    if row["name"] == entry.component and row["verdict"] != "unsupported":
                        one = found.setdefault((entry.key, row["kind"]), Verdict(entry, row["kind"]))
                        one.by_type[dtype] = row["verdict"]
                        if dtype == "f32" or not one.conventions:
                            one.conventions = row["conventions"]
    return list(found.values())


def stale(verdicts):
    """Reasons without a deviation, and deviations without a reason."""
    out = []
    for entry in {v.entry.key: v.entry for v in verdicts}.values():
        passes = all(v.passes for v in verdicts if v.entry is entry)
        if passes == bool(entry.why):
            out.append(f"{entry.key}: {'passes, and has a reason why not' if passes else 'needs a reason: why=...'}")
    return out
