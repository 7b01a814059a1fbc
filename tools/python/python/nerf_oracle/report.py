"""Verdicts: what the judge found, for people and for programs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from .errors import hint
from .rows import row_of


@dataclass(frozen=True)
class Mistake:
    """An explanation of the numbers: mistakes of the catalogue, and conventions that the candidate follows."""

    # The mistakes and the slip, joined by " + "; "" where a convention or lost digits alone explain the numbers.
    name: str
    cause: str
    effect: str
    fix: str
    seen: str
    conventions: dict[str, str]
    # Largest error over the explanation's own bound: at most 1.
    residual: float
    # Whether no answer can tell it from the best one.
    same_as_best: bool
    # Whether it is no mistake but the right formula with digits lost.
    inaccurate: bool
    # Outputs that it doesn't explain.
    unexplained: list[str]
    # Outputs that are right, and that its mistakes would change, too.
    spared: list[str]
    # Cases that it doesn't explain; most are.
    unexplained_cases: list[str]
    # What happens to one array beside the mistakes ("deltas its running sum, along axis 1"), where no catalogue lists it.
    slip: str | None
    # The number in the mistake (the width of a jitter, an eps, a factor), where it isn't the usual one.
    fitted: float | None
    # The numbers of all of them that have one, in their order, as far as they aren't the usual ones.
    numbers: list[float]


@dataclass(frozen=True)
class Row:
    """The verdict on a row in one direction; the fields are those of `nerf-oracle judge --json`."""

    name: str
    kind: str
    cases: int
    answered: int
    verdict: str
    grade: str | None
    # The same of each case of which two formulas' bounds differ, where the row is right.
    grades: dict[str, str]
    budget_used: float | None
    # The largest error in errors of the best honest form, where the row passes and that form makes one.
    over_honest: float | None
    vacuous: int
    unproved: list[str]
    lost_bits: int | None
    missing_outputs: list[str]
    worst_case: dict[str, Any] | None
    conventions: dict[str, str]
    shown_in: dict[str, str]
    contradiction: dict[str, str]
    layouts: list[str]
    findings: list[str]
    faults: list[str]
    left_out: dict[str, str]
    crashed: dict[str, str]
    # What the wrong cases of an `edge` row are, in the order of `wrong_cases`: "no samples", "one sample".
    edge_cases: list[str]
    # The cases of which something is wrong; of statistics, which take all cases together, none.
    wrong_cases: list[str]
    first_to_differ: str | None
    # What is known of a failure that nothing explains, output by output.
    observed: list[str]
    # The smallest case that is wrong: its inputs, and got and expected of the outputs that are off.
    example: dict[str, Any] | None
    diagnosis: list[Mistake]

    @property
    def passed(self) -> bool:
        """Whether every answer lies within its bound, and every output is proved."""
        return self.verdict == "pass"


def row_from(fields: dict[str, Any]) -> Row:
    """A row from the report's JSON."""
    known = {m["name"]: m for m in row_of(fields["name"])["mistakes"]}

    def mistake(given: dict[str, Any]) -> Mistake:
        found = {**given, "residual": number(given["residual"])}
        names = found.pop("mistakes")
        said = {
            key: " / ".join(known[name][key] for name in names if name in known) for key in ("cause", "effect", "fix", "seen")
        }
        other = found["slip"] or ""
        slip = [other if other.startswith("another formula: ") else f"a slip: {other}"] if other else []
        whole: dict[str, Any] = {"name": " + ".join(names + slip), **said, **found}
        return Mistake(**whole)

    worst = fields["worst_case"]
    changed = {
        "diagnosis": [mistake(found) for found in fields["diagnosis"]],
        "budget_used": number(fields["budget_used"]),
        "over_honest": number(fields["over_honest"]),
        "worst_case": worst and {key: x if key in ("id", "output", "index") else number(x) for key, x in worst.items()},
    }
    return Row(**{**fields, **changed})


def number(x: Any) -> Any:
    """JSON has no infinity: it came as text."""
    return None if x is None else float(x)


class Report:
    """What `judge` returns. `print(report)` is the page; `report["volume_render"]` and `report["volume_render", "vjp"]` are
    its rows."""

    def __init__(self, text: str, page: str, passed: bool, notes: list[str]) -> None:
        self.json: dict[str, Any] = json.loads(text)
        self.rows: list[Row] = [row_from(fields) for fields in self.json["components"]]
        self.passed: bool = passed
        self.notes: list[str] = notes
        self._page = page

    @property
    def profile(self) -> str:
        """The conventions that were pinned, or those that were found."""
        return self.json["profile"]

    @property
    def dtype(self) -> str:
        """The type under test."""
        return self.json["dtype"]

    def __getitem__(self, key: str | tuple[str, str]) -> Row:
        name, kind = (key, None) if isinstance(key, str) else key
        found = [row for row in self.rows if row.name == name and kind in (None, row.kind)]
        if not found:
            raise KeyError(f"{key}: not judged; {hint(str(name), [f'{row.name} {row.kind}' for row in self.rows])}")
        return found[0]

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __bool__(self) -> bool:
        return self.passed

    def __str__(self) -> str:
        notes = "".join(f"\n{note}" for note in self.notes)
        return self._page.rstrip() + ("\n" + notes if notes else "")

    def __repr__(self) -> str:
        rows = ", ".join(f"{row.name} {row.kind}: {row.verdict}" for row in self.rows)
        return f"<Report {'passed' if self.passed else 'not passed'}: {rows}>"
