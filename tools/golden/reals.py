"""Real numbers at 50 digits that remember how they were made: values, vector-Jacobian products and largest terms.

`Real` is an mpmath number on a tape. A reverse sweep over the tape differentiates the written definition, so that the
gradients here share nothing with the crate's hand-written ones.

Each number also carries `term`, the size that a rounding error in it is measured against. Inputs are exact (0). A sum
has the largest of its terms, a function f(x) has |f'(x)| term(x), and nothing has less than its own absolute value:
a first-order error analysis with max in the place of sum. An error of k ULP "of the largest term" is k ulp(term).
No rounded number's term is below the least normal f64, whose ULP is that of all subnormals: what underflows is off by
that much, and may be multiplied again. Sizes and terms are estimates, kept as floats below `HUGE`.
"""

import mpmath
import numpy as np
from mpmath import mp, mpf

mp.dps = 50
HUGE, LEAST_NORMAL = 1e308, 2.0**-1022
ONE, MINUS_ONE = mpf(1), mpf(-1)


class Real:
    """A number, its absolute value as a float, its largest term, and what it came from.

    `parents` lists (parent, partial derivative, absolute value of the partial, largest term of the partial).
    """

    __slots__ = ("value", "size", "term", "parents", "seeds", "order")
    count = 0

    def __init__(self, value, term=0.0, parents=()):
        self.value = value if isinstance(value, mpf) else mpf(value)
        self.size = size_of(self.value)
        self.term = min(max(self.size, term, LEAST_NORMAL), HUGE) if parents or term else 0.0
        self.parents, self.seeds = parents, None
        Real.count += 1
        self.order = Real.count

    def __neg__(self):
        return Real(-self.value, self.term, ((self, MINUS_ONE, 1.0, 0.0),))

    def __add__(self, other):
        return total([self, real(other)])

    def __sub__(self, other):
        other = real(other)
        parents = (self, ONE, 1.0, 0.0), (other, MINUS_ONE, 1.0, 0.0)
        return Real(self.value - other.value, max(self.term, other.term), parents)

    def __rsub__(self, other):
        return Real(other) - self

    def __mul__(self, other):
        other = real(other)
        term = max(self.term * other.size, self.size * other.term)
        parents = (self, other.value, other.size, other.term), (other, self.value, self.size, self.term)
        return Real(self.value * other.value, term, parents)

    def __truediv__(self, other):
        return self * real(other).reciprocal()

    __radd__, __rmul__ = __add__, __mul__

    def reciprocal(self):
        """1/x."""
        r = 1 / self.value
        return self.function(r, -r * r, 2 * r**3)

    def function(self, value, first, second):
        """f(x) from f(x), f'(x) and f''(x)."""
        slope = size_of(first)
        slope_term = max(slope, size_of(second) * self.term)
        return Real(value, slope * self.term, ((self, first, slope, slope_term),))


def size_of(value):
    """|x| as a float, at most `HUGE`."""
    return min(abs(float(value)), HUGE)


def real(x):
    """A number as an exact `Real`, unless it is one."""
    return x if isinstance(x, Real) else Real(x)


def constant(value):
    """A number that isn't exact in f64, such as ln 10: known to within its own rounding."""
    return Real(value, size_of(value))


def total(numbers):
    """The sum of a list. Its largest term is that of the list, or of a single addition its result."""
    numbers = list(numbers)
    terms = [x.term for x in numbers] + ([x.size for x in numbers] if len(numbers) > 2 else [])
    value = mpmath.fsum(x.value for x in numbers)
    return Real(value, max(terms, default=0.0), tuple((x, ONE, 1.0, 0.0) for x in numbers))


def dot(a, b):
    """sum_i a_i b_i."""
    return total([x * y for x, y in zip(a, b, strict=True)])


def exp(x):
    """e^x."""
    e = mpmath.exp(x.value)
    return x.function(e, e, e)


def expm1(x):
    """e^x - 1 without cancellation."""
    e = mpmath.exp(x.value)
    return x.function(mpmath.expm1(x.value), e, e)


def log(x):
    """The natural logarithm."""
    return x.function(mpmath.log(x.value), 1 / x.value, -1 / x.value**2)


def sqrt(x):
    """The square root."""
    s = mpmath.sqrt(x.value)
    return x.function(s, 1 / (2 * s), -1 / (4 * s**3))


