"""The second implementation's spherical harmonics: coefficients by the recurrence of Legendre's functions. See second.py."""

from functools import cache
from math import comb, factorial, pi, sqrt

import numpy as np


@cache
def terms(band, m, sign=True):
    """Monomials (coefficient, i, j, k) of Y_l^m: Q(z) Re or Im (x + i y)^|m|, with Q the Legendre function without its sines."""
    n = abs(m)
    before, legendre = np.zeros(1), np.array([float(np.prod(np.arange(1, 2 * n, 2)))])
    for k in range(n + 1, band + 1):
        one_more = (2 * k - 1) * np.append(0, legendre)
        one_more[: len(before)] -= (k + n - 1) * before
        before, legendre = legendre, one_more / (k - n)
    size = sqrt((2 * band + 1) / (4 * pi) * factorial(band - n) / factorial(band + n)) * (sqrt(2) if n else 1)
    size *= -1 if sign and n % 2 else 1
    out = []
    for q in range(n + 1):
        # (i y)^q is real for even q.
        if q % 2 == (m < 0):
            wave = comb(n, q) * (-1 if q % 4 > 1 else 1)
            out += [(size * wave * c, n - q, q, k) for k, c in enumerate(legendre) if c]
    return out


def homogeneous(column):
    """Each term of bands 2 and 3 times x^2 + y^2 + z^2 until it has the column's degree."""
    band = max(sum(powers) for _, *powers in column)
    out = []
    for coefficient, i, j, k in column:
        if i + j + k == band or band > 3:
            out.append((coefficient, i, j, k))
        else:
            out += [(coefficient, i + 2, j, k), (coefficient, i, j + 2, k), (coefficient, i, j, k + 2)]
    return out


def all_terms(degree, c, wrong):
    """Those of all columns, in order."""
    orders = lambda band: range(band, -band - 1, -1) if "m_descending" in wrong else range(-band, band + 1)  # noqa: E731
    sign = c["harmonic_sign"] == "alternating"
    columns = [terms(band, m, sign) for band in range(int(degree) + 1) for m in orders(band)]
    return [homogeneous(column) for column in columns] if c["harmonic_form"] == "homogeneous" else columns


def spherical_harmonics(a, c, wrong):
    """Sums of monomials."""
    d = a["d"]
    if "directions_in_unit_cube" in wrong:
        d = (d + 1) / 2
    if c["harmonic_form"] == "normalized":
        d = d / np.linalg.norm(d, axis=1, keepdims=True)
    x, y, z = (d[:, [0, 2, 1]] if "polar_axis_y" in wrong else d).T
    columns = [sum(d.dtype.type(c) * (x**i * y**j * z**k) for c, i, j, k in column) for column in all_terms(a["degree"], c, wrong)]
    if "band_1_signs" in wrong and len(columns) > 1:
        columns[1], columns[3] = -columns[1], -columns[3]
    if "band_4_slips" in wrong and len(columns) == 25:
        sign = 1 if c["harmonic_sign"] == "plain" else -1
        columns[19] = d.dtype.type(sign * 0.6690465435572892) * y * (7 * z * z - 3)
        columns[24] = columns[24] * d.dtype.type(0.4425326924449826 / 0.6258357354491761)
    return {"harmonics": np.stack(columns, 1)}


def spherical_harmonics_vjp(a, c, wrong):
    """The power rule, monomial by monomial."""
    d, g = a["d"], a["grad_harmonics"]
    out, length = np.zeros_like(d), np.ones_like(d[:, :1])
    if c["harmonic_form"] == "normalized":
        length = np.linalg.norm(d, axis=1, keepdims=True)
        d = d / length
    for column, own in zip(all_terms(a["degree"], c, ()), g.T):
        for coefficient, *powers in column:
            for axis, power in enumerate(powers):
                if power:
                    factors = [d[:, b] ** (n - (b == axis)) for b, n in enumerate(powers)]
                    factor = 1 if "power_rule_forgotten" in wrong else power
                    out[:, axis] += d.dtype.type(factor * coefficient) * own * factors[0] * factors[1] * factors[2]
    if c["harmonic_form"] == "normalized":
        out = (out - (out * d).sum(1, keepdims=True) * d) / length
    return {"grad_d": out}
