"""The program inside, and what importing costs."""

import json
import subprocess
import sys

import nerf_oracle as no
from nerf_oracle.rows import rows


def run(*words):
    """`python -m nerf_oracle`."""
    return subprocess.run([sys.executable, "-m", "nerf_oracle", *words], capture_output=True, text=True, check=False)


def test_it_is_the_same_program(tmp_path):
    found = json.loads(run("list", "--json").stdout)["components"]
    assert [row["name"] for row in found] == list(rows())
    assert run("--version").stdout.strip() == f"nerf-oracle {no.__version__}"
    done = run("cases", "depth", "--out", str(tmp_path / "cases"))
    assert done.returncode == 0 and (tmp_path / "cases" / "cases.json").exists()
    (tmp_path / "answers").mkdir()
    assert run("judge", str(tmp_path / "cases"), str(tmp_path / "answers")).returncode == 2
    wrong = run("cases", "--dtype", "f33", "--out", str(tmp_path / "x"))
    assert wrong.returncode == 2 and "f33" in wrong.stderr


def test_importing_brings_numpy_alone():
    code = "import sys, nerf_oracle; print([m for m in ('torch', 'jax', 'cupy', 'pytest') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
