"""Measures this crate's figures and writes benches/RESULTS.md: each with its command, commit and machine.

    python tools/results.py --list
    python tools/results.py --quick                 # what takes seconds
    python tools/results.py --only lego,step        # these
    python tools/results.py --data ../data          # everything, on a quiet machine; the folder has the scenes, and the course's

Figures are kept in benches/results.json: those that aren't measured this time stay as they are, with the commit and the machine
that they stand on. The page is made from that file alone, up to its line of earlier figures, which is kept as it is. Standard
library only; figures of PyTorch, and of the second implementation, need tools/requirements.txt.
"""

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

ROOT = Path(__file__).resolve().parent.parent
STORE, PAGE = ROOT / "benches" / "results.json", ROOT / "benches" / "RESULTS.md"
EARLIER = "## Earlier figures\n"
SEEDS = [0, 1, 2]


class Bench:
    """Runs commands, and remembers what was run and what is shared between figures."""

    def __init__(self, program, data, folder):
        self.tool, self.data, self.folder, self.said = program, data, Path(folder), []
        self.trained, self.cost, self.seeds = {}, {}, SEEDS

    def run(self, *words, show=None, ok=(0,)):
        """One command from the repository's root: (standard output, seconds). `show` is how the page has it."""
        words = [str(word) for word in words]
        shown = show or " ".join(words)
        for path, name in [(self.tool, "nerf-oracle"), (self.folder, "OUT"), (self.data, "DATA"), (sys.executable, "python")]:
            shown = shown.replace(str(path), name)
        self.said.append(shown)
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
            start = time.perf_counter()
            child = subprocess.Popen(words, cwd=ROOT, stdout=out, stderr=errors, env={**os.environ, "LC_ALL": "C"})
            # Waited for by its number, which tells its own memory, and not the most of all programs so far.
            try:
                _, status, used = os.wait4(child.pid, 0)
            except BaseException:
                child.kill()
                child.wait()
                raise
            seconds, child.returncode = time.perf_counter() - start, os.waitstatus_to_exitcode(status)
            out.seek(0), errors.seek(0)
            told, wrong = out.read().decode(), errors.read().decode()
        if child.returncode not in ok:
            raise RuntimeError(f"{shown}: exit {child.returncode}\n{wrong[-2000:]}")
        self.memory = used.ru_maxrss / 1024
        return told, seconds

    def json(self, *words, **more):
        """The object that the program prints with --json: (object, seconds)."""
        text, seconds = self.run(self.tool, *words, "--json", **more)
        return json.loads(text), seconds

    def scene(self, name):
        """A file of the folder of scenes."""
        path = self.data / name
        if not path.exists():
            raise FileNotFoundError(f"no {path} (--data)")
        return path

    def run_of(self, scene, seconds, seed, *more):
        """A trained run and its log, trained once."""
        key = (scene, seconds, seed, more)
        folder = self.folder / f"run{len(self.trained)}"
        if key not in self.trained:
            words = ["train", self.scene(scene), "--out", folder, "--seconds", seconds, "--seed", seed, *more]
            show = f"nerf-oracle train {scene} --out RUN --seconds {seconds} --seed N {' '.join(more)}"
            _, wall = self.run(self.tool, *words, show=show.strip())
            self.cost[folder] = (wall, self.memory)
            log = [json.loads(line) for line in (folder / "log.jsonl").read_text().splitlines()]
            self.trained[key] = (folder, log)
        return self.trained[key]


def number(x, digits=3):
    """So many significant digits, no more than needed."""
    return f"{x:,.{digits}g}" if abs(x) < 10**digits else f"{x:,.0f}"


def middle(values, unit="", digits=3):
    """The median, and all values."""
    return f"{number(statistics.median(values), digits)}{unit} ({', '.join(number(v, digits) for v in values)})"


def crates(bench):
    """Crates that the oracle and the judge alone need."""
    text, _ = bench.run("cargo", "tree", "-e", "normal", "--no-default-features", "--prefix", "none", "--locked")
    names = {" ".join(line.split()[:2]) for line in text.splitlines() if line.strip()}
    return f"{len(names)}, itself included"


def cases(bench):
    """Writing all cases."""
    found = []
    for dtype in ["f32", "f64"]:
        answer, seconds = bench.json("cases", "--out", bench.folder / f"cases-{dtype}", "--dtype", dtype)
        found.append(f"{dtype}: {number(seconds, 2)} s, {number(answer['bytes'] / 1e6, 2)} MB")
    return "; ".join(found)


