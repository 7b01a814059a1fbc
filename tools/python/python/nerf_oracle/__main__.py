"""The program: `python -m nerf_oracle`, `nerf-oracle`."""

import signal
import sys

from . import _core


def main() -> int:
    """Runs it with this process's arguments."""
    # Ctrl-C ends it as it ends any program: Python's own handler would wait for Rust to return.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _core.run(["nerf-oracle", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
