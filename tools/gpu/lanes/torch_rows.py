"""torch: the rows of examples/torch_candidate.py, gradients by autograd."""

import sys
from pathlib import Path


def answer(asked):
    """In every type; in f32 with TF32 products too, which the judge must tell; in f16 with sums of products in f16."""
    torch = asked.torch()
    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples"))
    from torch_candidate import ROWS

    rows = {row.__name__: row for row in ROWS}
    asked.hand("torch", **rows)
    products = {name: rows[name] for name in ("mlp", "nerf_mlp", "transform", "pixel_to_ray")}
    if asked.dtype == "f32" and asked.device == "cuda":
        torch.set_float32_matmul_precision("high")
        asked.hand("torch_tf32_as_f32", **rows)
    if asked.dtype == "f16" and asked.device == "cuda":
        torch.backends.cuda.matmul.allow_fp16_accumulation = True
        asked.hand("torch_f16_sums", **products)
