"""CUDA C: examples/c/volume_render.cu, as nvcc compiles it with several flags."""

import shutil
import subprocess
import tempfile
from pathlib import Path

from asked import Absent

FLAGS = {
    "plain": [],
    "use_fast_math": ["-use_fast_math"],
    "flush_to_zero": ["-ftz=true"],
    "no_fused_multiply_add": ["-fmad=false"],
    "short_division": ["-prec-div=false"],
}
SOURCE = Path(__file__).resolve().parents[2] / "examples/c/volume_render.cu"


def answer(asked):
    """A program for each flag. It reads bare numbers, in f32."""
    if not shutil.which("nvcc") or asked.device != "cuda":
        raise Absent("no nvcc" if asked.device == "cuda" else "it runs on CUDA alone")
    failed = False
    for name, flags in FLAGS.items():
        with tempfile.TemporaryDirectory() as place:
            program = Path(place) / name
            build = ["nvcc", "-O2", "-arch=native", *flags, "-I", SOURCE.parent, SOURCE, "-o", program]
            for command in (build, [program, asked.cases, asked.answers / f"cuda_c_{name}"]):
                code = subprocess.run(command, check=False).returncode
                if code:
                    print(f"cuda_c_{name}: exit status {code}", flush=True)
                    failed = True
                    break
    return int(failed)
