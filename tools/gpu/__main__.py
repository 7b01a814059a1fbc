"""Answers the judge's questions on a CUDA device, with what is installed there.

    for d in f64 f32 tf32 bf16 f16; do nerf-oracle cases --dtype $d --out CASES/$d; done
    nerf-oracle cases --layout raw --dtype f32 --out CASES/f32-raw
    python tools/gpu CASES ANSWERS [--only LANE ...] [--device cpu]
    python tools/gpu CASES ANSWERS --judge target/release/nerf-oracle

The first and the last command run on any machine, the third on one with CUDA; folders are copied between them. CASES is one
folder of questions, or has one for each type; answers lie in ANSWERS/(folder of cases)/(candidate), and each such folder is what
`nerf-oracle judge` takes. A lane is one package; it answers each folder in a process of its own, so that one that crashes takes
no other along. Where its package is absent it says so. nerfacc and gsplat compile their kernels on the first call: some minutes.
What an H100 answered, and what didn't pass, is in README.md.
"""

import argparse
import importlib
import json
import subprocess
import sys
import traceback
from pathlib import Path

HERE = Path(__file__).resolve().parent
LANES = "torch_rows torch_optimizers cupy_second cuda_c triton_kernel jax_rows nerfacc_kernels gsplat_kernels".split()
ABSENT = 77


def folders(cases):
    """The folders of questions: (path, type, layout)."""
    found = []
    for path in [cases, *sorted(cases.iterdir())] if cases.is_dir() else []:
        if (path / "cases.json").exists():
            manifest = json.loads((path / "cases.json").read_text(encoding="utf-8"))
            found.append((path, manifest["dtype"], "raw" if (path / "cases.txt").exists() else "npz"))
    if not found:
        advice = f"Write the cases first: nerf-oracle cases --out {cases}"
        raise SystemExit(f"{cases}: no cases.json in it or in its folders. {advice}")
    return found


def inside(lane, cases, dtype, answers, device):
    """One lane and one folder, in this process."""
    from asked import Absent, Asked

    try:
        return importlib.import_module(f"lanes.{lane}").answer(Asked(cases, answers, dtype, device))
    except (ImportError, Absent) as reason:
        print(f"{lane}: left out: {reason}", flush=True)
        return ABSENT


def outside(lane, cases, dtype, answers, arguments):
    """One lane and one folder, in a process of its own. What became of it."""
    command = [sys.executable, HERE, cases, answers, "--device", arguments.device, "--inside", lane, dtype]
    try:
        code = subprocess.run(command, timeout=arguments.seconds, check=False).returncode
    except subprocess.TimeoutExpired:
        return f"stopped after {arguments.seconds} s"
    return {0: "answered", ABSENT: "left out"}.get(code, f"crashed, exit status {code}")


def main():
    """Exit 0: all lanes answered or were left out; 1: one crashed, or took too long."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=Path)
    parser.add_argument("answers", type=Path)
    parser.add_argument("--only", nargs="+", choices=LANES, default=LANES, metavar="LANE", help=", ".join(LANES))
    parser.add_argument("--device", default="cuda", help="cuda, or cpu to try the plumbing")
    parser.add_argument("--seconds", type=int, default=900, help="the longest that a lane may take for a folder")
    parser.add_argument("--judge", type=Path, metavar="PROGRAM", help="judge what is in ANSWERS instead")
    parser.add_argument("--inside", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    sys.path[:0] = [str(HERE), str(HERE.parent)]
    if arguments.inside:
        lane, dtype = arguments.inside
        return inside(lane, arguments.cases, dtype, arguments.answers, arguments.device)
    found = folders(arguments.cases)
    if arguments.judge:
        from judging import judged

        return judged(arguments.judge, [path for path, _, _ in found], arguments.answers)
    became = {}
    for lane in arguments.only:
        for path, dtype, layout in found:
            if (layout == "raw") == (lane == "cuda_c"):
                became[lane, path.name] = outside(lane, path, dtype, arguments.answers / path.name, arguments)
    for (lane, name), what in became.items():
        print(f"{lane:18} {name:10} {what}")
    return int(any(what not in ("answered", "left out") for what in became.values()))


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Exception:
        traceback.print_exc()
        sys.exit(1)