def judge(bench):
    """Judging the second implementation, right and with one mistake."""
    folder, found = bench.folder / "judge", []
    bench.json("cases", "--out", folder / "cases", "--dtype", "f32")
    for name, words in [("passing", []), ("one component failing", ["--mistake", "volume_render:inclusive_transmittance"])]:
        answers = folder / name.replace(" ", "_")
        bench.run(sys.executable, "tools/second.py", folder / "cases", answers, *words)
        _, seconds = bench.json("judge", folder / "cases", answers, ok=(0, 1))
        found.append(f"{name}: {number(seconds, 2)} s")
    return "; ".join(found)


def demo(bench):
    """The demo as it comes."""
    answer, _ = bench.json("demo", "--out", bench.folder / "demo", ok=(0, 1))
    return f"{number(answer['val_psnr'])} dB; f32 off by {number(answer['largest_difference_from_reference'], 2)}"


def mutants(_):
    """From the page that tools/mutants.py keeps."""
    rows = json.loads((ROOT / "tests/pages/MUTANTS.json").read_text()).values()
    viable, left = sum(row["viable"] for row in rows), sum(len(row["survivors"]) for row in rows)
    return f"{viable - left:,} of {viable:,}; the others are shown equivalent"


def step(bench):
    """One training step, ours and PyTorch's, in rounds that take turns."""
    ours, theirs = [], []
    for _ in range(3):
        text, _ = bench.run("cargo", "bench", "--locked", "--bench", "step", "--", "--rounds", "1", "--threads", "2")
        ours.append(json.loads(text.splitlines()[-1]))
        text, _ = bench.run(sys.executable, "tools/bench_torch.py", "--rounds", "1", "--threads", "2")
        theirs.append(json.loads(text.splitlines()[-1]))
    rows = [
        ("step, s, against chunks of 64 rays", "step_seconds", "step_accumulated_seconds"),
        ("against the whole batch", "step_seconds", "step_whole_batch_seconds"),
        ("forward, points/s", "forward_points_per_second", "forward_points_per_second"),
        ("fit-image, s per 1,000 steps", "fit_image_seconds_per_1000_steps", "fit_image_seconds_per_1000_steps"),
    ]
    return "; ".join(f"{name}: {middle([o[a] for o in ours])} / {middle([t[b] for t in theirs])}" for name, a, b in rows)


def lego(bench):
    """The compact model on Lego: seconds to two PSNRs, and the end of five minutes."""
    logs = [bench.run_of("lego_200x200.npz", 300, seed)[1] for seed in bench.seeds]
    found = []
    for goal in [24.69, 30.0]:
        reached = [next((line["seconds"] for line in log if (psnr_of(line) or 0) >= goal), None) for log in logs]
        found.append(f"{goal} dB after " + (middle(reached, " s") if None not in reached else f"{reached} s"))
    ends = [[line for line in log if line["val_psnr"] is not None][-1] for log in logs]
    found.append(f"at the end {middle([end['val_psnr'] for end in ends], ' dB', 4)}")
    return "; ".join([*found, f"{middle([end['samples'] / end['seconds'] / 1e6 for end in ends])} million points/s"])


def psnr_of(line):
    """The validation PSNR of a line of the log: of whole views, or of the probe."""
    return line["val_psnr"] if line["val_psnr"] is not None else line.get("val_probe")


def view(bench):
    """One view of a trained model against the oracle."""
    run, _ = bench.run_of("lego_200x200.npz", 300, SEEDS[0])
    answer, _ = bench.json("bench", "system", "--run", run, "--quick", "--out", bench.folder / "system", ok=(0, 1))
    rows = [f"{row['variant']}: {number(row['seconds'])} s at {number(row['psnr'])} dB" for row in answer["system"][:2]]
    return "; ".join([*rows, f"f32 off by {number(answer['system'][0]['same_samples_max_error'], 2)} at the same samples"])


def dense(bench):
    """What the dense layers reach of the machine's best product."""
    peer = f"{sys.executable} tools/bench_torch.py --rounds 1 --only sgemm"
    answer, _ = bench.json("bench", "dense", "--out", bench.folder / "dense", "--peer", peer, ok=(0, 1))
    shares = [(row["network"], row["share_products"], row["best_share_products"]) for row in answer["dense"]["rows"]]
    return "; ".join(f"{name}: {100 * share:.1f}% (best round {100 * best:.1f}%)" for name, share, best in shares)


