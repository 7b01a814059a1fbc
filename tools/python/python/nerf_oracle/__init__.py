"""What is wrong with your NeRF code, and probably why.

    import nerf_oracle as no

    print(no.judge(volume_render=my_volrend))            # a verdict, with a named mistake
    no.assert_pass(volume_render=my_volrend)             # the same in a test
    no.oracle.volume_render(sigmas, rgbs, deltas)        # the reference in f64; its gradient: no.oracle.volume_render.vjp
    no.bound.volume_render(sigmas, rgbs, deltas)         # how far an honest f32 kernel may be off on these inputs
    no.check_close(mine, "volume_render", sigmas=sigmas, rgbs=rgbs, deltas=deltas)

`dir(no.oracle)` has the rows of the contract; `help(no.oracle.volume_render)` the shapes and units of one.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import bound, oracle
    from ._core import VERSION as __version__
    from .adapted import adapt
    from .dealing import dealt
    from .errors import CandidateError
    from .functional import functional
    from .judging import assert_pass, check_close, judge
    from .report import Mistake, Report, Row

__all__ = [
    "CandidateError",
    "Mistake",
    "Report",
    "Row",
    "__version__",
    "adapt",
    "assert_pass",
    "bound",
    "check_close",
    "dealt",
    "functional",
    "judge",
    "oracle",
]

# Where each name is. They come when they are asked for: pytest loads the package in every session, with its plugin.
WHERE = {
    "CandidateError": "errors",
    "Mistake": "report",
    "Report": "report",
    "Row": "report",
    "__version__": "_core",
    "adapt": "adapted",
    "assert_pass": "judging",
    "check_close": "judging",
    "dealt": "dealing",
    "functional": "functional",
    "judge": "judging",
}


def __getattr__(name: str) -> Any:
    if name in ("bound", "oracle"):
        return import_module(f".{name}", __name__)
    if name not in WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{WHERE[name]}", __name__), "VERSION" if name == "__version__" else name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
