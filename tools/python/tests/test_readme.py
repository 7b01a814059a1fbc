"""The examples of the pages run, and say what they say."""

import re
from pathlib import Path

import pytest

PAGES = [Path(__file__).parents[1] / "README.md", Path(__file__).parents[3] / "README.md"]


@pytest.mark.parametrize("page", PAGES, ids=["package", "project"])
def test_examples_run(page, capsys):
    text = page.read_text(encoding="utf-8")
    blocks = re.findall(r"```(python|text)\n(.*?)```", text, re.DOTALL)
    assert [kind for kind, _ in blocks].count("python") >= 2
    names = {}
    for kind, block in blocks:
        if kind == "text":
            printed = capsys.readouterr().out
            assert all(line in printed for line in block.splitlines()), printed
        elif "import torch" not in block or pytest.importorskip("torch"):
            exec(compile(block, page.name, "exec"), names)