def skipping(bench):
    """The 8x256 network's step with and without empty space."""
    run, _ = bench.run_of("lego_200x200.npz", 600, 0, "--model", "nerf", "--steps", "500")
    answer, _ = bench.json("bench", "nerf_step", "--run", run, "--out", bench.folder / "skip", ok=(0, 1))
    step = answer["nerf_step"]
    middle, low, high = (number(ratio, 3) for ratio in step["ratio"])
    return f"{middle} times ({low} to {high}); {step['loss_db']:.2f} dB better on the same rays"


def capture(bench):
    """The compact model on a capture with a lens."""
    _, log = bench.run_of("fox_capture", 120, 0, "--holdout", "8")
    end = [line for line in log if line["val_psnr"] is not None][-1]
    return f"{number(end['val_psnr'], 4)} dB, {number(end['samples'] / end['seconds'] / 1e6)} million points/s"


def sized(scene, seconds, *more):
    """A scene as people have it: all pixels of its held-out views, the whole run's wall clock, and memory."""

    def measure(bench):
        runs = [bench.run_of(scene, seconds, seed, "--val-all", *more) for seed in bench.seeds]
        ends = [[line for line in log if line["val_psnr"] is not None][-1] for _, log in runs]
        cost = [bench.cost[folder] for folder, _ in runs]
        found = [middle([end["val_psnr"] for end in ends], " dB", 4), middle([wall for wall, _ in cost], " s in all")]
        points = middle([end["samples"] / end["seconds"] / 1e6 for end in ends], " million points/s")
        return "; ".join([*found, middle([memory for _, memory in cost], " MiB"), points])

    return measure


def matrix(bench):
    """Whether training learns wherever it is taken."""
    answer, _ = bench.json("matrix", ok=(0, 1))
    return f"{answer['learned']} of {answer['runs']}"


def tests(bench):
    """The whole suite, after building."""
    bench.run("cargo", "test", "--release", "--locked", "--no-run")
    _, seconds = bench.run("cargo", "test", "--release", "--locked")
    return f"{seconds:.0f} s"


def machines(bench):
    """Honest machines that a bound rejects."""
    show = "BOUND_MACHINES=192 cargo test --release --test bounds"
    bench.run("env", "BOUND_MACHINES=192", "cargo", "test", "--release", "--locked", "--test", "bounds", show=show)
    return "0"


@dataclass
class Figure:
    """A figure: what it is, what it must be, how it is measured, and whether that takes seconds alone."""

    id: str
    what: str
    must: str
    measure: Callable
    quick: bool = False


FIGURES = [
    Figure("crates", "crates without default features", "at most 40", crates, True),
    Figure("cases", "`cases` for everything", "5 s, 20 MB", cases, True),
    Figure("judge", "`judge` of everything", "5 s; 10 s", judge, True),
    Figure("mutants", "mutants of the oracle files killed", "all", mutants, True),
    Figure("demo", "`demo`, 15 s of training; f32 against f64 on its 64 densest rays", "25 dB; 1e-5", demo, True),
    Figure("step", "8x256 network, 1,024 x 64 points, and a fit of 256 pixels: ours / PyTorch", "1.15, 1.2, 1.25 times", step),
    Figure("lego", "compact model on Lego 200", "10 s, 45 s, 33 dB, 1.5 million", lego),
    Figure("view", "one 200 x 200 view of it after 5 minutes", "0.25 s at 45 dB", view),
    Figure("capture", "compact model on a capture of 50 photographs, 2 minutes", "24 dB", capture),
    Figure("lego_800", "Lego 800, 25 test views, 60 s", "31 dB; 500 MiB", sized("lego_800", 60)),
    Figure("lego_400", "the same at `--scale 1/2`", "31.5 dB", sized("lego_800", 60, "--scale", "1/2")),
    Figure("chair_400", "Chair 400, 60 s", "31 dB", sized("chair_400", 60)),
    Figure("fox_capture", "the small capture, 60 s", "28.5 dB; 75 s in all", sized("fox_capture", 60)),
    Figure("fox_540", "the same at 540 x 960, 2 minutes", "25 dB", sized("fox_540", 120)),
    Figure("fern", "LLFF's fern, 5 minutes", "23.5 dB", sized("fern_llff", 300)),
    Figure("beer", "a capture of COLMAP's at `--scale 1/2`, 5 minutes", "learns", sized("beer_colmap", 300, "--scale", "1/2")),
    Figure("matrix", "`matrix`: builtin scenes of all sizes that learn", "all", matrix),
    Figure("dense", "share of the best matrix product in the dense layers", "65%", dense),
    Figure("skip", "8x256 with occupancy grid and early stop against the dense step", "5 times", skipping),
    Figure("tests", "`cargo test --release` after building", "120 s", tests),
    Figure("machines", "honest machines rejected by a bound", "0", machines),
]


