"""Volume rendering and its gradient."""

import numpy as np


def volume_render(sigmas, rgbs, deltas):
    """Colors and weights of rays."""
    depth = sigmas * deltas
    in_front = np.cumsum(np.concatenate([np.zeros_like(depth[:, :1]), depth[:, :-1]], 1), 1)
    weights = -np.expm1(-depth) * np.exp(-in_front)
    return (weights[..., None] * rgbs).sum(1), weights


def over(colors, opacity, background):
    """Colors in front of a background."""
    return colors + (1 - opacity)[:, None] * background


def to_bytes(image):
    """Stretched to the full range: a choice of this project."""
    low, high = image.min(), image.max()
    return np.round(255 * (image - low) / max(high - low, 1e-12)).astype(np.uint8)


class Camera:
    """A pinhole, with its principal point in the middle."""

    def __init__(self, height, width, focal):
        self.height, self.width, self.focal = height, width, focal

    def rays(self, c2w):
        """Pixel centers, origins, unit directions."""
        v, u = np.meshgrid(np.arange(self.height) + 0.5, np.arange(self.width) + 0.5, indexing="ij")
        x = (u - self.width / 2) / self.focal
        y = (v - self.height / 2) / self.focal
        d = np.stack([x, y, np.ones_like(x)], -1) @ c2w[:3, :3].T
        return np.stack([u, v], -1), np.broadcast_to(c2w[:3, 3], d.shape), d / np.linalg.norm(d, axis=-1, keepdims=True)
