"""What a lane is asked: a folder of cases, and where its answers go."""

import sys
import time
from dataclasses import dataclass
from pathlib import Path

from candidate import CandidateError, read_manifest, run


class Absent(Exception):
    """What a lane needs isn't there."""


@dataclass(frozen=True)
class Asked:
    """One folder of cases, in one type; answers lie below `answers`, a folder for each candidate."""

    cases: Path
    answers: Path
    dtype: str
    device: str

    def torch(self):
        """torch on the device, where there is one: tensors that a function makes lie there too."""
        import torch

        if self.device == "cuda" and not torch.cuda.is_available():
            raise Absent("torch finds no CUDA device")
        torch.set_default_device(self.device)
        torch.set_float32_matmul_precision("high" if self.dtype == "tf32" else "highest")
        return torch

    def cuda(self):
        """Ends the lane where the device isn't CUDA's."""
        if self.device != "cuda" or not self.torch():
            raise Absent("it runs on CUDA alone")

    def hand(self, candidate, **functions):
        """Each function answers its row, into the candidate's folder. A row that crashes leaves the others alone."""
        known = {case["component"] for case in read_manifest(self.cases)["cases"]}
        for row, function in functions.items():
            began = time.time()
            if row not in known:
                continue
            try:
                told = run(self.cases, self.answers / candidate, arrays="torch", device=self.device, **{row: function})
                state = ", ".join(f"{kind.split('/')[1]} {what}" for kind, what in told.items())
            except CandidateError as error:
                state = f"{type(error).__name__}: {str(error)[:300]}"
            print(f"{candidate:32} {self.dtype:5} {row:24} {time.time() - began:6.1f} s  {state}", flush=True)


def adapters(name):
    """An adapter of tools/libraries."""
    import importlib

    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "libraries"))
    return importlib.import_module(f"adapters.{name}")
