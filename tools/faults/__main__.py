"""Planted faults: does the judge catch what is wrong on purpose, and what does it say?

    python tools/faults                     all of them, some minutes
    python tools/faults --only precision    of a family, a row or a name
    python tools/faults --record            and writes outcomes.json and, once it has all, FAULTS.md
    python tools/faults --sample 8          every eighth of those of small cases

Needs the wheel (pip install ./tools/python). Each fault is planted around a right kernel, the oracle's answers rounded to the
type, and judged in process in its own row and type. Exit 1 where one passes in f64 or f32, or the right kernel of a row fails.
"""

import argparse
import json
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import nerf_oracle as no  # noqa: E402
import numpy as np  # noqa: E402
from kernel import Kernel  # noqa: E402
from planted import PLANTED, VJP  # noqa: E402

HEAD = """# Planted faults

Written by `python tools/faults --record`. Each fault is planted around a right kernel and judged in its own row and type. Caught:
the verdict isn't a pass, or the report tells that answers change from call to call. Named: the report says what kind of thing it
is: how many bits were lost, stale state or chance, the cases that are off where others aren't, the first item of many that is. *Over
bound* is the largest error over what an honest answer of the type may be off by, on elements that prove something: below 1 nothing but a
change from call to call can be told. The bounds themselves, row by row and type by type, are in
[BOUNDS.md](../../tests/pages/BOUNDS.md).
"""


def asked(row, kind, dtype, candidate, tier="small"):
    """The judge's report of one row."""
    with np.errstate(all="ignore"):
        name = f"{row}_vjp" if kind == VJP else row
        report = no.judge(dtype=dtype, gradients=kind == VJP, tier=tier, **{name: lambda **arrays: candidate(**arrays)})
    return next(found for found in report.json["components"] if (found["kind"] == VJP) == (kind == VJP))


def changing(row):
    """What the report says of answers that change from call to call, or with the order, tile or layout in which a question comes."""
    return [told for told in (*row["faults"], *row["findings"]) if "with other bits" in told or told.startswith("depends on the ")]


# How a report names what kind of thing a fault is.
NAMES = {
    "precision": lambda row: row["verdict"] == "imprecise",
    "state": lambda row: bool(changing(row)),
    "habits": lambda row: bool(changing(row)) or 0 < len(row["wrong_cases"]) < row["cases"],
    "trigger": lambda row: 0 < len(row["wrong_cases"]) < row["cases"],
    "size": lambda row: any("is the first that is off" in told for told in row["observed"]),
}


def said(row):
    """What the report says of a row beyond its verdict."""
    if changing(row):
        return changing(row)[0]
    if row["diagnosis"]:
        best = row["diagnosis"][0]
        parts = [*best["mistakes"], *(f"{key} = {value}" for key, value in best.get("conventions", {}).items())]
        if parts:
            return " + ".join(parts)
    if row["verdict"] == "imprecise":
        return f"imprecise, {row['lost_bits']} bits lost" if row.get("lost_bits") else "imprecise"
    if row["verdict"] == "edge":
        return f"edge: {', '.join(row['edge_cases'])}"
    return (row["findings"] or row["observed"] or row["faults"] or [""])[0]


def over_bound(row):
    """The largest error over its bound, in two digits; a word where there is no number."""
    used = row["budget_used"]
    return "" if used is None else used if isinstance(used, str) else f"{used:.2g}"


def outcome(number):
    """(caught, named, what was said, error over bound, seconds) of a fault by its number."""
    fault = PLANTED[number]
    start = time.perf_counter()
    row = asked(fault.row, fault.kind, fault.dtype, fault.candidate(), fault.tier)
    words = said(row)
    caught = row["verdict"] != "pass" or bool(changing(row))
    named = caught and NAMES[fault.family](row)
    return caught, named, words.replace("|", "/").replace("\n", " "), over_bound(row), time.perf_counter() - start


