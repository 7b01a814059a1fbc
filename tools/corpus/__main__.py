"""Strangers' behaviors, re-created, handed to the judge: what it says of each.

    python tools/corpus PROGRAM [--only NAME] [--dtype f32]      judge, print what isn't as it should be
    python tools/corpus PROGRAM --record                         and write README.md and outcomes.json
    python tools/corpus PROGRAM --check                          and compare: exit 1 where a row is worse, better, new or gone

PROGRAM is the built nerf-oracle. A row is an entry and a row of the judge's report: forward, trace or statistics, and vjp where
the component has one and the entry is torch's. Expectations say what is right, not what the judge says today; outcomes.json
holds the latter, and may only become better.
"""

import argparse
import contextlib
import importlib
import json
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Before torch is there: its threads would wait in loops beside the judge's.
os.environ.setdefault("OMP_NUM_THREADS", "1")

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
from entry import ENTRIES  # noqa: E402

from candidate import CandidateError, run  # noqa: E402

# What becomes of a row.
GOOD = ("named right", "passed")
BAD = ("unnamed", "named wrong", "passed wrongly", "failed wrongly", "not judged")


def program(*words):
    """JSON that the program prints."""
    done = subprocess.run([*map(str, words), "--json"], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1) or not done.stdout:
        raise CandidateError(f"{' '.join(map(str, words))}: {done.stderr.strip().splitlines()[:3]}")
    return json.loads(done.stdout)


def load():
    """All entries, file by file."""
    for path in sorted(HERE.glob("*.py")):
        if path.stem not in ("__main__", "entry"):
            importlib.import_module(path.stem)
    return sorted(ENTRIES, key=lambda entry: entry.name)


def kinds_of(entry, manifest):
    """The rows that an entry answers."""
    component = entry.component.removesuffix("_vjp")
    kinds = list(dict.fromkeys(case["kind"] for case in manifest if case["component"] == component))
    if entry.component.endswith("_vjp"):
        return component, ["vjp"]
    wanted = entry.arrays == "torch" and entry.gradient != "none"
    return component, [kind for kind in kinds if kind != "vjp" or wanted]


def expected(entry, kind):
    """(is it a fault, names) of a row."""
    if kind == "vjp" and isinstance(entry.gradient, tuple):
        return True, tuple(frozenset(name.split("+")) for name in entry.gradient)
    if kind == "vjp" and entry.gradient == "right":
        return False, ()
    return entry.kind == "fault", entry.names


def outcome(entry, kind, row):
    """What became of a row, and what the judge said."""
    wrong, names = expected(entry, kind)
    verdict = row["verdict"]
    if verdict in ("unsupported", "unproved", "crashed"):
        return ("not judged", row.get("reason") or verdict)
    if not wrong:
        good = verdict in ("pass", *["imprecise"] * entry.digits, *["edge"] * entry.edges)
        return ("passed" if good else "failed wrongly"), verdict if good or verdict != "fail" else said(row)
    if verdict == "pass":
        return "passed wrongly", "pass"
    if verdict == "imprecise":
        return "named wrong", "imprecise"
    found = [names_of(d) for d in row["diagnosis"] if d is row["diagnosis"][0] or d.get("same_as_best")]
    if not found or not any(found):
        return "unnamed", said(row)
    return ("named right" if any(d in names for d in found) else "named wrong"), said(row)


def names_of(diagnosis):
    """Its mistakes, and its slip without the place in the sources."""
    slip = diagnosis.get("slip")
    return frozenset([*diagnosis["mistakes"], *(["slip: " + slip.split(" (src/")[0]] if slip else [])])


def said(row):
    """The judge's first diagnosis, in a few words."""
    if row.get("diagnosis"):
        best = row["diagnosis"][0]
        return (
            " + ".join([*best["mistakes"], *(f"{k} = {v}" for k, v in best.get("conventions", {}).items())])
            or best.get("slip")
            or "conventions alone"
        )
    return "; ".join(row.get("findings", []))[:80] or f"unknown, {row['first_to_differ'] or 'an output'} differs first"


def answered(entry, cases, folder):
    """Answers below `folder`; a reason where there are none."""
    try:
        with (
            contextlib.redirect_stderr(None),
            open(os.devnull, "w", encoding="utf-8") as nothing,
            contextlib.redirect_stdout(nothing),
        ):
            became = run(cases, folder, arrays=entry.arrays, **{entry.component: entry.function})
        return {key.split("/")[1]: what for key, what in became.items()}
    except CandidateError as error:
        text = str(error).split("It was handed")[0].split(": ", 1)[-1]
        return {kind: f"crashed: {text.strip()[:100]}" for kind in ("forward", "vjp", "trace", "statistics")}


def judged(tool, cases, folder, component):
    """The component's rows by kind."""
    if not any(folder.rglob("*.npz")):
        return {}
    try:
        report = program(tool, "judge", cases, folder)
    except CandidateError as error:
        print(error, file=sys.stderr)
        return dict.fromkeys(("forward", "vjp", "trace", "statistics"), {"verdict": "crashed", "reason": "the judge itself crashed"})
    return {row["kind"]: row for row in report["components"] if row["name"] == component}


