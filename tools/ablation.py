"""What each part of the compact model is worth: trains a scene with each switched off in turn and prints a table.

    python tools/ablation.py target/release/nerf-oracle SCENE --seconds 30 [--rounds 3] [--args=--holdout=8] > table.md

Every run trains for the same time; rounds are interleaved, so that a slow minute of the machine hits all rows alike. Points are
samples that went forward and backward. Standard library only.

On several machines of one kind: `--shard I/N --out part_I.json` does every Nth run, `--merge part_*.json` prints the table of all.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

PARTS = {
    "nothing": "the default",
    "occupancy": "occupancy grid",
    "stop": "early stop (and rays ending behind opaque cells)",
    "patience": "rays ending behind opaque cells",
    "coarse_steps": "coarse steps at first",
    "coarse_levels": "coarse levels first",
    "growth": "growing batch",
    "decay": "falling learning rate",
    "view_dependence": "view dependence",
    "random_backgrounds": "random backgrounds",
    "distortion": "distortion loss",
    "averaging": "pictures of the parameters' running mean",
}


def train(program, scene, part, seconds, more, seed):
    """Step, million points a second and validation PSNR at the end of one run."""
    with tempfile.TemporaryDirectory() as folder:
        without = [] if part == "nothing" else ["--without", part]
        command = [program, "train", scene, "--out", f"{folder}/run", "--seconds", str(seconds), "--val-every", "10000000"]
        done = subprocess.run([*command, "--seed", str(seed), *without, *more], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(done.stderr)
        lines = [json.loads(line) for line in (Path(folder) / "run" / "log.jsonl").read_text().splitlines()]
    last = [line for line in lines if line["val_psnr"] is not None][-1]
    return last["step"], last["samples"] / last["seconds"] / 1e6, last["val_psnr"]


def row(name, runs):
    """Medians, and the PSNR's spread where there is one."""
    steps, points, psnr = (sorted(column) for column in zip(*runs))
    spread = f" ({psnr[0]:.2f} to {psnr[-1]:.2f})" if len(runs) > 1 else ""
    middle = [statistics.median(column) for column in (steps, points, psnr)]
    return name, *middle, spread


def shard(text):
    """I/N as two numbers."""
    number, of = (int(part) for part in text.split("/"))
    if not 1 <= number <= of:
        raise ValueError(text)
    return number, of


def merged(files, work, names):
    """All runs of parts of the same work; a part that is there twice counts once."""
    done = {}
    for file in files:
        part = json.loads(file.read_text())
        for field, expected in work.items():
            if part["work"][field] != expected:
                sys.exit(f"{file}: {field}: found {part['work'][field]}; expected {expected}. Merge parts of one ablation alone.")
        done = {**part["runs"], **done}
    missing = [name for name in names if name not in done]
    if missing:
        sys.exit(f"missing: {'; '.join(missing)}. Run the --shard that has them, and merge again.")
    return done


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--rounds", type=int, default=1, help="runs of every row, with seeds 0, 1, ...")
    parser.add_argument("--parts", default=",".join(PARTS), help="rows, with commas")
    parser.add_argument("--args", action="append", default=[], help="more arguments for train")
    parser.add_argument("--shard", type=shard, default=(1, 1), metavar="I/N", help="every Nth run from the Ith on, into --out")
    parser.add_argument("--out", type=Path, help="the part that --shard makes")
    parser.add_argument("--merge", nargs="+", type=Path, metavar="PART", help="print the table of these parts, made with the same options")
    given = parser.parse_args()
    if given.shard[1] > 1 and not given.out:
        parser.error("--shard needs --out")
    parts = given.parts.split(",")
    unknown = [part for part in parts if part not in PARTS]
    if unknown:
        sys.exit(f"--parts: {', '.join(unknown)}; known are {', '.join(PARTS)}")
    work = {"scene": given.scene, "seconds": given.seconds, "rounds": given.rounds, "parts": parts, "args": given.args}
    names = [f"{part}, seed {seed}" for seed in range(given.rounds) for part in parts]
    if given.merge:
        done = merged(given.merge, work, names)
    else:
        number, of = given.shard
        done = {}
        for name in names[number - 1 :: of]:
            part, seed = name.split(", seed ")
            done[name] = train(given.program, given.scene, part, given.seconds, given.args, int(seed))
            print(f"{name}: {done[name]}", file=sys.stderr)
        if given.out:
            given.out.write_text(json.dumps({"work": work, "runs": done}))
            return
    runs = {part: [done[f"{part}, seed {seed}"] for seed in range(given.rounds)] for part in parts}
    rows = [row(PARTS[part], runs[part]) for part in parts]
    base = rows[0]
    print(f"{given.seconds:g} s of training, {given.rounds} run(s) a row\n")
    print("| without | steps | million points/s | dB | dB against the first row |\n|---|---|---|---|---|")
    for name, steps, points, psnr, spread in rows:
        print(f"| {name} | {steps:.0f} | {points:.2f} | {psnr:.2f}{spread} | {psnr - base[3]:+.2f} |")


if __name__ == "__main__":
    main()
