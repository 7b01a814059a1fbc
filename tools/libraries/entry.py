"""What an adapter's entry is: one row of the contract, answered by a library's own functions."""

from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version

ENTRIES = []


@dataclass(frozen=True)
class Entry:
    """`call` names the library's functions; `dtypes` the types they are asked in; `arrays` whose arrays they take; `why` what
    doesn't pass, and why."""

    package: str
    component: str
    call: str
    function: object
    dtypes: tuple
    arrays: str
    why: str

    @property
    def key(self):
        """A name that says which: library, row, and the function where a library has several for a row."""
        return f"{self.package}.{self.function.__name__}"

    @property
    def title(self):
        """The library with its version."""
        return f"{self.package} {version(self.package)}"


def answers(package, component, call, *, dtypes=("f64", "f32", "bf16"), arrays="torch", why=""):
    """A decorator that makes a function an entry."""

    def keep(function):
        ENTRIES.append(Entry(package, component, call, function, dtypes, arrays, why))
        return function

    return keep


@contextmanager
def replaced(module, **functions):
    """Functions of a module replaced for a while: how a draw of a library's own is handed the case's numbers."""
    own = {name: getattr(module, name) for name in functions}
    for name, function in functions.items():
        setattr(module, name, function)
    try:
        yield
    finally:
        for name, function in own.items():
            setattr(module, name, function)
