"""What the second implementation's `np` is on a device: cupy, and numpy where no array is on the device (hyper-parameters).

Beside cupy's functions: it takes numpy's arrays and lists of arrays, and where cupy lacks a form, another that does the same.
"""

import cupy
import numpy

ndarray = cupy.ndarray
HOST = "float16 float32 float64 uint64 uint8 int64 inf pi nan promote_types errstate ndindex longdouble integer floating".split()


def on(x):
    """Whether an array is on the device."""
    return isinstance(x, ndarray)


def holds_arrays(x):
    """An array, or a list with one in it."""
    return on(x) or isinstance(x, numpy.ndarray) or (isinstance(x, (list, tuple)) and any(holds_arrays(y) for y in x))


def down(x):
    """To the host."""
    return cupy.asnumpy(x) if on(x) else x


def cast_(kind, x):
    """kind(x), where x may be on the device."""
    return x.astype(kind) if on(x) else kind(x)


def array(x, dtype=None):
    """Of lists with arrays of both kinds too."""
    if isinstance(x, (list, tuple)) and holds_arrays(x):
        parts = [array(y) for y in x]
        dtype = dtype or numpy.result_type(*(part.dtype for part in parts))
        return cupy.stack([part.astype(dtype) for part in parts])
    return cupy.array(x, dtype=dtype)


def asarray(x, dtype=None):
    """As it is where it is there already."""
    return (x if dtype is None else x.astype(dtype, copy=False)) if on(x) else array(x, dtype)


def concatenate(parts, axis=0):
    """Of arrays of both kinds."""
    return cupy.concatenate([asarray(part) for part in parts], axis)


def stack(parts, axis=0):
    """Of arrays of both kinds."""
    return cupy.stack([asarray(part) for part in parts], axis)


def append(x, y):
    """Flat."""
    x, y = asarray(x).reshape(-1), asarray(y).reshape(-1)
    kind = numpy.result_type(x.dtype, y.dtype)
    return concatenate([x.astype(kind), y.astype(kind)])


class Rows:
    """numpy.r_ of arrays and numbers."""

    def __getitem__(self, parts):
        return concatenate([asarray(part).reshape(-1) for part in (parts if isinstance(parts, tuple) else (parts,))])


r_ = Rows()


def split(x, at, axis=0):
    """At numbers on the host."""
    return cupy.split(x, [int(n) for n in down(asarray(at)).tolist()], axis)


def repeat(x, n, axis=None):
    """Counts on the host."""
    if on(n):
        n = [int(k) for k in down(n).tolist()] if n.ndim else int(n)
    return cupy.repeat(asarray(x), n, axis)


def divide(x, y, out=None, where=None):
    """With `where`, which cupy hasn't got."""
    if where is None:
        return cupy.divide(x, y)
    return cupy.where(where, x / cupy.where(where, y, y.dtype.type(1) if hasattr(y, "dtype") else 1), out)


def where(condition, x, y):
    """On the host where all of it is."""
    if not (on(condition) or on(x) or on(y)):
        return numpy.where(condition, x, y)
    x, y = (asarray(v) if isinstance(v, numpy.ndarray) else v for v in (x, y))
    return cupy.where(asarray(condition), x, y)


def searchsorted(a, v, side="left"):
    """Of one number too."""
    v = asarray(v)
    return cupy.searchsorted(a, v.reshape(-1) if not v.ndim else v, side).reshape(v.shape)


def delete(x, i, axis=None):
    """One index or a slice."""
    return cupy.delete(x, i if isinstance(i, slice) else int(i), axis)


def full(shape, value, dtype=None):
    """Of a value on the device too."""
    if on(value):
        return cupy.broadcast_to(value, shape).astype(dtype or value.dtype, copy=True)
    return cupy.full(shape, value, dtype)


def full_like(x, value, dtype=None):
    """Of a value on the device too."""
    return full(x.shape, value, dtype or x.dtype)


class Operation:
    """An elementwise function, on the host where all of its arguments are."""

    def __init__(self, name):
        self.device, self.host = getattr(cupy, name), getattr(numpy, name)

    def __call__(self, *given, **how):
        """Called."""
        if not any(holds_arrays(x) for x in given):
            return self.host(*given, **how)
        return self.device(*(asarray(x) if isinstance(x, (list, numpy.ndarray)) else x for x in given), **how)

    def at(self, x, i, v):
        """Scattered."""
        return self.device.at(x, i, v.astype(x.dtype) if on(v) else v)


class Drawn:
    """numpy's generator: what it draws goes to the device."""

    def __init__(self, seed):
        self.generator = numpy.random.default_rng(seed)

    def __getattr__(self, name):
        return lambda *given, **how: cupy.asarray(getattr(self.generator, name)(*given, **how))


class random:
    """The part of numpy.random that is used."""

    default_rng = Drawn


linalg = cupy.linalg


def __getattr__(name):
    if name in HOST:
        return getattr(numpy, name)
    if isinstance(getattr(numpy, name), numpy.ufunc):
        return Operation(name)
    function = getattr(cupy, name)

    def call(first, *rest, **how):
        first = array(first) if isinstance(first, list) else first
        return function(*(asarray(x) if isinstance(x, numpy.ndarray) else x for x in (first, *rest)), **how)

    return call
