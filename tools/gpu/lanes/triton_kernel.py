"""A volume renderer in Triton, forward, f32: a program for each ray."""

import triton
import triton.language as tl


@triton.jit
def kernel(s, c, d, colors, weights, opacity, left, N, B: tl.constexpr):
    """One ray of N samples, in a block of B."""
    r = tl.program_id(0)
    i = tl.arange(0, B)
    here = i < N
    x = tl.load(s + r * N + i, mask=here, other=0.0) * tl.load(d + r * N + i, mask=here, other=0.0)
    # What lies in front: the sum of the samples before, read shifted, so that no infinity is subtracted.
    before = (i > 0) & (i < N + 1)
    y = tl.load(s + r * N + i - 1, mask=before, other=0.0) * tl.load(d + r * N + i - 1, mask=before, other=0.0)
    front = tl.cumsum(y, 0)
    w = tl.where(here, tl.exp(-front) * (1 - tl.exp(-x)), 0.0)
    tl.store(weights + r * N + i, w, mask=here)
    tl.store(opacity + r, tl.sum(w, 0))
    tl.store(left + r, tl.exp(-tl.sum(x, 0)))
    for a in tl.static_range(3):
        rgb = tl.load(c + (r * N + i) * 3 + a, mask=here, other=0.0)
        tl.store(colors + r * 3 + a, tl.sum(w * rgb, 0))


def volume_render(sigmas, rgbs, deltas):
    """Launches it."""
    rays, samples = sigmas.shape
    out = [sigmas.new_empty(shape) for shape in ((rays, 3), (rays, samples), (rays,), (rays,))]
    block = triton.next_power_of_2(samples + 1)
    kernel[(rays,)](sigmas.contiguous(), rgbs.contiguous(), deltas.contiguous(), *out, samples, block)
    return tuple(out)


def answer(asked):
    """f32 alone."""
    asked.cuda()
    if asked.dtype == "f32":
        asked.hand("triton", volume_render=volume_render)
