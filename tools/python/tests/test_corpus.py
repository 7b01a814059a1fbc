"""What strangers' code does, judged in process: the same as by files, as ../../corpus has recorded it, or, of gradients that files ask in
shapes that aren't theirs, judged at all. A tenth of the entries."""

import importlib.util
import json
import sys
from pathlib import Path

import nerf_oracle as no
import pytest

CORPUS = Path(__file__).parents[2] / "corpus"


@pytest.fixture(scope="module")
def corpus():
    """The corpus' own program, which has its entries and says what became of them."""
    pytest.importorskip("torch")
    spec = importlib.util.spec_from_file_location("corpus", CORPUS / "__main__.py")
    program = importlib.util.module_from_spec(spec)
    path = list(sys.path)
    spec.loader.exec_module(program)
    entries = program.load()
    sys.path[:] = path
    return program, entries, json.loads((CORPUS / "outcomes.json").read_text(encoding="utf-8"))


@pytest.mark.filterwarnings("ignore")
def test_in_process_as_by_files(corpus):
    program, entries, recorded = corpus
    different, compared = [], 0
    for entry in entries[::10]:
        # What numpy's functions in a file that imports torch too take isn't found: the entry says it, as it does where files are asked.
        mixed = entry.arrays == "numpy" and "torch" in entry.function.__globals__
        report = no.judge(again=False, framework="numpy" if mixed else None, **{entry.component: entry.function})
        assert f"arrays of {entry.arrays}" in report.notes[0], (entry.name, report.notes)
        for row in report.json["components"]:
            what, said = program.outcome(entry, row["kind"], row)
            before = recorded.get(program.title(entry, row["kind"]), what)
            if before == "not judged" and what == "passed":
                continue
            compared += 1
            different += [(entry.name, row["kind"], before, what, said)] if what != before else []
    assert compared >= 40 and not different, different
