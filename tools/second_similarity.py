"""The second implementation's structural similarity: filters along one axis and then the other. See second.py."""

import numpy as np


# Windows whose pixels all weigh the same, and their sizes.
BOXES = {"uniform": 7, "uniform_11": 11, "uniform_3": 3}


class Windows:
    """The two pictures, filtered: each filter is a matrix from pixels to windows along an axis."""

    def __init__(self, p, t, peak, c, wrong):
        kind = p.dtype
        if "gray_pictures" in wrong:
            p, t = p.mean(2, keepdims=True), t.mean(2, keepdims=True)
        if "luma_pictures" in wrong:
            shares = np.array([0.299, 0.587, 0.114], kind)[: p.shape[2]]
            p, t = ((x * shares).sum(2, keepdims=True) / shares.sum() for x in (p, t))
        if "one_window" in wrong:
            self.down, self.across = (np.full((1, n), 1 / n, kind) for n in p.shape[:2])
            p, t = (x.transpose(0, 2, 1).reshape(-1, x.shape[1], 1) for x in (p, t))
            self.down = np.full((1, p.shape[0]), 1 / p.shape[0], kind)
        else:
            self.down, self.across = (filters(n, c, kind) for n in p.shape[:2])
        size = BOXES.get(c["ssim_window"], 11) ** 2
        self.more = kind.type(size / (size - 1) if c["ssim_variance"] == "sample" and "one_window" not in wrong else 1)
        self.p, self.t = p, t
        self.mean_p, self.mean_t = self.mean(p), self.mean(t)
        # About the middle of the picture's range, so that little cancels.
        shift = (t.max() + t.min()) / 2 if c["ssim_padding"] != "zero" else kind.type(0)
        self.shift = shift
        p, t = p - shift, t - shift
        mean_p, mean_t = self.mean(p), self.mean(t)
        kept = 0 if "squared_means_kept" in wrong else 1
        pairs = (p, p, mean_p, mean_p), (t, t, mean_t, mean_t), (p, t, mean_p, mean_t)
        self.var_p, self.var_t, self.cov = ((self.mean(x * y) - u * v) * self.more for x, y, u, v in pairs)
        if not kept:
            self.var_p = self.var_p + self.mean_p**2
            self.var_t = self.var_t + self.mean_t**2
            self.cov = self.cov + self.mean_p * self.mean_t
        power = 1 if "constants_not_squared" in wrong else 2
        c1, c2 = kind.type((0.01 * peak) ** power), kind.type((0.03 * peak) ** power)
        self.luminance = (2 * self.mean_p * self.mean_t + c1) / (self.mean_p**2 + self.mean_t**2 + c1)
        self.over, self.under = self.mean_p**2 + self.mean_t**2 + c1, self.var_p + self.var_t + c2
        self.structure = (2 * self.cov + c2) / self.under

    def mean(self, x):
        """Weighted means of all windows."""
        return np.einsum("yj,xi,jic->yxc", self.down, self.across, x, optimize=True).astype(x.dtype)

    def back(self, g):
        """The transposed filter."""
        return np.einsum("yj,xi,yxc->jic", self.down, self.across, g, optimize=True).astype(g.dtype)


def filters(n, c, kind):
    """Rows are windows, columns pixels."""
    size = BOXES.get(c["ssim_window"])
    if size:
        line = np.full(size, 1 / size)
    else:
        line = np.exp(-(np.arange(-5, 6) ** 2) / 4.5)
        line = line / line.sum()
    before = len(line) // 2
    centers = range(before, n - before) if c["ssim_padding"] == "valid" else range(n)
    out = np.zeros((len(centers), n))
    for row, center in enumerate(centers):
        for k, weight in enumerate(line):
            at = center + k - before
            if c["ssim_padding"] == "reflect":
                at = abs(at) if at < n else 2 * (n - 1) - at
            if 0 <= at < n:
                out[row, at] += weight
    return out.astype(kind)


def peak_of(a, c, wrong):
    """The peak."""
    if "peak_255" in wrong:
        return 255.0
    if "peak_of_target" in wrong:
        return float(a["target"].max() - a["target"].min())
    return 1.0 if c["ssim_peak"] == "one" else float(a["peak"])


def ssim(a, c, wrong):
    """Luminance times structure."""
    w = Windows(a["prediction"], a["target"], peak_of(a, c, wrong), c, wrong)
    value = (w.structure if "luminance_dropped" in wrong else w.luminance * w.structure).mean()
    return {"value": 1 - value if "dissimilarity" in wrong else value}


def ssim_vjp(a, c, wrong):
    """Luminance and structure, each differentiated, by transposed filters."""
    w = Windows(a["prediction"], a["target"], peak_of(a, c, ()), c, ())
    g = a["grad_value"] / (1 if "mean_forgotten" in wrong else w.structure.size)
    g = w.p.dtype.type(-g if "gradient_of_the_loss" in wrong else g)
    of_mean = g * w.structure * 2 * (w.mean_t - w.luminance * w.mean_p) / w.over
    of_cov, of_var = (g * w.luminance * 2 * w.more * x / w.under for x in (1, -w.structure))
    if "means_held" in wrong:
        of_mean = of_mean * 0
    if "variances_held" in wrong:
        of_cov, of_var = of_cov * 0, of_var * 0
    p, t, mean_p, mean_t = (x - w.shift for x in (w.p, w.t, w.mean_p, w.mean_t))
    if "center_alone" in wrong:
        return {"grad_prediction": center_alone(w, p, t, mean_p, mean_t, of_mean, of_cov, of_var)}
    out = w.back(of_mean - of_cov * mean_t - of_var * mean_p) + t * w.back(of_cov) + p * w.back(of_var)
    return {"grad_prediction": out}


def center_alone(w, p, t, mean_p, mean_t, of_mean, of_cov, of_var):
    """To the pixels in the middle of windows alone."""
    out = np.zeros_like(p)
    down, across = ((n - m) // 2 for n, m in zip(p.shape[:2], mean_p.shape[:2]))
    inner = (slice(down, down + mean_p.shape[0]), slice(across, across + mean_p.shape[1]))
    out[inner] = of_mean + of_cov * (t[inner] - mean_t) + of_var * (p[inner] - mean_p)
    return out