def right(question):
    """What is wrong with the right kernel of a row, if anything."""
    row, kind, dtype, tier = question
    found = asked(row, kind, dtype, Kernel(row, kind, dtype), tier)
    return (
        None
        if found["verdict"] == "pass"
        else f"{row}/{kind} {dtype} {tier}: a right kernel gets {found['verdict']}: {said(found)}"
    )


def record(found):
    """Adds to outcomes.json what was found, and writes the page where nothing is missing."""
    file = HERE / "outcomes.json"
    known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    known |= {title(fault): list(o[:4]) for fault, o in found}
    known = {title(fault): known[title(fault)] for fault in PLANTED if title(fault) in known}
    file.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
    missing = len(PLANTED) - len(known)
    if missing:
        print(f"FAULTS.md isn't written: {missing} faults have no outcome yet")
    else:
        (HERE / "FAULTS.md").write_text(page([(fault, known[title(fault)]) for fault in PLANTED]), encoding="utf-8")


def page(found):
    """FAULTS.md."""
    lines = [HEAD, "| family | faults | caught | named | passed |", "|---|---|---|---|---|"]
    for family in [*dict.fromkeys(fault.family for fault, _ in found), "**all**"]:
        part = [o for fault, o in found if family in (fault.family, "**all**")]
        caught, named = sum(o[0] for o in part), sum(o[1] for o in part)
        lines.append(f"| {family} | {len(part)} | {caught} | {named} | {len(part) - caught} |")
    passed = [f"| {title(fault)} | {o[3]} |" for fault, o in found if not o[0]]
    lines += ["", "## Passed", "", *(["| fault | over bound |", "|---|---|", *passed] if passed else ["None."]), "", "## All", ""]
    lines += ["| fault | row | type | cases | caught | over bound | said |", "|---|---|---|---|---|---|---|"]
    for fault, (caught, _, words, used) in found:
        row = f"{fault.row}{'/vjp' if fault.kind == VJP else ''}"
        told = "yes" if caught else "**no**"
        lines.append(f"| {fault.name} | {row} | {fault.dtype} | {fault.tier} | {told} | {used} | {words[:110]} |")
    return "\n".join(lines) + "\n"


def title(fault):
    """A fault in its row and type."""
    return f"{fault.name}: {fault.row}{'/vjp' if fault.kind == VJP else ''} {fault.dtype}"


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="a family, a row, or part of a name")
    parser.add_argument("--sample", type=int, default=1, help="every so many-th of them, of small cases alone")
    parser.add_argument("--record", action="store_true", help="keep what was found: outcomes.json, FAULTS.md")
    arguments = parser.parse_args()
    chosen = [f for f in PLANTED if arguments.only in f"{f.family} {f.row} {title(f)}"]
    if arguments.sample > 1:
        chosen = [f for f in chosen if f.tier == "small"][:: arguments.sample]
    start = time.perf_counter()
    questions = list(dict.fromkeys((f.row, f.kind, f.dtype, f.tier) for f in chosen))
    with ProcessPoolExecutor() as pool:
        outcomes = pool.map(outcome, [PLANTED.index(fault) for fault in chosen])
        wrong = [problem for problem in pool.map(right, questions) if problem]
        found = list(zip(chosen, outcomes))
    seconds = time.perf_counter() - start
    passed = [fault for fault, o in found if not o[0]]
    for fault in passed:
        print(f"passed: {title(fault)}")
    for problem in wrong:
        print(problem)
    for fault, o in sorted(found, key=lambda pair: -pair[1][4])[:5]:
        print(f"{o[4]:6.1f} s  {title(fault)}")
    caught, named = sum(o[0] for _, o in found), sum(o[1] for _, o in found)
    print(f"{len(found)} faults: {caught} caught, {named} named, {len(passed)} passed; {seconds:.0f} s")
    if arguments.record:
        record(found)
    return 1 if wrong or any(fault.dtype in ("f64", "f32") for fault in passed) else 0


if __name__ == "__main__":
    sys.exit(main())