def machine():
    """Processor, cores and system."""
    info = Path("/proc/cpuinfo")
    names = re.findall(r"model name\s*:\s*(.*)", info.read_text()) if info.exists() else []
    return f"{names[0] if names else os.uname().machine}, {os.cpu_count()} cores, {os.uname().sysname}"


def commit():
    """The commit, marked where the tree differs from it."""

    def run(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()

    changed = run("status", "--porcelain", "--untracked-files=no", "--", ".", ":!benches")
    return run("rev-parse", "--short", "HEAD") + (" and changes" if changed else "")


def page(stored, earlier):
    """The page: a row a figure, in the script's order, and the earlier figures as they were."""
    rows = ["| figure | must | measured | commit | machine |", "|---|---|---|---|---|"]
    commands = []
    for figure in FIGURES:
        if found := stored.get(figure.id):
            rows.append(f"| {figure.what} | {figure.must} | {found['measured']} | {found['commit']} | {found['machine']} |")
            said = found["commands"] or ["tests/pages/MUTANTS.json"]
            commands.append(f"* {figure.what}: " + ", ".join(f"`{command}`" for command in said))
    head = "# Results\n\nThis part is written by `python tools/results.py` from `results.json` beside it; `--list` says what it\n"
    head += "can measure. A figure of a busy machine says so in its machine's column.\n\n"
    return head + "\n".join(rows) + "\n\nCommands:\n\n" + "\n".join(commands) + "\n\n" + EARLIER + earlier


def main():
    """Measures what was asked for, and writes the page."""
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--list", action="store_true", help="the figures' names")
    words.add_argument("--quick", action="store_true", help="only what takes seconds")
    words.add_argument("--only", default="", help="these figures, separated by commas; none: only write the page again")
    words.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data", help="folder of scenes")
    words.add_argument("--seeds", type=int, default=len(SEEDS), choices=range(1, len(SEEDS) + 1), help="how many seeds a scene is trained with")
    words.add_argument("--busy", action="store_true", help="mark the machine as busy with other work")
    asked = words.parse_args()
    if asked.list:
        print("\n".join(f"{f.id:11} {'quick ' if f.quick else '      '} {f.what}" for f in FIGURES))
        return
    only = None if not asked.only else [] if asked.only == "none" else asked.only.split(",")
    if unknown := set(only or []) - {f.id for f in FIGURES}:
        sys.exit(f"no such figure: {', '.join(sorted(unknown))}; --list names them")
    wanted = [f for f in FIGURES if (f.id in only if only is not None else f.quick or not asked.quick)]
    stored = json.loads(STORE.read_text()) if STORE.exists() else {}
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
        bench = Bench((target / "release" / "nerf-oracle").resolve(), asked.data.resolve(), folder)
        bench.seeds = SEEDS[: asked.seeds]
        # The program that is measured is that of this tree, whatever was built before.
        if any(figure.measure not in [crates, mutants] for figure in wanted):
            bench.run("cargo", "build", "--release", "--locked")
        for figure in wanted:
            bench.said = []
            try:
                measured = figure.measure(bench)
            except (RuntimeError, FileNotFoundError) as reason:
                failed.append(f"{figure.id}: {reason}")
                continue
            print(f"{figure.id}: {measured}", flush=True)
            where = machine() + (", busy" if asked.busy else "")
            said = list(dict.fromkeys(bench.said))
            stored[figure.id] = {"measured": measured, "commands": said, "commit": commit(), "machine": where}
            STORE.write_text(json.dumps(stored, indent=1) + "\n")
    earlier = PAGE.read_text().split(EARLIER, 1)[1] if PAGE.exists() and EARLIER in PAGE.read_text() else "\n"
    PAGE.write_text(page(stored, earlier))
    if failed:
        sys.exit("not measured:\n" + "\n".join(failed))


if __name__ == "__main__":
    main()
