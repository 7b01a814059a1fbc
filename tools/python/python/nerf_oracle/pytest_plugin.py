"""The judge as tests of pytest: one item a row and direction.

    @pytest.mark.nerf_oracle("volume_render", dtype="f32")
    def test_volume_render(sigmas, rgbs, deltas):       # the kernel itself, or what calls it
        return my_volrend(sigmas, rgbs, deltas)

    @pytest.mark.nerf_oracle("volume_render", "composite_background")
    def test_renderer(renderer):                        # fixtures in, kernels by row out
        return {"volume_render": renderer.march, "composite_background": renderer.over}

Further settings of the mark are those of `nerf_oracle.judge`. `nerf_oracle_xfail = "FILE"` in pytest's configuration names
what is known to fail, a line each: row, direction, reason. What is listed and passes fails.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import pytest

DIRECTION = "nerf_oracle_row"
SETTINGS = ("dtype", "profile", "framework", "device", "again", "allow")


def pytest_addoption(parser: pytest.Parser) -> None:
    """The setting."""
    parser.addini("nerf_oracle_xfail", "file of rows that are known to fail: row, direction, reason", default="")


def pytest_configure(config: pytest.Config) -> None:
    """The mark, with which `--strict-markers` knows it."""
    config.addinivalue_line("markers", "nerf_oracle(row, ..., dtype='f32', profile=None): judge what the function is or returns")


def pytest_pycollect_makeitem(collector: Any, name: str, obj: Any) -> Any:
    """A kernel's own parameters are arrays, no fixtures: pytest collects a function without any in its place."""
    mark = next((mark for mark in getattr(obj, "pytestmark", []) if getattr(mark, "name", "") == "nerf_oracle"), None)
    if mark is None or not is_kernel(obj, mark):
        return None

    def kernel() -> Any:
        return obj

    vars(kernel).update(vars(obj), __test__=True)
    return collector.ihook.pytest_pycollect_makeitem(collector=collector, name=name, obj=kernel)


def is_kernel(function: Any, mark: Any) -> bool:
    """Whether a function's parameters are inputs of the row."""
    from .errors import CandidateError
    from .names import matched
    from .rows import row_of

    if len(mark.args) != 1 or not callable(function):
        return False
    try:
        row = row_of(mark.args[0])
        match = matched(function, row, [port["name"] for port in row["inputs"]], {})
    except CandidateError:
        return False
    return match.names is None or bool(match.names)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One item a row and direction."""
    mark = metafunc.definition.get_closest_marker("nerf_oracle")
    if mark is not None:
        known = xfails(metafunc.config)
        metafunc.fixturenames.append(DIRECTION)
        metafunc.parametrize(DIRECTION, [param(key, known) for key in directions(mark)])


def param(key: tuple[str, str], known: dict[tuple[str, str], str]) -> Any:
    """A row and direction, expected to fail where it is listed."""
    marks = [pytest.mark.xfail(reason=known[key], strict=True)] if key in known else []
    return pytest.param(key, id="-".join(key), marks=marks)


def directions(mark: pytest.Mark) -> Iterator[tuple[str, str]]:
    """The rows and directions of a mark."""
    from .errors import CandidateError
    from .rows import row_of

    unknown = [name for name in mark.kwargs if name not in (*SETTINGS, "gradients")]
    if not mark.args or unknown:
        found = f"no setting {unknown[0]!r}" if unknown else "no row"
        pytest.fail(f"nerf_oracle: {found}. Expected: rows, then {', '.join(SETTINGS)}, gradients", pytrace=False)
    for name in mark.args:
        try:
            row = row_of(name)
        except CandidateError as error:
            pytest.fail(f"nerf_oracle: {error}", pytrace=False)
        yield name, row["kind"]
        if row["vjp"] and mark.kwargs.get("gradients", True):
            yield name, "vjp"


def xfails(config: pytest.Config) -> dict[tuple[str, str], str]:
    """The rows that are known to fail, from the file that the configuration names."""
    from .rows import rows

    file = config.getini("nerf_oracle_xfail")
    if not file:
        return {}
    path, out = Path(config.rootpath, file), {}
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        pytest.fail(f"nerf_oracle_xfail: {path}: {error.strerror}", pytrace=False)
    for n, line in enumerate(lines, 1):
        words = line.partition("#")[0].split(None, 2)
        if not words:
            continue
        row = rows().get(words[0])
        kinds = [] if row is None else [row["kind"], *["vjp"] * row["vjp"]]
        if len(words) < 3 or words[1] not in kinds:
            expected = (
                f"a direction of {words[0]} ({', '.join(kinds)}) and a reason" if row else "a row, a direction and a reason"
            )
            pytest.fail(f"{path}:{n}: found {line.strip()!r}, expected {expected}", pytrace=False)
        out[words[0], words[1]] = words[2]
    return out


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Judges what the function is or returns. A failure is the judge's page, without a traceback."""
    mark = pyfuncitem.get_closest_marker("nerf_oracle")
    if mark is None:
        return None
    name, kind = cast("tuple[str, str]", pyfuncitem.callspec.params[DIRECTION])
    report = judged(pyfuncitem, mark)
    rows = [row for row in report if (row.name, row.kind) == (name, kind)]
    if not rows:
        pytest.skip(next((note for note in report.notes if note.startswith(f"{name}:")), f"{name} {kind}: not judged"))
    if not (rows[0].passed or rows[0].verdict in mark.kwargs.get("allow", ())):
        pytest.fail(str(report), pytrace=False)
    return True


def judged(item: pytest.Function, mark: pytest.Mark) -> Any:
    """The report on an item's kernels: the same for both directions of a kernel, so that it is made once."""
    from .errors import CandidateError
    from .judging import judge

    kernels = (
        item.obj if is_kernel(item.obj, mark) else item.obj(**{name: item.funcargs[name] for name in item._fixtureinfo.argnames})
    )
    kernels = kernels if isinstance(kernels, dict) else {mark.args[0]: kernels}
    if any(not callable(kernel) for kernel in kernels.values()):
        pytest.fail(f"nerf_oracle: {item.name} returned no function to judge, nor a dict of functions by row", pytrace=False)
    kept = item.session.stash.setdefault(REPORTS, [])
    settings = dict(mark.kwargs)
    for known, before, report in kept:
        if settings == before and kernels.keys() == known.keys() and all(kernels[name] is known[name] for name in known):
            return report
    try:
        report = judge(**settings, **kernels)
    except CandidateError as error:
        pytest.fail(str(error), pytrace=False)
    kept.append((kernels, settings, report))
    return report


REPORTS: pytest.StashKey[list[Any]] = pytest.StashKey()
