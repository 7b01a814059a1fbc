"""Seconds a training step, points a second forward, seconds to fit a picture, with PyTorch: the peer of `benches/step.rs`.

The same network, batch and optimizer, as one would write them in PyTorch: the whole batch at once, and gradients accumulated
over chunks of 64 rays (whichever is faster counts); forward in chunks of 4,096 points. One JSON object a round, so that
rounds of both programs can be interleaved:

    python tools/bench_torch.py --rounds 1 --threads 2 --fit-steps 100

or, in the rounds of `bench` itself:

    nerf-oracle bench nerf_mlp --out DIR --peer "python tools/bench_torch.py --rounds 1 --fit-steps 10"

With `--only sgemm`, a 4096^3 product alone, best of 5: what PyTorch's library adds to the ceiling of the dense layers.

    nerf-oracle bench dense --out DIR --peer "python tools/bench_torch.py --rounds 1 --only sgemm"
"""

import argparse
import json
import math
import time

import torch
from torch import nn

RAYS, SAMPLES, PIXELS, REPEATS = 1024, 64, 10_000, 3


def encode(x: torch.Tensor, levels: int) -> torch.Tensor:
    """(M, D) -> (M, D + 2 L D): identity, then per band the sines of all dimensions, then their cosines."""
    angles = [math.pi * 2**k * x for k in range(levels)]
    return torch.cat([x] + [f(a) for a in angles for f in (torch.sin, torch.cos)], dim=-1)


class Nerf(nn.Module):
    """The paper's network with the profile `cs180`."""

    def __init__(self) -> None:
        super().__init__()
        self.trunk = nn.ModuleList(nn.Linear({0: 63, 4: 319}.get(n, 256), 256) for n in range(8))
        self.sigma, self.feature = nn.Linear(256, 1), nn.Linear(256, 256)
        self.color0, self.color1 = nn.Linear(283, 128), nn.Linear(128, 3)
        with torch.no_grad():
            self.sigma.bias += 0.1  # keeps every density alive

    def forward(self, x: torch.Tensor, d: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        position, direction = encode(x, 10), encode(d, 4)
        h = position
        for n, layer in enumerate(self.trunk):
            h = torch.relu(layer(torch.cat([h, position], -1) if n == 4 else h))
        sigma = torch.relu(self.sigma(h))
        color = torch.relu(self.color0(torch.cat([self.feature(h), direction], -1)))
        return sigma[:, 0], torch.sigmoid(self.color1(color))


def render(net: Nerf, o: torch.Tensor, d: torch.Tensor, t: torch.Tensor, delta: float) -> torch.Tensor:
    """Colors (R, 3) of rays with samples at t (R, N)."""
    x = o[:, None] + t[..., None] * d[:, None]
    sigma, rgb = net(x.reshape(-1, 3), d[:, None].expand_as(x).reshape(-1, 3))
    depth = sigma.view(t.shape) * delta
    transmittance = torch.exp(-(torch.cumsum(depth, 1) - depth))
    weights = transmittance * -torch.expm1(-depth)
    return (weights[..., None] * rgb.view(*t.shape, 3)).sum(1)


def fastest(work) -> float:
    """The shortest of REPEATS runs, in seconds."""
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def training_step(chunk: int) -> float:
    """Seconds a step of 1024 rays x 64 samples with Adam, gradients accumulated over chunks of `chunk` rays."""
    torch.manual_seed(0)
    net, width = Nerf(), 4 / SAMPLES
    optimizer = torch.optim.Adam(net.parameters(), lr=5e-4)
    o, d = 4 * torch.rand(RAYS, 3) - 2, 1.16 * torch.rand(RAYS, 3) - 0.58
    t = 2 + (torch.arange(SAMPLES) + torch.rand(RAYS, SAMPLES)) * width
    targets = torch.rand(RAYS, 3)

    def step() -> None:
        optimizer.zero_grad(set_to_none=True)
        for i in range(0, RAYS, chunk):
            s = slice(i, i + chunk)
            loss = ((render(net, o[s], d[s], t[s], width) - targets[s]) ** 2).sum() / (3 * RAYS)
            loss.backward()
        optimizer.step()

    return fastest(step)


def forward() -> float:
    """Points a second in chunks of 4,096, without gradients."""
    torch.manual_seed(0)
    net, points = Nerf(), RAYS * SAMPLES
    x, d = torch.rand(points, 3), torch.rand(RAYS, 3).repeat_interleave(SAMPLES, 0)
    with torch.inference_mode():
        return points / fastest(lambda: [net(x[i : i + 4096], d[i : i + 4096]) for i in range(0, points, 4096)])


def fit_image(steps: int) -> float:
    """Seconds for 1000 steps of 10,000 pixels, 3 hidden layers of 256, L = 10, from `steps` of them."""
    torch.manual_seed(0)
    sizes = [42, 256, 256, 256]
    hidden = [m for a, b in zip(sizes, sizes[1:]) for m in (nn.Linear(a, b), nn.ReLU())]
    net = nn.Sequential(*hidden, nn.Linear(256, 3), nn.Sigmoid())
    optimizer = torch.optim.Adam(net.parameters(), lr=5e-3)
    start = time.perf_counter()
    for _ in range(steps):
        x, targets = torch.rand(PIXELS, 2), torch.rand(PIXELS, 3)
        loss = nn.functional.mse_loss(net(encode(x, 10)), targets)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        optimizer.step()
    return (time.perf_counter() - start) * 1000 / steps


def sgemm(size: int, runs: int = 5) -> dict[str, float | int | str]:
    """GFLOP/s of a size^3 product in f32, the best of `runs` after one that warms up, and the library that computes it."""
    a, b, c = torch.rand(size, size), torch.rand(size, size), torch.empty(size, size)
    seconds = []
    for _ in range(1 + runs):
        start = time.perf_counter()
        torch.matmul(a, b, out=c)
        seconds.append(time.perf_counter() - start)
    library = "MKL" if torch.backends.mkl.is_available() else "sgemm"
    return {"sgemm_gflops": 2 * size**3 / min(seconds[1:]) / 1e9, "sgemm_size": size, "sgemm_library": library}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--fit-steps", type=int, default=100)
    parser.add_argument("--only", choices=["sgemm"], help="this alone")
    parser.add_argument("--sgemm-size", type=int, default=4096)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    for number in range(arguments.rounds):
        report = {"program": f"torch {torch.__version__}", "round": number, "threads": arguments.threads}
        report |= sgemm(arguments.sgemm_size)
        if arguments.only:
            print(json.dumps(report), flush=True)
            continue
        report |= {
            "step_whole_batch_seconds": training_step(RAYS),
            "step_accumulated_seconds": training_step(64),
            "forward_points_per_second": forward(),
            "fit_image_seconds_per_1000_steps": fit_image(arguments.fit_steps),
        }
        print(json.dumps(report), flush=True)


if __name__ == "__main__":
    main()
