"""Judges what pip brings, unchanged, on a CPU, and compares the fixtures with it.

    python tools/libraries [PROGRAM]             judge, compare, write the tables of ../README.md and DEVIATIONS.md
    python tools/libraries [PROGRAM] --check     exit 1 where they would come out otherwise

PROGRAM is the built nerf-oracle (target/release/nerf-oracle). The libraries are installed on the first call (seven gigabytes,
mostly torch's), into an environment outside of the checkout, one for each set of pinned versions. A verdict other than a pass
needs a reason in its adapter, a reproduction must still reproduce: what has gone stale ends the run with 1.
"""

import argparse
import hashlib
import os
import subprocess
import sys
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PINS = HERE / "requirements.txt", HERE / "alone.txt"


def environment():
    """The Python of the pinned versions, installed where it isn't yet."""
    pins = hashlib.sha256(b"".join(path.read_bytes() for path in PINS)).hexdigest()[:16]
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    place = cache / "nerf-oracle" / f"libraries-{pins}"
    python = place / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not (place / "ready").exists():
        venv.create(place, clear=True, with_pip=True)
        install = [python, "-m", "pip", "install", "--quiet"]
        subprocess.run([*install, "--requirement", PINS[0]], check=True)
        subprocess.run([*install, "--no-deps", "--requirement", PINS[1]], check=True)
        (place / "ready").touch()
    return python


def main():
    """Inside the environment, or outside of it to begin with."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    built = ROOT / "target/release/nerf-oracle"
    parser.add_argument("program", nargs="?", type=Path, default=built, help="the built nerf-oracle")
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not arguments.program.exists():
        parser.error(f"{arguments.program}: not there. Build it first: cargo build --release")
    if not arguments.inside:
        return subprocess.run([environment(), HERE, "--inside", *sys.argv[1:]], check=False).returncode
    sys.path[:0] = [str(HERE), str(HERE.parent)]
    from pages import written

    return written(arguments.program.resolve(), arguments.check)


if __name__ == "__main__":
    sys.exit(main())