def sin_pi(x, scale):
    """sin(pi scale x), the argument reduced exactly."""
    s, c, p = mpmath.sinpi(scale * x.value), mpmath.cospi(scale * x.value), scale * mp.pi
    return x.function(s, p * c, -p * p * s)


def cos_pi(x, scale):
    """cos(pi scale x), the argument reduced exactly."""
    s, c, p = mpmath.sinpi(scale * x.value), mpmath.cospi(scale * x.value), scale * mp.pi
    return x.function(c, -p * s, -p * p * c)


def sin(x, scale):
    """sin(scale x)."""
    s, c = mpmath.sin(scale * x.value), mpmath.cos(scale * x.value)
    return x.function(s, scale * c, -scale * scale * s)


def cos(x, scale):
    """cos(scale x)."""
    s, c = mpmath.sin(scale * x.value), mpmath.cos(scale * x.value)
    return x.function(c, -scale * s, -scale * scale * c)


def relu(x):
    """max(x, 0), with derivative 0 at 0."""
    return x.function(x.value, ONE, mpf(0)) if x.value > 0 else x.function(mpf(0), mpf(0), mpf(0))


def sigmoid(x):
    """1 / (1 + e^-x)."""
    s = 1 / (1 + mpmath.exp(-x.value))
    return x.function(s, s * (1 - s), s * (1 - s) * (1 - 2 * s))


def softplus(x):
    """log(1 + e^x)."""
    s = 1 / (1 + mpmath.exp(-x.value))
    value = mpmath.log1p(mpmath.exp(x.value)) if x.value < 0 else x.value + mpmath.log1p(mpmath.exp(-x.value))
    return x.function(value, s, s * (1 - s))


def one_minus_power(base, exponent):
    """1 - base^exponent without cancellation, for an exact base below 1."""
    value = -mpmath.expm1(exponent * mpmath.log(base.value))
    power = base.value**exponent
    return base.function(value, -exponent * power / base.value, -exponent * (exponent - 1) * power / base.value**2)


def lift(array):
    """An array of exact inputs."""
    array = np.asarray(array, dtype=np.float64)
    out = np.empty(array.shape, dtype=object)
    for index in np.ndindex(array.shape):
        out[index] = Real(float(array[index]))
    return out


def vjp(outputs, cotangents, inputs):
    """For each array of `inputs`, sum over all outputs y of cotangent(y) dy/dx, as an array of `Real`."""
    pending = []
    for name, cotangent in cotangents.items():
        for index in np.ndindex(cotangent.shape):
            y = outputs[name][index]
            y.seeds = (y.seeds or []) + [(mpf(float(cotangent[index])), 0.0)]
            pending.append(y)
    tape = reachable(pending)
    gradients = {}
    for order in sorted(tape, reverse=True):
        y = tape[order]
        # The adjoint is the sum of all contributions; its largest term is the largest of theirs, or itself.
        g, g_term = mpmath.fsum(v for v, _ in y.seeds), max(t for _, t in y.seeds)
        gradients[order] = Real(g, g_term)
        g_size, g_term, y.seeds = gradients[order].size, max(g_term, gradients[order].size), None
        for parent, p, p_size, p_term in y.parents:
            v = g * p
            parent.seeds = parent.seeds or []
            parent.seeds.append((v, min(max(size_of(v), g_term * p_size, g_size * p_term, LEAST_NORMAL), HUGE)))
    zero, found = Real(0), {}
    for name, array in inputs.items():
        found[name] = np.empty(array.shape, dtype=object)
        for index in np.ndindex(array.shape):
            found[name][index] = gradients.get(array[index].order, zero)
    return found


def reachable(pending):
    """All numbers behind a list of them, by the order in which they were made."""
    tape = {}
    while pending:
        y = pending.pop()
        if y.order not in tape:
            tape[y.order] = y
            pending.extend(parent for parent, *_ in y.parents)
    return tape


def double_double(array):
    """(hi, lo, term) of an array of `Real`: hi the nearest f64, lo the nearest f64 to what is left."""
    parts = [np.empty(array.shape) for _ in range(3)]
    for index in np.ndindex(array.shape):
        x = array[index]
        hi = float(x.value)
        lo = float(x.value - hi) if np.isfinite(hi) else 0.0
        for part, value in zip(parts, (hi, lo, x.term)):
            part[index] = value
    return parts
