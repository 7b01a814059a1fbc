"""What is said of functions and arguments that don't fit."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class CandidateError(ValueError):
    """A function, an argument or an array that can't be judged: what was found, what was expected, what to do."""


def hint(name: str, names: Iterable[str]) -> str:
    """The nearest of the names that would have been right, and all of them."""
    names = list(names)
    near = difflib.get_close_matches(name, names, 1)
    return f"{f'did you mean {near[0]}? ' if near else ''}Expected: {', '.join(names)}"
