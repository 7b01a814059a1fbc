"""The tables of tools/README.md and DEVIATIONS.md."""

import inspect
import json
import math
import sys
import textwrap
import warnings

import mpmath
from bases import BASES, COMPOSED, FIXTURES, distance
from beside.similarity import ssims
from entry import ENTRIES
from reproduction import DEVIATIONS
from verdicts import HERE, judged, load, program, stale

README, DEVIATIONS_PAGE = HERE.parent / "README.md", HERE / "DEVIATIONS.md"


KINDS = {"bug": "A bug.", "digits": "Digits are lost.", "choice": "A choice."}
HEAD = """# Where libraries deviate, each with a few lines that show it

Written by `python tools/libraries`, which runs every one of them: found is what the library returned, expected what mpmath has
at 50 digits, or what follows from the definition alone. A *bug* contradicts the library's own documentation or the paper's
formula; *digits* are lost for no reason; a *choice* is right to have and good to know."""


def table(columns, rows):
    """Markdown."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def usual(tool):
    """The conventions of the default profile: the first value of each."""
    return {convention["name"]: convention["values"][0] for convention in program(tool, "list")["conventions"]}


def of_verdicts(verdicts, usual):
    """A line for every entry."""
    rows = []
    for entry in dict.fromkeys(v.entry for v in verdicts):
        own = [v for v in verdicts if v.entry is entry]
        cells = [cell([(v.kind, v.by_type.get(dtype)) for v in own]) for dtype in ("f64", "f32", "bf16")]
        others = {k: x for v in own for k, x in v.conventions.items() if usual.get(k) != x}
        conventions = ", ".join(f"{k} = {x}" for k, x in sorted(others.items())) or "the usual"
        kinds = ", ".join(v.kind for v in own)
        rows.append([entry.title, f"`{entry.component}` {kinds}", f"`{entry.call}`", *cells, conventions, entry.why])
    return table(["library", "row", "what answers", "f64", "f32", "bf16", "conventions found", "what doesn't pass"], rows)


def cell(kinds):
    """One verdict where all kinds have it, else one each."""
    said = {verdict for _, verdict in kinds}
    if len(said) == 1:
        return said.pop() or "-"
    return ", ".join(f"{kind} {verdict or '-'}" for kind, verdict in kinds)


def bound(ulp):
    """The next power of two: other machines round otherwise."""
    return "0" if ulp == 0 else f"<= {2 ** max(0, math.ceil(math.log2(ulp)))}"


def of_bases():
    """A line for every component and library; `single source` where there is none."""
    components = {note["component"]: note for note in (json.loads(p.read_text()) for p in sorted(FIXTURES.glob("*/mpmath.json")))}
    rows = []
    for component in components:
        own = [basis for basis in BASES if basis.component == component]
        kornia = (FIXTURES / component / "kornia.json").exists()
        if kornia:
            rows.append([f"`{component}`", "kornia 0.8.2, in the fixtures", "its own cases", "recorded there", ""])
        for basis in own:
            far = distance(basis)
            what = "forward, vjp" if far.gradients else "forward"
            rows.append([f"`{component}`", basis.title, f"{far.compared} of {far.cases}, {what}", bound(far.ulp), basis.setting])
        if not own and not kornia:
            why = "through its parts" if component in COMPOSED else "**single source**"
            rows.append([f"`{component}`", why, "", "", ""])
    ssim = "SSIM (`src/ssim/tests.rs`)"
    rows += [[ssim, title, "two pairs of pictures", bound(ulp), note] for title, ulp, note in ssims()]
    return table(["component", "basis beside mpmath and torch", "cases", "ULP of the largest term", "what was set"], rows)


def shown(x):
    """A number with all its digits."""
    return repr(float(x))


def of_deviations():
    """DEVIATIONS.md."""
    parts = [HEAD]
    for deviation in DEVIATIONS:
        found, expected = deviation.function()
        if close(found, expected):
            raise SystemExit(f"{deviation.name}: {deviation.title}: doesn't deviate any more; take it out")
        parts += [
            f"## {deviation.name}: {deviation.title}",
            f"{KINDS[deviation.kind]} {deviation.why}",
            f"```python\n{body(deviation.function)}\n```",
            f"found {', '.join(map(shown, found))}; expected {', '.join(map(shown, expected))}",
        ]
    wrapped = [part if part.startswith(("```", "#")) else textwrap.fill(part, 130) for part in parts]
    return "\n\n".join(wrapped) + "\n"


def close(found, expected):
    """Within 4 ULP."""
    same = lambda a, b: a == b or (math.isfinite(b) and abs(a - b) <= 4 * math.ulp(b))  # noqa: E731
    return len(found) == len(expected) and all(map(same, found, expected))


def body(function):
    """The lines of a reproduction, without the docstring and the return."""
    lines = inspect.getsource(function).split('"""', 2)[2].strip("\n").splitlines()
    return textwrap.dedent("\n".join(lines)).replace("return found, expected", "print(found, expected)").strip()


def put(page, name, text):
    """A page with what stands between two markers replaced."""
    begin, end = f"<!-- {name}: begin, written by python tools/libraries -->\n", f"\n<!-- {name}: end -->"
    head, rest = page.split(begin)
    return head + begin + text + end + rest.split(end)[1]


def written(tool, check):
    """Exit 0: written, or as they are; 1: otherwise, or something is stale."""
    warnings.filterwarnings("ignore")
    mpmath.mp.dps = 50
    for package in ("beside", "deviations"):
        load(package)
    load("adapters")
    verdicts = judged(tool, ENTRIES)
    problems = stale(verdicts)
    page = put(README.read_text(encoding="utf-8"), "verdicts", of_verdicts(verdicts, usual(tool)))
    pages = {README: put(page, "bases", of_bases()), DEVIATIONS_PAGE: of_deviations()}
    for path, text in pages.items():
        if check and (not path.exists() or path.read_text(encoding="utf-8") != text):
            problems.append(f"{path}: comes out otherwise; write it again: python tools/libraries")
        if not check:
            path.write_text(text, encoding="utf-8")
    print("\n".join(problems) or f"{len(verdicts)} rows, {len(DEVIATIONS)} deviations", file=sys.stderr)
    return 1 if problems else 0
