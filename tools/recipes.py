"""The inputs of large cases, made from their recipes in cases.json: numpy's own Philox, then shifts and powers of two.

    nerf-oracle cases volume_render --tier large --out cases
    python tools/recipes.py cases            # the npz that `--inputs` would have written

src/contract/recipe.rs says what each law is. `--check` compares with files that are there.
"""

import argparse
import json
import math
import sys
from pathlib import Path

import numpy as np

BITS = {"f64": 53, "f32": 24, "tf32": 11, "bf16": 8, "f16": 11}
STORED = {"f64": np.float64, "f32": np.float32, "f16": np.float16, "i64": np.int64, "u8": np.uint8}


def made(entry, bits):
    """An input from its entry in the manifest."""
    recipe, shape = entry["recipe"], entry["shape"]
    count = math.prod(shape)
    words = np.random.Philox(key=entry["key"]).random_raw(max(count, 1))[:count]
    return law(recipe, words, shape, bits).reshape(shape).astype(STORED[entry["dtype"]])


def law(recipe, words, shape, bits):
    """Entries in f64; nothing rounds."""
    number, shift = np.arange(len(words)), np.uint64
    if recipe["law"] == "constant":
        return np.full(len(words), recipe["is"])
    if recipe["law"] == "fraction":
        return (words >> shift(64 - bits)).astype(float) * 2.0**-bits
    if recipe["law"] == "float":
        exponent = recipe["lowest"] + ((words % shift(256)) % shift(recipe["binades"])).astype(int)
        x = np.ldexp(1 + (words >> shift(65 - bits)).astype(float) * 2.0 ** (1 - bits), exponent)
        if recipe["signed"]:
            x = np.where(words >> shift(8) & shift(1) == 1, -x, x)
        return np.where((words >> shift(9)) % shift(8) < recipe["empty"], 0.0, x)
    if recipe["law"] == "ascending":
        inside = (words >> shift(76 - bits)).astype(float) * 2.0 ** (11 - bits) if bits > 12 else 0.0
        return (number % shape[-1] + inside) * 2.0 ** -recipe["cells"]
    if recipe["law"] == "each":
        return (number // recipe["each"]).astype(float)
    if recipe["law"] == "cycle":
        laws, x = recipe["of"], np.empty(len(words))
        for place, one in enumerate(laws):
            x[place :: len(laws)] = law(one, words, shape, bits)[place :: len(laws)]
        return x
    lengths = (words[:-1] >> shift(33)) % shift(recipe["most"] + 1)
    return np.concatenate([[0], np.cumsum(lengths)]).astype(float)


def main():
    """Writes, or compares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", type=Path, help="the folder that `nerf-oracle cases --tier large` wrote")
    parser.add_argument("--check", action="store_true", help="compare with the files that are there")
    arguments = parser.parse_args()
    manifest = json.loads((arguments.cases / "cases.json").read_text())
    if manifest.get("tier") != "large":
        sys.exit("these cases come with their inputs")
    for case in manifest["cases"]:
        path = arguments.cases / case["file"]
        inputs = {entry["name"]: made(entry, BITS[manifest["dtype"]]) for entry in case["inputs"]}
        if not arguments.check:
            path.parent.mkdir(parents=True, exist_ok=True)
            np.savez(path, **inputs)
            continue
        with np.load(path) as found:
            off = [n for n, x in inputs.items() if x.dtype != found[n].dtype or not np.array_equal(x, found[n])]
        if off or set(found.files) != set(inputs):
            sys.exit(f"{path}: {', '.join(off) or 'other arrays'} differ")
    print(f"{len(manifest['cases'])} cases {'agree' if arguments.check else 'written'}")


if __name__ == "__main__":
    main()
