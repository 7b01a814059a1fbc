"""The type stubs are those of this registry."""

import ast
from pathlib import Path

import nerf_oracle
import pytest
from nerf_oracle.stubs import MODULES, stub


@pytest.mark.parametrize("module", MODULES)
def test_stubs_are_fresh(module):
    text = Path(nerf_oracle.__file__).with_name(f"{module}.pyi").read_text(encoding="utf-8")
    assert text == stub(*MODULES[module]), "stale: python -m nerf_oracle.stubs"
    names = {node.target.id for node in ast.parse(text).body if isinstance(node, ast.AnnAssign)}
    assert names == set(dir(getattr(nerf_oracle, module)))


def test_it_says_that_it_is_typed():
    assert Path(nerf_oracle.__file__).with_name("py.typed").exists()
