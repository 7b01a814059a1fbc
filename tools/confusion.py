"""The judge, tested with answers that it didn't make: the confusion table and the figures that it must reach.

    python tools/confusion.py PROGRAM [--dtype f64 --dtype f32] [--pairs 100] [--seed 1] [--only COMPONENT] [--sample N] > CONFUSION.md

PROGRAM is the built nerf-oracle. The second implementation (second.py) answers every case: right, in every profile, with every mistake
alone, and with a convention and a mistake drawn at random. All other components are answered right. `--sample N` asks for N mistakes
alone. Exit 1: a figure isn't reached.
"""

import argparse
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import second
from candidate import write
from second_sampler import HONEST


def program(*words):
    """JSON that the program prints."""
    done = subprocess.run([*map(str, words), "--json"], capture_output=True, text=True, check=False)
    if done.returncode == 2:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr}")
    return json.loads(done.stdout)


def judged(tool, cases, right, mistakes=(), conventions=None, autograd=False):
    """The judge's report on right answers with these components' answers in their place."""
    with tempfile.TemporaryDirectory(dir=cases.parent) as folder:
        answers = Path(folder)
        shutil.copytree(right, answers, copy_function=os.link, dirs_exist_ok=True)
        second.answer(cases, answers, mistakes, conventions, {component for component, _ in mistakes}, autograd)
        return program(tool, "judge", cases, answers)


def named(row, name):
    """What the judge made of a mistake: named, pair, passed, or what it said instead."""
    if row["verdict"] == "pass":
        return "passed"
    found = row["diagnosis"]
    if found and found[0]["mistakes"] == [name]:
        return "named"
    if any(d["mistakes"] == [name] and d["same_as_best"] for d in found):
        return "pair"
    if not found:
        return "unknown"
    return "said " + " + ".join(found[0]["mistakes"] or ["conventions alone"])


def judgment(report, component, name, kinds=("forward", "trace", "statistics", "vjp")):
    """That of the component's first failing row."""
    rows = [row for row in report["components"] if row["name"] == component and row["kind"] in kinds]
    failed = [row for row in rows if row["verdict"] in ("fail", "edge")] or rows
    return named(failed[0], name), failed[0]


def others(report, component):
    """Rows of other components that failed."""
    return [row["name"] for row in report["components"] if row["verdict"] in ("fail", "edge") and row["name"] != component]


def singles(tool, cases, right, mistakes, autograd=False):
    """Every mistake alone; with `autograd` as its gradient shows it."""

    def one(mistake):
        report = judged(tool, cases, right, [mistake], autograd=autograd)
        verdict, row = judgment(report, *mistake, *([("vjp",)] if autograd else []))
        if autograd and judgment(report, *mistake, ("forward", "trace"))[0] == "passed":
            # Its effect is less than that of rounding: nothing is left of it in the gradient.
            verdict = "passed"
        print(*mistake, verdict, file=sys.stderr, flush=True)
        diagnosis = row["diagnosis"]
        runner_up = diagnosis[1]["mistakes"] + [f"{k} = {v}" for k, v in diagnosis[1]["conventions"].items()] if len(diagnosis) > 1 else []
        return [*mistake, verdict, row["budget_used"], " + ".join(runner_up), others(report, mistake[0])]

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, mistakes))


