"""Write the tensors of a PyTorch checkpoint to an .npz, under their own names, for `nerf-oracle import`.

    python tools/torch_weights.py 200000.tar weights.npz
    nerf-oracle import weights.npz --mapping mapping.json --scene SCENE --out run

Dictionaries in one another become names with dots: {"network_fn_state_dict": {"rgb_linear.weight": ...}} is
"network_fn_state_dict.rgb_linear.weight". What isn't a tensor of floats is left out and named. Nothing that a file holds is run:
it is read with `weights_only`.
"""

import argparse
import sys

import numpy as np
import torch


def tensors(value: object, name: str, found: dict[str, np.ndarray], left: list[str]) -> None:
    """Add all tensors of floats in `value` to `found`, and the names of anything else to `left`."""
    if isinstance(value, dict):
        for key, inner in value.items():
            tensors(inner, f"{name}.{key}" if name else str(key), found, left)
    elif isinstance(value, torch.Tensor) and value.is_floating_point():
        # numpy has no bfloat16; f32 has all of its values.
        wide = value.float() if value.dtype == torch.bfloat16 else value
        found[name] = wide.detach().cpu().numpy()
    else:
        left.append(name)


def main() -> None:
    """Convert one file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", help="what torch.save wrote: a state dict, or a dict with some in it")
    parser.add_argument("out", help="the .npz to write")
    arguments = parser.parse_args()
    found: dict[str, np.ndarray] = {}
    left: list[str] = []
    tensors(torch.load(arguments.checkpoint, map_location="cpu", weights_only=True), "", found, left)
    if not found:
        sys.exit(f"{arguments.checkpoint}: no tensor of floats in it. Save model.state_dict() rather than the model.")
    if left:
        print(f"left out: {', '.join(left)}", file=sys.stderr)
    with open(arguments.out, "wb") as file:
        np.savez(file, **found)
    for name, array in found.items():
        print(name, array.dtype, list(array.shape))


if __name__ == "__main__":
    main()