def results(tool, entries, dtype):
    """(entry, kind, outcome, what was said) of all rows. Every component has cases of its own, which the judge reads faster."""
    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(os.cpu_count()) as pool:
        asked = {}
        for component in dict.fromkeys(entry.component.removesuffix("_vjp") for entry in entries):
            cases = Path(place) / "cases" / component
            program(tool, "cases", component, "--out", cases, "--dtype", dtype)
            asked[component] = cases, json.loads((cases / "cases.json").read_text(encoding="utf-8"))["cases"]
        waiting = []
        for i, entry in enumerate(entries):
            folder = Path(place) / f"answers{i}"
            folder.mkdir()
            cases, manifest = asked[entry.component.removesuffix("_vjp")]
            component, kinds = kinds_of(entry, manifest)
            became = answered(entry, cases, folder)
            waiting.append((entry, kinds, became, pool.submit(judged, tool, cases, folder, component)))
        out = []
        for entry, kinds, became, future in waiting:
            rows = future.result()
            for kind in kinds:
                why = became.get(kind, "no answer")
                row = rows.get(kind) if why.startswith("answered") else {"verdict": "unsupported", "reason": why}
                out.append((entry, kind, *outcome(entry, kind, row or {"verdict": "unsupported", "reason": "no row"})))
        return out


def title(entry, kind):
    """A row's name."""
    return f"{entry.name} {kind}"


HEAD = """# Strangers' behaviors and what the judge says of them

Written by `python tools/corpus PROGRAM --record`, answers in f32. Each entry re-creates, in our own words, a behavior that was
met in public code: a right formula in somebody's way, a library's choice, or a fault. What is expected says what is right; where
the judge says something else, it is listed below. A row is an entry and forward, vjp, trace or statistics.
"""
COLUMNS = "component, faulty, named right, unnamed, named wrong, passed wrongly, right, passed, failed wrongly, not judged".split(
    ", "
)


def table(columns, rows):
    """Markdown."""
    return [
        "| " + " | ".join(columns) + " |",
        "|" + "---|" * len(columns),
        *("| " + " | ".join(map(str, row)) + " |" for row in rows),
        "",
    ]


def figures(rows, component):
    """A line of the first table."""
    part = [r for r in rows if component in ("**all**", r[0].component.removesuffix("_vjp"))]
    faulty = [what for entry, kind, what, _ in part if expected(entry, kind)[0]]
    good = [what for entry, kind, what, _ in part if not expected(entry, kind)[0]]
    counts = [len(faulty), *(faulty.count(what) for what in ("named right", "unnamed", "named wrong", "passed wrongly"))]
    return [
        component,
        *counts,
        len(good),
        good.count("passed"),
        good.count("failed wrongly"),
        (faulty + good).count("not judged"),
    ]


def page(rows):
    """README.md: figures by component, then every row that isn't as it should be, then every entry."""
    components = sorted({r[0].component.removesuffix("_vjp") for r in rows})
    lines = [HEAD, *table(COLUMNS, [figures(rows, component) for component in [*components, "**all**"]])]
    nameless = [expected(r[0], r[1]) for r in rows].count((True, ()))
    number = len({r[0].name for r in rows})
    lines += [f"{number} entries. Of the faulty rows {nameless} have no name in the catalog: until they have one, unnamed is all"]
    lines += ["that they can be.", ""]
    for what in BAD:
        bad = [
            [title(e, kind), e.text, wanted(e, kind), said.replace("|", "/")] for e, kind, found, said in rows if found == what
        ]
        lines += [f"## {what.capitalize()}: {len(bad)}", ""]
        lines += table(["row", "behavior", "expected", "said"], bad) if bad else ["None.", ""]
    entries = {r[0].name: r[0] for r in rows}.values()
    lines += ["## All entries", ""]
    lines += table(
        ["entry", "what it is", "behavior", "seen", "times"], [[e.name, e.kind, e.text, e.seen, e.times] for e in entries]
    )
    return "\n".join(lines).rstrip() + "\n"


def wanted(entry, kind):
    """What is expected, in words."""
    wrong, names = expected(entry, kind)
    if wrong:
        return " or ".join(" + ".join(sorted(x)) for x in names) or "fail (no name yet)"
    told = ", ".join(f"{k} = {v}" for k, v in entry.choice.items())
    return "pass" + " or imprecise" * entry.digits + " or edge" * entry.edges + (
        f", {told}" if told else ", told" if entry.kind == "convention" else ""
    )


def compared(rows, recorded):
    """Lines about rows that aren't what was recorded."""
    now = {title(e, kind): what for e, kind, what, _ in rows}
    out = [f"gone: {name}" for name in recorded if name not in now]
    for name, what in now.items():
        before = recorded.get(name)
        if before != what:
            change = "new" if before is None else "worse" if before in GOOD else "better: record it" if what in GOOD else "other"
            out.append(f"{change}: {name}: {before} -> {what}")
    return out


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--dtype", default="f32")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    entries = [e for e in load() if arguments.only in e.name]
    rows = results(arguments.program.resolve(), entries, arguments.dtype)
    for entry, kind, what, text in rows:
        if what in BAD and not arguments.check:
            print(f"{what:15} {title(entry, kind):75} {wanted(entry, kind):45} {text}")
    counts = {what: sum(r[2] == what for r in rows) for what in (*GOOD, *BAD)}
    print(f"{len(entries)} entries, {len(rows)} rows: " + ", ".join(f"{n} {what}" for what, n in counts.items()))
    file = HERE / "outcomes.json"
    if arguments.record:
        file.write_text(json.dumps({title(e, k): what for e, k, what, _ in rows}, indent=1) + "\n", encoding="utf-8")
        (HERE / "README.md").write_text(page(rows), encoding="utf-8")
    if arguments.check:
        recorded = {k: v for k, v in json.loads(file.read_text(encoding="utf-8")).items() if arguments.only in k}
        changes = compared(rows, recorded)
        print("\n".join(changes) or "as recorded")
        return 1 if changes else 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
