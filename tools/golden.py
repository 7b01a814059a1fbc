"""Makes the fixtures under fixtures/, or checks that the committed ones still come out.

    python tools/golden.py                       all components
    python tools/golden.py --only volume_render  one of them
    python tools/golden.py --check               exit 1 and name the file where one differs

mpmath must come out bit by bit; torch and kornia within the error that was recorded beside them (`ulp`, `unit`).
"""

import argparse
import sys
from pathlib import Path

from golden import check, registry

ROOT = Path(__file__).resolve().parent.parent


def main():
    """Exit 0: done, or all fixtures come out; 1: one does not; 2: usage."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    parser.add_argument("--only", metavar="COMPONENT", action="append", choices=registry.COMPONENTS)
    parser.add_argument("--out", type=Path, default=ROOT / "fixtures", help="the folder of fixtures")
    arguments = parser.parse_args()
    failures = 0
    for component in arguments.only or registry.COMPONENTS:
        for fixture in registry.build(component):
            if arguments.check:
                problem = check.differs(fixture, arguments.out)
                failures += problem is not None
                print(f"{component}/{fixture.basis}: {problem or 'comes out'}", flush=True)
            else:
                print(f"{component}/{fixture.basis}: {len(fixture.cases)} cases", flush=True)
                registry.write(fixture, arguments.out)
    if arguments.check:
        failures += check.strangers(arguments.out)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