def drawn(tool, cases, components, known, pairs, seed):
    """A convention and a mistake, drawn at random; the convention holds for the whole run."""
    choice, choices = random.Random(seed), {c["name"]: c["values"] for c in program(tool, "list")["conventions"]}
    rows = [c for c in components if c["conventions"] and known.get(c["name"])]

    def one(n):
        own = random.Random(choice_seeds[n])
        component = own.choice(rows)
        key = own.choice([k for k in component["conventions"] if k in second.CS180])
        value = own.choice([v for v in choices[key] if v != second.CS180[key]])
        name = own.choice(known[component["name"]])
        conventions = second.CS180 | {key: value}
        if key == "last_delta":
            conventions["delta"] = "differences"
        if key == "identity":
            return None
        with tempfile.TemporaryDirectory(dir=cases.parent) as folder:
            second.answer(cases, folder, [(component["name"], name)], conventions)
            report = program(tool, "judge", cases, folder)
        verdict, row = judgment(report, component["name"], name)
        print(component["name"], name, key, value, verdict, file=sys.stderr, flush=True)
        return [component["name"], name, f"{key} = {value}", verdict, row["budget_used"]]

    choice_seeds = [choice.randrange(2**32) for _ in range(pairs)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return [row for row in pool.map(one, range(pairs)) if row]


def honest(tool, cases, right):
    """Choices of samplers that are no mistakes: (choice, what the judge says of it)."""
    out = []
    for name in HONEST:
        row = judgment(judged(tool, cases, right, [("sample_random_rays", name)]), "sample_random_rays", name)[1]
        out.append([name, row["verdict"], "; ".join(row["findings"])])
    return out


def profiles(tool, cases):
    """Every profile, nothing pinned: (profile, what failed)."""
    out = []
    for name, deviations in second.DEVIATIONS.items():
        with tempfile.TemporaryDirectory(dir=cases.parent) as folder:
            second.answer(cases, folder, conventions=second.CS180 | deviations)
            report = program(tool, "judge", cases, folder)
        failed = [f"{r['name']} {r['kind']}" for r in report["components"] if r["verdict"] in ("fail", "edge")]
        out.append([name, report["profile"], failed])
    return out


def cheats(tool, cases, right):
    """Rows that pass with nothing but zeros, NaN, or the first case alone."""
    passed = []
    manifest = json.loads((cases / "cases.json").read_text(encoding="utf-8"))["cases"]
    first = {(case["component"], case["kind"]): case["file"] for case in reversed(manifest)}
    fills = {"zeros": 0.0, "NaN": np.nan, "first case": None}
    for cheat, fill in fills.items():
        with tempfile.TemporaryDirectory(dir=cases.parent) as folder:
            for case in manifest:
                target = Path(folder) / case["file"]
                if fill is None and case["file"] in first.values():
                    target.parent.mkdir(exist_ok=True)
                    os.link(right / case["file"], target)
                elif fill is not None:
                    kinds = {"f64": np.float64, "f32": np.float32, "u8": np.uint8}
                    arrays = {p["name"]: np.zeros(p["shape"], kinds[p["dtype"]]) for p in case["outputs"]}
                    write(target, {n: x if x.dtype == np.uint8 else x + x.dtype.type(fill) for n, x in arrays.items()})
            report = program(tool, "judge", cases, folder)
        passed += [f"{cheat}: {r['name']} {r['kind']}" for r in report["components"] if r["verdict"] == "pass"]
    return passed


def share(rows, place):
    """(right, all) of those that could be seen, where `place` holds the judgment."""
    seen = [row for row in rows if row[place] != "passed"]
    return sum(row[place] in ("named", "pair") for row in seen), len(seen)


def table(head, rows):
    """Markdown."""
    print("\n".join(["", "| " + " | ".join(head) + " |", "|" + "---|" * len(head)]))
    for row in rows:
        print("| " + " | ".join(f"{x:.3g}" if isinstance(x, float) else str(x or "") for x in row) + " |")
    print(flush=True)


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--dtype", action="append", choices=["f64", "f32"])
    parser.add_argument("--pairs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--sample", type=int)
    arguments = parser.parse_args()
    tool, good = arguments.program.resolve(), True
    listed = [c for c in program(tool, "list")["components"] if arguments.only in c["name"]]
    components = [c for c in listed if c["name"] in second.FUNCTIONS]
    # Of a mistake that it doesn't know it would answer rightly.
    code = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parent.glob("second*.py"))
    listed_mistakes = [(c["name"], name) for c in components for name in c["mistakes"]]
    mistakes = [(component, name) for component, name in listed_mistakes if f'"{name}' in code]
    known = {c["name"]: [name for component, name in mistakes if component == c["name"]] for c in components}
    # A network has too many weights for differences.
    small = [c["name"] for c in components if "vjp" in c["variants"] and c["name"] != "nerf_mlp"]
    gradients = {(c["name"], name) for c in components for name in c.get("gradient_mistakes", [])}
    forward = [m for m in mistakes if m[0] in small and m not in gradients]
    if arguments.sample:
        mistakes, forward = (random.Random(180).sample(m, min(len(m), arguments.sample)) for m in (mistakes, forward))
    print(__doc__.split("\n\n")[0] + "\n\nWritten by `" + " ".join(["python tools/confusion.py PROGRAM", *sys.argv[2:]]) + "`.\n")
    absent = [c["name"] for c in listed if c not in components]
    if absent:
        print(f"Not in the second implementation, so not asked: {', '.join(absent)}\n")
    if len(mistakes) < len(listed_mistakes):
        print(f"{len(listed_mistakes) - len(mistakes)} mistakes that the second implementation doesn't know are left out.\n")
    for dtype in arguments.dtype or ["f64", "f32"]:
        with tempfile.TemporaryDirectory() as folder:
            cases, right = Path(folder) / "cases", Path(folder) / "right"
            program(tool, "cases", "--out", cases, "--dtype", dtype)
            second.answer(cases, right)
            print(f"## Answers in {dtype}")
            rows = profiles(tool, cases)
            table(["profile answered", "found", "failed"], [[n, f, ", ".join(x)] for n, f, x in rows])
            cheated = [] if arguments.sample else cheats(tool, cases, right)
            print("" if arguments.sample else f"Zeros, NaN, or the first case alone that pass: {', '.join(cheated) or 'none'}")
            choices = honest(tool, cases, right) if "sample_random_rays" in [c["name"] for c in components] else []
            table(["honest choice of a sampler", "verdict", "said"], choices)
            head = ["component", "mistake", "judged", "error / bound", "runner-up", "others failed"]
            alone = singles(tool, cases, right, mistakes)
            right_ones, all_ones = share(alone, 2)
            table(head, alone)
            print(f"**Single mistakes named, of those that exceed the bound: {right_ones} of {all_ones}**\n")
            if dtype == "f32" and not arguments.sample:
                through = singles(tool, cases, right, forward, autograd=True)
                right_through, all_through = share(through, 2)
                print("Gradients of the wrong forward functions, as automatic differentiation makes them; all but these are named:")
                table(head, [row for row in through if row[2] != "named"])
                print(f"**Forward mistakes named by their gradients alone: {right_through} of {all_through}**\n")
                good &= right_through == all_through
            pairs = drawn(tool, cases, components, known, arguments.pairs, arguments.seed)
            right_pairs, all_pairs = share(pairs, 3)
            print("A convention and a mistake, drawn at random; all but these are named:")
            table(["component", "mistake", "convention", "judged", "error / bound"], [r for r in pairs if r[3] != "named"])
            print(f"**A convention and a mistake, seed {arguments.seed}: {right_pairs} of {all_pairs}**\n")
            good &= right_ones == all_ones and right_pairs >= 0.98 * all_pairs and not cheated and not any(r[2] for r in rows)
            good &= not any(row[5] for row in alone) and all(verdict == "pass" and said for _, verdict, said in choices)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
