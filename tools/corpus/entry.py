"""What an entry of the corpus is: a behavior met in somebody's code, re-created here, and what is expected of the judge."""

from dataclasses import dataclass

ENTRIES = []


@dataclass(frozen=True)
class Entry:
    """One behavior.

    `names` are the answers that are right for a fault, each a set of mistakes, or a slip as the judge words it ("slip: a / b in
    the place of b / a"); none: the catalog has no name for it, so that it must fail unnamed. `choice` is the convention that is
    to be reported, empty where the judge knows none for it: it must pass all the same. `digits`: the formula is right and loses
    digits, so that `imprecise` is as right as `pass`; `edges`: it can't take what few programs ever meet, so that `edge` is.
    `gradient`: what differs in the vjp row: "right", "none" (the row isn't asked), or the names expected there.
    """

    component: str
    function: object
    kind: str
    names: tuple
    choice: dict
    digits: bool
    edges: bool
    gradient: object
    arrays: str
    seen: str
    times: int

    @property
    def name(self):
        """Component and function."""
        return f"{self.component}.{self.function.__name__}"

    @property
    def text(self):
        """The behavior in words."""
        return " ".join(self.function.__doc__.split())


def added(component, kind, names=(), choice=None, *, seen, times=1, digits=False, edges=False, gradient=None, arrays="torch"):
    """A decorator that makes a function an entry."""

    def keep(function):
        alternatives = tuple(frozenset([name] if name.startswith("slip: ") else name.split("+")) for name in names)
        ENTRIES.append(Entry(component, function, kind, alternatives, choice or {}, digits, edges, gradient, arrays, seen, times))
        return function

    return keep


def right(component, **more):
    """The right formula, however it is written."""
    return added(component, "right", **more)


def convention(component, choice=None, **more):
    """A library's choice: passes, and is told."""
    return added(component, "convention", (), choice, **more)


def fault(component, *names, **more):
    """Wrong. Each name is one right answer; "a+b" is two mistakes together."""
    return added(component, "fault", names, **more)
