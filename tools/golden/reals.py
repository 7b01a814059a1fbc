"""Real numbers at 50 digits that remember how they were made: values, vector-Jacobian products and largest terms.

`Real` is an mpmath number on a tape. A reverse sweep over the tape differentiates the written definition, so that the
gradients here share nothing with the crate's hand-written ones.

Each number also carries `term`, the size that a rounding error in it is measured against. Inputs are exact (0). A sum has
the largest of its terms, a function f(x) has |f'(x)| term(x), and nothing has less than its own absolute value:
a first-order error analysis with max in the place of sum. An error of k ULP "of the largest term" is k ulp(term).
"""

import mpmath
import numpy as np
from mpmath import mp, mpf

mp.dps = 50


class Real:
    """A number, its largest term, and (parent, partial derivative, largest term of the partial) of what it came from."""

    __slots__ = ("value", "term", "parents", "seeds", "order")
    count = 0

    def __init__(self, value, term=0, parents=()):
        self.value, self.parents, self.seeds = mpf(value), parents, None
        self.term = term
        Real.count += 1
        self.order = Real.count

    def __neg__(self):
        return Real(-self.value, self.term, ((self, mpf(-1), 0),))

    def __add__(self, other):
        return total([self, other]) if isinstance(other, Real) else total([self, Real(other)])

    def __sub__(self, other):
        other = other if isinstance(other, Real) else Real(other)
        value = self.value - other.value
        return Real(value, max(abs(value), self.term, other.term), ((self, mpf(1), 0), (other, mpf(-1), 0)))

    def __rsub__(self, other):
        return Real(other) - self

    def __mul__(self, other):
        other = other if isinstance(other, Real) else Real(other)
        value = self.value * other.value
        term = max(abs(value), self.term * abs(other.value), abs(self.value) * other.term)
        return Real(value, term, ((self, other.value, other.term), (other, self.value, self.term)))

    def __truediv__(self, other):
        return self * (other if isinstance(other, Real) else Real(other)).reciprocal()

    __radd__, __rmul__ = __add__, __mul__

    def reciprocal(self):
        """1/x."""
        r = 1 / self.value
        return self.function(r, -r * r, 2 * r**3)

    def function(self, value, first, second):
        """f(x) from f(x), f'(x) and f''(x)."""
        term = max(abs(value), abs(first) * self.term)
        return Real(value, term, ((self, first, max(abs(first), abs(second) * self.term)),))


def total(numbers):
    """The sum of a list. Its largest term is that of the list, or of a single addition its result."""
    numbers = list(numbers)
    value = mpmath.fsum(x.value for x in numbers)
    terms = [x.term for x in numbers] + ([abs(x.value) for x in numbers] if len(numbers) > 2 else [])
    return Real(value, max([abs(value), *terms]), tuple((x, mpf(1), 0) for x in numbers))


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
    return x.function(x.value, mpf(1), 0) if x.value > 0 else x.function(mpf(0), mpf(0), 0)


def sigmoid(x):
    """1 / (1 + e^-x)."""
    s = 1 / (1 + mpmath.exp(-x.value))
    return x.function(s, s * (1 - s), s * (1 - s) * (1 - 2 * s))


def lift(array):
    """An array of exact inputs."""
    array = np.asarray(array, dtype=np.float64)
    out = np.empty(array.shape, dtype=object)
    for index in np.ndindex(array.shape):
        out[index] = Real(float(array[index]))
    return out


def vjp(outputs, cotangents, inputs):
    """For each array of `inputs`, sum over all outputs y of cotangent(y) dy/dx, as an array of `Real`."""
    tape, pending = {}, []
    for name, cotangent in cotangents.items():
        for index in np.ndindex(cotangent.shape):
            y = outputs[name][index]
            y.seeds = (y.seeds or []) + [(mpf(float(cotangent[index])), mpf(0))]
            pending.append(y)
    while pending:
        y = pending.pop()
        if y.order not in tape:
            tape[y.order] = y
            pending.extend(parent for parent, _, _ in y.parents)
    gradients = {}
    for order in sorted(tape, reverse=True):
        y = tape[order]
        g, g_term = collect(y.seeds)
        gradients[order] = Real(g, g_term)
        for parent, p, p_term in y.parents:
            v = g * p
            parent.seeds = parent.seeds or []
            parent.seeds.append((v, max(abs(v), g_term * abs(p), abs(g) * p_term)))
        y.seeds = None
    zero = Real(0)
    found = {}
    for name, array in inputs.items():
        found[name] = np.empty(array.shape, dtype=object)
        for index in np.ndindex(array.shape):
            found[name][index] = gradients.get(array[index].order, zero)
    return found


def collect(seeds):
    """The adjoint of a node: the sum of its contributions, and the largest of them."""
    value = mpmath.fsum(v for v, _ in seeds)
    return value, max([abs(value)] + [t for _, t in seeds])


def double_double(array):
    """(hi, lo, term) of an array of `Real`: hi the nearest f64, lo the nearest f64 to what is left."""
    parts = [np.empty(array.shape) for _ in range(3)]
    for index in np.ndindex(array.shape):
        x = array[index]
        hi = float(x.value)
        lo = float(x.value - hi) if np.isfinite(hi) else 0.0
        for part, value in zip(parts, (hi, lo, float(x.term))):
            part[index] = value
    return parts


def constant(value):
    """A number that isn't exact in f64, such as ln 10: known to within its own rounding."""
    return Real(value, abs(value))


def softplus(x):
    """log(1 + e^x)."""
    s = 1 / (1 + mpmath.exp(-x.value))
    value = mpmath.log1p(mpmath.exp(x.value)) if x.value < 0 else x.value + mpmath.log1p(mpmath.exp(-x.value))
    return x.function(value, s, s * (1 - s))


def one_minus_power(base, exponent):
    """1 - base^exponent without cancellation, for an exact base below 1."""
    value = -mpmath.expm1(exponent * mpmath.log(base.value))
    power = base.value**exponent
    first, second = -exponent * power / base.value, -exponent * (exponent - 1) * power / base.value**2
    return base.function(value, first, second)
