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

from ._core import VERSION as __version__
from .adapted import adapt
from .dealing import dealt
from .errors import CandidateError
from .judging import assert_pass, check_close, judge
from .report import Mistake, Report, Row

__all__ = [
    "__version__",
    "CandidateError",
    "Mistake",
    "Report",
    "Row",
    "adapt",
    "assert_pass",
    "bound",
    "check_close",
    "dealt",
    "functional",
    "judge",
    "oracle",
]

# Loaded when they are asked for: importing the package costs little more than numpy.
LATER = {"oracle": "oracle", "bound": "bound", "functional": "functional"}


def __getattr__(name):
    if name not in LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = import_module(f".{LATER[name]}", __name__)
    value = module.functional if name == "functional" else module
    globals()[name] = value
    return value


def __dir__():
    return sorted({*globals(), *__all__})
