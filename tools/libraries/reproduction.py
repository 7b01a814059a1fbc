"""Where a library deviates from the formula: a few lines that show it, what they find, and what mpmath says at 50 digits.

Each function is a reproduction that can be pasted; pages.py prints its body. `found` and `expected` are lists of numbers.
"""

from dataclasses import dataclass
from importlib.metadata import version

DEVIATIONS = []


@dataclass(frozen=True)
class Deviation:
    """`kind`: a bug, digits that are lost, or a choice of the library's that callers should know."""

    package: str
    title: str
    kind: str
    function: object

    @property
    def name(self):
        """The library with its version."""
        return f"{self.package} {version(self.package)}"

    @property
    def why(self):
        """Its reason: the function's docstring."""
        return " ".join(self.function.__doc__.split())


def deviation(package, kind, title):
    """A decorator that makes a function a reproduction."""

    def keep(function):
        DEVIATIONS.append(Deviation(package, title, kind, function))
        return function

    return keep
