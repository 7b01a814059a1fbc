"""The program inside, and what importing costs."""

import json
import subprocess
import sys
from pathlib import Path

import nerf_oracle as no
import pytest
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


def imported(code):
    """The large modules that are there after some code."""
    names = "('numpy', 'torch', 'jax', 'cupy', 'pytest')"
    code = f"import sys; {code}; print(*[m for m in {names} if m in sys.modules])"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()


def test_importing_brings_little():
    assert imported("import nerf_oracle") == []
    assert imported("import nerf_oracle; nerf_oracle.oracle.mse([1.0], [2.0]); nerf_oracle.judge") == ["numpy"]


def test_every_name_is_there():
    assert all(getattr(no, name) is not None for name in no.__all__) and set(no.__all__) <= set(dir(no))
    with pytest.raises(AttributeError, match="no attribute 'jugde'"):
        no.jugde


def test_the_license_travels():
    here = Path(__file__).parents[1]
    assert (here / "LICENSE").read_bytes() == (here.parents[1] / "LICENSE").read_bytes()
