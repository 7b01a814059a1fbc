"""Makes the fixtures under fixtures/, or checks that the committed ones still come out.

    python tools/golden.py                       all components
    python tools/golden.py --only volume_render  one of them
    python tools/golden.py --check               exit 1 and name the file where one differs

mpmath must come out bit by bit; torch and kornia within sixteen times the error that was recorded beside them (`ulp`, `unit`),
for they round differently on every processor.
"""

import argparse
import itertools
import multiprocessing
import os
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
    names = arguments.only or registry.COMPONENTS
    with multiprocessing.Pool(min(len(names), os.cpu_count() or 1)) as pool:
        for fixture in itertools.chain.from_iterable(pool.imap(registry.build, names)):
            where = f"{fixture.component}/{fixture.basis}"
            if arguments.check:
                problem = check.differs(fixture, arguments.out)
                failures += problem is not None
                print(f"{where}: {problem or 'comes out'}", flush=True)
            else:
                registry.write(fixture, arguments.out)
                print(f"{where}: {len(fixture.cases)} cases", flush=True)
    if arguments.check:
        failures += check.strangers(arguments.out)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
